//! Why an expression has no value, in words for the author of a scene; what was meant by a unit that does not exist.

use super::quantity::{Dimension, FORCE, UNITS, unit};
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

/// Names under which units are known elsewhere.
const ELSEWHERE: [(&str, &str); 22] = [
    ("inch", "in"),
    ("inches", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("thou", "mil"),
    ("micron", "um"),
    ("meter", "m"),
    ("metre", "m"),
    ("gm", "g"),
    ("lbs", "lb"),
    ("lbm", "lb"),
    ("lbft", "lbf ft"),
    ("lbin", "lbf in"),
    ("sec", "s"),
    ("hr", "h"),
    ("newton", "N"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("turn", "r"),
    ("turns", "r"),
    ("Hz", "r/s"),
    ("kHz", "r/ms"),
];

/// The unit that is most likely meant by a name that is none.
pub fn nearest_unit(name: &str) -> Option<String> {
    let known = |name: &str| unit(name).is_some();
    if let Some((_, symbol)) = ELSEWHERE.iter().find(|(other, _)| *other == name) {
        return Some((*symbol).to_owned());
    }
    // `mm2`, and with superscripts.
    let plain = name.replace('\u{b2}', "2").replace('\u{b3}', "3");
    if let Some((symbol, power)) = plain.char_indices().next_back().map(|(at, _)| plain.split_at(at))
        && ["2", "3", "4"].contains(&power)
        && known(symbol)
    {
        return Some(format!("{symbol}^{power}"));
    }
    // `Nm`: a force, or a kilogram, and what follows it.
    let split = (1..name.len()).filter(|at| name.is_char_boundary(*at)).map(|at| name.split_at(at));
    let is_first =
        |name: &str| unit(name).is_some_and(|unit| unit.dimension == FORCE.dimension) || name == "kg";
    if let Some((one, other)) = split.clone().find(|(one, other)| is_first(one) && known(other)) {
        return Some(format!("{one} {other}"));
    }
    let symbols = || UNITS.iter().map(|(symbol, _)| *symbol);
    if let Some(symbol) = symbols().find(|symbol| symbol.eq_ignore_ascii_case(name)) {
        return Some(symbol.to_owned());
    }
    let first = name.chars().next();
    let near = symbols()
        .filter(|symbol| symbol.chars().count() > 1 && strsim::damerau_levenshtein(name, symbol) == 1);
    near.min_by_key(|symbol| (symbol.chars().next() != first, symbol.len())).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::super::expression::read_unit;
    use super::*;

    #[test]
    fn what_was_meant_by_a_name() {
        for (name, meant) in [
            ("mmm", Some("mm")),
            ("Nm", Some("N m")),
            ("Nmm", Some("N mm")),
            ("kNm", Some("kN m")),
            ("lbft", Some("lbf ft")),
            ("inch", Some("in")),
            ("Mpa", Some("MPa")),
            ("KG", Some("kg")),
            ("PSI", Some("psi")),
            ("mm2", Some("mm^2")),
            ("mm\u{b2}", Some("mm^2")),
            ("degs", Some("deg")),
            ("Hz", Some("r/s")),
            ("furlong", None),
            ("x", None),
        ] {
            assert_eq!(nearest_unit(name).as_deref(), meant, "{name}");
        }
    }

    #[test]
    fn names_from_elsewhere_lead_to_units() {
        for (name, symbol) in ELSEWHERE {
            assert!(read_unit(symbol).is_ok() && unit(name).is_none(), "{name}: {symbol}");
        }
    }
}
