//! What can be wrong with a scene, said so that its author can mend it: file, key, value, what is allowed.

use super::expression::read_unit;
use super::quantity::{Dimension, Kind};
use crate::accuracy::AccuracyNameError;
use thiserror::Error;

/// All faults of a scene, found in one pass; said in one line each, after their number if there are several.
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
    /// What is wrong.
    pub kind: FaultKind,
}

/// What is wrong with a value.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FaultKind {
    /// The file could not be read.
    #[error("cannot be read: {message}")]
    Unreadable {
        /// The system's reason.
        message: String,
    },
    /// No built-in scene and no file has this name.
    #[error("no such scene or file{}; built-in scenes: {}", suggestion(nearest), known.join(", "))]
    UnknownScene {
        /// The nearest built-in name.
        nearest: Option<String>,
        /// All built-in names.
        known: Vec<String>,
    },
    /// Scenes extend each other in a circle, or through too many files.
    #[error("`extends` goes through more than {limit} scenes: is it a circle?")]
    ExtendsTooDeep {
        /// The bound.
        limit: usize,
    },
    /// Not TOML.
    #[error("{message}")]
    Syntax {
        /// The parser's message with its line.
        message: String,
    },
    /// A key nobody reads.
    #[error("unknown key{}; allowed here: {}", suggestion(nearest), known.join(", "))]
    UnknownKey {
        /// The nearest known key.
        nearest: Option<String>,
        /// Keys allowed here.
        known: Vec<String>,
    },
    /// A key that must be there.
    #[error("is missing, expected {expected}")]
    Missing {
        /// What belongs there.
        expected: String,
    },
    /// Another type of TOML value.
    #[error("{value} is {found}, expected {expected}")]
    WrongType {
        /// The value as written.
        value: String,
        /// What it is.
        found: String,
        /// What belongs there.
        expected: String,
    },
    /// A number without a unit where one is needed.
    #[error("{value} has no unit, expected {} ({}, ...)", expected.name, expected.units)]
    NoUnit {
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
        /// Its dimension.
        found: Dimension,
        /// The kind of quantity that belongs there.
        expected: Kind,
    },
    /// Not an expression, or one whose dimensions do not fit.
    #[error("{value}: {message}")]
    Expression {
        /// The value as written.
        value: String,
        /// What the evaluator says.
        message: String,
    },
    /// A number outside its range.
    #[error("{value} is out of range, allowed: {allowed}")]
    OutOfRange {
        /// The value as written, or as a variable set it.
        value: String,
        /// The allowed range in words.
        allowed: String,
    },
    /// No name of an accuracy.
    #[error(transparent)]
    Accuracy(AccuracyNameError),
    /// A word that is not one of those known.
    #[error("\"{value}\" is unknown{}; allowed: {}", suggestion(nearest), known.join(", "))]
    UnknownWord {
        /// The word.
        value: String,
        /// The nearest one known.
        nearest: Option<String>,
        /// All that are allowed.
        known: Vec<String>,
    },
    /// A reference to something the scene does not have.
    #[error(
        "there is no {what} \"{value}\"{}; there {}",
        suggestion(nearest),
        if known.is_empty() { "is none".to_owned() } else { format!("are: {}", list(known)) }
    )]
    UnknownReference {
        /// body, point, joint, material, output, variable, key.
        what: &'static str,
        /// The name.
        value: String,
        /// The nearest name.
        nearest: Option<String>,
        /// Names that exist.
        known: Vec<String>,
    },
    /// A name that is taken.
    #[error("the name \"{value}\" is taken, names of {what} are unique")]
    Duplicate {
        /// What the list holds.
        what: String,
        /// The name.
        value: String,
    },
    /// A name that would be read as something else.
    #[error("\"{value}\" cannot be a name: {reason}")]
    BadName {
        /// The name.
        value: String,
        /// Why not.
        reason: String,
    },
    /// Values that contradict each other.
    #[error("{message}")]
    Inconsistent {
        /// What contradicts what.
        message: String,
    },
    /// A random variable, at one of its bounds or far out in a tail, makes the scene invalid.
    #[error("at {value}, {} of this variable, the scene is invalid: {fault}; {}", end(*.hard), remedy(*.hard))]
    BoundOutsidePhysics {
        /// The bound, or where one in a million lies beyond.
        value: String,
        /// Whether it is a bound.
        hard: bool,
        /// The fault there.
        fault: String,
    },
    /// A sample or setting of the wrong length.
    #[error("a sample of {found} values was given, the scene has {expected} random variables")]
    SampleLength {
        /// Values given.
        found: usize,
        /// Variables of the scene.
        expected: usize,
    },
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!(", did you mean \"{name}\"?")).unwrap_or_default()
}

fn end(hard: bool) -> &'static str {
    if hard { "a bound" } else { "beyond which lies one in a million values" }
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

/// Names that exist, as many as a reader takes in.
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

/// The name of `known` nearest to `name`, if near enough to be a slip of the hand.
pub(super) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .filter(|(distance, candidate)| {
            *distance <= 1 + candidate.chars().count() / 3 || strsim::jaro_winkler(name, candidate) > 0.9
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate.to_owned())
}

/// A number in SI to six digits, as a person reads it.
pub(super) fn six_digits(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    let plain = rounded == 0.0 || (1e-3..1e6).contains(&f64::abs(rounded));
    if plain { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// A value in SI as a person reads it, in the unit given.
pub(super) fn in_unit(value: f64, symbol: &str) -> String {
    match read_unit(symbol) {
        Ok(unit) => format!("{} {symbol}", six_digits(value * unit.divide / unit.multiply)),
        Err(_) => six_digits(value),
    }
}

/// A value in SI as a person reads it, in the first of the units that its kind suggests.
pub(super) fn in_first_unit(value: f64, kind: Kind) -> String {
    match kind.units.split(',').next() {
        Some(symbol) if !symbol.is_empty() => in_unit(value, symbol),
        _ => format!("{} {}", six_digits(value), kind.dimension.base_units()).trim_end().to_owned(),
    }
}
