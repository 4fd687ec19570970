//! The faults of a scene: each names file, key, value and what is allowed.
//!
//! All faults of a scene are found in one pass:
//!
//! ```
//! use common::scene::SceneSource;
//!
//! let text = r#"
//!     [scene]
//!     name = "faulty"
//!     [life]
//!     cycles = 0
//!     checkpoint_every = "10"
//! "#;
//! let faults = SceneSource::parse(text, "faulty.toml").unwrap_err();
//! let keys: Vec<&str> = faults.0.iter().map(|fault| fault.key.as_str()).collect();
//! assert_eq!(keys, ["bodies", "joints", "life.period", "life.cycles", "life.checkpoint_every"]);
//! println!("{faults}"); // faulty.toml: life.cycles: 0 is out of range, allowed: 1 to 100000000 ...
//! ```

use super::expression::read_unit;
use super::location::Location;
use super::quantity::{Dimension, Kind};
use crate::accuracy::AccuracyNameError;
use std::collections::BTreeSet;
use std::ops::Range;
use thiserror::Error;

/// All faults of a scene, found in one pass; displayed one per line, after their number if there are several.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}", in_lines(.0))]
pub struct Faults(pub Vec<Fault>);

/// One fault and where it is.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{file}: {}{kind}", if key.is_empty() { String::new() } else { format!("{key}: ") })]
pub struct Fault {
    /// The file, or the name of a built-in scene.
    pub file: String,
    /// Path of the key, rows of a list by their name, e.g. `joints.1.bushing_radius`; empty for the whole file.
    pub key: String,
    /// Kind of fault, with its values.
    pub kind: FaultKind,
    /// Place in the text; of a faulty parameter that of its definition. None for what is in no text.
    pub location: Option<Box<Location>>,
    /// Where the parameter is used whose definition is at `location`; of a name or key that is given twice its first place.
    pub used_at: Option<Box<Location>>,
}

impl Fault {
    /// A fault whose place in the text is not known yet.
    pub fn new(file: impl Into<String>, key: impl Into<String>, kind: impl Into<FaultKind>) -> Self {
        Fault { file: file.into(), key: key.into(), kind: kind.into(), location: None, used_at: None }
    }

    /// A fault at the bytes `span` of the text of its file.
    pub fn at(file: &str, text: &str, span: Range<usize>, key: &str, kind: impl Into<FaultKind>) -> Self {
        let location = Some(Box::new(Location::new(file, text, span)));
        Fault { location, ..Self::new(file, key, kind) }
    }
}

impl Faults {
    /// A single fault.
    pub fn one(file: &str, key: &str, kind: impl Into<FaultKind>) -> Self {
        Faults(vec![Fault::new(file, key, kind)])
    }

    /// These faults without their places, for a text that no person wrote.
    pub fn without_places(self) -> Self {
        Faults(self.0.into_iter().map(|fault| Fault::new(fault.file, fault.key, fault.kind)).collect())
    }
}

/// Kinds of fault.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FaultKind {
    /// The file could not be read. Holds the reason given by the operating system.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// No built-in scene and no file has this name.
    #[error("no such scene or file{}; built-in scenes: {}", suggestion(nearest), known.join(", "))]
    UnknownScene {
        /// Built-in name nearest to it, if near enough.
        nearest: Option<String>,
        /// Names of all built-in scenes.
        known: Vec<String>,
    },
    /// Scenes extend each other in a circle, or through too many files. Holds the largest number of scenes in a chain.
    #[error("`extends` goes through more than {0} scenes: is it a circle?")]
    ExtendsTooDeep(usize),
    /// The text is not valid TOML.
    #[error("TOML parse error at line {line}, column {column}: {message}")]
    Syntax {
        /// Number of the line, from 1.
        line: usize,
        /// Number of the column, from 1.
        column: usize,
        /// Message of the parser.
        message: String,
    },
    /// A key that the table does not have.
    #[error("unknown key{}; allowed here: {}", suggestion(nearest), known.join(", "))]
    UnknownKey {
        /// Allowed key nearest to it, if near enough.
        nearest: Option<String>,
        /// Keys allowed in this table.
        known: Vec<String>,
    },
    /// A required key is missing. Holds the value expected, in words.
    #[error("is missing, expected {0}")]
    Missing(String),
    /// Another type of TOML value.
    #[error("{value} is {found}, expected {expected}")]
    WrongType {
        /// The value as written.
        value: String,
        /// Type of the value.
        found: String,
        /// Type expected, in words.
        expected: String,
    },
    /// A number without a unit where one is needed, or a text without a unit of angle: `30`, or `900 1/min`.
    #[error("{value} has no {unit}, expected {} ({}, ...)", expected.name, expected.units)]
    NoUnit {
        /// The value as written.
        value: String,
        /// What it does not have: `unit`, or `unit of angle`.
        unit: &'static str,
        /// The kind of quantity that belongs there.
        expected: Kind,
    },
    /// A unit of angle where none belongs.
    #[error("{value} has a unit of angle, expected {}", expected.name)]
    AngleUnit {
        /// The value as written.
        value: String,
        /// The kind of quantity that belongs there.
        expected: Kind,
    },
    /// A unit of another kind.
    #[error("{value} is {found}, expected {} ({})", expected.name, units(expected))]
    WrongUnit {
        /// The value as written.
        value: String,
        /// Dimension of the value.
        found: Dimension,
        /// The kind of quantity that belongs there.
        expected: Kind,
    },
    /// Not an expression, or one whose dimensions do not fit.
    #[error("{value}: {message}")]
    Expression {
        /// The value as written.
        value: String,
        /// Message of the evaluator.
        message: String,
        /// The piece of the value that cannot be read.
        piece: Option<String>,
    },
    /// A number outside its range.
    #[error("{value} is out of range, allowed: {allowed}")]
    OutOfRange {
        /// The value as written, or as a variable set it.
        value: String,
        /// Allowed range, in words.
        allowed: String,
    },
    /// A text that is not the name of an accuracy.
    #[error(transparent)]
    Accuracy(AccuracyNameError),
    /// A word that is not one of those known.
    #[error("\"{value}\" is unknown{}; allowed: {}", suggestion(nearest), known.join(", "))]
    UnknownWord {
        /// The word as written.
        value: String,
        /// Allowed word nearest to it, if near enough.
        nearest: Option<String>,
        /// All allowed words.
        known: Vec<String>,
    },
    /// A reference to a name that the scene does not have.
    #[error(
        "there is no {what} \"{value}\"{}; there {}",
        suggestion(nearest),
        if known.is_empty() { "is none".to_owned() } else { format!("are: {}", list(known)) }
    )]
    UnknownReference {
        /// Kind of thing: body, point, joint, material, output, variable, quantity.
        what: &'static str,
        /// The name as written.
        value: String,
        /// Existing name nearest to it, if near enough.
        nearest: Option<String>,
        /// Names that exist.
        known: Vec<String>,
    },
    /// A name that another row of the list has already.
    #[error("the name \"{value}\" is taken, names of {what} are unique: change one of the two")]
    Duplicate {
        /// Path of the list.
        what: String,
        /// The name as written.
        value: String,
    },
    /// A text that cannot be a name.
    #[error("\"{value}\" cannot be a name: {reason}; use another one")]
    BadName {
        /// The name as written.
        value: String,
        /// Reason, as a clause.
        reason: String,
    },
    /// Values that contradict each other.
    #[error("{message}")]
    Inconsistent {
        /// The contradiction, in words.
        message: String,
    },
    /// A random variable makes the scene invalid at one of its bounds, or at its 1e-6 or 1 - 1e-6 quantile.
    #[error("at {value}, {} of this variable, the scene is invalid: {fault}; {}", end(*.hard), remedy(*.hard))]
    BoundOutsidePhysics {
        /// The bound or quantile, with its unit.
        value: String,
        /// True for a bound, false for a quantile.
        hard: bool,
        /// The fault of the scene at this value.
        fault: String,
    },
    /// A sample or setting of the wrong length.
    #[error("a sample of {found} values was given, the scene has {expected} random variables")]
    SampleLength {
        /// Number of values given.
        found: usize,
        /// Number of random variables of the scene.
        expected: usize,
    },
}

/// A contradiction, in words.
impl From<String> for FaultKind {
    fn from(message: String) -> Self {
        Self::Inconsistent { message }
    }
}

/// A contradiction, in words.
impl From<&str> for FaultKind {
    fn from(message: &str) -> Self {
        message.to_owned().into()
    }
}

impl FaultKind {
    /// A key that is none of those `known`.
    pub(super) fn unknown_key<'n>(key: &str, known: impl Iterator<Item = &'n str> + Clone) -> Self {
        let nearest = nearest(key, known.clone());
        // Types of one element share keys.
        let mut seen = BTreeSet::new();
        Self::UnknownKey {
            nearest,
            known: known.filter(|key| seen.insert(*key)).map(str::to_owned).collect(),
        }
    }

    /// A word that is none of those `known`.
    pub fn unknown_word<'n>(word: &str, known: impl Iterator<Item = &'n str> + Clone) -> Self {
        let (nearest, known) = (nearest(word, known.clone()), known.map(str::to_owned).collect());
        Self::UnknownWord { value: word.to_owned(), nearest, known }
    }

    /// A name that is none of those `known`, of a kind of thing.
    pub fn unknown_reference<'n>(
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Self {
        let (nearest, known) = (nearest(name, known.clone()), known.map(str::to_owned).collect());
        Self::UnknownReference { what, value: name.to_owned(), nearest, known }
    }

    /// What [`Fault::used_at`] points to, in words.
    pub(super) fn related(&self) -> &'static str {
        match self {
            Self::Duplicate { .. } | Self::Syntax { .. } => "first at",
            _ => "used at",
        }
    }

    /// True if a value is not of the kind or in the range expected, whatever it is the value of.
    pub(super) fn is_of_a_value(&self) -> bool {
        matches!(
            self,
            Self::WrongUnit { .. } | Self::NoUnit { .. } | Self::AngleUnit { .. } | Self::OutOfRange { .. }
        )
    }
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!(", did you mean \"{name}\"?")).unwrap_or_default()
}

fn end(hard: bool) -> &'static str {
    if hard { "a bound" } else { "a 1e-6 tail quantile" }
}

fn remedy(hard: bool) -> &'static str {
    if hard {
        "use a smaller std or truncation, or lower and upper"
    } else {
        "use a smaller std, or a distribution with bounds"
    }
}

fn in_lines(faults: &[Fault]) -> String {
    match faults {
        [one] => one.to_string(),
        many => {
            many.iter().fold(format!("{} faults", many.len()), |text, fault| format!("{text}\n  {fault}"))
        }
    }
}

/// The names that exist, at most twelve of them.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 12;
    match names.len().checked_sub(SHOWN) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{} and {more} more", names[..SHOWN].join(", ")),
    }
}

fn units(kind: &Kind) -> String {
    if kind.units.is_empty() { "no unit".to_owned() } else { format!("{}, ...", kind.units) }
}

/// The name of `known` nearest to `name`, if near enough for a typing error.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .filter(|(distance, candidate)| {
            let length = candidate.chars().count();
            let is_near = *distance <= 1 + length / 3 || strsim::jaro_winkler(name, candidate) > 0.9;
            // A name of which no letter is left is another one.
            is_near && *distance < length.max(name.chars().count())
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate.to_owned())
}

/// A number to six digits, with an exponent only where needed.
pub(super) fn six_digits(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    let plain = rounded == 0.0 || (1e-3..1e6).contains(&f64::abs(rounded));
    if plain { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// A value in SI, converted to a unit and followed by it.
pub(super) fn in_unit(value: f64, symbol: &str) -> String {
    match read_unit(symbol) {
        Ok(unit) => format!("{} {symbol}", six_digits(value * unit.divide / unit.multiply)),
        Err(_) => six_digits(value),
    }
}

/// A value in SI, converted to the first of the units that its kind suggests.
pub(super) fn in_first_unit(value: f64, kind: Kind) -> String {
    match kind.units.split(',').next() {
        Some(symbol) if !symbol.is_empty() => in_unit(value, symbol),
        _ => format!("{} {}", six_digits(value), kind.dimension.base_units()).trim_end().to_owned(),
    }
}
