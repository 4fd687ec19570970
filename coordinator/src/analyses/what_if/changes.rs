//! What was changed, as data: distributions, correlations and thresholds before and after, in SI units.

use crate::analyses::scene_settings::correlation_of;
use common::random::{Distribution, RandomVariable};
use common::scene::{LimitState, Scene};
use serde::Serialize;

/// The changes of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Changes {
    /// Changed random variables.
    pub variables: Vec<ChangedVariable>,
    /// Limit states with another threshold.
    pub thresholds: Vec<ChangedThreshold>,
    /// Pairs of variables with another correlation.
    pub correlations: Vec<ChangedCorrelation>,
}

/// A random variable before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedVariable {
    /// Name of the variable.
    pub name: String,
    /// Unit in which a person reads it; the values here are in SI.
    pub unit: String,
    /// Its distribution in the study.
    pub before: LawParameters,
    /// Its changed distribution.
    pub after: LawParameters,
}

/// A distribution with its parameters [SI].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawParameters {
    /// Name of the distribution, as in a scene file.
    pub distribution: String,
    /// Mean, of the parent for a truncated normal.
    pub mean: f64,
    /// Standard deviation, of the parent for a truncated normal.
    pub std: f64,
    /// Lower bound; absent if there is none.
    pub lower: Option<f64>,
    /// Upper bound; absent if there is none.
    pub upper: Option<f64>,
}

impl LawParameters {
    fn of(distribution: &Distribution) -> Self {
        let (lower, upper) = distribution.support();
        let [lower, upper] = [lower, upper].map(|bound| bound.is_finite().then_some(bound));
        let (mean, std) = (distribution.parent_mean(), distribution.given_std());
        Self { distribution: distribution.name().to_owned(), mean, std, lower, upper }
    }
}

/// A threshold before and after [SI unit of its output].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedThreshold {
    /// Name of the limit state.
    pub limit_state: String,
    /// Its key in a scene: `threshold`, or `lower` or `upper` of two.
    pub key: String,
    /// Its threshold in the study.
    pub before: f64,
    /// Its changed threshold.
    pub after: f64,
}

/// A correlation of the standard normals of two variables before and after [1].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedCorrelation {
    /// Names of the variables.
    pub variables: [String; 2],
    /// Coefficient in the study, 0 without one.
    pub before: f64,
    /// Coefficient in the changed scene, 0 without one.
    pub after: f64,
}

/// The thresholds of a limit state that differ in two scenes.
fn changed_thresholds(studied: &LimitState, changed: &LimitState) -> Vec<ChangedThreshold> {
    let keys: &[&str] = if studied.middle().is_some() { &["lower", "upper"] } else { &["threshold"] };
    let pairs = studied.thresholds().into_iter().zip(changed.thresholds());
    let of_key = |(key, (before, after)): (&&str, (f64, f64))| {
        let (limit_state, key) = (studied.name.clone(), (*key).to_owned());
        (before.to_bits() != after.to_bits()).then_some(ChangedThreshold { limit_state, key, before, after })
    };
    keys.iter().zip(pairs).filter_map(of_key).collect()
}

impl Changes {
    /// The differences of two scenes of the same variables and limit states.
    pub fn between(studied: &Scene, changed: &Scene) -> Self {
        let pairs = studied.variables.iter().zip(&changed.variables);
        let variable = |(before, after): (&RandomVariable, &RandomVariable)| ChangedVariable {
            name: before.name.clone(),
            unit: before.unit.clone(),
            before: LawParameters::of(&before.distribution),
            after: LawParameters::of(&after.distribution),
        };
        let states = studied.limit_states.iter().zip(&changed.limit_states);
        let d = studied.variables.len();
        let all = (0..d).flat_map(|i| (i + 1..d).map(move |k| (i, k)));
        let correlation = |(i, k): (usize, usize)| ChangedCorrelation {
            variables: [i, k].map(|k| studied.variables[k].name.clone()),
            before: correlation_of(studied, i, k),
            after: correlation_of(changed, i, k),
        };
        Self {
            variables: pairs.filter(|(a, b)| a.distribution != b.distribution).map(variable).collect(),
            thresholds: states.flat_map(|(a, b)| changed_thresholds(a, b)).collect(),
            correlations: all.map(correlation).filter(|c| c.before.to_bits() != c.after.to_bits()).collect(),
        }
    }

    /// True without any change.
    pub fn is_empty(&self) -> bool {
        self.variables.is_empty() && self.thresholds.is_empty() && self.correlations.is_empty()
    }
}
