//! Parses a text as TOML; a fault of syntax names line and column, and for what is often mistyped the remedy.

use super::expression_error::instead_of_comma;
use super::faults::{Fault, FaultKind, Faults};
use super::location::Location;
use super::quantity::unit;
use std::ops::Range;
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
        Faults(vec![syntax(location, format!("{}{advice}", error.message().trim_end()))])
    })
}

/// A fault of syntax at a place.
fn syntax(location: Location, message: String) -> Fault {
    let kind = FaultKind::Syntax { line: location.line, column: location.column, message };
    let file = location.file.clone();
    Fault { location: Some(Box::new(location)), ..Fault::new(file, "", kind) }
}

/// What was meant by other signs than those of TOML, or if a number stands before the fault: a decimal comma, a unit outside of quotes, or
/// separators of thousands.
fn advice(location: &Location) -> Option<String> {
    let at = location.text.char_indices().nth(location.column - 1).map_or(location.text.len(), |(at, _)| at);
    let (before, after) = location.text.split_at(at);
    if after.starts_with(['\u{201c}', '\u{201d}', '\u{201e}', '\u{2018}', '\u{2019}']) {
        return Some("use straight quotes: \"".to_owned());
    }
    let written = |key: &str| !key.trim().is_empty() && !key.contains(['=', '"', '[', '#']);
    let with_colon = after.strip_prefix(':').map(|value| (before, value));
    let with_colon = with_colon.or_else(|| Some((before.trim_end().strip_suffix(':')?, after)));
    if let Some((key, value)) = with_colon.filter(|(key, _)| written(key)) {
        return Some(format!("write {} = {}", key.trim(), value.trim()));
    }
    if let Some((rest, value)) = after.split_once('=').filter(|_| written(before)) {
        let key = format!("{before}{rest}");
        return Some(format!("a key has no spaces: {} ={value}", key.trim().replace(' ', "_")));
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
    if rest.trim_start().starts_with("//") {
        return Some("a comment begins with #".to_owned());
    }
    if rest == ";" {
        return Some(format!("nothing follows a value: {number}"));
    }
    let parts: Vec<&str> = value.split([' ', '\'']).collect();
    if parts[1..].iter().all(|part| part.len() == 3 && part.parse::<u32>().is_ok()) {
        return Some(format!("digits have no separators: {}", parts.concat()));
    }
    let symbol = rest.trim_start().split(|c: char| !c.is_alphabetic() && c != '%').next()?;
    let value = value.split(',').next().unwrap_or_default().trim_end();
    unit(symbol).map(|_| format!("a quantity with a unit is a text: \"{value}\""))
}

/// Parts of a scene that are lists of tables.
const LISTS: [&str; 8] =
    ["bodies", "joints", "loads", "outputs", "limit_states", "conditions", "variables", "correlations"];

/// The fault of a key or the head of a table at `span` that the text has twice, with its first place; where the first head of a list
/// has one bracket instead of two, that is the fault.
fn duplicate_key(text: &str, origin: &str, span: Range<usize>) -> Faults {
    let line_start = |at: usize| text[..at].rfind('\n').map_or(0, |end| end + 1);
    let lines_before = |end: usize| {
        let mut at = 0;
        text[..end].split_inclusive('\n').map(move |line| {
            let indent = line.len() - line.trim_start().len();
            at += line.len();
            (at - line.len() + indent, line.trim())
        })
    };
    let fault = |span: Range<usize>, message| syntax(Location::new(origin, text, span), message);
    let start = line_start(span.start);
    let head = text[start..line_end(text, span.start)].trim();
    let inside = head.trim_start_matches('[').trim_start();
    let is_head = head.starts_with('[');
    let is_named = |list: &&str| {
        is_head && inside.strip_prefix(*list).is_some_and(|rest| rest.starts_with([']', '.', ' ']))
    };
    if let Some(list) = LISTS.into_iter().find(is_named) {
        let right = format!("[[{list}]]");
        let is_meant = |line: &str| {
            let name = line.split(']').next().map(|name| name.trim_matches(['[', ' ']));
            line.starts_with('[')
                && !line.starts_with(&right)
                && name.is_some_and(|name| name.eq_ignore_ascii_case(list))
        };
        let mut lines = lines_before(line_end(text, span.start));
        if let Some((at, line)) = lines.find(|(_, line)| is_meant(line)) {
            let how = if line.starts_with("[[") { "lower case" } else { "two brackets" };
            let message = format!("each row of the list `{list}` begins with {right}, in {how}");
            return Faults(vec![fault(at..at + line.len(), message)]);
        }
    }
    // The lines of the same table, or for a head all lines.
    let key = text[span.clone()].trim();
    let mut before: Vec<(usize, &str)> = lines_before(start).collect();
    if !is_head && let Some(own) = before.iter().rposition(|(_, line)| line.starts_with('[')) {
        before.drain(..own);
    }
    let is_first = |line: &str| match is_head {
        true => line.starts_with(head),
        false => line.strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('=')),
    };
    let name = if is_head { head } else { key };
    let mut found = fault(span.clone(), format!("`{name}` is given twice; remove one of the two"));
    let first = before.into_iter().find(|(_, line)| is_first(line));
    found.used_at = first.map(|(at, line)| Box::new(Location::new(origin, text, at..at + line.len())));
    Faults(vec![found])
}

/// End of the line at a byte.
fn line_end(text: &str, at: usize) -> usize {
    text[at..].find('\n').map_or(text.len(), |end| at + end)
}
