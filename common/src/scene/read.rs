//! Reads the tables of a scene file field by field, for the modules that know what the fields mean. A faulty
//! field is noted and reading goes on, so that one pass finds every fault. What a random variable or a user
//! overrides is looked up here, by the path of the key.

use super::expression::{ExpressionError, evaluate, read_unit};
use super::faults::{Fault, FaultKind, in_first_unit, nearest};
use super::parameters::Parameters;
use super::quantity::{Dimension, Kind, NUMBER, Quantity};
use std::collections::{BTreeMap, BTreeSet};
use toml::Value;

/// Values in SI by the path of their key.
pub(super) type Overrides = BTreeMap<String, f64>;

/// Allowed range of a number in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Range {
    /// Any finite number.
    Any,
    /// > 0.
    Positive,
    /// >= 0.
    NonNegative,
    /// From .. to, both allowed.
    Within(f64, f64),
    /// From .. to, only the second allowed.
    Above(f64, f64),
    /// Any but zero.
    NotZero,
}

impl Range {
    fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Range::Any => true,
                Range::Positive => value > 0.0,
                Range::NonNegative => value >= 0.0,
                Range::Within(from, to) => (from..=to).contains(&value),
                Range::Above(from, to) => from < value && value <= to,
                Range::NotZero => value != 0.0,
            }
    }

    fn words(self) -> String {
        match self {
            Range::Any => "any finite number".to_owned(),
            Range::Positive => "> 0".to_owned(),
            Range::NonNegative => ">= 0".to_owned(),
            Range::Within(from, to) => format!("{from} to {to}"),
            Range::Above(from, to) => format!("> {from} and <= {to}"),
            Range::NotZero => "not 0".to_owned(),
        }
    }
}

/// What one pass over a scene has learned.
pub(super) struct Context<'s> {
    origin: &'s str,
    overrides: &'s Overrides,
    used: BTreeSet<String>,
    /// The scene's parameters.
    pub(super) parameters: Parameters<'s>,
    /// Every quantity read, by the path of its key.
    pub(super) seen: BTreeMap<String, Quantity>,
    /// Every fault found.
    pub(super) faults: Vec<Fault>,
}

impl<'s> Context<'s> {
    pub(super) fn new(origin: &'s str, overrides: &'s Overrides) -> Self {
        Context {
            origin,
            overrides,
            used: BTreeSet::new(),
            parameters: Parameters::default(),
            seen: BTreeMap::new(),
            faults: Vec::new(),
        }
    }

    pub(super) fn fault(&mut self, key: impl Into<String>, kind: FaultKind) {
        self.faults.push(Fault { file: self.origin.to_owned(), key: key.into(), kind });
    }

    pub(super) fn inconsistent(&mut self, key: impl Into<String>, message: impl Into<String>) {
        self.fault(key, FaultKind::Inconsistent { message: message.into() });
    }

    /// The quantity at a key, of the kind expected (or of any kind), overridden if somebody overrides it.
    pub(super) fn value(&mut self, key: &str, value: &Value, expected: Option<Kind>) -> Option<Quantity> {
        let mut quantity = self.written(key, value, expected)?;
        if let Some(&overridden) = self.overrides.get(key) {
            self.used.insert(key.to_owned());
            quantity.value = overridden;
        }
        self.seen.insert(key.to_owned(), quantity);
        Some(quantity)
    }

    fn written(&mut self, key: &str, value: &Value, expected: Option<Kind>) -> Option<Quantity> {
        let bare = |value: f64| Quantity { value, dimension: Dimension::NONE };
        let found = match value {
            Value::Integer(n) => Ok(bare(*n as f64)),
            Value::Float(x) if x.is_finite() => Ok(bare(*x)),
            Value::Float(_) => Err(ExpressionError::NotFinite),
            Value::String(text) => evaluate(text, &mut |name| self.parameter(name)),
            other => {
                let expected = expected.map_or("a quantity", |kind| kind.name).to_owned();
                self.wrong_type(key, other, expected);
                return None;
            }
        };
        let shown = || value.to_string();
        let kind = match (found, expected) {
            (Ok(quantity), None) => return Some(quantity),
            (Ok(_), Some(expected)) if !value.is_str() && expected != NUMBER => {
                FaultKind::NoUnit { value: shown(), expected }
            }
            (Ok(quantity), Some(expected)) if quantity.dimension != expected.dimension => {
                // A text such as "5" has no unit either; "a plain number" would be a puzzling answer.
                FaultKind::WrongUnit { value: shown(), found: quantity.dimension, expected }
            }
            (Ok(quantity), Some(_)) => return Some(quantity),
            (Err(ExpressionError::Broken(_)), _) => return None,
            (Err(error), _) => FaultKind::Expression { value: shown(), message: error.to_string() },
        };
        self.fault(key, kind);
        None
    }

    pub(super) fn wrong_type(&mut self, key: &str, value: &Value, expected: String) {
        let found = match value {
            Value::String(_) => "a text",
            Value::Integer(_) | Value::Float(_) => "a number",
            Value::Boolean(_) => "true or false",
            Value::Datetime(_) => "a date",
            Value::Array(_) => "a list",
            Value::Table(_) => "a table",
        };
        let value = match value {
            Value::Array(_) | Value::Table(_) => "the value".to_owned(),
            other => other.to_string(),
        };
        self.fault(key, FaultKind::WrongType { value, found: found.to_owned(), expected });
    }

    /// A quantity at `key` within its range.
    pub(super) fn quantity(&mut self, key: &str, value: &Value, kind: Kind, range: Range) -> Option<f64> {
        let quantity = self.value(key, value, Some(kind))?;
        if range.contains(quantity.value) {
            return Some(quantity.value);
        }
        let value = self.shown(key, value, quantity.value, kind);
        self.fault(key, FaultKind::OutOfRange { value, allowed: range.words() });
        None
    }

    /// A value as its author wrote it, with what comes of it unless that is plain to see; or as an override set it.
    pub(super) fn shown(&self, key: &str, written: &Value, value: f64, kind: Kind) -> String {
        let result = in_first_unit(value, kind);
        if self.overrides.contains_key(key) {
            return format!("{result} (set from outside)");
        }
        match written.as_str() {
            Some(text) if !is_number_with_unit(text) => format!("{written} = {result}"),
            _ => written.to_string(),
        }
    }

    /// Whether nothing is overridden: the scene is read as its author wrote it.
    pub(super) fn as_written(&self) -> bool {
        self.overrides.is_empty()
    }

    /// Index of `name` among `known`, or a fault with the nearest one.
    pub(super) fn reference<'n>(
        &mut self,
        key: &str,
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Option<usize> {
        let found = known.clone().position(|candidate| candidate == name);
        if found.is_none() {
            let nearest = nearest(name, known.clone());
            let known = known.map(str::to_owned).collect();
            let value = name.to_owned();
            self.fault(key, FaultKind::UnknownReference { what, value, nearest, known });
        }
        found
    }

    /// One of a few words.
    pub(super) fn word<T: Copy>(&mut self, key: &str, word: &str, words: &[(&str, T)]) -> Option<T> {
        let found = words.iter().find(|(name, _)| *name == word).map(|(_, meaning)| *meaning);
        if found.is_none() {
            let nearest = nearest(word, words.iter().map(|(name, _)| *name));
            let known = words.iter().map(|(name, _)| (*name).to_owned()).collect();
            self.fault(key, FaultKind::UnknownWord { value: word.to_owned(), nearest, known });
        }
        found
    }

    /// Overrides that no field consumed become faults.
    pub(super) fn check_overrides(&mut self) {
        for key in self.overrides.keys().filter(|key| !self.used.contains(*key)).cloned().collect::<Vec<_>>()
        {
            let known: Vec<_> = self.seen.keys().cloned().collect();
            self.reference(&key, "quantity", &key, known.iter().map(String::as_str));
        }
    }
}

/// Whether a text is one number, with or without a unit, so that nothing had to be computed.
fn is_number_with_unit(text: &str) -> bool {
    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || "+-.eE ".contains(c)).trim_end();
    // The only digits of a unit are its exponents.
    let exponents = |pair: &[u8]| !pair[1].is_ascii_digit() || matches!(pair[0], b'^' | b'-');
    unit.is_empty() || (unit.as_bytes().windows(2).all(exponents) && read_unit(unit).is_ok())
}
