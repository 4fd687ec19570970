//! Reads the tables of a scene file field by field, for the modules that know what the fields mean. A faulty
//! field is noted and reading goes on, so that one pass finds every fault. What a random variable or a user
//! overrides is looked up here, by the path of the key.

use super::expression::{ExpressionError, RESERVED, evaluate};
use super::faults::{Fault, FaultKind, nearest, six_digits};
use super::quantity::{Dimension, Kind, NUMBER, Quantity, unit};
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// Values in SI by the path of their key.
pub(super) type Overrides = BTreeMap<String, f64>;

/// Parameters may refer to each other through this many steps.
const PARAMETER_DEPTH: usize = 64;

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
}

impl Range {
    fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Range::Any => true,
                Range::Positive => value > 0.0,
                Range::NonNegative => value >= 0.0,
                Range::Within(from, to) => (from..=to).contains(&value),
            }
    }

    fn words(self) -> String {
        match self {
            Range::Any => "any finite number".to_owned(),
            Range::Positive => "> 0".to_owned(),
            Range::NonNegative => ">= 0".to_owned(),
            Range::Within(from, to) => format!("{from} to {to}"),
        }
    }
}

/// What one pass over a scene has learned.
pub(super) struct Context<'s> {
    origin: &'s str,
    overrides: &'s Overrides,
    used: BTreeSet<String>,
    definitions: Option<&'s Table>,
    parameters: BTreeMap<String, Option<Quantity>>,
    open: Vec<String>,
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
            definitions: None,
            parameters: BTreeMap::new(),
            open: Vec::new(),
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

    /// Evaluates every parameter, and notes names that cannot be one.
    pub(super) fn read_parameters(&mut self, table: &'s Table) {
        self.definitions = Some(table);
        for name in table.keys() {
            let plain = name.chars().all(|c| c.is_alphanumeric() || c == '_')
                && name.chars().next().is_some_and(|c| !c.is_ascii_digit());
            let reason = if unit(name).is_some() {
                Some("it is a unit")
            } else if RESERVED.contains(&name.as_str()) {
                Some("it is a function or constant of expressions")
            } else if !plain {
                Some("names of parameters have letters, digits and `_`, and start with a letter")
            } else {
                None
            };
            match reason {
                Some(reason) => {
                    let (value, reason) = (name.clone(), reason.to_owned());
                    self.fault(format!("parameters.{name}"), FaultKind::BadName { value, reason });
                }
                None => {
                    let _ = self.parameter(name);
                }
            }
        }
    }

    fn parameter(&mut self, name: &str) -> Result<Quantity, ExpressionError> {
        let broken = || ExpressionError::Broken(name.to_owned());
        if let Some(known) = self.parameters.get(name) {
            return known.ok_or_else(broken);
        }
        let definition = self.definitions.and_then(|table| table.get(name));
        let Some(definition) = definition else {
            let names = self.definitions.into_iter().flat_map(Table::keys).map(String::as_str);
            let nearest = nearest(name, names);
            return Err(ExpressionError::UnknownName { name: name.to_owned(), nearest });
        };
        let key = format!("parameters.{name}");
        if self.open.iter().any(|open| open == name) || self.open.len() >= PARAMETER_DEPTH {
            let chain = self.open.join(" -> ");
            self.inconsistent(key, format!("depends on itself, or through too many others: {chain}"));
            return Err(broken());
        }
        self.open.push(name.to_owned());
        let value = self.value(&key, definition, None);
        self.open.pop();
        self.parameters.insert(name.to_owned(), value);
        value.ok_or_else(broken)
    }

    /// The quantity at a key, of the kind expected (or of any kind), overridden if somebody overrides it.
    fn value(&mut self, key: &str, value: &Value, expected: Option<Kind>) -> Option<Quantity> {
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
        let value = self.shown(key, value, quantity.value);
        self.fault(key, FaultKind::OutOfRange { value, allowed: range.words() });
        None
    }

    /// A value as its author wrote it, or as an override set it.
    pub(super) fn shown(&self, key: &str, written: &Value, value: f64) -> String {
        if self.overrides.contains_key(key) {
            format!("{} (SI, set from outside)", six_digits(value))
        } else if written.as_str().is_some_and(|text| text.contains(|c: char| c.is_alphabetic() || c == '_'))
        {
            format!("{written} = {} (SI)", six_digits(value))
        } else {
            written.to_string()
        }
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
