//! The responses of an evaluation: its outputs, and the negatives of those outputs that fail below a
//! threshold, so that failure always means that a response reaches its threshold from below.

use super::Observed;
use crate::statistics::learning::Mode;
use common::scene::{Fails, LimitState, Scene};

/// The responses of a scene, and the limit states over them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ResponseLayout {
    /// Number of outputs.
    outputs: usize,
    /// Outputs whose negatives follow the outputs, in this order.
    negated: Vec<usize>,
    /// Limit states over the responses, in the order of the scene.
    pub(super) modes: Vec<Mode>,
}

impl ResponseLayout {
    /// The layout for the limit states of a scene. Without limit states that fail below, the responses are
    /// the outputs.
    pub(super) fn from_scene(scene: &Scene) -> Self {
        let outputs = scene.outputs.len();
        let mut negated: Vec<usize> = Vec::new();
        let mut mode = |limit: &LimitState| match limit.fails {
            Fails::Above => Mode { output: limit.output, threshold: limit.threshold },
            Fails::Below => {
                let place = negated.iter().position(|output| *output == limit.output);
                let place = place.unwrap_or_else(|| {
                    negated.push(limit.output);
                    negated.len() - 1
                });
                Mode { output: outputs + place, threshold: -limit.threshold }
            }
        };
        let modes = scene.limit_states.iter().map(&mut mode).collect();
        Self { outputs, negated, modes }
    }

    /// Number of responses.
    pub(super) fn count(&self) -> usize {
        self.outputs + self.negated.len()
    }

    /// Appends the negated outputs to the result of an evaluation.
    pub(super) fn complete(&self, mut observed: Observed) -> Observed {
        for output in &self.negated {
            let negated = observed.histories[*output].iter().map(|value| -value).collect();
            observed.histories.push(negated);
            let errors = observed.errors[*output].clone();
            observed.errors.push(errors);
            observed.start.push(observed.start[*output].map(|value| -value));
        }
        observed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn an_output_that_fails_below_is_negated_once() {
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
            start: vec![None, Some(2.0)],
        };
        let complete = responses.complete(observed);
        assert_eq!(complete.histories, [[1.0], [3.0], [-3.0]]);
        assert_eq!(complete.errors, [[0.0], [0.5], [0.5]]);
        assert_eq!(complete.start, [None, Some(2.0), Some(-2.0)]);
        let mut above = source.nominal().clone();
        above.limit_states.retain(|limit| limit.fails == Fails::Above);
        assert_eq!(ResponseLayout::from_scene(&above).count(), 2);
    }
}
