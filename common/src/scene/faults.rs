//! The faults of a scene: each names file, key, value and what is allowed. For people each is printed as its message, its place, the line
//! and carets under the piece, as compilers do.
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
use std::collections::BTreeSet;
use std::fmt::{Display, Write};
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

    /// The faults with an excerpt of the file each, and their number if there are several. Faults of one parameter, wherever it is
    /// used, are one.
    ///
    /// ```
    /// use common::scene::SceneSource;
    ///
    /// let text = "[scene]\nname = \"press\"\n[life]\ncycles = 0\n";
    /// let faults = SceneSource::parse(text, "press.toml").unwrap_err();
    /// assert!(faults.explained().contains(
    ///     "error: life.cycles: 0 is out of range, allowed: 1 to 100000000\n \
    ///      --> press.toml:4:10\n  |\n4 | cycles = 0\n  |          ^\n"
    /// ));
    /// ```
    pub fn explained(&self) -> String {
        let mut text = String::new();
        let mut shown: Vec<&Fault> = Vec::new();
        for fault in &self.0 {
            if shown.iter().any(|other| is_repeated(other, fault)) {
                continue;
            }
            shown.push(fault);
            if !text.is_empty() {
                text.push('\n');
            }
            let others = self.0.iter().filter(|other| is_repeated(fault, other) && other.key != fault.key);
            // Writing to a String cannot fail.
            let _ = write!(text, "error: {}", one(fault, others));
        }
        if shown.len() > 1 {
            let _ = write!(text, "\nerror: {} faults\n", shown.len());
        }
        text
    }

    /// These faults without their places, for a text that no person wrote.
    pub fn without_places(self) -> Self {
        Faults(self.0.into_iter().map(|fault| Fault::new(fault.file, fault.key, fault.kind)).collect())
    }
}

/// True if two faults of different keys have their cause in one parameter.
fn is_repeated(one: &Fault, other: &Fault) -> bool {
    one.used_at.is_some()
        && other.used_at.is_some()
        && one.location == other.location
        && one.kind == other.kind
}

/// A fault with its excerpt; `others` have the same cause.
fn one<'f>(fault: &Fault, others: impl Iterator<Item = &'f Fault>) -> String {
    let Some(location) = &fault.location else { return format!("{fault}\n") };
    let headline = match &fault.kind {
        FaultKind::Syntax { message, .. } => message.clone(),
        kind if fault.key.is_empty() => kind.to_string(),
        kind => format!("{}: {kind}", fault.key),
    };
    let mut text = format!("{headline}\n{}\n", location.excerpt());
    let margin = " ".repeat(location.line.to_string().len());
    if let Some(used) = &fault.used_at {
        let _ = writeln!(text, "{margin} = {} {used}: {}", fault.kind.related(), used.text.trim());
    }
    for other in others {
        if let Some(used) = &other.used_at {
            let _ = writeln!(text, "{margin} = used at {used}: {}: {}", other.key, used.text.trim());
        }
    }
    text
}

/// Kinds of fault.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FaultKind {
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
    /// A value that is not of the kind or in the range expected, whatever it is the value of. Holds what is wrong, in words.
    #[error("{0}")]
    OfAValue(String),
    /// Not an expression, or one whose dimensions do not fit. Holds value and message, and the piece of the value that cannot be read.
    #[error("{0}")]
    Expression(String, Option<String>),
    /// A reference to a name that the scene does not have. Holds the kind of thing (body, point, joint, material, output, variable,
    /// quantity), and the name with those that exist, in words.
    #[error("there is no {0} {1}")]
    UnknownReference(&'static str, String),
    /// A name that another row of the list has already. Holds the path of the list, and the name as written.
    #[error("the name \"{1}\" is taken, names of {0} are unique: change one of the two")]
    Duplicate(String, String),
    /// A text that cannot be a name. Holds the name as written, and the reason as a clause.
    #[error("\"{0}\" cannot be a name: {1}; use another one")]
    BadName(String, &'static str),
    /// Values that contradict each other, or what else is wrong, in words.
    #[error("{0}")]
    Inconsistent(String),
}

/// A contradiction, in words.
impl From<String> for FaultKind {
    fn from(message: String) -> Self {
        Self::Inconsistent(message)
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
        let meant = suggestion(&nearest(word, known.clone()));
        let known: Vec<&str> = known.collect();
        format!("\"{word}\" is unknown{meant}; allowed: {}", known.join(", ")).into()
    }

    /// A name that is none of those `known`, of a kind of thing.
    pub fn unknown_reference<'n>(
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Self {
        // The name of a parameter, or the last part of a single path.
        let after =
            |path: &'n str, before: &str| path.strip_suffix(name).is_some_and(|rest| rest.ends_with(before));
        let mut ending = known.clone().filter(|path| after(path, "."));
        let single = ending.next().filter(|_| ending.next().is_none());
        let parameter = known.clone().find(|path| after(path, "parameters."));
        let meant = parameter.or(single).map(str::to_owned).or_else(|| nearest(name, known.clone()));
        Self::unknown_near(what, name, &meant, &known.collect::<Vec<_>>())
    }

    /// A name that is none of those `known`, of a kind of thing; `nearest` is the one that is likely meant.
    pub(super) fn unknown_near(
        what: &'static str,
        name: &str,
        nearest: &Option<String>,
        known: &[&str],
    ) -> Self {
        // At most twelve of them.
        const SHOWN: usize = 12;
        let known = match known.len().checked_sub(SHOWN) {
            None if known.is_empty() => "is none".to_owned(),
            None | Some(0) => format!("are: {}", known.join(", ")),
            Some(more) => format!("are: {} and {more} more", known[..SHOWN].join(", ")),
        };
        Self::UnknownReference(what, format!("\"{name}\"{}; there {known}", suggestion(nearest)))
    }

    /// A value whose dimension is not that of the kind expected; `found` says what it is.
    pub(super) fn wrong_unit(value: impl Display, found: Dimension, expected: Kind) -> Self {
        let Kind { name, units, .. } = expected;
        let units = if units.is_empty() { "no unit".to_owned() } else { format!("{units}, ...") };
        Self::OfAValue(format!("{value} is {found}, expected {name} ({units})"))
    }

    /// A value that is not in its range.
    pub(super) fn out_of_range(value: impl Display, allowed: impl Display) -> Self {
        Self::OfAValue(format!("{value} is out of range, allowed: {allowed}"))
    }

    /// What [`Fault::used_at`] points to, in words.
    pub(super) fn related(&self) -> &'static str {
        match self {
            Self::Duplicate(..) | Self::Syntax { .. } => "first at",
            _ => "used at",
        }
    }
}

/// The question whether the nearest name is meant, if there is one.
pub(super) fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!(", did you mean \"{name}\"?")).unwrap_or_default()
}

fn in_lines(faults: &[Fault]) -> String {
    match faults {
        [one] => one.to_string(),
        many => {
            many.iter().fold(format!("{} faults", many.len()), |text, fault| format!("{text}\n  {fault}"))
        }
    }
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
