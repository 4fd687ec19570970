//! The simulator this program offers to a coordinator.

use crate::service::Simulator;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use std::sync::Arc;

/// The simulator of the `worker` command and of local workers.
pub fn simulator() -> Arc<dyn Simulator> {
    Arc::new(Mechanism)
}

struct Mechanism;

impl Simulator for Mechanism {
    fn simulate(
        &self,
        _scene: &str,
        _sample: &[f64],
        _accuracy: &Accuracy,
        _with_first_cycle: bool,
    ) -> Result<Evaluation, SimulationFailure> {
        Err(SimulationFailure::NotModelled { what: "mechanisms".into() })
    }
}
