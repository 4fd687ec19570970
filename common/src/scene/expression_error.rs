//! Why an expression has no value, in words for the author of a scene.

use super::nearest_unit::nearest_unit;
use super::quantity::Dimension;
use thiserror::Error;

/// Parentheses and signs may nest to this depth, so that hostile text cannot exhaust the stack.
pub(super) const DEPTH_LIMIT: usize = 64;

/// Why an expression has no value.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ExpressionError {
    /// The text is empty.
    #[error("is empty, expected a number with its unit")]
    Empty,
    /// A character that is not part of the grammar.
    #[error("unexpected character `{0}`{advice}", advice = instead_of(*.0))]
    Character(char),
    /// A comma between two digits. Holds the digits before it, and what follows it.
    #[error("unexpected character `,`: {}", instead_of_comma(.0, .1))]
    Comma(String, String),
    /// A piece that cannot follow what precedes it. Holds the piece as written, and the pieces that could follow, in words.
    #[error("unexpected `{0}`, expected {1}")]
    Unexpected(String, &'static str),
    /// The text ends inside an expression.
    #[error("ends too early, expected {0}")]
    Incomplete(&'static str),
    /// A name that is no unit, parameter or function.
    #[error("there is no unit, parameter or function `{name}`{}", hint(.name, .nearest))]
    UnknownName {
        /// The name as written.
        name: String,
        /// Parameter nearest to it, if near enough.
        nearest: Option<String>,
    },
    /// A name after a number that is no unit. Holds the name as written.
    #[error("unknown unit `{}`{}", .0, hint(.0, &None))]
    UnknownUnit(String),
    /// A parameter that is itself faulty; its own fault says why.
    #[error("the parameter `{0}` is faulty")]
    Broken(String),
    /// Operands of different dimension. Holds `add` or `subtract`, and the dimensions of both.
    #[error("cannot {0} {1} and {2}: both must be of one kind")]
    Mixed(&'static str, Dimension, Dimension),
    /// A function of an argument of the wrong dimension. Holds the function, that dimension, and the argument expected, in words.
    #[error("{0} of {1}, expected {2}")]
    Argument(&'static str, Dimension, &'static str),
    /// An exponent that is not a whole number from -12 to 12.
    #[error("exponents are whole numbers from -12 to 12")]
    Exponent,
    /// After `/` in a unit, a further factor could stand above or below.
    #[error("the unit is ambiguous after `/`: write `*` or `/` before `{0}`")]
    AmbiguousUnit(String),
    /// Parentheses or signs nested too deeply.
    #[error("is nested deeper than {DEPTH_LIMIT} levels")]
    TooDeep,
    /// Division by zero, root of a negative number or overflow.
    #[error("has no finite value, expected no division by 0, no root of a negative number and no overflow")]
    NotFinite,
}

impl ExpressionError {
    /// The piece of the text that cannot be read, if it is one.
    pub fn piece(&self) -> Option<String> {
        match self {
            Self::Character(character) => Some(character.to_string()),
            Self::Comma(..) => Some(",".to_owned()),
            Self::Unexpected(piece, _)
            | Self::UnknownName { name: piece, .. }
            | Self::UnknownUnit(piece)
            | Self::AmbiguousUnit(piece) => Some(piece.clone()),
            _ => None,
        }
    }
}

/// The parameter that is near to a name, otherwise the unit.
fn hint(name: &str, nearest: &Option<String>) -> String {
    let meant = nearest.clone().or_else(|| nearest_unit(name));
    meant.map(|meant| format!(", did you mean `{meant}`?")).unwrap_or_default()
}

/// What to write for a number with a comma between `before` and `after`, which may separate thousands where three digits follow.
pub(super) fn instead_of_comma(before: &str, after: &str) -> String {
    let digits = after.split(|c: char| !(c.is_ascii_digit() || c == ',')).next().unwrap_or_default();
    let groups: Vec<&str> = digits.split(',').collect();
    let first = before.trim_start_matches(['+', '-']);
    let in_thousands = (1..=3).contains(&first.len())
        && !first.starts_with('0')
        && groups.iter().all(|group| group.len() == 3);
    match groups.as_slice() {
        [one] if in_thousands && !after[one.len()..].starts_with('.') => {
            format!("write {before}{one} if it separates thousands, {before}.{one} if it is a decimal comma")
        }
        many if in_thousands => format!("digits have no separators: {before}{}", many.concat()),
        many => format!("use a decimal point: {before}.{}", many[0]),
    }
}

/// What to write for a character that keyboards and word processors offer.
fn instead_of(character: char) -> &'static str {
    match character {
        '\u{b0}' => ": write `deg`",
        '\u{b7}' | '\u{d7}' | '\u{22c5}' => ": write `*`",
        '\u{2212}' | '\u{2013}' => ": write `-`",
        ',' => ": a value is one quantity, a list has each in quotes",
        '=' => ": an expression has no `=`",
        _ => "",
    }
}
