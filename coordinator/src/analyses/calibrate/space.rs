//! The space that is searched: free parameters beside the random variables of a scene.
//!
//! A parameter that changes keys of the scene becomes one more variable of the scene that workers are given, so that a sample
//! says everything. One that moves the means or the spread of random variables needs nothing of the workers: it moves
//! the samples, x_k = f_mean mean_k + f_spread std_k z_k with z_k the standardised variable.

use super::CalibrationError;
use crate::statistics::design::InputModel;
use common::scene::{Fault, FaultKind, Faults, Scene, SceneSource};
use toml::{Table, Value};

/// What a free parameter moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Moves {
    /// Keys of the scene: the parameter is their value.
    Keys(Vec<String>),
    /// Means of random variables: the parameter is a factor on them.
    Mean(Vec<usize>),
    /// Standard deviations, likewise.
    Spread(Vec<usize>),
}

/// A parameter that may move.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Name.
    pub name: String,
    /// What it moves.
    pub moves: Moves,
    /// Least value [SI, or a factor].
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
    /// SI unit; empty of a factor.
    pub unit: String,
    /// Bounds as written.
    pub bounds: [String; 2],
}

/// Free parameters and random variables.
#[derive(Debug, Clone)]
pub struct Space {
    /// The scene with one more variable for each parameter that changes keys, after its own.
    pub source: SceneSource,
    /// The scene's own variables.
    pub inputs: InputModel,
    /// Free parameters, bounds in SI.
    pub free: Vec<Free>,
}

impl Space {
    /// Of a scene and what is free in it.
    ///
    /// # Errors
    /// Faults of the free parameters as variables of the scene.
    pub fn new(source: &SceneSource, free: &[Free]) -> Result<Self, CalibrationError> {
        let scene = source.nominal();
        let own = scene.variables.len();
        let source = with_parameters(source, free)?;
        let mut free = free.to_vec();
        let added = source.nominal().variables[own..].to_vec();
        let keyed = free.iter_mut().filter(|free| matches!(free.moves, Moves::Keys(_)));
        for (free, variable) in keyed.zip(added) {
            (free.lower, free.upper) = variable.distribution.support();
            free.unit = variable.unit;
        }
        Ok(Self { inputs: InputModel::of(scene), source, free })
    }

    /// The nominal scene.
    pub fn scene(&self) -> &Scene {
        self.source.nominal()
    }

    /// Number of random variables and free parameters, d + p.
    pub fn dimension(&self) -> usize {
        self.inputs.dimension() + self.free.len()
    }

    /// The sample for the scene [`Space::source`] `(d + keyed,)` [SI], of the standardised variables z `(d,)` and the
    /// parameters `(p,)`.
    pub fn sample(&self, z: &[f64], parameters: &[f64]) -> Vec<f64> {
        let (mut mean_by, mut spread_by) = (vec![1.0; z.len()], vec![1.0; z.len()]);
        let mut keyed = Vec::new();
        for (free, value) in self.free.iter().zip(parameters) {
            match &free.moves {
                Moves::Keys(_) => keyed.push(*value),
                Moves::Mean(variables) => variables.iter().for_each(|k| mean_by[*k] *= value),
                Moves::Spread(variables) => variables.iter().for_each(|k| spread_by[*k] *= value),
            }
        }
        let variables = self.inputs.variables().iter().zip(z).enumerate();
        let x = variables
            .map(|(k, (law, z))| mean_by[k] * law.parent_mean() + spread_by[k] * law.parent_std() * z);
        x.chain(keyed).collect()
    }

    /// What surrogates see of a sample `(d + keyed,)` [1]: deviations from the scene's means in its standard deviations, and
    /// parameters from -1 to 1 over their bounds.
    pub fn features(&self, sample: &[f64]) -> Vec<f64> {
        let d = self.inputs.dimension();
        let mut features = self.inputs.standardise(&sample[..d]);
        let keyed = self.free.iter().filter(|free| matches!(free.moves, Moves::Keys(_)));
        features.extend(
            keyed
                .zip(&sample[d..])
                .map(|(free, x)| (2.0 * x - free.lower - free.upper) / (free.upper - free.lower)),
        );
        features
    }

    /// Parameters `(p,)` where the scene stands: factors of one, keys in the middle of their bounds.
    pub fn middle(&self) -> Vec<f64> {
        let middle = |free: &Free| match free.moves {
            Moves::Keys(_) => 0.5 * (free.lower + free.upper),
            Moves::Mean(_) | Moves::Spread(_) => 1.0_f64.clamp(free.lower, free.upper),
        };
        self.free.iter().map(middle).collect()
    }
}

/// The scene with a uniform variable for each parameter that changes keys.
fn with_parameters(source: &SceneSource, free: &[Free]) -> Result<SceneSource, CalibrationError> {
    let keyed = free.iter().filter_map(|free| match &free.moves {
        Moves::Keys(keys) => Some((free, keys)),
        Moves::Mean(_) | Moves::Spread(_) => None,
    });
    let syntax = |message: String| {
        Faults(vec![Fault {
            file: source.origin().to_owned(),
            key: String::new(),
            kind: FaultKind::Syntax { message },
        }])
    };
    let mut document: Table =
        source.text().parse().map_err(|error: toml::de::Error| syntax(error.to_string()))?;
    let variables = document.entry("variables").or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(rows) = variables {
        for (free, keys) in keyed {
            let mut row = Table::new();
            row.insert("name".into(), Value::String(free.name.clone()));
            row.insert("changes".into(), Value::Array(keys.iter().cloned().map(Value::String).collect()));
            row.insert("distribution".into(), Value::String("uniform".into()));
            for (key, bound) in ["lower", "upper"].into_iter().zip(&free.bounds) {
                // A number without a unit stays a number.
                let value = bound.parse().map_or_else(|_| Value::String(bound.clone()), Value::Float);
                row.insert(key.into(), value);
            }
            rows.push(Value::Table(row));
        }
    }
    let text = toml::to_string(&document).map_err(|error| syntax(error.to_string()))?;
    Ok(SceneSource::parse(&text, source.origin())?)
}
