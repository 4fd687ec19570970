//! Simulated points, and their outcomes in the form that a campaign receives.

use common::scene::Scene;
use coordinator::study::{Observed, StoredOutcome, complete_outcomes};

/// Sample and simulated outputs of one point.
#[derive(Debug, Clone)]
pub struct SimulatedPoint {
    /// Values of the random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Simulated histories, per output of the scene.
    pub observed: Observed,
}

/// The simulations in the form that a campaign receives, `(N,)`.
pub fn completed(scene: &Scene, simulated: &[SimulatedPoint]) -> Vec<Observed> {
    let stored = |point: &SimulatedPoint| StoredOutcome {
        sample: point.sample.clone(),
        outcome: Ok(point.observed.clone()),
    };
    let stored: Vec<StoredOutcome> = simulated.iter().map(stored).collect();
    complete_outcomes(scene, &stored).into_iter().filter_map(|(_, outcome)| outcome.ok()).collect()
}
