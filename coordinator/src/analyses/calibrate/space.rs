//! The space of a calibration: the free parameters and the random variables of a scene.
//!
//! A parameter that changes keys of the scene becomes an additional variable of the scene that the workers receive, so that
//! a sample defines the simulation completely. A parameter that scales the means or the spread of random variables
//! transforms the samples:
//!
//! `x_k = f_mean mean_k + f_spread std_k z_k`
//!
//! with `x_k` the variable [SI], `z_k` the standardised variable [1], and the factors `f_mean`, `f_spread` [1]; mean and
//! standard deviation are those at the values of the parameters, since a variable that states no mean follows the keys
//! that it changes. Lognormal and Weibull variables, whose shape depends on both, are those of the new mean and standard
//! deviation at the same probability, and so remain positive.

use crate::analyses::scene_settings::{rows, variable_row, written_value};
use crate::statistics::design::InputModel;
use common::random::Distribution;
use common::scene::{Faults, Scene, SceneSource};

/// Effect of a free parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum ParameterKind {
    /// Keys of the scene: the parameter is their value.
    Keys(Vec<String>),
    /// Means of random variables: the parameter is a factor on them.
    Mean(Vec<usize>),
    /// Standard deviations of random variables: the parameter is a factor on them.
    Spread(Vec<usize>),
}

/// A parameter to be fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Name in the report.
    pub name: String,
    /// Effect on the scene or on the samples.
    pub kind: ParameterKind,
    /// Lower bound [SI, or a factor].
    pub lower: f64,
    /// Upper bound [SI, or a factor].
    pub upper: f64,
    /// SI unit; empty for a factor.
    pub unit: String,
}

impl FreeParameter {
    /// The keys of the scene of which it is the value; none of a factor.
    fn keys(&self) -> &[String] {
        if let ParameterKind::Keys(keys) = &self.kind { keys } else { &[] }
    }
}

/// Free parameters and random variables.
#[derive(Debug, Clone)]
pub struct Space {
    /// The scene with one more variable for each parameter that changes keys, after its own.
    pub source: SceneSource,
    /// The scene's own variables.
    pub inputs: InputModel,
    /// The scene as its author wrote it.
    own: SceneSource,
    /// Free parameters, bounds in SI.
    pub free: Vec<FreeParameter>,
}

impl Space {
    /// The space of a scene and its free parameters.
    ///
    /// # Errors
    /// [`Faults`] if a free parameter is no valid variable of the scene.
    pub fn new(source: &SceneSource, free: &[FreeParameter]) -> Result<Self, Faults> {
        let (inputs, own) = (InputModel::from_scene(source.nominal()), source.clone());
        Ok(Self { inputs, own, source: with_parameters(source, free)?, free: free.to_vec() })
    }

    /// The nominal scene.
    pub fn scene(&self) -> &Scene {
        self.source.nominal()
    }

    /// Number of random variables and free parameters, d + p.
    pub fn dimension(&self) -> usize {
        self.inputs.dimension() + self.free.len()
    }

    /// The random variables at these parameters `(p,)`.
    pub fn placed<'s>(&'s self, parameters: &'s [f64]) -> PlacedSpace<'s> {
        let keyed = self.free.iter().zip(parameters);
        let keyed = keyed.flat_map(|(free, value)| free.keys().iter().map(|key| (key.clone(), *value)));
        // With values that give no valid scene nothing follows, and the simulations fail.
        let variables = self.own.variables_with(&keyed.collect::<Vec<_>>());
        let laws = variables.map(|all| all.into_iter().map(|variable| variable.distribution).collect());
        let copula = self.inputs.copula.clone();
        let inputs = laws.map_or_else(|_| self.inputs.clone(), |laws| InputModel::new(laws, copula));
        PlacedSpace { space: self, parameters, inputs }
    }

    /// Parameters `(p,)` of the places between their bounds `(p,)` [1].
    pub fn parameters(&self, places: &[f64]) -> Vec<f64> {
        let value = |(free, place): (&FreeParameter, &f64)| free.lower + (free.upper - free.lower) * place;
        self.free.iter().zip(places).map(value).collect()
    }

    /// Start of the fit `(p,)`: factors of one, keys in the middle of their bounds.
    pub fn middle(&self) -> Vec<f64> {
        let middle = |free: &FreeParameter| match free.keys() {
            [] => 1.0_f64.clamp(free.lower, free.upper),
            _ => 0.5 * (free.lower + free.upper),
        };
        self.free.iter().map(middle).collect()
    }
}

/// The random variables of a [`Space`] at values of its parameters.
#[derive(Debug)]
pub struct PlacedSpace<'s> {
    space: &'s Space,
    parameters: &'s [f64],
    /// The scene's own variables, without factors.
    inputs: InputModel,
}

impl PlacedSpace<'_> {
    /// The sample for the scene [`Space::source`] `(d + keyed,)` [SI], of the standardised variables z `(d,)`.
    pub fn sample(&self, z: &[f64]) -> Vec<f64> {
        let (mut mean_by, mut spread_by) = (vec![1.0; z.len()], vec![1.0; z.len()]);
        let mut keyed = Vec::new();
        for (free, value) in self.space.free.iter().zip(self.parameters) {
            match &free.kind {
                ParameterKind::Keys(_) => keyed.push(*value),
                ParameterKind::Mean(variables) => variables.iter().for_each(|k| mean_by[*k] *= value),
                ParameterKind::Spread(variables) => variables.iter().for_each(|k| spread_by[*k] *= value),
            }
        }
        let written = self.space.inputs.variables();
        let value = |(k, z): (usize, &f64)| {
            transformed(&written[k], &self.inputs.variables()[k], *z, mean_by[k], spread_by[k])
        };
        z.iter().enumerate().map(value).chain(keyed).collect()
    }

    /// Coordinates of a sample for surrogates `(d + keyed,)` [1]: deviations from the means at these parameters in standard
    /// deviations, and parameters from -1 to 1 over their bounds.
    pub fn features(&self, sample: &[f64]) -> Vec<f64> {
        let d = self.inputs.dimension();
        let keyed = self.space.free.iter().filter(|free| !free.keys().is_empty()).zip(&sample[d..]);
        let keyed = keyed.map(|(free, x)| (2.0 * x - free.lower - free.upper) / (free.upper - free.lower));
        self.inputs.standardise(&sample[..d]).into_iter().chain(keyed).collect()
    }
}

/// Value [SI] of a variable of standardised value z [1], with the distribution `law` at values of the parameters in the place of
/// that written, and factors on its mean and standard deviation [1].
fn transformed(written: &Distribution, law: &Distribution, z: f64, mean_by: f64, spread_by: f64) -> f64 {
    let (mean, std) = (mean_by * law.parent_mean(), spread_by * law.parent_std());
    let same = [mean_by, spread_by] == [1.0, 1.0] && written == law;
    let changed = match law {
        Distribution::Lognormal(_) if !same => Distribution::lognormal(mean, std),
        Distribution::Weibull(_) if !same => Distribution::weibull(mean, std),
        _ => return mean + std * z,
    };
    let normal = written.to_standard_normal(written.parent_mean() + written.parent_std() * z);
    changed.map_or(mean + std * z, |law| law.from_standard_normal(normal))
}

/// The scene with a uniform variable for each parameter that changes keys.
fn with_parameters(source: &SceneSource, free: &[FreeParameter]) -> Result<SceneSource, Faults> {
    let keyed = free.iter().filter(|free| !free.keys().is_empty());
    source.edited(source.origin(), |document| {
        for free in keyed {
            let [lower, upper] = [free.lower, free.upper].map(|bound| written_value(bound, &free.unit));
            let law = [("distribution", "uniform".into()), ("lower", lower), ("upper", upper)];
            rows(document, "variables").push(variable_row(&free.name, free.keys(), &law).into());
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_means_follow_a_free_parameter() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let free = FreeParameter {
            name: "play".into(),
            kind: ParameterKind::Keys(vec!["parameters.clearance".into()]),
            lower: 20e-6,
            upper: 40e-6,
            unit: "m".into(),
        };
        let space = Space::new(&source, &[free]).unwrap();
        let names: Vec<&str> = source.variables().iter().map(|variable| variable.name.as_str()).collect();
        let crank = names.iter().position(|name| *name == "clearance_crank").unwrap();
        for clearance in [20e-6, 30e-6, 40e-6] {
            let parameters = [clearance];
            let placed = space.placed(&parameters);
            let nominal = placed.sample(&vec![0.0; names.len()]);
            assert_eq!([nominal[crank], nominal[names.len()]], [clearance; 2]);
            // The crank's standard deviation is given in um and stays.
            let above = placed.sample(&vec![1.0; names.len()]);
            assert!((above[crank] - nominal[crank] - 2e-6).abs() < 1e-7, "{above:?}");
            let features = placed.features(&above);
            assert!((features[crank] - 1.0).abs() < 0.05, "{features:?}");
            assert!((features[names.len()] - (clearance - 30e-6) / 10e-6).abs() < 1e-9, "{features:?}");
        }
    }

    #[test]
    fn issue_factors_keep_a_lognormal_and_a_weibull_variable_what_they_are() {
        for law in [Distribution::lognormal(2.0, 1.0).unwrap(), Distribution::weibull(2.0, 1.0).unwrap()] {
            let n = 20_000_u32;
            let probability = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
            let z = |i: u32| (law.quantile(probability(i)) - 2.0) / 1.0;
            let x: Vec<f64> = (0..n).map(|i| transformed(&law, &law, z(i), 0.5, 1.5)).collect();
            assert!(x.iter().all(|x| *x > 0.0), "a shift would make a third of them negative");
            let mean = x.iter().sum::<f64>() / f64::from(n);
            let std = (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n)).sqrt();
            assert!((mean - 1.0).abs() < 5e-3 && (std - 1.5).abs() < 3e-2, "{mean} {std}");
            assert_eq!(transformed(&law, &law, 0.7, 1.0, 1.0), 2.7);
        }
        let normal = Distribution::normal(2.0, 1.0).unwrap();
        assert_eq!(transformed(&normal, &normal, -2.0, 0.5, 1.0), -1.0);
    }
}
