//! The state of one pass over a scene file: the faults found and the quantities read so far, by the path of their
//! key, with the values that a random variable or a user sets in place of the written ones.
//!
//! Parameters are a part of it: which are defined, evaluated or under evaluation, and which of them something depends on.
//!
//! A faulty value is recorded and reading continues, so that one pass finds every fault. The readers see the file as
//! `Section`s, which pass what they read to the context that they share.

use super::expression::{ExpressionError, RESERVED, evaluate, read_unit};
use super::faults::{Fault, FaultKind, in_first_unit, nearest};
use super::quantity::{AngleUnit, Kind, NUMBER, Quantity, unit};
use super::unit_advice::advised;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// Values in SI by the path of their key.
pub(super) type Overrides = BTreeMap<String, f64>;

/// Nothing is overridden.
pub(super) static NONE: Overrides = Overrides::new();

/// Allowed range of a number in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Any finite number.
    Any,
    /// Any finite number > 0.
    Positive,
    /// Any finite number >= 0.
    NonNegative,
    /// Interval with both ends.
    Within(f64, f64),
    /// Interval without its lower end.
    Above(f64, f64),
    /// Interval without its ends.
    Between(f64, f64),
    /// Any finite number except 0.
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
                Range::Between(from, to) => from < value && value < to,
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
            Range::Between(from, to) => format!("> {from} and < {to}"),
            Range::NotZero => "not 0".to_owned(),
        }
    }
}

/// Longest chain of parameters, each defined by the next one.
const CHAIN_LIMIT: usize = 64;

/// The parameters of a scene, `[parameters]`: each is evaluated once, on its first use.
#[derive(Default)]
pub(super) struct Parameters<'s> {
    /// The table `[parameters]`.
    definitions: Option<&'s Table>,
    /// Values of those evaluated so far; none for a faulty one.
    values: BTreeMap<String, Option<Quantity>>,
    /// Names of those under evaluation, each used in the definition of the one before it.
    open: Vec<String>,
    /// Names that the definition of each parameter uses; under `None` those that other parts of the scene use.
    uses: BTreeMap<Option<String>, BTreeSet<String>>,
}

impl Parameters<'_> {
    /// Parameters that the rest of the scene depends on, directly or through others.
    pub(super) fn used(&self) -> BTreeSet<String> {
        let mut used = BTreeSet::new();
        let mut left = vec![None];
        while let Some(user) = left.pop() {
            for name in self.uses.get(&user).into_iter().flatten() {
                left.extend(used.insert(name.clone()).then(|| Some(name.clone())));
            }
        }
        used
    }
}

/// The state of one pass over a scene.
pub(super) struct Context<'s> {
    origin: &'s str,
    overrides: &'s Overrides,
    pub(super) parameters: RefCell<Parameters<'s>>,
    /// Every quantity read, by the path of its key.
    pub(super) seen: RefCell<BTreeMap<String, Quantity>>,
    pub(super) faults: RefCell<Vec<Fault>>,
}

impl<'s> Context<'s> {
    pub(super) fn new(origin: &'s str, overrides: &'s Overrides) -> Self {
        Context {
            origin,
            overrides,
            parameters: RefCell::default(),
            seen: RefCell::default(),
            faults: RefCell::default(),
        }
    }

    /// Records a fault at the path of a key; `None`, in the place of the value.
    pub(super) fn fault(&self, key: impl Into<String>, kind: FaultKind) -> Option<()> {
        self.faults.borrow_mut().push(Fault::new(self.origin, key, kind));
        None
    }

    /// Records that a value contradicts another one.
    pub(super) fn inconsistent(&self, key: impl Into<String>, message: impl Into<String>) -> Option<()> {
        self.fault(key, message.into().into())
    }

    /// Number of faults so far.
    pub(super) fn fault_count(&self) -> usize {
        self.faults.borrow().len()
    }

    /// The faults so far; none are left.
    pub(super) fn take_faults(&self) -> Vec<Fault> {
        self.faults.take()
    }

    /// Evaluates every parameter, and records names that no parameter can have.
    pub(super) fn read_parameters(&self, table: &'s Table) {
        self.parameters.borrow_mut().definitions = Some(table);
        for name in table.keys() {
            let _ = match why_not_a_name(name) {
                Some(reason) => {
                    self.fault(format!("parameters.{name}"), FaultKind::BadName(name.clone(), reason))
                }
                None => self.evaluated(name).ok().map(drop),
            };
        }
    }

    /// The value of a parameter for the expression that names it, in the definition of the parameter under evaluation or else in the rest
    /// of the scene.
    fn parameter(&self, name: &str) -> Result<Quantity, ExpressionError> {
        let mut parameters = self.parameters.borrow_mut();
        let user = parameters.open.last().cloned();
        parameters.uses.entry(user).or_default().insert(name.to_owned());
        drop(parameters);
        self.evaluated(name)
    }

    fn evaluated(&self, name: &str) -> Result<Quantity, ExpressionError> {
        let faulty = || ExpressionError::Broken(name.to_owned());
        let key = format!("parameters.{name}");
        let mut parameters = self.parameters.borrow_mut();
        if let Some(known) = parameters.values.get(name) {
            return known.ok_or_else(faulty);
        }
        let Some(definition) = parameters.definitions.and_then(|table| table.get(name)) else {
            let names = parameters.definitions.into_iter().flat_map(Table::keys).map(String::as_str);
            return Err(ExpressionError::UnknownName {
                name: name.to_owned(),
                nearest: nearest(name, names),
            });
        };
        if parameters.open.iter().any(|open| open == name) || parameters.open.len() >= CHAIN_LIMIT {
            let chain = parameters.open.join(" -> ");
            let message =
                format!("depends on itself, or through too many others: {chain}; give one of them a value");
            self.inconsistent(key, message);
            return Err(faulty());
        }
        parameters.open.push(name.to_owned());
        drop(parameters);
        let value = self.value(&key, definition, None);
        let mut parameters = self.parameters.borrow_mut();
        parameters.open.pop();
        parameters.values.insert(name.to_owned(), value);
        value.ok_or_else(faulty)
    }

    /// The quantity at a key, of the kind expected (or of any kind), or the value that overrides it.
    pub(super) fn value(&self, key: &str, value: &Value, expected: Option<Kind>) -> Option<Quantity> {
        let mut quantity = self.written(key, value, expected)?;
        if let Some(&overridden) = self.overrides.get(key) {
            quantity.value = overridden;
        }
        self.seen.borrow_mut().insert(key.to_owned(), quantity);
        Some(quantity)
    }

    fn written(&self, key: &str, value: &Value, expected: Option<Kind>) -> Option<Quantity> {
        let found = match value {
            Value::Integer(n) => Ok(Quantity::plain(*n as f64)),
            Value::Float(x) if x.is_finite() => Ok(Quantity::plain(*x)),
            Value::Float(_) => Err(ExpressionError::NotFinite),
            Value::String(text) => evaluate(text, &mut |name| self.parameter(name)),
            other => {
                let expected = expected.map_or("a quantity", |kind| kind.name).to_owned();
                return self.wrong_type(key, other, expected).and(None);
            }
        };
        let without = |unit: &str, Kind { name, units, .. }: Kind| {
            FaultKind::OfAValue(format!("{value} has no {unit}, expected {name} ({units}, ...)"))
        };
        let kind = match (found, expected) {
            (Ok(_), Some(expected)) if !value.is_str() && !expected.takes_bare_numbers() => {
                without("unit", expected)
            }
            (Ok(quantity), Some(expected)) if quantity.dimension != expected.dimension => {
                // A text such as "5" has no unit either; "a plain number" would be a puzzling answer.
                FaultKind::wrong_unit(value, quantity.dimension, expected)
            }
            (Ok(quantity), Some(expected)) if !expected.takes(quantity.angle) => match quantity.angle {
                AngleUnit::Present => {
                    FaultKind::OfAValue(format!("{value} has a unit of angle, expected {}", expected.name))
                }
                _ => without("unit of angle", expected),
            },
            (Ok(quantity), _) => return Some(quantity),
            (Err(ExpressionError::Broken(_)), _) => return None,
            (Err(error), _) => {
                FaultKind::Expression(format!("{value}: {}", advised(&error, expected)), error.piece())
            }
        };
        self.fault(key, kind).and(None)
    }

    pub(super) fn wrong_type(&self, key: &str, value: &Value, expected: String) -> Option<()> {
        let (found, value) = match value {
            Value::String(_) => ("a text", value.to_string()),
            Value::Integer(_) | Value::Float(_) => ("a number", value.to_string()),
            Value::Boolean(_) => ("true or false", value.to_string()),
            Value::Datetime(_) => ("a date", value.to_string()),
            Value::Array(_) => ("a list", "the value".to_owned()),
            Value::Table(_) => ("a table", "the value".to_owned()),
        };
        self.inconsistent(key, format!("{value} is {found}, expected {expected}"))
    }

    /// A quantity at `key` within its range.
    pub(super) fn quantity(&self, key: &str, value: &Value, kind: Kind, range: Range) -> Option<f64> {
        let quantity = self.value(key, value, Some(kind))?;
        if range.contains(quantity.value) {
            return Some(quantity.value);
        }
        let value = self.shown(key, value, quantity.value, kind);
        self.fault(key, FaultKind::out_of_range(value, range.words())).and(None)
    }

    /// A quantity at `key`, or a share of `whole` such as `"2 %"`.
    pub(super) fn quantity_or_share(&self, key: &str, value: &Value, kind: Kind, whole: f64) -> Option<f64> {
        let relative = value.as_str().is_some_and(|text| text.trim_end().ends_with('%'));
        let found = self.quantity(key, value, if relative { NUMBER } else { kind }, Range::Any)?;
        Some(if relative { found * whole } else { found })
    }

    /// A value as its author wrote it, followed by its result unless it is a plain number; or as an override set it.
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

    /// True if nothing is overridden: the scene is read as its author wrote it.
    pub(super) fn as_written(&self) -> bool {
        self.overrides.is_empty()
    }

    /// The meaning of a word, or a fault with the nearest of `words`.
    pub(super) fn word<T: Copy>(&self, key: &str, word: &str, words: &[(&str, T)]) -> Option<T> {
        let found = words.iter().find(|(name, _)| *name == word).map(|(_, meaning)| *meaning);
        let unknown = || FaultKind::unknown_word(word, words.iter().map(|(name, _)| *name));
        found.or_else(|| self.fault(key, unknown()).and(None))
    }
}

/// Why a name cannot be that of a parameter; none if it can.
fn why_not_a_name(name: &str) -> Option<&'static str> {
    let plain = name.chars().all(|c| c.is_alphanumeric() || c == '_')
        && name.chars().next().is_some_and(|c| !c.is_ascii_digit());
    if unit(name).is_some() {
        Some("it is a unit")
    } else if RESERVED.contains(&name) {
        Some("it is a function or constant of expressions")
    } else if !plain {
        Some("names of parameters have letters, digits and `_`, and start with a letter")
    } else {
        None
    }
}

/// The SI value of a text such as `15.2 um`, which names no parameter.
///
/// # Errors
/// It is no quantity, or one of another kind.
pub fn read_quantity(text: &str, kind: Kind) -> Result<f64, FaultKind> {
    let cx = Context::new("", &NONE);
    let read = cx.quantity("", &Value::String(text.to_owned()), kind, Range::Any);
    let fault = || cx.take_faults().remove(0).kind;
    read.ok_or_else(fault)
}

/// A finite number and the rest of the text, its unit.
pub fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    // A unit may begin with e or E, as no exponent without digits does.
    (1..=text.len()).rev().filter(|end| text.is_char_boundary(*end)).find_map(|end| {
        Some((text[..end].parse::<f64>().ok().filter(|n| n.is_finite())?, text[end..].trim()))
    })
}

/// True if a text is one number with or without a unit, not an expression.
pub(super) fn is_number_with_unit(text: &str) -> bool {
    // The only digits of a unit are its exponents.
    let exponents = |pair: &[u8]| !pair[1].is_ascii_digit() || matches!(pair[0], b'^' | b'-');
    number_and_unit(text).is_some_and(|(_, unit)| {
        unit.is_empty() || (unit.as_bytes().windows(2).all(exponents) && read_unit(unit).is_ok())
    })
}
