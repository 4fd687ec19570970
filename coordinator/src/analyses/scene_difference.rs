//! The keys in which scenes differ, with their values as the scenes write them.

use common::scene::SceneSource;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use toml::Value;

/// A key with different values.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DifferingKey {
    /// Path of the key; rows of a list stand by their names, e.g. `joints.crank.width`.
    pub key: String,
    /// Value in each scene; `None` where the scene has no such key.
    pub values: Vec<Option<String>>,
}

/// The keys whose values are not the same in all `scenes`, sorted. Values are compared as they are written: `20 um` and
/// `0.02 mm` differ.
pub fn differing_keys(scenes: &[&SceneSource]) -> Vec<DifferingKey> {
    let all: Vec<BTreeMap<String, String>> = scenes.iter().map(|scene| written_values(scene)).collect();
    let keys: BTreeSet<&String> = all.iter().flat_map(BTreeMap::keys).collect();
    let differing = |key: &String| {
        let values: Vec<_> = all.iter().map(|values| values.get(key).cloned()).collect();
        let differ = values.iter().any(|value| *value != values[0]);
        differ.then(|| DifferingKey { key: key.clone(), values })
    };
    keys.into_iter().filter_map(differing).collect()
}

/// All values of a scene by the paths of their keys.
fn written_values(scene: &SceneSource) -> BTreeMap<String, String> {
    let mut values = BTreeMap::new();
    collect(&Value::Table(scene.document.clone()), "", &mut values);
    values
}

fn collect(value: &Value, path: &str, values: &mut BTreeMap<String, String>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| collect(value, &below(key), values)),
        Value::Array(rows) if rows.iter().all(Value::is_table) && !rows.is_empty() => {
            for (number, row) in rows.iter().enumerate() {
                collect(row, &below(&row_name(row).unwrap_or_else(|| (number + 1).to_string())), values);
            }
        }
        Value::String(text) => drop(values.insert(path.to_owned(), text.clone())),
        other => drop(values.insert(path.to_owned(), other.to_string())),
    }
}

/// The name of a row of a list: its `name`, or for a correlation the names of its variables.
fn row_name(row: &Value) -> Option<String> {
    let name = row.get("name").and_then(Value::as_str).map(str::to_owned);
    name.or_else(|| {
        let names: Option<Vec<&str>> = row.get("variables")?.as_array()?.iter().map(Value::as_str).collect();
        names.map(|names| format!("({})", names.join(",")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyses::scene_settings::scene_with;

    #[test]
    fn the_keys_that_were_set_are_those_that_differ() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let settings =
            ["parameters.width=12 mm", "friction.std=10 %", "correlation(friction,load_torque)=0.5"]
                .map(str::to_owned);
        let changed = scene_with(&source, &settings).unwrap();
        let found = differing_keys(&[&source, &changed]);
        let expected = [
            ("correlations.(friction,load_torque).coefficient", None, Some("0.5")),
            ("correlations.(friction,load_torque).variables", None, Some("[\"friction\", \"load_torque\"]")),
            ("parameters.width", Some("10 mm"), Some("12 mm")),
            ("variables.friction.std", Some("5 %"), Some("10 %")),
        ];
        let found: Vec<(&str, Option<&str>, Option<&str>)> = found
            .iter()
            .map(|row| (row.key.as_str(), row.values[0].as_deref(), row.values[1].as_deref()))
            .collect();
        assert_eq!(found, expected);
        assert_eq!(differing_keys(&[&source, &source, &source]), []);
    }
}
