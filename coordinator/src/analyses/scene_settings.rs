//! A scene with values set by key before a study: quantities of the scene (`parameters.clearance=25 um`), means of random variables
//! (`friction=0.06`), and distributions, thresholds and correlations as in a what-if (`friction.std=5 %`). The values are written
//! into the text of the scene, which is then read and checked like any scene file and stored with the study.

use super::what_if::{redistributed, setting_fault};
use common::scene::{Fault, Faults, SceneSource};
use toml::{Table, Value};

/// The scene with these settings, each `KEY=VALUE` as typed.
///
/// # Errors
/// The faults of all settings, or those of the scene that they give.
pub fn scene_with(source: &SceneSource, settings: &[String]) -> Result<SceneSource, Faults> {
    let mut faults: Vec<Fault> = Vec::new();
    let mut quantities: Vec<(&str, &str)> = Vec::new();
    let mut others: Vec<String> = Vec::new();
    for setting in settings {
        let (key, value) =
            setting.split_once('=').map_or((setting.trim(), ""), |(k, v)| (k.trim(), v.trim()));
        let variables = source.variables();
        if variables.iter().any(|variable| variable.name == key) {
            others.push(format!("{key}.mean={value}"));
            continue;
        }
        // Thresholds and parameters of distributions have forms of their own.
        if !is_scene_quantity(source, key) && !is_within_scene(key) {
            others.push(setting.clone());
            continue;
        }
        if let Err(Faults(found)) = source.parse_setting(setting) {
            faults.extend(found);
        } else if quantities.iter().any(|(known, _)| *known == key) {
            faults.push(setting_fault(setting, "this is set twice"));
        } else if let Some(variable) =
            variables.iter().find(|variable| variable.changes.iter().any(|change| change == key))
        {
            let message = format!(
                "the random variable \"{name}\" changes this key in every simulation; set {name} or {name}.mean instead",
                name = variable.name
            );
            faults.push(setting_fault(setting, message));
        } else {
            quantities.push((key, value));
        }
    }
    // The faults of the other settings are found together with these.
    let others_alone = redistributed(source, &others);
    if let Err(Faults(found)) = &others_alone {
        faults.extend(found.iter().cloned());
    }
    if !faults.is_empty() {
        return Err(Faults(faults));
    }
    if quantities.is_empty() {
        return others_alone;
    }
    let changed = source.edited("--set", |document| {
        for (key, value) in quantities {
            let parts: Vec<&str> = key.split('.').collect();
            let written = value.parse::<f64>().map_or_else(|_| Value::String(value.to_owned()), Value::Float);
            if insert(document, &parts, written).is_none() {
                let setting = format!("{key}={value}");
                faults.push(setting_fault(
                    &setting,
                    "this key cannot be set; write a scene that `extends` this one",
                ));
            }
        }
    });
    if !faults.is_empty() {
        return Err(Faults(faults));
    }
    redistributed(&changed?, &others)
}

/// Whether a key is a quantity of the scene itself: no random variable, distribution, threshold or correlation.
pub fn is_scene_quantity(source: &SceneSource, key: &str) -> bool {
    let is_variable = source.variables().iter().any(|variable| variable.name == key);
    !is_variable && is_quantity(source, key) && !is_distribution(key)
}

/// Whether a key is a quantity of the scene, whatever value is given to it.
fn is_quantity(source: &SceneSource, key: &str) -> bool {
    use common::scene::FaultKind::UnknownReference;
    let unknown = |fault: &Fault| matches!(fault.kind, UnknownReference { .. });
    !source.parse_setting(&format!("{key}=1")).is_err_and(|Faults(faults)| faults.iter().any(unknown))
}

/// Whether a key can only be that of a quantity of the scene, so that an unknown one is answered with the nearest quantity.
fn is_within_scene(key: &str) -> bool {
    ["parameters.", "bodies.", "joints.", "loads.", "materials."].iter().any(|start| key.starts_with(start))
}

/// Whether a key belongs to a random variable, a limit state or a correlation.
fn is_distribution(key: &str) -> bool {
    ["variables.", "limit_states.", "correlations"].iter().any(|start| key.starts_with(start))
}

/// Writes a value at the path of a key: keys of tables, names of rows, and numbers or coordinates of entries. `None` if the
/// path leads nowhere.
fn insert(table: &mut Table, path: &[&str], value: Value) -> Option<()> {
    let (first, rest) = path.split_first()?;
    // What a file gave is another value then.
    table.remove("source");
    if rest.is_empty() {
        table.insert((*first).to_owned(), value);
        return Some(());
    }
    insert_below(table.get_mut(*first)?, rest, value)
}

fn insert_below(below: &mut Value, path: &[&str], value: Value) -> Option<()> {
    match below {
        Value::Table(table) => insert(table, path, value),
        Value::Array(rows) => {
            let (first, rest) = path.split_first()?;
            let has_name = |row: &Value| row.get("name").and_then(Value::as_str) == Some(first);
            let place = rows.iter().position(has_name).or_else(|| match *first {
                "x" => Some(0),
                "y" => Some(1),
                number => number.parse::<usize>().ok()?.checked_sub(1),
            })?;
            let row = rows.get_mut(place)?;
            if rest.is_empty() {
                *row = value;
                return Some(());
            }
            insert_below(row, rest, value)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::quantity::{AngleUnit, Quantity};

    fn set(settings: &[&str]) -> Result<SceneSource, Faults> {
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        scene_with(&SceneSource::builtin("four-bar").unwrap(), &settings)
    }

    /// A value as a scene writes it, in SI base units.
    fn written(quantity: &Quantity, value: f64) -> String {
        let unit = quantity.dimension.base_units();
        match (quantity.angle, unit.as_str()) {
            (AngleUnit::Present, "") => format!("{value:e} rad"),
            (AngleUnit::Present, unit) if unit.starts_with("1/") => format!("{value:e} rad{}", &unit[1..]),
            _ => format!("{value:e} {unit}").trim_end().to_owned(),
        }
    }

    #[test]
    fn issue_set_of_every_key_of_every_scene_is_the_edited_scene() {
        let (mut compared, mut refused) = (0, 0);
        for name in SceneSource::builtin_names() {
            let source = SceneSource::builtin(name).unwrap();
            for (key, quantity) in source.quantities() {
                let changed = |change: &String| change == key;
                if source.variables().iter().any(|variable| variable.changes.iter().any(changed)) {
                    continue; // Refused: its random variable is to be set.
                }
                let setting = format!("{key}={}", written(quantity, quantity.value * 1.001));
                let Ok(edited) = scene_with(&source, std::slice::from_ref(&setting)) else {
                    refused += 1;
                    continue;
                };
                let set = source.resolve_with(&[source.parse_setting(&setting).unwrap()]).unwrap();
                assert_eq!(set, *edited.nominal(), "{name}: {setting}");
                compared += 1;
            }
        }
        assert!(compared > 400 && refused < compared / 10, "{compared} compared, {refused} refused");
    }

    #[test]
    fn issue_a_set_scene_lost_its_comments() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let found = set(&["parameters.width=11 mm", "friction.std=4 %", "wear.threshold=9 um"]).unwrap();
        let differ = found.text().lines().zip(source.text().lines()).filter(|(a, b)| a != b);
        assert_eq!(differ.count(), 3, "{}", found.text());
        assert_eq!(set(&["parameters.width=10 mm"]).unwrap().digest(), source.digest());
    }

    #[test]
    fn variables_and_thresholds_are_set_by_their_names() {
        let found =
            set(&["friction=0.06", "wear.threshold=9 um", "load_torque.std=5 %", "parameters.width=11 mm"])
                .unwrap();
        let scene = found.nominal();
        let law = |name: &str| scene.variables.iter().find(|v| v.name == name).unwrap().distribution.clone();
        assert!((law("friction").parent_mean() - 0.06).abs() < 1e-12);
        assert!((law("load_torque").given_std() - 0.04).abs() < 1e-12);
        assert!((scene.limit_states[0].threshold - 9e-6).abs() < 1e-15);
    }

    #[test]
    fn every_fault_of_every_setting_is_reported() {
        let said = set(&[
            "parameters.friction=0.06",
            "parameters.width=3 kg",
            "nothing=1",
            "wear.threshhold=2",
            "friction=x",
            "parameters.clearence=25 um",
        ])
        .unwrap_err()
        .to_string();
        for part in [
            "did you mean \"parameters.clearance\"",
            "set friction or friction.mean instead",
            "parameters.width=3 kg",
            "nothing=1",
            "wear.threshhold=2",
        ] {
            assert!(said.contains(part), "{part}\n{said}");
        }
        assert!(set(&["friction=x"]).is_err() && set(&["parameters.width=-3 mm"]).is_err());
    }
}
