//! The designs of a study: its scene and the ranges of the design variables.

use crate::analyses::scene_settings::{rows, scene_with, variable_row};
use crate::analyses::setting::is_scene_quantity;
use common::scene::{Fault, Faults, Scene, SceneSource, number_and_unit};
use serde::{Deserialize, Serialize};
use toml::Value;

/// Name of the document of a campaign file with the [`StoredSpace`].
pub const DESIGNS_DOCUMENT: &str = "designs";

/// Most design variables of a study.
const MOST: usize = 3;

/// A scene and its design variables.
#[derive(Debug, Clone)]
pub struct DesignSpace {
    pub(super) base: SceneSource,
    /// The design variables.
    pub variables: Vec<DesignVariable>,
}

/// A design space as stored with its study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredSpace {
    /// Text of the scene without design variables.
    pub scene: String,
    /// The design variables.
    pub variables: Vec<DesignVariable>,
}

impl DesignSpace {
    /// The designs of a scene, `ranges` as typed: `KEY=LOWER..UPPER`.
    ///
    /// # Errors
    /// Ranges that cannot be read, unknown keys, and designs at the ends of the ranges whose scene is not valid.
    pub fn new(base: SceneSource, ranges: &[String]) -> Result<Self, Faults> {
        let mut faults = Vec::new();
        let mut read =
            |range: &String| DesignVariable::parse(range).map_err(|Faults(found)| faults.extend(found)).ok();
        let variables = ranges.iter().filter_map(&mut read).collect();
        if faults.is_empty() { Self::of_variables(base, variables) } else { Err(Faults(faults)) }
    }

    /// The designs of a stored space; `origin` names its study in messages.
    ///
    /// # Errors
    /// As [`DesignSpace::new`], of a study by another version.
    pub fn from_stored(stored: StoredSpace, origin: &str) -> Result<Self, Faults> {
        Self::of_variables(SceneSource::parse(&stored.scene, origin)?, stored.variables)
    }

    fn of_variables(base: SceneSource, mut variables: Vec<DesignVariable>) -> Result<Self, Faults> {
        if variables.len() > MOST {
            let message = format!("{} design variables; at most {MOST} are allowed", variables.len());
            return Err(Faults::one("--design", "", message));
        }
        let keys: Vec<&str> = variables.iter().map(|variable| variable.key.as_str()).collect();
        if let Some(i) = (0..keys.len()).find(|i| keys[..*i].contains(&keys[*i])) {
            return Err(Faults::one("--design", keys[i], "this key has two ranges"));
        }
        let mut names: Vec<String> = base.variables().iter().map(|variable| variable.name.clone()).collect();
        for variable in variables.iter_mut().filter(|variable| is_scene_quantity(&base, &variable.key)) {
            let last = variable.key.rsplit('.').next().unwrap_or(&variable.key);
            let taken = names.iter().any(|name| name == last);
            names.push(if taken { variable.key.replace('.', "_") } else { last.to_owned() });
            variable.added = names.last().cloned();
        }
        let space = Self { base, variables };
        // A key that is wrong is wrong at every corner.
        let fault = space.corners().iter().find_map(|values| space.source_at(values).err());
        fault.map_or(Ok(space), |Faults(found)| {
            let of_design = |fault: Fault| Fault::new("--design", fault.key, fault.kind);
            Err(Faults(found.into_iter().map(of_design).collect()))
        })
    }

    /// What is stored with the study.
    pub fn stored(&self) -> StoredSpace {
        StoredSpace { scene: self.base.text().to_owned(), variables: self.variables.clone() }
    }

    /// The scene of the design with these values `(q,)`, each in the unit of its variable, with the variables of the scene
    /// alone.
    ///
    /// # Errors
    /// The faults of the design.
    pub fn source_at(&self, values: &[f64]) -> Result<SceneSource, Faults> {
        let settings = self.variables.iter().zip(values);
        let settings = settings.map(|(variable, value)| variable.setting(*value)).collect::<Vec<_>>();
        scene_with(&self.base, &settings)
    }

    /// The same design with the random variables of the augmented scene: the added ones are constant.
    ///
    /// # Errors
    /// The faults of the design.
    pub fn with_constants(&self, values: &[f64]) -> Result<SceneSource, Faults> {
        let design = self.source_at(values)?;
        let constant = |(variable, value): (&DesignVariable, &f64)| {
            variable.row(&[("distribution", Value::from("constant")), ("mean", variable.written(*value))])
        };
        if self.variables.iter().all(|variable| variable.added.is_none()) {
            return Ok(design);
        }
        let constants = self.variables.iter().zip(values).filter_map(constant);
        design.edited("--design", |document| rows(document, "variables").extend(constants))
    }

    /// The scene of [`DesignSpace::with_constants`].
    ///
    /// # Errors
    /// The faults of the design.
    pub fn scene_at(&self, values: &[f64]) -> Result<Scene, Faults> {
        Ok(self.with_constants(values)?.nominal().clone())
    }

    /// The values of a design in words, e.g. `parameters.clearance = 18 um`.
    pub fn in_words(&self, values: &[f64]) -> String {
        let word = |(v, value): (&DesignVariable, &f64)| format!("{} = {}", v.key, v.with_unit(*value));
        self.variables.iter().zip(values).map(word).collect::<Vec<_>>().join(", ")
    }

    /// The values of one design `(q,)`, given as `KEY=VALUE` for every design variable in any order.
    ///
    /// # Errors
    /// Keys that are no design variables, missing ones, and values outside their ranges.
    pub fn design(&self, settings: &[String]) -> Result<Vec<f64>, Faults> {
        let refuse = |text: &str, message: String| Faults::one("--set", text, message);
        let keys = || self.variables.iter().map(|v| v.key.as_str()).collect::<Vec<_>>().join(", ");
        let mut values = vec![None; self.variables.len()];
        for setting in settings {
            let (key, value) = setting.split_once('=').unwrap_or((setting, ""));
            let Some(i) = self.variables.iter().position(|variable| variable.key == key.trim()) else {
                return Err(refuse(setting, format!("the design variables of this study are {}", keys())));
            };
            let variable @ DesignVariable { lower, upper, unit, .. } = &self.variables[i];
            let is_allowed = |(value, of): &(f64, &str)| of == unit && (*lower..=*upper).contains(value);
            let value = number_and_unit(value.trim()).filter(is_allowed).map(|(value, _)| value);
            let range = [*lower, *upper].map(|end| variable.with_unit(end)).join(" to ");
            values[i] = Some(value.ok_or_else(|| refuse(setting, format!("allowed: {range}")))?);
        }
        let missing = || refuse("", format!("a design has a value for each of {}", keys()));
        values.into_iter().collect::<Option<_>>().ok_or_else(missing)
    }

    /// Ends of the ranges in all combinations `(2^q)(q,)`.
    pub fn corners(&self) -> Vec<Vec<f64>> {
        self.grid(2)
    }

    /// The middle of all ranges `(q,)`.
    pub fn middle(&self) -> Vec<f64> {
        self.variables.iter().map(|variable| variable.at(0.5)).collect()
    }

    /// A grid of `points` >= 2 values per variable with both ends `(points^q)(q,)`, the first variable varying slowest.
    pub fn grid(&self, points: usize) -> Vec<Vec<f64>> {
        self.variables.iter().fold(vec![vec![]], |grid, variable| {
            let values = (0..points).map(|i| variable.at(i as f64 / (points - 1) as f64));
            let longer = |row: &Vec<f64>| values.clone().map(|value| [&row[..], &[value]].concat()).collect();
            grid.iter().flat_map::<Vec<_>, _>(longer).collect()
        })
    }
}

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
    /// Name of the random variable that represents it in the augmented scene; `None` if it changes a distribution or a threshold.
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

    /// The row of the random variable that represents it, with the keys of its distribution; `None` if none does.
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
