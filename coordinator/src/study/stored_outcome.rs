//! Outcomes of a study as they are stored, and as a campaign receives them.

use super::observations::{Observed, ObservedOutcome};
use super::plan::ResponseLayout;
use common::scene::Scene;

/// Sample and simulated outputs of one point.
#[derive(Debug, Clone)]
pub struct SimulatedPoint {
    /// Values of the random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Simulated histories, per output of the scene.
    pub observed: Observed,
}

/// Outcome of one evaluation of a study.
#[derive(Debug, Clone)]
pub struct StoredOutcome {
    /// Values of the random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Simulated histories per output of the scene, or the failure.
    pub outcome: ObservedOutcome,
}

/// The simulations in the form that a campaign receives, `(N,)`.
pub fn completed(scene: &Scene, simulated: &[SimulatedPoint]) -> Vec<Observed> {
    let responses = ResponseLayout::from_scene(scene);
    simulated.iter().map(|point| responses.complete(point.observed.clone())).collect()
}
