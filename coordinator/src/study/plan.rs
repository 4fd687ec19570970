//! What an active-learning campaign works on.

use super::response_layout::ResponseLayout;
use super::{LARGEST_POPULATION, Settings};
use crate::statistics::design::InputModel;
use crate::statistics::learning::{Mode, StoppingTargets};
use common::scene::Scene;

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
}

impl Plan {
    /// Plan of a study of `scene`.
    pub fn new(settings: &Settings, scene: &Scene) -> Self {
        Self {
            settings: settings.clone(),
            targets: settings.targets(),
            largest_population: LARGEST_POPULATION,
            retry: settings.stricter(scene).is_some(),
        }
    }
}
