//! The simulator this program offers to a coordinator.

use crate::service::Simulator;
use crate::simulate::simulate;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Faults, SceneSource};
use std::sync::{Arc, Mutex, PoisonError};

/// The simulator of the `worker` command and of local workers.
pub fn simulator() -> Arc<dyn Simulator> {
    Arc::new(Mechanism::default())
}

/// Remembers the last scene it read: a scene is checked at every bound of its variables when it is read, which
/// takes some 10 ms, and a campaign has one scene.
#[derive(Default)]
struct Mechanism {
    last: Mutex<Option<Arc<SceneSource>>>,
}

impl Mechanism {
    fn source(&self, text: &str) -> Result<Arc<SceneSource>, Faults> {
        // What a panic elsewhere left behind is a whole scene or none.
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(source) = last.as_ref().filter(|source| source.text() == text) {
            return Ok(Arc::clone(source));
        }
        let source = Arc::new(SceneSource::parse(text, "scene of the campaign")?);
        *last = Some(Arc::clone(&source));
        Ok(source)
    }
}

impl Simulator for Mechanism {
    fn simulate(
        &self,
        scene: &str,
        sample: &[f64],
        accuracy: &Accuracy,
        with_first_cycle: bool,
    ) -> Result<Evaluation, SimulationFailure> {
        let invalid = |faults: Faults| SimulationFailure::InvalidSample { faults: faults.to_string() };
        let source = self.source(scene).map_err(invalid)?;
        let scene = source.resolve_sample(sample).map_err(invalid)?;
        simulate(&scene, accuracy, with_first_cycle)
    }
}
