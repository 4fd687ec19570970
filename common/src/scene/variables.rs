//! Reads the random variables of a scene and their correlations, when the nominal values of the keys that they change are known.
//!
//! Reads the measured samples of a random variable: as an empirical distribution, or with `fit` as the distribution of a family that
//! has the largest likelihood.
//!
//! Reads the correlations of random variables: `[[correlations]]`, each a pair of variables with the coefficient of
//! their standard normals or their rank correlation.

use super::context::Range;
use super::expression::read_unit;
use super::faults::in_first_unit;
use super::quantity::{Dimension, NUMBER, Quantity};
use super::section::Section;
use super::units::Units;
use super::variable_law::WrittenLaw;
use crate::random::{
    Correlation, Distribution, Family, FitError, GaussianCopula, RandomVariable, normal_from_rank_correlation,
};
use std::collections::BTreeMap;
use toml::Value;

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

/// What the scene without its random variables consists of.
#[derive(Clone, Copy)]
pub(super) struct Changed<'a> {
    /// What the variables may change.
    pub(super) may: Changes,
    /// Its quantities by the path of their key.
    pub(super) seen: &'a BTreeMap<String, Quantity>,
    /// True if it has a fault: a quantity may be unread only because of it.
    pub(super) is_faulty: bool,
}

/// A random variable, and its measured samples if it has them.
pub(super) type Variable = (RandomVariable, Option<MeasuredVariable>);

/// Reads `[[variables]]`, after everything that a variable may change: name and variable, unless faulty. Variables without keys that they
/// change are inputs of an external simulator. One without a unit has that of its kind among the chosen `units`, or the SI unit.
pub(super) fn variables<'s>(
    file: &mut Section<'s>,
    scene: Changed,
    units: Option<&Units>,
) -> Vec<(&'s str, Option<Variable>)> {
    let mut owners: BTreeMap<String, &str> = BTreeMap::new();
    file.each_row("variables", |name, row| {
        let is_input = match scene.may {
            Changes::Required => false,
            Changes::Optional => row.get("changes").is_none(),
            Changes::None => true,
        };
        let changes = if is_input { Some(vec![]) } else { changes(row) };
        for key in changes.iter().flatten() {
            if let Some(other) = owners.insert(key.clone(), name) {
                let message = format!("\"{key}\" is already changed by the variable \"{other}\"");
                row.inconsistent("changes", message);
            }
        }
        (name, variable(name, row, changes, (scene, units)))
    })
}

fn variable(
    name: &str,
    row: &mut Section,
    changes: Option<Vec<String>>,
    (scene, units): (Changed, Option<&Units>),
) -> Option<Variable> {
    let unit = row.if_any("unit", |row, key| row.text(key, "a unit, e.g. \"mm\""));
    let law = law(row, changes.as_deref(), scene);
    let ((nominal, distribution, measured), unit, changes) = (law?, unit?, changes?);
    let dimension = nominal.dimension;
    let is_bare_input = changes.is_empty() && dimension == Dimension::NONE;
    let unit = match unit {
        Some(unit) => match read_unit(unit) {
            Ok(found) if found.dimension == dimension => unit.to_owned(),
            // A unit of the simulator, which is only displayed.
            Err(_) if is_bare_input => unit.to_owned(),
            _ => {
                let mean = distribution.mean();
                let write = format!("; write mean = \"{mean} {unit}\"");
                let advice = if is_bare_input { write } else { String::new() };
                let message = format!("\"{unit}\" is not a unit of {dimension}{advice}");
                return row.inconsistent("unit", message).and(None);
            }
        },
        None => {
            let of_samples = row.peek("samples").and_then(|samples| samples.get("unit")?.as_str());
            let chosen = || units?.of_kind(nominal.kind()).map(str::to_owned);
            of_samples.map(str::to_owned).or_else(chosen).unwrap_or_else(|| dimension.si_unit())
        }
    };
    Some((RandomVariable { name: name.to_owned(), distribution, changes, unit }, measured))
}

/// Reads the keys of a distribution: the value of the scene without the variable, the distribution, and its samples if it has them.
fn law(
    row: &mut Section,
    changes: Option<&[String]>,
    scene: Changed,
) -> Option<(Quantity, Distribution, Option<MeasuredVariable>)> {
    if row.peek("samples").is_some() {
        let (nominal, measured) = measured(row, changes, scene)?;
        return Some((nominal, measured.distribution.clone(), Some(measured)));
    }
    if refuses_fit_without_samples(row) {
        row.given_up = true;
        return None;
    }
    let law = WrittenLaw::read(row);
    // A known key of every variable, absent here.
    let _ = row.get("samples");
    let (law, changes) = (law?, changes?);
    let located = law.located().map(|(key, value)| (key, value.clone()));
    let nominal = nominal(row, changes, scene, located, law.takes_nominal())?;
    Some((nominal, law.distribution(row, nominal, changes)?, None))
}

/// The common value of all keys of the variable without it; the mean of a simulator's input, which has no keys: the `located` value as
/// written, with its key.
fn nominal(
    row: &Section,
    changes: &[String],
    Changed { seen, is_faulty, .. }: Changed,
    located: Option<(&str, Value)>,
    takes_nominal: bool,
) -> Option<Quantity> {
    if changes.is_empty() {
        let Some((key, written)) = located else {
            return row.missing("mean", "the mean of this input, a quantity or a plain number").and(None);
        };
        return row.cx.value(&row.key(key), &written, None);
    }
    let mut first: Option<Quantity> = None;
    for key in changes {
        if is_faulty && !seen.contains_key(key) {
            return None;
        }
        row.reference("changes", "quantity", key, seen.keys().map(String::as_str))?;
        let (found, first) = (seen[key], *first.get_or_insert(seen[key]));
        if first.dimension != found.dimension {
            let message = format!("\"{key}\" is {}, the others are {}", found.dimension, first.dimension);
            return row.inconsistent("changes", message).and(None);
        }
        if first.value != found.value && takes_nominal {
            let [a, b] = [first, found].map(|quantity| in_first_unit(quantity.value, quantity.kind()));
            let message = format!("the nominal values differ ({a} and {b}), so mean must be given");
            return row.inconsistent("changes", message).and(None);
        }
    }
    first
}

/// The keys that a variable changes.
fn changes(row: &mut Section) -> Option<Vec<String>> {
    let changes = row.texts("changes", "a list of keys, e.g. [\"parameters.rod_length\"]")?;
    if changes.is_empty() {
        let message = "is empty: the variable would change nothing; give the keys that it sets";
        return row.inconsistent("changes", message).and(None);
    }
    Some(changes.into_iter().map(str::to_owned).collect())
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

/// Reads `samples` and `fit`: the value of the scene without the variable, and the samples with their distribution.
fn measured(
    row: &mut Section,
    changes: Option<&[String]>,
    scene: Changed,
) -> Option<(Quantity, MeasuredVariable)> {
    let list = row.get("samples")?;
    let before = row.cx.fault_count();
    for key in ["distribution", "mean", "std", "lower", "upper"] {
        // Known where it is given, so that it has this fault only.
        if row.peek(key).is_some() && row.get(key).is_some() {
            row.inconsistent(key, "is that of the samples: give either samples or this key");
        }
    }
    let family =
        row.if_any("fit", |row, key| row.choice(key, "a family of distributions", &Family::WORDS))?;
    let changes = changes.filter(|_| row.cx.fault_count() == before)?;
    let located = first(list).map(|value| ("samples.1", value));
    let nominal = nominal(row, changes, scene, located, false)?;
    let samples = row.quantities("samples", nominal.kind())?;
    let made = family.map_or_else(|| Distribution::empirical(&samples), |family| family.fit(&samples));
    let refused = |error| match error {
        FitError::NotPositive(place) => {
            let value = in_first_unit(samples[place], nominal.kind());
            let allowed = "> 0 in this family; `fit = \"normal\"` takes all values";
            row.out_of_range(&format!("samples.{}", place + 1), value, allowed)
        }
        FitError::Law(error) => row.inconsistent("fit", error.to_string()),
        other => row.inconsistent("samples", other.to_string()),
    };
    let distribution = made.map_err(refused).ok()?;
    let name = row.path.strip_prefix("variables.").unwrap_or(&row.path).to_owned();
    Some((nominal, MeasuredVariable { name, samples, family, distribution }))
}

/// The first of a list of samples as written, which has the dimension of the variable.
fn first(samples: &Value) -> Option<Value> {
    match samples {
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

/// Refuses `fit = "lognormal"` without samples; true if it did.
fn refuses_fit_without_samples(row: &mut Section) -> bool {
    let word = row.peek("fit").and_then(Value::as_str);
    let Some((word, _)) = Family::WORDS.into_iter().find(|(known, _)| Some(*known) == word) else {
        return false;
    };
    let message = format!(
        "\"{word}\" is fitted to measured values: add samples = {{ csv = \"FILE\", column = \"NAME [UNIT]\" }}, or write \
         distribution = \"{word}\" with mean and std"
    );
    row.inconsistent("fit", message);
    true
}

/// Reads `[[correlations]]` of the `variables`, each with its name; in a scene that `is_faulty` their names may be wrong only because of that.
pub(super) fn correlations(
    file: &mut Section,
    variables: &[(&str, Option<Variable>)],
    is_faulty: bool,
) -> Vec<Correlation> {
    let before = file.cx.fault_count();
    let mut found: Vec<Correlation> = Vec::new();
    for mut row in file.unnamed_rows("correlations") {
        let expected = "a pair of random variables, e.g. [\"rod_length\", \"friction\"]";
        let names = row.texts("variables", expected);
        let pair = names.and_then(|names| match names[..] {
            [a, b] if a != b => Some([a, b]),
            _ => row.inconsistent("variables", format!("is not {expected}")).and(None),
        });
        let coefficient = coefficient(&mut row);
        row.finish();
        let (Some([a, b]), Some(coefficient), false) = (pair, coefficient, is_faulty) else { continue };
        let index = |name: &str| {
            let names = variables.iter().map(|(name, _)| *name);
            let i = row.reference("variables", "random variable", name, names)?;
            if variables[i].1.as_ref().is_some_and(|(variable, _)| variable.distribution.is_constant()) {
                let message = format!("\"{name}\" is constant and cannot be correlated");
                return row.inconsistent("variables", message).and(None);
            }
            Some(i)
        };
        let (first, second) = (index(a), index(b));
        let Some((first, second)) = first.zip(second) else { continue };
        if found.iter().any(|c| [(first, second), (second, first)].contains(&(c.first, c.second))) {
            row.inconsistent("variables", format!("the correlation of \"{a}\" and \"{b}\" is given twice"));
            continue;
        }
        found.push(Correlation { first, second, coefficient });
    }
    if file.cx.fault_count() == before
        && let Err(error) = GaussianCopula::new(variables.len(), &found)
    {
        let message = format!(
            "the correlation matrix is not positive definite: the correlations of \"{}\" contradict those before it; use \
             coefficients nearer to 0",
            variables[error.variable].0
        );
        file.inconsistent("correlations", message);
    }
    found
}

/// The coefficient of the standard normals, from `coefficient` or `rank`.
fn coefficient(row: &mut Section) -> Option<f64> {
    let expected = || "a number between -1 and 1, or rank".to_owned();
    let key = row.either(["coefficient", "rank"], expected)?;
    let value = row.quantity(key, NUMBER, Range::Any)?;
    if value.abs() >= 1.0 {
        return row.out_of_range(key, value.to_string(), "> -1 and < 1").and(None);
    }
    Some(if key == "rank" { normal_from_rank_correlation(value) } else { value })
}
