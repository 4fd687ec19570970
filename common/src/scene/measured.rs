//! Reads the measured samples of a random variable: as an empirical distribution, or with `fit` as the distribution of a family that
//! has the largest likelihood.

use super::context::Context;
use super::faults::{FaultKind, in_first_unit};
use super::quantity::Kind;
use super::quantity_list::quantity_list;
use super::section::Section;
use crate::random::{Distribution, Family, FitError};
use toml::Value;

/// Measured values of a random variable, and the family that was fitted to them.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredVariable {
    /// Name of the variable.
    pub name: String,
    /// The values as measured `(n,)` [SI].
    pub samples: Vec<f64>,
    /// The family that was fitted; none for an empirical distribution.
    pub family: Option<Family>,
    /// The distribution of the variable.
    pub distribution: Distribution,
}

/// Samples as written, not yet read: their dimension is that of the keys that the variable changes.
pub(super) struct WrittenSamples {
    list: Value,
    family: Option<Family>,
}

impl WrittenSamples {
    /// Reads `samples` and `fit`; none without samples, the inner one if they are faulty.
    pub(super) fn read(row: &mut Section) -> Option<Option<Self>> {
        row.peek("samples")?;
        let list = row.get("samples")?.clone();
        let before = row.cx.fault_count();
        for key in ["distribution", "mean", "std", "lower", "upper"] {
            if row.peek(key).is_some() {
                // Known, so that it has this fault only.
                let _ = row.get(key);
                row.inconsistent(key, "is that of the samples: give either samples or this key");
            }
        }
        let words: Vec<(&str, Family)> = Family::ALL.map(|family| (family.word(), family)).to_vec();
        let family = row.get("fit").map(|_| row.choice("fit", "a family of distributions", &words));
        Some((row.cx.fault_count() == before).then_some(Self { list, family: family.flatten() }))
    }

    /// The first sample as written, which has the dimension of the variable.
    pub(super) fn first(&self) -> Option<Value> {
        match &self.list {
            Value::Array(list) => list.first().cloned(),
            Value::Table(table) => {
                let number = match table.get("values")?.as_array()?.first()? {
                    Value::Integer(number) => *number as f64,
                    other => other.as_float()?,
                };
                let unit = table.get("unit").and_then(Value::as_str);
                Some(unit.map_or(Value::Float(number), |unit| Value::String(format!("{number:?} {unit}"))))
            }
            _ => None,
        }
    }

    /// The unit that all samples have.
    pub(super) fn unit(&self) -> Option<&str> {
        self.list.as_table()?.get("unit")?.as_str()
    }

    /// The samples and their distribution, for the variable at `path`, whose values are of this kind.
    pub(super) fn measured(&self, cx: &Context, path: &str, kind: Kind) -> Option<MeasuredVariable> {
        let key = format!("{path}.samples");
        let samples = quantity_list(cx, &key, &self.list, kind)?;
        let made = match self.family {
            None => Distribution::empirical(&samples),
            Some(family) => family.fit(&samples),
        };
        let refused = |error| match error {
            FitError::TooFew { found, least } => {
                cx.inconsistent(&key, format!("has {found} values, at least {least} are needed"));
            }
            FitError::AllEqual => cx.inconsistent(&key, "all values are equal: leave the variable out"),
            FitError::NotPositive { place } => {
                let value = in_first_unit(samples[place], kind);
                let allowed = "> 0 in this family; `fit = \"normal\"` takes all values".to_owned();
                cx.fault(format!("{key}.{}", place + 1), FaultKind::OutOfRange { value, allowed });
            }
            FitError::Law(error) => cx.inconsistent(format!("{path}.fit"), error.to_string()),
        };
        let distribution = made.map_err(refused).ok()?;
        let name = path.strip_prefix("variables.").unwrap_or(path).to_owned();
        Some(MeasuredVariable { name, samples, family: self.family, distribution })
    }
}

/// Refuses `fit = "lognormal"` without samples; true if it did.
pub(super) fn refuses_fit_without_samples(row: &mut Section) -> bool {
    let word = row.peek("fit").and_then(Value::as_str);
    let Some(family) = Family::ALL.into_iter().find(|family| Some(family.word()) == word) else {
        return false;
    };
    let word = family.word();
    let message = format!(
        "\"{word}\" is fitted to measured values: add samples = {{ csv = \"FILE\", column = \"NAME [UNIT]\" }}, or write \
         distribution = \"{word}\" with mean and std"
    );
    row.inconsistent("fit", message);
    true
}
