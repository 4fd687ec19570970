//! A design variable as typed: `KEY=LOWER..UPPER`, with numbers in one unit.

use crate::analyses::scene_settings::variable_row;
use common::scene::{Faults, number_and_unit};
use serde::{Deserialize, Serialize};
use toml::Value;

/// A key of the scene with a range of values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignVariable {
    /// Key as `run --set` takes it.
    pub key: String,
    /// Lower end of the range [`unit`](Self::unit).
    pub lower: f64,
    /// Upper end of the range [`unit`](Self::unit).
    pub upper: f64,
    /// Unit as typed; empty for a plain number.
    pub unit: String,
    /// Name of the random variable that stands for it in the augmented scene; `None` if it changes a distribution or a threshold.
    #[serde(skip)]
    pub(super) added: Option<String>,
}

impl DesignVariable {
    /// Reads `KEY=LOWER..UPPER`, e.g. `parameters.clearance=18 um..30 um`; the unit may stand at the upper end alone.
    ///
    /// # Errors
    /// The fault of the text.
    pub fn parse(text: &str) -> Result<Self, Faults> {
        let refuse = |message: &str| Err(Faults::one("--design", text, message));
        let range = text.split_once('=').and_then(|(key, range)| Some((key.trim(), range.split_once("..")?)));
        let Some((key, (lower, upper))) = range.filter(|(key, _)| !key.is_empty()) else {
            return refuse("expected KEY=LOWER..UPPER, e.g. parameters.clearance='18 um..30 um'");
        };
        let (Some((lower, first)), Some((upper, unit))) = (number_and_unit(lower), number_and_unit(upper))
        else {
            return refuse("both ends of the range must be numbers, each with its unit, e.g. 18 um..30 um");
        };
        if !first.is_empty() && first != unit {
            return refuse("both ends of the range must have the same unit");
        }
        if lower >= upper {
            return refuse("the lower end of the range must be below the upper one");
        }
        Ok(Self { key: key.to_owned(), lower, upper, unit: unit.to_owned(), added: None })
    }

    /// The setting `KEY=VALUE` of a value in the unit of the range.
    pub fn setting(&self, value: f64) -> String {
        format!("{}={}", self.key, self.with_unit(value))
    }

    /// A value with its unit, as in a scene file.
    pub fn with_unit(&self, value: f64) -> String {
        if self.unit.is_empty() { format!("{value}") } else { format!("{value} {}", self.unit) }
    }

    /// A value as TOML writes it in a scene.
    pub(super) fn written(&self, value: f64) -> Value {
        if self.unit.is_empty() { Value::Float(value) } else { Value::from(self.with_unit(value)) }
    }

    /// The row of the random variable that stands for it, with the keys of its distribution; `None` if none does.
    pub(super) fn row(&self, law: &[(&str, Value)]) -> Option<Value> {
        let mut row = variable_row(self.added.as_ref()?, std::slice::from_ref(&self.key), law);
        if !self.unit.is_empty() && self.unit != "%" {
            row.insert("unit".to_owned(), Value::from(self.unit.as_str()));
        }
        Some(Value::Table(row))
    }

    /// The value at the share `t` in [0, 1] of the range, without digits beyond a millionth of it.
    pub fn at(&self, t: f64) -> f64 {
        let value = self.lower + t * (self.upper - self.lower);
        let digits = (6.0 - (self.upper - self.lower).log10().floor()).clamp(0.0, 300.0) as usize;
        // Zero digits are few enough for a range of a million; a number that was formatted is read back.
        format!("{value:.digits$}").parse().unwrap_or(value)
    }

    /// Name of the variable with its unit, for heads of tables and axes.
    pub fn label(&self) -> String {
        if self.unit.is_empty() { self.key.clone() } else { format!("{} [{}]", self.key, self.unit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_with_their_unit() {
        let (key, unit) = ("a.b".to_owned(), "um".to_owned());
        let expected = DesignVariable { key, lower: 18.0, upper: 30.5, unit, added: None };
        for text in ["a.b=18um..30.5um", "a.b = 18 um .. 30.5 um", "a.b=18..30.5 um", "a.b=1.8e1..3.05e1um"] {
            assert_eq!(DesignVariable::parse(text), Ok(expected.clone()), "{text}");
        }
        assert_eq!(expected.setting(expected.at(0.5)), "a.b=24.25 um");
        let plain = DesignVariable::parse("friction=-1..2").unwrap();
        assert_eq!((plain.lower, plain.setting(0.25)), (-1.0, "friction=0.25".to_owned()));
        let share = DesignVariable::parse("wear.std=2 %..8 %").unwrap();
        assert_eq!(share.setting(share.at(1.0 / 3.0)), "wear.std=4 %");
    }

    #[test]
    fn what_is_no_range_is_refused() {
        for text in ["a", "a=1", "=1..2", "a=1..b", "a=2..1", "a=1 um..2 mm", "a=1..inf", "a=..2"] {
            assert!(DesignVariable::parse(text).is_err(), "{text}");
        }
    }
}
