//! Reads the random variables of a scene: first as written, then, when the nominal values of the keys that they change
//! are known, as distributions.
//!
//! Reads the measured samples of a random variable: as an empirical distribution, or with `fit` as the distribution of a family that
//! has the largest likelihood.

use super::context::Context;
use super::expression::read_unit;
use super::faults::{FaultKind, in_first_unit};
use super::quantity::{Dimension, Kind, Quantity};
use super::quantity_list::quantity_list;
use super::section::{Section, record};
use super::variable_law::WrittenLaw;
use crate::random::{Distribution, Family, FitError, RandomVariable};
use std::collections::BTreeMap;
use toml::Value;

/// A row of `[[variables]]`, its numbers not yet read: their dimension is that of the keys that the variable changes.
pub(super) struct VariableRow {
    pub(super) name: String,
    pub(super) changes: Vec<String>,
    unit: Option<String>,
    law: VariableLaw,
}

/// The distribution of a variable as written.
enum VariableLaw {
    /// By its word and parameters.
    Parameters(WrittenLaw),
    /// By measured samples.
    Measured(WrittenSamples),
}

impl VariableLaw {
    /// Reads the keys of a distribution.
    fn read(row: &mut Section) -> Option<Self> {
        if let Some(samples) = WrittenSamples::read(row) {
            return samples.map(Self::Measured);
        }
        if refuses_fit_without_samples(row) {
            row.give_up();
            return None;
        }
        let law = WrittenLaw::read(row).map(Self::Parameters);
        // A known key of every variable, absent here.
        let _ = row.get("samples");
        law
    }

    /// The first key that locates the variable, with its value as written.
    fn located(&self) -> Option<(&'static str, Value)> {
        match self {
            Self::Parameters(law) => law.located().map(|(key, value)| (key, value.clone())),
            Self::Measured(samples) => Some(("samples.1", samples.first()?)),
        }
    }

    fn takes_nominal(&self) -> bool {
        matches!(self, Self::Parameters(law) if law.takes_nominal())
    }

    /// Unit of the samples.
    fn unit(&self) -> Option<&str> {
        match self {
            Self::Parameters(_) => None,
            Self::Measured(samples) => samples.unit(),
        }
    }
}

/// Whether random variables have keys that they change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Changes {
    /// Those of a mechanism.
    Required,
    /// Those of a mechanism of which a program simulates the cycles.
    Optional,
    /// Inputs of an external simulator.
    None,
}

/// Reads `[[variables]]` as written; variables without keys that they change are inputs of an external simulator.
pub(super) fn variable_rows(file: &mut Section, may_change: Changes) -> Vec<VariableRow> {
    let rows = file.each_row("variables", |name, row| {
        let is_input = match may_change {
            Changes::Required => false,
            Changes::Optional => row.get("changes").is_none(),
            Changes::None => true,
        };
        record!(VariableRow {
            name: Some(name.to_owned()),
            changes: if is_input { Some(vec![]) } else { changes(row) },
            unit: row.if_any("unit", |row, key| row.text(key, "a unit, e.g. \"mm\"").map(str::to_owned)),
            law: VariableLaw::read(row),
        })
    });
    rows.into_iter().flatten().collect()
}

/// The keys that a variable changes.
fn changes(row: &mut Section) -> Option<Vec<String>> {
    let changes = row.texts("changes", "a list of keys, e.g. [\"parameters.rod_length\"]")?;
    if changes.is_empty() {
        let message = "is empty: the variable would change nothing; give the keys that it sets";
        row.inconsistent("changes", message);
        return None;
    }
    Some(changes.into_iter().map(str::to_owned).collect())
}

/// Gives the variables their distributions, from the nominal values `seen` at the keys they change, and their measured samples if they
/// have them.
pub(super) fn variables(
    cx: &Context,
    rows: &[VariableRow],
    seen: &BTreeMap<String, Quantity>,
) -> Vec<(RandomVariable, Option<MeasuredVariable>)> {
    let mut owners: BTreeMap<&str, &str> = BTreeMap::new();
    for row in rows {
        for key in &row.changes {
            if let Some(other) = owners.insert(key, &row.name) {
                let place = format!("variables.{}.changes", row.name);
                cx.inconsistent(place, format!("\"{key}\" is already changed by the variable \"{other}\""));
            }
        }
    }
    rows.iter().filter_map(|row| variable(cx, row, seen)).collect()
}

fn variable(
    cx: &Context,
    row: &VariableRow,
    seen: &BTreeMap<String, Quantity>,
) -> Option<(RandomVariable, Option<MeasuredVariable>)> {
    let path = format!("variables.{}", row.name);
    let nominal = nominal(cx, row, seen)?;
    let (distribution, measured) = match &row.law {
        VariableLaw::Parameters(law) => (law.distribution(cx, &path, nominal, &row.changes)?, None),
        VariableLaw::Measured(samples) => {
            let measured = samples.measured(cx, &path, nominal.kind())?;
            (measured.distribution.clone(), Some(measured))
        }
    };
    let dimension = nominal.dimension;
    let unit = match &row.unit {
        Some(unit) => match read_unit(unit) {
            Ok(found) if found.dimension == dimension => unit.clone(),
            // A unit of the simulator, which is only displayed.
            Err(_) if row.changes.is_empty() && dimension == Dimension::NONE => unit.clone(),
            found => {
                let bare = row.changes.is_empty() && dimension == Dimension::NONE && found.is_ok();
                let mean = distribution.mean();
                let advice = if bare { format!("; write mean = \"{mean} {unit}\"") } else { String::new() };
                cx.inconsistent(
                    format!("{path}.unit"),
                    format!("\"{unit}\" is not a unit of {dimension}{advice}"),
                );
                return None;
            }
        },
        None => row.law.unit().map_or_else(|| dimension.si_unit(), str::to_owned),
    };
    let variable =
        RandomVariable { name: row.name.clone(), distribution, changes: row.changes.clone(), unit };
    Some((variable, measured))
}

/// The common value of all keys of the variable without it; the mean of a simulator's input, which has no keys.
fn nominal(cx: &Context, row: &VariableRow, seen: &BTreeMap<String, Quantity>) -> Option<Quantity> {
    let place = format!("variables.{}.changes", row.name);
    if row.changes.is_empty() {
        let Some((key, written)) = row.law.located() else {
            let expected = "the mean of this input, a quantity or a plain number".to_owned();
            cx.fault(format!("variables.{}.mean", row.name), FaultKind::Missing { expected });
            return None;
        };
        return cx.value(&format!("variables.{}.{key}", row.name), &written, None);
    }
    let mut first: Option<Quantity> = None;
    for key in &row.changes {
        cx.reference(&place, "quantity", key, seen.keys().map(String::as_str))?;
        let found = seen[key];
        match first {
            None => first = Some(found),
            Some(first) if first.dimension != found.dimension => {
                let message = format!("\"{key}\" is {}, the others are {}", found.dimension, first.dimension);
                cx.inconsistent(place, message);
                return None;
            }
            Some(first) if first.value != found.value && row.law.takes_nominal() => {
                let message = format!(
                    "the nominal values differ ({} and {}), so mean must be given",
                    in_first_unit(first.value, first.kind()),
                    in_first_unit(found.value, found.kind())
                );
                cx.inconsistent(place, message);
                return None;
            }
            Some(_) => {}
        }
    }
    first
}

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
