//! Scenes in which nothing wears: one cycle stands for the whole life.

use super::observe::FirstSeen;
use super::run::Run;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;

/// Time steps of the second run of the cycle are finer by this factor: of a fourth-order scheme's error, the two runs
/// differ by fifteen sixteenths.
const FINER: f64 = 2.0;
/// The difference over the error it stands for.
const SAFETY: f64 = 2.0;
/// Relative error of any value: rounding of some million steps.
const ROUNDING: f64 = 1e-10;

impl Run<'_> {
    /// The result, with the error of the cycle just measured from a second run of it at finer time steps.
    ///
    /// # Errors
    /// As of any cycle.
    pub async fn unchanging(&mut self, first: FirstSeen) -> Result<Evaluation, SimulationFailure> {
        let values = self.motion_outputs();
        let finer = self.accuracy.refined(FINER);
        self.begin_again(&finer);
        self.measure().await?;
        let again = self.motion_outputs();
        let cycles = self.scene.life.checkpoints();
        let error = |value: f64, again: f64| (SAFETY * (value - again).abs()).max(ROUNDING * value.abs());
        let errors = values.iter().zip(again).map(|(&v, a)| vec![error(v, a); cycles.len()]).collect();
        let histories = values.iter().map(|&v| vec![v; cycles.len()]).collect();
        self.finish(cycles, histories, errors, first)
    }
}
