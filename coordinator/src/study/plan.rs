//! What a campaign is to learn, and how.

use crate::statistics::design::InputModel;
use crate::statistics::learning::{LearningFunction, Mode, Targets};
use crate::statistics::surrogate::{FormSettings, StatedErrors};

/// What is to be learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The d random variables and how they depend on each other.
    pub inputs: InputModel,
    /// Number of outputs of an evaluation.
    pub outputs: usize,
    /// Limit states.
    pub modes: Vec<Mode>,
    /// Checkpoints of life [cycles] `(m,)`; a static problem has one.
    pub checkpoints: Vec<u32>,
}

/// How it is to be learned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Monte Carlo population to begin with.
    pub population: usize,
    /// Size to which the population may grow for the coefficient of variation.
    pub largest_population: usize,
    /// Initial design, the nominal point included.
    pub initial: usize,
    /// Points under way at once after the initial design; half of them are proposed together, see [`Plan::chunk`].
    pub batch: usize,
    /// Budget of evaluations, failed ones included.
    pub max_evaluations: usize,
    /// Seed of every draw.
    pub seed: u64,
    /// Which points are the most wanted.
    pub learning: LearningFunction,
    /// Stopping rules.
    pub targets: Targets,
    /// What is left open of the surrogates' form.
    pub forms: FormSettings,
    /// What the surrogates make of the numerical errors that simulations state.
    pub stated_errors: StatedErrors,
    /// Whether a failed simulation is repeated once at a stricter setting.
    pub retry: bool,
    /// Share of failed simulations above which the campaign ends [1].
    pub failed_share: f64,
}

impl Plan {
    /// Points proposed together: half a batch, so that one half is simulated while the other is learned from.
    ///
    /// That is the look-ahead: chunk k + 2 is proposed from the outcomes up to chunk k and the points, not the
    /// outcomes, of chunk k + 1. It is fixed by the plan, so the points do not depend on who is quick.
    pub fn chunk(&self) -> usize {
        self.batch.div_ceil(2)
    }
}
