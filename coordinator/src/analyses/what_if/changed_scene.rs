//! The scene of a study with changed distributions, correlations and thresholds: the changes are written into its text,
//! which is then read and checked like any scene file.
//!
//! A change has the meaning that it has in the file. A standard deviation that the file gives as a share of the mean
//! follows a changed mean, and so do bounds that the file does not name. Of keys that exclude each other those that were set
//! replace the others; what the distribution then lacks is taken from the present one.

use super::setting::{Setting, fault, parse};
use common::random::RandomVariable;
use common::scene::expression::read_unit;
use common::scene::{DEFAULT_LAW, Fault, Faults, SceneSource, laws};
use toml::{Table, Value};

/// The scene with these changes, each as typed, e.g. `rod_length.std=0.1 mm`.
///
/// # Errors
/// The faults of all changes, or those of the changed scene.
pub fn changed_scene(source: &SceneSource, settings: &[String]) -> Result<SceneSource, Faults> {
    let influence = |setting: &String| {
        let change = parse(source, setting).ok()?;
        unknown_influence(source, setting, &change)
    };
    let unknown: Vec<Fault> = settings.iter().filter_map(influence).collect();
    match redistributed(source, settings) {
        Ok(_) if !unknown.is_empty() => Err(Faults(unknown)),
        Ok(changed) => Ok(changed),
        Err(Faults(found)) => Err(Faults([unknown, found].concat())),
    }
}

/// The scene with these changes, before any study of it: constant variables may be changed too.
///
/// # Errors
/// The faults of all changes, or those of the changed scene.
pub fn redistributed(source: &SceneSource, settings: &[String]) -> Result<SceneSource, Faults> {
    let mut faults: Vec<Fault> = Vec::new();
    let mut changes: Vec<Setting> = Vec::new();
    for setting in settings {
        match parse(source, setting) {
            Ok(change) if changes.iter().any(|known| known.coincides(&change)) => {
                faults.push(fault(setting, "this is set twice"));
            }
            Ok(change) => changes.push(change),
            Err(Faults(found)) => faults.extend(found),
        }
    }
    if !faults.is_empty() {
        return Err(Faults(faults));
    }
    source.edited("--set", |document| write_changes(document, source, changes))
}

/// Writes the changes into the tables of the scene.
fn write_changes(document: &mut Table, source: &SceneSource, changes: Vec<Setting>) {
    for (k, variable) in source.variables().iter().enumerate() {
        let of_variable = |change: &Setting| match change {
            Setting::Variable { variable, key, value } if *variable == k => Some((*key, value.clone())),
            _ => None,
        };
        let set: Vec<(&str, Value)> = changes.iter().filter_map(of_variable).collect();
        if let Some(row) = row(document, "variables", &variable.name).filter(|_| !set.is_empty()) {
            change_variable(row, variable, &set);
        }
    }
    for change in changes {
        match change {
            Setting::Variable { .. } => {}
            Setting::Threshold { limit_state, key, value } => {
                let name = &source.nominal().limit_states[limit_state].name;
                if let Some(row) = row(document, "limit_states", name) {
                    row.insert(key.to_owned(), value);
                }
            }
            Setting::Correlation { pair, key, value } => {
                let names = pair.map(|k| source.variables()[k].name.clone());
                change_correlation(document, &names, key, value);
            }
        }
    }
}

/// The fault of a variable that the study held constant: its simulations do not show its influence.
fn unknown_influence(source: &SceneSource, setting: &str, change: &Setting) -> Option<Fault> {
    let Setting::Variable { variable, .. } = change else { return None };
    let variable = &source.variables()[*variable];
    variable.distribution.is_constant().then(|| {
        let message = format!(
            "\"{}\" was constant in all simulations of the study, which therefore do not show its influence; start a study in \
             which it varies with `coordinator run`",
            variable.name
        );
        fault(setting, message)
    })
}

/// The row of this name in a list of tables.
fn row<'d>(document: &'d mut Table, list: &str, name: &str) -> Option<&'d mut Table> {
    let rows = document.get_mut(list)?.as_array_mut()?;
    let is_asked = |row: &&mut Table| row.get("name").and_then(Value::as_str) == Some(name);
    rows.iter_mut().filter_map(Value::as_table_mut).find(is_asked)
}

/// Writes the changed keys of a variable into its row, without those that they exclude.
fn change_variable(row: &mut Table, variable: &RandomVariable, set: &[(&str, Value)]) {
    let sets = |key: &str| set.iter().any(|(known, _)| *known == key);
    let word = |value: &Value| value.as_str().map(str::to_owned);
    leave_samples(row, variable, set);
    let before = row.get("distribution").and_then(word).unwrap_or_else(|| DEFAULT_LAW.to_owned());
    let asked = set.iter().find(|(key, _)| *key == "distribution").and_then(|(_, value)| word(value));
    let law = asked.unwrap_or_else(|| before.clone());
    let present = &variable.distribution;
    let moments = [("mean", present.parent_mean()), ("std", present.given_std())];
    let fill = |row: &mut Table, values: &[(&str, f64)]| {
        for (key, value) in values {
            if !row.contains_key(*key) {
                row.insert((*key).to_owned(), written_value(*value, &variable.unit));
            }
        }
    };
    let remove = |row: &mut Table, keys: &[&str]| keys.iter().for_each(|key| drop(row.remove(*key)));
    // Moments in place of a fit, or of the bounds and the mode that located the variable.
    let moments_set = sets("mean") || sets("std");
    let bounds_set = sets("lower") || sets("upper");
    if row.contains_key("fit") && (moments_set || law != before) {
        remove(row, &["fit"]);
        fill(row, &moments);
    }
    let by_bounds = before == "triangular" || (before == "uniform" && row.contains_key("lower"));
    if law != before && by_bounds && !row.contains_key("mean") {
        fill(row, &[("mean", present.mean()), ("std", present.std())]);
    }
    match law.as_str() {
        "uniform" if bounds_set => {
            remove(row, &["mean", "std", "fit"]);
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
    if let Some((_, taken)) = laws().iter().find(|(name, _)| *name == law).filter(|_| law != before) {
        let all = ["mean", "std", "truncation", "lower", "upper", "mode"];
        all.iter().filter(|key| !taken.contains(key)).for_each(|key| drop(row.remove(*key)));
    }
    for (key, value) in set {
        row.insert((*key).to_owned(), value.clone());
    }
}

/// Replaces measured samples by the distribution that is asked for or was fitted, with their moments. An empirical distribution has
/// none that could be changed: that is a fault of the changed scene.
fn leave_samples(row: &mut Table, variable: &RandomVariable, set: &[(&str, Value)]) {
    let asked = set.iter().find(|(key, _)| *key == "distribution").map(|(_, value)| value.clone());
    let Some(law) = asked.or_else(|| row.get("fit").cloned()).filter(|_| row.contains_key("samples")) else {
        return;
    };
    row.retain(|key, _| key != "samples" && key != "fit");
    row.insert("distribution".to_owned(), law);
    let present = &variable.distribution;
    for (key, value) in [("mean", present.parent_mean()), ("std", present.given_std())] {
        row.insert(key.to_owned(), written_value(value, &variable.unit));
    }
}

/// A value in SI as in a scene file, in the unit of its variable.
pub fn written_value(value: f64, unit: &str) -> Value {
    match read_unit(unit) {
        Ok(read) if unit != "1" => Value::String(format!("{:e} {unit}", value * read.divide / read.multiply)),
        // A plain number, or a unit of the simulator, which is only displayed.
        _ => Value::Float(value),
    }
}

/// Writes the correlation of two variables, in place of the present one.
fn change_correlation(document: &mut Table, names: &[String; 2], key: &str, value: Value) {
    let rows = document.entry("correlations").or_insert_with(|| Value::Array(vec![]));
    let Some(rows) = rows.as_array_mut() else { return };
    let is_pair = |row: &Value| {
        let pair = row.get("variables").and_then(Value::as_array);
        let found: Option<Vec<&str>> = pair.map(|pair| pair.iter().filter_map(Value::as_str).collect());
        found.is_some_and(|found| found == [&names[0], &names[1]] || found == [&names[1], &names[0]])
    };
    rows.retain(|row| !is_pair(row));
    let mut row = Table::new();
    row.insert("variables".to_owned(), Value::from(names.to_vec()));
    row.insert(key.to_owned(), value);
    rows.push(Value::Table(row));
}

#[cfg(test)]
#[path = "changed_scene_tests.rs"]
mod tests;
