//! A scene with values set by key: quantities of the scene (`parameters.clearance=25 um`), means of random variables
//! (`friction=0.06`), and distributions, thresholds and correlations (`friction.std=5 %`). The values are written into the text of
//! the scene, which is then read and checked like any scene file and stored with the study.
//!
//! A value has the meaning that it has in the file. A standard deviation that the file gives as a share of the mean
//! follows a changed mean, and so do bounds that the file does not name. Of keys that exclude each other those that were set
//! replace the others; what the distribution then lacks is taken from the present one.

use super::setting::{Allowed, Place, Setting, parse_all};
use common::random::{Correlation, Distribution, RandomVariable};
use common::scene::expression::read_unit;
use common::scene::{DEFAULT_LAW, Fault, Faults, LAWS, Scene, SceneSource};
use toml::{Table, Value};

/// Keys of a tolerance fit that gives a variable its moments.
pub const FIT_KEYS: [&str; 3] = ["fit", "diameter", "capability"];

/// The scene with these settings before a study of it, each `KEY=VALUE` as typed.
///
/// # Errors
/// The faults of all settings, or those of the scene that they give.
pub fn scene_with(source: &SceneSource, settings: &[String]) -> Result<SceneSource, Faults> {
    with_settings(source, settings, Allowed::Everything)
}

/// The scene of a finished study with other distributions, correlations and thresholds, e.g. `rod_length.std=0.1 mm`.
///
/// # Errors
/// As [`scene_with`]; also for quantities, which change what is simulated, and for constants of the study.
pub fn changed_scene(source: &SceneSource, settings: &[String]) -> Result<SceneSource, Faults> {
    with_settings(source, settings, Allowed::Studied)
}

/// As [`changed_scene`], of a scene whose constants may be changed too.
///
/// # Errors
/// As [`scene_with`]; also for quantities.
pub fn redistributed(source: &SceneSource, settings: &[String]) -> Result<SceneSource, Faults> {
    with_settings(source, settings, Allowed::Distributions)
}

/// The scene with values at keys of its tables, as in a scene file: rows of lists by their names, `*` for all rows.
///
/// # Errors
/// Keys that lead nowhere, or the faults of the changed scene.
pub fn with_keys(source: &SceneSource, origin: &str, keys: &Table) -> Result<SceneSource, Faults> {
    let what = "the scene has no such key; allowed: the path of a key, e.g. joints.crank.contact_law, with * for all rows";
    let mut faults: Vec<Fault> = Vec::new();
    let changed = source.edited(origin, |document| {
        let refused = keys.iter().filter(|(key, value)| insert(document, key, value).is_none());
        faults.extend(refused.map(|(key, _)| Fault::new(origin, key, what)));
    });
    if faults.is_empty() { changed } else { Err(Faults(faults)) }
}

fn with_settings(source: &SceneSource, settings: &[String], allowed: Allowed) -> Result<SceneSource, Faults> {
    let (read, mut faults) = parse_all(source, settings, allowed);
    let (quantities, others): (Vec<_>, Vec<_>) =
        read.into_iter().partition(|(place, _)| matches!(place, Place::Quantity(_)));
    // The faults of both are found together.
    let alone = [edited(source, &quantities), edited(source, &others)];
    let found = alone.iter().filter_map(|edited| edited.as_ref().err());
    faults.extend(found.flat_map(|Faults(found)| found.iter().cloned()));
    match alone {
        [Ok(changed), Ok(_)] if faults.is_empty() && !quantities.is_empty() => edited(&changed, &others),
        [_, Ok(changed)] if faults.is_empty() => Ok(changed),
        _ => Err(Faults(faults)),
    }
}

/// The scene with settings that do not depend on each other.
fn edited(source: &SceneSource, settings: &[Setting]) -> Result<SceneSource, Faults> {
    if settings.is_empty() {
        return Ok(source.clone());
    }
    let of_variable = |k: usize| -> Vec<(&str, Value)> {
        let of = |(place, value): &Setting| match place {
            Place::Variable(i, key) if *i == k => Some((*key, value.clone())),
            _ => None,
        };
        settings.iter().filter_map(of).collect()
    };
    // A distribution without moments of its own moves to those that a normal one has as they are written.
    let moves = |k: &usize| {
        let (keys, law) = (of_variable(*k), &source.variables()[*k].distribution);
        let has_none = matches!(law, Distribution::Triangular(_) | Distribution::Empirical(_));
        has_none && !keys.is_empty() && keys.iter().all(|(key, _)| ["mean", "std"].contains(key))
    };
    let moved: Vec<usize> = (0..source.variables().len()).filter(moves).collect();
    let normal = |k: &usize| (Place::Variable(*k, "distribution"), "normal".into());
    let normals: Vec<Setting> = moved.iter().map(normal).collect();
    let targets =
        if moved.is_empty() { source.clone() } else { edited(source, &[settings, &normals].concat())? };
    let mut faults: Vec<Fault> = Vec::new();
    let changed = source.edited("--set", |document| {
        for (k, variable) in source.variables().iter().enumerate() {
            let set = of_variable(k);
            let Some(row) = row(document, &variable.name).filter(|_| !set.is_empty()) else { continue };
            if moved.contains(&k) {
                let measured = source.measured.iter().find(|measured| measured.name == variable.name);
                let samples = measured.map(|measured| measured.samples.as_slice());
                move_values(row, variable, samples, &targets.variables()[k].distribution);
            } else {
                change_variable(row, variable, &set);
            }
        }
        for (place, value) in settings {
            match place {
                Place::Variable(..) => {}
                Place::Quantity(key) | Place::Threshold(key) => {
                    let what = "this key cannot be set; write a scene that `extends` this one";
                    let found = insert(document, key, value);
                    faults.extend(found.is_none().then(|| Fault::new("--set", key, what)));
                }
                Place::Correlation(pair) => {
                    let names = pair.map(|k| source.variables()[k].name.as_str());
                    let is_pair = |row: &Value| {
                        let pair = row.get("variables").and_then(Value::as_array);
                        pair.is_some_and(|pair| names.iter().all(|name| pair.contains(&Value::from(*name))))
                    };
                    let rows = rows(document, "correlations");
                    rows.retain(|row| !is_pair(row));
                    rows.push(value.clone());
                }
            }
        }
    });
    if faults.is_empty() { changed } else { Err(Faults(faults)) }
}

/// The rows of a list of tables of a scene.
pub fn rows<'d>(document: &'d mut Table, list: &str) -> &'d mut Vec<Value> {
    let rows = document.entry(list).or_insert_with(|| Value::Array(vec![]));
    rows.as_array_mut().expect("the lists of a valid scene are lists")
}

/// The row of a random variable.
pub fn row<'d>(document: &'d mut Table, name: &str) -> Option<&'d mut Table> {
    let is_asked = |row: &&mut Table| row.get("name").and_then(Value::as_str) == Some(name);
    rows(document, "variables").iter_mut().filter_map(Value::as_table_mut).find(is_asked)
}

/// Correlation of the standard normals of two variables of a scene, 0 without one [1].
pub fn correlation_of(scene: &Scene, i: usize, k: usize) -> f64 {
    let is_pair = |c: &&Correlation| [(i, k), (k, i)].contains(&(c.first, c.second));
    scene.correlations.iter().find(is_pair).map_or(0.0, |c| c.coefficient)
}

/// A row of the list of random variables: one that changes these `keys`, with the keys of its distribution.
pub fn variable_row(name: &str, keys: &[String], law: &[(&str, Value)]) -> Table {
    let row = [("name", Value::from(name)), ("changes", Value::from(keys.to_vec()))];
    let row = row.into_iter().chain(law.iter().cloned());
    row.map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Writes a value at the path of a key: keys of tables, names of rows, and numbers or coordinates of entries. `None` if the
/// path leads nowhere.
fn insert(table: &mut Table, path: &str, value: &Value) -> Option<()> {
    // What a file gave is another value then.
    table.remove("source");
    if let Some((first, rest)) = path.split_once('.') {
        return insert_below(table.get_mut(first)?, rest, value);
    }
    table.insert(path.to_owned(), value.clone());
    Some(())
}

fn insert_below(below: &mut Value, path: &str, value: &Value) -> Option<()> {
    let rows = match below {
        Value::Table(table) => return insert(table, path, value),
        below => below.as_array_mut()?,
    };
    let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
    if let ("*", Some(rest)) = (first, rest) {
        let of_all = rows.iter_mut().map(|row| insert_below(row, rest, value));
        return of_all.collect::<Option<Vec<()>>>().filter(|all| !all.is_empty()).map(drop);
    }
    let has_name = |row: &Value| row.get("name").and_then(Value::as_str) == Some(first);
    let place = rows.iter().position(has_name).or_else(|| match first {
        "x" => Some(0),
        "y" => Some(1),
        number => number.parse::<usize>().ok()?.checked_sub(1),
    })?;
    let row = rows.get_mut(place)?;
    if let Some(rest) = rest {
        return insert_below(row, rest, value);
    }
    row.clone_from(value);
    Some(())
}

/// Writes the changed keys of a variable into its row, without those that they exclude.
fn change_variable(row: &mut Table, variable: &RandomVariable, set: &[(&str, Value)]) {
    let sets = |key: &str| set.iter().any(|(known, _)| *known == key);
    let word = |value: &Value| value.as_str().map(str::to_owned);
    let asked = set.iter().find(|(key, _)| *key == "distribution").map(|(_, value)| value);
    let present = &variable.distribution;
    let moments = [("mean", present.parent_mean()), ("std", present.given_std())];
    // Measured samples give way to the distribution that is asked for or was fitted.
    if let Some(law) = asked.cloned().or_else(|| row.get("fit").cloned())
        && row.remove("samples").is_some()
    {
        row.remove("fit");
        row.insert("distribution".to_owned(), law);
        write_values(row, &moments, &variable.unit);
    }
    let before = row.get("distribution").and_then(word).unwrap_or_else(|| DEFAULT_LAW.to_owned());
    let law = asked.and_then(word).unwrap_or_else(|| before.clone());
    let fill = |row: &mut Table, values: &[(&str, f64)]| {
        let missing: Vec<_> = values.iter().filter(|(key, _)| !row.contains_key(*key)).copied().collect();
        write_values(row, &missing, &variable.unit);
    };
    let remove = |row: &mut Table, keys: &[&str]| keys.iter().for_each(|key| drop(row.remove(*key)));
    // Moments in place of a fit, or of the bounds and the mode that located the variable.
    let moments_set = sets("mean") || sets("std");
    let bounds_set = sets("lower") || sets("upper");
    if row.contains_key("fit") && (moments_set || law != before) {
        remove(row, &FIT_KEYS);
        fill(row, &moments);
    }
    let by_bounds = before == "triangular" || (before == "uniform" && row.contains_key("lower"));
    if law != before && by_bounds && !row.contains_key("mean") {
        fill(row, &[("mean", present.mean()), ("std", present.std())]);
    }
    match law.as_str() {
        "uniform" if bounds_set => {
            remove(row, &["mean", "std"]);
            remove(row, &FIT_KEYS);
            let (lower, upper) = present.support();
            if lower.is_finite() && upper.is_finite() {
                fill(row, &[("lower", lower), ("upper", upper)]);
            }
        }
        "uniform" if moments_set || law != before => {
            remove(row, &["lower", "upper"]);
            fill(row, &moments);
        }
        "exponential" if sets("std") => remove(row, &["lower"]),
        "exponential" if sets("lower") => remove(row, &["std"]),
        _ => {}
    }
    // Keys that another distribution does not take; an unknown one is a fault of the changed scene.
    if let Some((_, taken)) = LAWS.iter().find(|(name, _)| *name == law).filter(|_| law != before) {
        let all = ["mean", "std", "truncation", "lower", "upper", "mode"];
        all.iter().filter(|key| !taken.contains(key)).for_each(|key| drop(row.remove(*key)));
    }
    for (key, value) in set {
        row.insert((*key).to_owned(), value.clone());
    }
}

/// Moves the samples of a variable, or the bounds and the mode of a triangular one, to the mean and the standard deviation of `target`.
fn move_values(row: &mut Table, variable: &RandomVariable, samples: Option<&[f64]>, target: &Distribution) {
    let law = &variable.distribution;
    let (mean, (lower, upper)) = (law.parent_mean(), law.support());
    let stretch = target.given_std() / law.given_std();
    let moved = |x: f64| target.parent_mean() + (x - mean) * stretch;
    if let Some(samples) = samples {
        let values = samples.iter().map(|x| written_value(moved(*x), &variable.unit)).collect();
        row.insert("samples".to_owned(), Value::Array(values));
    } else {
        let values = [("lower", lower), ("mode", 3.0 * mean - lower - upper), ("upper", upper)];
        write_values(row, &values.map(|(key, x)| (key, moved(x))), &variable.unit);
    }
}

/// Writes values in SI at keys of the row of a variable with this unit.
pub fn write_values(row: &mut Table, values: &[(&str, f64)], unit: &str) {
    row.extend(values.iter().map(|(key, value)| ((*key).to_owned(), written_value(*value, unit))));
}

/// A value in SI as in a scene file, in the unit of its variable.
pub fn written_value(value: f64, unit: &str) -> Value {
    match read_unit(unit) {
        Ok(read) if unit != "1" => Value::String(format!("{:e} {unit}", value * read.divide / read.multiply)),
        // A plain number, or a unit of the simulator, which is only displayed.
        _ => Value::Float(value),
    }
}

#[cfg(test)]
#[path = "scene_settings_tests.rs"]
mod tests;
