//! Evaluates requests by the external simulator that a scene names, on slots of this process.

use super::Evaluator;
use super::slots::SlotEvaluator;
use common::external::{OpenedSimulator, SimulatorError, Slot};
use common::scene::{ExternalSimulator, Scene};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Opens the simulator of a scene on `slots` slots. The first program is started here, so that a program that cannot
/// start is reported at once; the model of a server is checked against the scene.
///
/// # Errors
/// [`SimulatorError`].
pub fn open(
    simulator: &ExternalSimulator,
    scene: &Scene,
    slots: usize,
    interrupted: Arc<AtomicBool>,
) -> Result<Box<dyn Evaluator>, SimulatorError> {
    let opened = OpenedSimulator::open(simulator, scene)?;
    let mut all: Vec<Box<dyn Slot>> = (0..slots).map(|number| opened.slot(number)).collect();
    if let Some(first) = all.first_mut() {
        first.start()?;
    }
    Ok(Box::new(SlotEvaluator::new(all, interrupted)))
}
