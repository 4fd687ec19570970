//! What an active-learning campaign works on: the reliability problem of a scene, and the plan.
//!
//! The responses of an evaluation are its outputs, and what follows from them for limit states that fail below a threshold or
//! outside of two, so that failure always means that a response reaches its threshold from below: the negative of an output, or
//! its distance from the middle between two thresholds.

use super::observations::{Distance, Observed};
use super::{LARGEST_POPULATION, Method, Settings};
use crate::statistics::design::InputModel;
use crate::statistics::learning::{Mode, StoppingTargets};
use common::scene::{Fails, LimitState, Scene};

/// The reliability problem to be learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The d random variables and their dependence.
    pub inputs: InputModel,
    /// Number of outputs of an evaluation.
    pub outputs: usize,
    /// Limit states over the outputs.
    pub modes: Vec<Mode>,
    /// Checkpoints of life [cycles] `(m,)`; a static problem has one.
    pub checkpoints: Vec<u32>,
}

impl Problem {
    /// The reliability problem of a scene.
    pub fn from_scene(scene: &Scene) -> Self {
        let responses = ResponseLayout::from_scene(scene);
        Self {
            inputs: InputModel::from_scene(scene),
            outputs: responses.count(),
            modes: responses.modes,
            checkpoints: scene.life.checkpoints(),
        }
    }
}

/// Settings of a campaign, and what follows from them and the problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Settings of the study; `samples` is the size of the population at first.
    pub settings: Settings,
    /// Bounds of the stopping rules.
    pub targets: StoppingTargets,
    /// Size to which the population may grow until the coefficient of variation of P_f is small enough.
    pub largest_population: usize,
    /// Whether a failed evaluation is repeated once at a stricter accuracy.
    pub retry: bool,
    /// Whether two evaluations of a sample agree to the last bit: those of the built-in simulator do.
    pub is_exact: bool,
}

impl Plan {
    /// Plan of a study of `scene`.
    pub fn new(settings: &Settings, scene: &Scene) -> Self {
        Self {
            settings: settings.clone(),
            targets: settings.targets(),
            largest_population: LARGEST_POPULATION,
            retry: settings.stricter(scene).is_some(),
            is_exact: scene.simulator.is_none(),
        }
    }

    /// True for the published method, see [`super::as_published`].
    pub(super) fn is_as_published(&self) -> bool {
        self.settings.method == Method::AkMcs
    }
}

/// The responses of a scene, and the limit states over them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ResponseLayout {
    /// Number of outputs.
    outputs: usize,
    /// Limit states whose responses follow the outputs, in this order: the first of those with equal responses.
    derived: Vec<LimitState>,
    /// Limit states over the responses, in the order of the scene.
    pub(super) modes: Vec<Mode>,
}

impl ResponseLayout {
    /// The layout for the limit states of a scene. If all fail above their thresholds, the responses are the outputs.
    pub(super) fn from_scene(scene: &Scene) -> Self {
        let outputs = scene.outputs.len();
        let mut derived: Vec<LimitState> = Vec::new();
        let mut mode = |limit: &LimitState| {
            let threshold = limit.response_threshold();
            if limit.fails == Fails::Above {
                return Mode { output: limit.output, threshold };
            }
            let place = derived.iter().position(|other| have_equal_responses(other, limit));
            let place = place.unwrap_or_else(|| {
                derived.push(limit.clone());
                derived.len() - 1
            });
            Mode { output: outputs + place, threshold }
        };
        let modes = scene.limit_states.iter().map(&mut mode).collect();
        Self { outputs, derived, modes }
    }

    /// Number of responses.
    pub(super) fn count(&self) -> usize {
        self.outputs + self.derived.len()
    }

    /// Appends the derived responses to the result of an evaluation. The error stated for a value is that of its response: no
    /// response changes by more than its value.
    pub(super) fn complete(&self, mut observed: Observed) -> Observed {
        for limit in &self.derived {
            let output = limit.output;
            let history = observed.histories[output].iter().map(|value| limit.response(*value)).collect();
            observed.histories.push(history);
            let errors = observed.errors[output].clone();
            observed.errors.push(errors);
            if let Some(rough) = observed.rough.get(output).cloned() {
                observed.rough.push(rough);
            }
            observed.start.push(observed.start[output].map(|value| limit.response(value)));
            if let Some(middle) = limit.middle() {
                let response = observed.histories.len() - 1;
                observed.distances.push(Distance { response, output, middle });
            }
        }
        observed
    }
}

/// True if two limit states, neither of which fails above a single threshold, have the same response.
fn have_equal_responses(a: &LimitState, b: &LimitState) -> bool {
    let middle = |limit: &LimitState| limit.middle().map(f64::to_bits);
    a.output == b.output && middle(a) == middle(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn an_output_that_fails_below_is_negated_once_and_one_within_limits_is_a_distance() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\n\
            outputs = [{ name = \"a\" }, { name = \"b\" }]\n\
            limit_states = [{ name = \"1\", output = \"b\", threshold = 2, fails = \"below\" },\n\
            { name = \"2\", output = \"b\", threshold = 9 }, { name = \"3\", output = \"b\", threshold = -1, fails = \"below\" }]\n\
            variables = [{ name = \"x\", mean = 0, std = 1 }]";
        let source = SceneSource::parse(text, "s").unwrap();
        let responses = ResponseLayout::from_scene(source.nominal());
        let modes: Vec<_> = responses.modes.iter().map(|mode| (mode.output, mode.threshold)).collect();
        assert_eq!(modes, [(2, -2.0), (1, 9.0), (2, 1.0)]);
        assert_eq!(responses.count(), 3);
        let observed = Observed {
            histories: vec![vec![1.0], vec![3.0]],
            errors: vec![vec![0.0], vec![0.5]],
            rough: vec![],
            start: vec![None, Some(2.0)],
            distances: vec![],
            source: None,
        };
        let complete = responses.complete(observed.clone());
        assert_eq!(complete.histories, [[1.0], [3.0], [-3.0]]);
        assert_eq!(complete.errors, [[0.0], [0.5], [0.5]]);
        assert_eq!(complete.start, [None, Some(2.0), Some(-2.0)]);
        let mut outside = source.nominal().clone();
        for (limit, lower) in outside.limit_states.iter_mut().zip([-2.0, -1.0, -5.0]) {
            limit.fails = Fails::Outside { lower };
        }
        let responses = ResponseLayout::from_scene(&outside);
        let modes: Vec<_> = responses.modes.iter().map(|mode| (mode.output, mode.threshold)).collect();
        // The middles are 0, 4 and -3.
        assert_eq!(modes, [(2, 2.0), (3, 5.0), (4, 2.0)]);
        let complete = responses.complete(observed);
        assert_eq!(complete.histories, [[1.0], [3.0], [3.0], [1.0], [6.0]]);
        assert_eq!(complete.errors[2..], [[0.5], [0.5], [0.5]]);
        assert_eq!(complete.start[2..], [Some(2.0), Some(2.0), Some(5.0)]);
        let distances: Vec<_> = complete.distances.iter().map(|d| (d.response, d.output, d.middle)).collect();
        assert_eq!(distances, [(2, 1, 0.0), (3, 1, 4.0), (4, 1, -3.0)]);
        let mut above = source.nominal().clone();
        above.limit_states.retain(|limit| limit.fails == Fails::Above);
        assert_eq!(ResponseLayout::from_scene(&above).count(), 2);
    }
}
