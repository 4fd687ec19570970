//! Values set by name: `name=quantity`, where the name is a random variable or the path of a key.

use super::context::read_quantity;
use super::expression::read_unit;
use super::faults::{Fault, FaultKind, Faults, nearest};
use super::quantity::{Dimension, Kind, Quantity};
use super::source::SceneSource;

impl SceneSource {
    /// Kind of the values of a random variable, or of the quantity at the path of a key; `None` if the scene has neither.
    pub fn kind_of(&self, name: &str) -> Option<Kind> {
        let variable = self.variable(name).map(|k| &self.variables()[k]);
        let key = variable.map_or(Some(name), |variable| variable.changes.first().map(String::as_str));
        match (variable, key) {
            // An input of a simulator has the dimension of its unit, if that is a known one.
            (Some(input), None) => {
                let dimension = read_unit(&input.unit).map_or(Dimension::NONE, |unit| unit.dimension);
                Some(Kind::from_dimension(dimension))
            }
            (_, key) => self.quantities.get(key?).map(Quantity::kind),
        }
    }

    /// Reads `name=quantity`, e.g. `rod_length=40.05mm`, as name and SI value; the unit must be of the kind of the value
    /// that the name stands for.
    ///
    /// # Errors
    /// An unknown name, no quantity, or one of another kind.
    pub fn parse_setting(&self, setting: &str) -> Result<(String, f64), Faults> {
        let Some((name, value)) = setting.split_once('=') else {
            return Err(Faults::one("--set", setting, "expected variable=value, e.g. rod_length=40.05mm"));
        };
        let name = name.trim();
        let kind = self.kind_of(name).ok_or_else(|| self.unknown_setting(name));
        let read = kind.and_then(|kind| read_quantity(value.trim(), kind));
        let value = read.map_err(|kind| Faults::one("--set", setting, kind))?;
        Ok((name.to_owned(), value))
    }

    /// Reads several settings, each of another name.
    ///
    /// # Errors
    /// All faults.
    pub fn parse_settings(&self, settings: &[String]) -> Result<Vec<(String, f64)>, Faults> {
        let (mut read, mut faults) = (Vec::<(String, f64)>::new(), Vec::new());
        for setting in settings {
            match self.parse_setting(setting) {
                Ok((name, _)) if read.iter().any(|(known, _)| *known == name) => {
                    faults.push(Fault::new("--set", setting, format!("{name} is set twice")));
                }
                Ok(setting) => read.push(setting),
                Err(Faults(found)) => faults.extend(found),
            }
        }
        if faults.is_empty() { Ok(read) } else { Err(Faults(faults)) }
    }

    /// The fault of a name that is no random variable and no path of a quantity.
    pub fn unknown_setting(&self, name: &str) -> FaultKind {
        let (first, rest) = name.split_once('.').unwrap_or((name, ""));
        let written =
            self.document.get(first).and_then(|top| rest.split('.').try_fold(top, |v, key| v.get(key)));
        if written.is_some_and(|value| !value.is_table() && !value.is_array()) {
            let message = "this key is no random variable and no quantity, and only those can be set; write a scene that \
                           `extends` this one and changes it";
            return message.into();
        }
        let variables = self.variables().iter().map(|variable| variable.name.as_str());
        let keys = self.quantities.keys().map(String::as_str);
        let nearest = nearest(name, variables.clone().chain(keys.clone()));
        let is_path = name.contains('.') && keys.clone().next().is_some();
        let (what, known): (_, Vec<&str>) =
            if is_path { ("quantity", keys.collect()) } else { ("variable", variables.collect()) };
        FaultKind::unknown_near(what, name, &nearest, &known)
    }
}
