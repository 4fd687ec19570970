//! The scene as its author wrote it, as far as a resolved scene does not have it: parameters, formulas, and the names of points and
//! materials.

use super::format::joined;
use common::scene::expression::{ExpressionError, evaluate};
use common::scene::quantity::Quantity;
use common::scene::{SceneSource, Units};
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Tables in which no formula depends on a random variable: their values are read once.
const READ_ONCE: [&str; 5] = ["scene", "parameters", "variables", "correlations", "study"];

/// Texts of a scene by their keys; empty for a scene that cannot be read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WrittenScene {
    /// Parameters with their values or formulas, in the order of the scene.
    pub parameters: Vec<(String, String)>,
    /// Keys of quantities that depend on parameters, with their formulas.
    pub formulas: Vec<(String, String)>,
    /// What operating conditions change, by the path of the key: `conditions.NAME.changes.KEY`.
    pub changes: Vec<(String, String)>,
    /// Units in which quantities are shown.
    pub units: Units,
    /// Names by the path of their key: points, materials, files that values are from.
    names: BTreeMap<String, String>,
    /// Values of the quantities that are written [SI].
    quantities: BTreeMap<String, f64>,
}

impl WrittenScene {
    /// Reads the text of a scene that stands alone.
    pub fn new(text: &str) -> Self {
        let Ok(source) = SceneSource::parse(text, "scene.toml") else { return Self::default() };
        let document = &source.document;
        let mut written = Self { units: source.nominal().units.clone(), ..Self::default() };
        let table = document.get("parameters").and_then(Value::as_table);
        let parameters: Vec<&String> = table.into_iter().flat_map(Table::keys).collect();
        written.parameters =
            table.into_iter().flatten().map(|(name, value)| (name.clone(), text_of(value))).collect();
        for row in document.get("variables").and_then(Value::as_array).into_iter().flatten() {
            let text = |value: Option<&Value>| value.and_then(Value::as_str).map(str::to_owned);
            let from = text(row.get("samples").and_then(|samples| samples.get("source")));
            if let Some((name, from)) = text(row.get("name")).zip(from) {
                written.names.insert(format!("variables.{name}.samples.source"), from);
            }
        }
        for (key, value) in document.iter().filter(|(key, _)| !READ_ONCE.contains(&key.as_str())) {
            written.walk(&source, &parameters, key, value);
        }
        written
    }

    fn walk(&mut self, source: &SceneSource, parameters: &[&String], path: &str, value: &Value) {
        match value {
            Value::Table(table) => {
                for (key, value) in table {
                    self.walk(source, parameters, &format!("{path}.{key}"), value);
                }
            }
            Value::Array(items) => {
                for (k, item) in items.iter().enumerate() {
                    let is_axis = |axis: &&str| source.quantity(&format!("{path}.{axis}")).is_some();
                    let axis = ["x", "y"].get(k).copied().filter(is_axis);
                    let name = item.get("name").and_then(Value::as_str).or(axis);
                    let last = name.map_or_else(|| (k + 1).to_string(), str::to_owned);
                    self.walk(source, parameters, &format!("{path}.{last}"), item);
                }
            }
            value => {
                if let Some(si) = source.quantity(path) {
                    self.quantities.insert(path.to_owned(), si);
                    let text = text_of(value);
                    if path.starts_with("conditions.") && path.contains(".changes.") {
                        self.changes.push((path.to_owned(), text.clone()));
                    }
                    if uses_one(&text, parameters) {
                        self.formulas.push((path.to_owned(), text));
                    }
                } else if let Some(name) = value.as_str() {
                    self.names.insert(path.to_owned(), name.to_owned());
                }
            }
        }
    }

    /// What the operating condition of this name changes, as it is written: `KEY = VALUE; ...`.
    pub fn changes_of(&self, condition: &str) -> String {
        let place = format!("conditions.{condition}.changes.");
        let changes = self.changes.iter().filter_map(|(key, text)| Some((key.strip_prefix(&place)?, text)));
        joined(changes.map(|(key, text)| format!("{key} = {text}")), "; ")
    }

    /// True if the quantity at this key depends on parameters.
    pub fn has_formula(&self, key: &str) -> bool {
        self.formulas.iter().any(|(formula, _)| formula == key)
    }

    /// The name at this key, such as that of a point or of a material.
    pub fn name(&self, key: &str) -> Option<&str> {
        self.names.get(key).map(String::as_str)
    }

    /// States another text at this key.
    pub fn rename(&mut self, key: &str, text: &str) {
        self.names.insert(key.to_owned(), text.to_owned());
    }

    /// The files that values were read from, as `NAME, SHA-256 HASH`, with the keys of these values.
    pub fn files(&self) -> Vec<(&str, Vec<&str>)> {
        let mut files = BTreeMap::<&str, Vec<&str>>::new();
        for (key, file) in &self.names {
            if let Some(key) = key.strip_suffix(".source") {
                files.entry(file).or_default().push(key);
            }
        }
        files.into_iter().collect()
    }

    /// The value at this key, where the scene writes one [SI].
    pub fn quantity(&self, key: &str) -> Option<f64> {
        self.quantities.get(key).copied()
    }
}

/// A value as text: a quantity, or a number.
fn text_of(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// True if an expression uses a parameter.
fn uses_one(text: &str, parameters: &[&String]) -> bool {
    let mut used = false;
    // The value does not matter: dimensions of a dummy may contradict each other once a parameter was found.
    let _ = evaluate(text, &mut |name| {
        used |= parameters.iter().any(|parameter| *parameter == name);
        Err::<Quantity, _>(ExpressionError::UnknownName { name: name.to_owned(), nearest: None })
    });
    used
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_names_and_values_are_found_by_their_keys() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let written = WrittenScene::new(source.text());
        assert!(written.parameters.contains(&("clearance".into(), "30 um".into())));
        let formula = |key: &str| {
            written.formulas.iter().find(|(found, _)| found == key).map(|(_, text)| text.as_str())
        };
        assert_eq!(formula("bodies.coupler.inertia"), Some("coupler_mass * coupler_length^2 / 12"));
        assert_eq!(formula("bodies.frame.points.rocker_pin.x"), Some("ground_length"));
        // `type = "clearance"` is the word of a joint, not the parameter of this name.
        assert_eq!((formula("joints.crank.type"), formula("joints.crank.width")), (None, Some("width")));
        assert_eq!(written.name("joints.crank.journal.point"), Some("pin"));
        assert_eq!(written.name("joints.crank.bushing_material"), Some("bronze"));
        assert!((written.quantity("joints.crank.radial_clearance").unwrap() - 30e-6).abs() < 1e-18);
        assert!(written.quantity("joints.crank.bushing_radius").is_none());
        assert_eq!(WrittenScene::new("no scene"), WrittenScene::default());
    }

    #[test]
    fn entries_of_lists_count_from_one() {
        let everything = include_str!("../../../../common/tests/scenes/everything.toml");
        let written = WrittenScene::new(everything);
        assert_eq!(written.quantity("loads.push.size.value.2"), Some(5.0));
        assert!(written.has_formula("bodies.slider.start_position.x"));
        assert!(!written.has_formula("bodies.slider.start_position.y"));
    }
}
