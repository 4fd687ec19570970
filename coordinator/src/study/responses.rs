//! What the statistics see of an evaluation: its outputs, and those turned over whose fall below a threshold is a failure,
//! so that failing always means reaching a threshold from below.

use super::Observed;
use crate::statistics::learning::Mode;
use common::scene::{Fails, LimitState, Scene};

/// Which rows the statistics see, and which of them each limit state watches.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Responses {
    outputs: usize,
    /// Outputs that are turned over, in the order of the rows that hold them.
    turned: Vec<usize>,
    /// Limit states over the rows, in the scene's order.
    pub(super) modes: Vec<Mode>,
}

impl Responses {
    /// By the limit states of a scene. A scene none of whose outputs may fall too low has the outputs alone.
    pub(super) fn of(scene: &Scene) -> Self {
        let outputs = scene.outputs.len();
        let mut turned: Vec<usize> = Vec::new();
        let mut mode = |limit: &LimitState| match limit.fails {
            Fails::Above => Mode { output: limit.output, threshold: limit.threshold },
            Fails::Below => {
                let place = turned.iter().position(|output| *output == limit.output);
                let place = place.unwrap_or_else(|| {
                    turned.push(limit.output);
                    turned.len() - 1
                });
                Mode { output: outputs + place, threshold: -limit.threshold }
            }
        };
        let modes = scene.limit_states.iter().map(&mut mode).collect();
        Self { outputs, turned, modes }
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.outputs + self.turned.len()
    }

    /// Adds the rows that are turned over.
    pub(super) fn complete(&self, mut observed: Observed) -> Observed {
        for output in &self.turned {
            let turned = observed.histories[*output].iter().map(|value| -value).collect();
            observed.histories.push(turned);
            let errors = observed.errors[*output].clone();
            observed.errors.push(errors);
        }
        observed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn what_may_fall_too_low_is_turned_over_once() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\n\
            outputs = [{ name = \"a\" }, { name = \"b\" }]\n\
            limit_states = [{ name = \"1\", output = \"b\", threshold = 2, fails = \"below\" },\n\
            { name = \"2\", output = \"b\", threshold = 9 }, { name = \"3\", output = \"b\", threshold = -1, fails = \"below\" }]\n\
            variables = [{ name = \"x\", mean = 0, std = 1 }]";
        let source = SceneSource::parse(text, "s").unwrap();
        let responses = Responses::of(source.nominal());
        let modes: Vec<_> = responses.modes.iter().map(|mode| (mode.output, mode.threshold)).collect();
        assert_eq!(modes, [(2, -2.0), (1, 9.0), (2, 1.0)]);
        assert_eq!(responses.count(), 3);
        let observed = Observed { histories: vec![vec![1.0], vec![3.0]], errors: vec![vec![0.0], vec![0.5]] };
        let complete = responses.complete(observed);
        assert_eq!(complete.histories, [[1.0], [3.0], [-3.0]]);
        assert_eq!(complete.errors, [[0.0], [0.5], [0.5]]);
        let mut above = source.nominal().clone();
        above.limit_states.retain(|limit| limit.fails == Fails::Above);
        assert_eq!(Responses::of(&above).count(), 2);
    }
}
