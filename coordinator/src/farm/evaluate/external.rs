//! Opens the external simulator named by a scene: a program or an UM-Bridge model server.

use super::Evaluator;
use super::program::{ProgramSlot, Setup, check_program_file};
pub use super::simulator_error::SimulatorError;
use super::slots::SlotEvaluator;
use super::umbridge::{ModelSlot, UmBridgeClient};
use common::scene::{ExternalSimulator, Scene, SimulatorKind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Checks what can be known of a simulator without using it: that its program exists and can be executed.
///
/// # Errors
/// [`SimulatorError::Start`].
pub fn check(simulator: &ExternalSimulator) -> Result<(), SimulatorError> {
    match &simulator.kind {
        SimulatorKind::Program(program) => check_program_file(program),
        SimulatorKind::UmBridge(_) => Ok(()),
    }
}

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
    match &simulator.kind {
        SimulatorKind::Program(program) => {
            let setup = Arc::new(Setup::new(program, simulator.timeout, scene));
            let mut all: Vec<ProgramSlot> =
                (0..slots).map(|k| ProgramSlot::new(Arc::clone(&setup), k)).collect();
            if let Some(first) = all.first_mut() {
                first.start()?;
            }
            Ok(Box::new(SlotEvaluator::new(all, interrupted)))
        }
        SimulatorKind::UmBridge(model) => {
            let server = Arc::new(UmBridgeClient::open(model, simulator.timeout, scene)?);
            let all = (0..slots).map(|k| ModelSlot::new(Arc::clone(&server), k)).collect();
            Ok(Box::new(SlotEvaluator::<ModelSlot>::new(all, interrupted)))
        }
    }
}
