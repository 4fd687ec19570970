//! The designs of a study: its scene and the ranges of the design variables.

use super::variable::DesignVariable;
use crate::analyses::scene_settings::{rows, scene_with};
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
    pub(super) variables: Vec<DesignVariable>,
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
        let read = ranges.iter().map(|range| DesignVariable::parse(range));
        let mut faults = Vec::new();
        let mut variables = Vec::new();
        for variable in read {
            match variable {
                Ok(variable) => variables.push(variable),
                Err(Faults(found)) => faults.extend(found),
            }
        }
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
        let twice =
            variables.iter().enumerate().find(|(i, v)| variables[..*i].iter().any(|w| w.key == v.key));
        if let Some((_, twice)) = twice {
            return Err(Faults::one("--design", &twice.key, "this key has two ranges"));
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

    /// The design variables `(q,)`.
    pub fn variables(&self) -> &[DesignVariable] {
        &self.variables
    }

    /// The scene of the design with these values `(q,)`, each in the unit of its variable, with the variables of the scene
    /// alone.
    ///
    /// # Errors
    /// The faults of the design.
    pub fn source_at(&self, values: &[f64]) -> Result<SceneSource, Faults> {
        let settings: Vec<String> =
            self.variables.iter().zip(values).map(|(variable, value)| variable.setting(*value)).collect();
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
        let constants: Vec<Value> = self.variables.iter().zip(values).filter_map(constant).collect();
        if constants.is_empty() {
            return Ok(design);
        }
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
        let words = self.variables.iter().zip(values);
        let words: Vec<String> =
            words.map(|(v, value)| format!("{} = {}", v.key, v.with_unit(*value))).collect();
        words.join(", ")
    }

    /// The values of one design `(q,)`, given as `KEY=VALUE` for every design variable in any order.
    ///
    /// # Errors
    /// Keys that are no design variables, missing ones, and values outside their ranges.
    pub fn design(&self, settings: &[String]) -> Result<Vec<f64>, Faults> {
        let refuse = |text: &str, message: String| Faults::one("--at", text, message);
        let keys = || self.variables.iter().map(|v| v.key.as_str()).collect::<Vec<_>>().join(", ");
        let mut values = vec![None; self.variables.len()];
        for setting in settings {
            let (key, value) =
                setting.split_once('=').map_or((setting.trim(), ""), |(k, v)| (k.trim(), v.trim()));
            let Some(i) = self.variables.iter().position(|variable| variable.key == key) else {
                return Err(refuse(setting, format!("the design variables of this study are {}", keys())));
            };
            let variable = &self.variables[i];
            let value = number_and_unit(value)
                .filter(|(_, unit)| *unit == variable.unit)
                .map(|(value, _)| value)
                .filter(|value| (variable.lower..=variable.upper).contains(value));
            let allowed = format!(
                "allowed: {} to {}",
                variable.with_unit(variable.lower),
                variable.with_unit(variable.upper)
            );
            values[i] = Some(value.ok_or_else(|| refuse(setting, allowed))?);
        }
        let all: Option<Vec<f64>> = values.into_iter().collect();
        all.ok_or_else(|| refuse("", format!("a design has a value for each of {}", keys())))
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
        let mut grid = vec![vec![]];
        for variable in &self.variables {
            let values = (0..points).map(|i| variable.at(i as f64 / (points - 1) as f64));
            let values: Vec<f64> = values.collect();
            let longer = |row: &Vec<f64>| {
                values.iter().map(|value| [row.as_slice(), &[*value]].concat()).collect::<Vec<_>>()
            };
            grid = grid.iter().flat_map(longer).collect();
        }
        grid
    }
}
