//! Parses a text as TOML; a fault of syntax names line and column, and for what is often mistyped the remedy.

use super::duplicate_key::duplicate_key;
use super::expression_error::instead_of_comma;
use super::faults::{Fault, FaultKind, Faults};
use super::location::Location;
use super::quantity::unit;
use toml::Table;

/// Parses a text as TOML; `origin` names it in the fault.
pub(super) fn document(text: &str, origin: &str) -> Result<Table, Faults> {
    text.parse::<Table>().map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        if error.message().starts_with("duplicate key") {
            return duplicate_key(text, origin, span);
        }
        let location = Location::new(origin, text, span);
        let advice = advice(&location).map(|advice| format!("; {advice}")).unwrap_or_default();
        let kind = FaultKind::Syntax {
            line: location.line,
            column: location.column,
            message: format!("{}{advice}", error.message().trim_end()),
        };
        Faults(vec![Fault { location: Some(Box::new(location)), ..Fault::new(origin, "", kind) }])
    })
}

/// What was meant, if a number stands before the fault: a decimal comma, or a unit outside of quotes.
fn advice(location: &Location) -> Option<String> {
    let at = location.text.char_indices().nth(location.column - 1).map_or(location.text.len(), |(at, _)| at);
    let (before, after) = location.text.split_at(at);
    if after.starts_with(['\u{201c}', '\u{201d}', '\u{201e}', '\u{2018}', '\u{2019}']) {
        return Some("use straight quotes: \"".to_owned());
    }
    // The place is that of the whole value, or of what follows the number.
    let is_part = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let start = before.trim_end().trim_end_matches(is_part).len();
    let value = format!("{}{after}", &before[start..]);
    let value = value.split(['#', ']', '}']).next().unwrap_or_default().trim();
    let digits = value.find(|c| !is_part(c)).filter(|digits| *digits > 0)?;
    let (number, rest) = value.split_at(digits);
    let decimals = rest.strip_prefix(',').filter(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    if let Some(decimals) = decimals {
        return Some(instead_of_comma(number, decimals));
    }
    let symbol = rest.trim_start().split(|c: char| !c.is_alphabetic() && c != '%').next()?;
    let value = value.split(',').next().unwrap_or_default().trim_end();
    unit(symbol).map(|_| format!("a quantity with a unit is a text: \"{value}\""))
}
