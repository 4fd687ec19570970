//! Opens the external simulator named by a scene: a program or an UM-Bridge model server.

use super::cycle_slot::CycleSlot;
use super::program::{ProgramSlot, Setup, check_program_file};
use super::slot::{SimulatorError, Slot};
use super::umbridge::{ModelSlot, UmBridgeClient};
use crate::scene::{ExternalSimulator, Scene, SimulatorKind};
use std::sync::Arc;

/// Checks what can be known of a simulator without using it: that its program exists and can be executed, and its files
/// can be read.
///
/// # Errors
/// [`SimulatorError`].
pub fn check(simulator: &ExternalSimulator, scene: &Scene) -> Result<(), SimulatorError> {
    match &simulator.kind {
        SimulatorKind::Program(program) => check_program_file(program, scene),
        SimulatorKind::UmBridge(_) => Ok(()),
    }
}

/// The simulator of a scene, ready to give slots.
#[derive(Debug, Clone)]
pub enum OpenedSimulator {
    /// A program of this machine.
    Program(Arc<Setup>),
    /// A model of a server.
    Server(Arc<UmBridgeClient>),
}

impl OpenedSimulator {
    /// Opens the simulator of a scene. The model of a server is checked against the scene, the files of a program are
    /// checked; no program is started.
    ///
    /// # Errors
    /// [`SimulatorError`].
    pub fn open(simulator: &ExternalSimulator, scene: &Scene) -> Result<Self, SimulatorError> {
        Ok(match &simulator.kind {
            SimulatorKind::Program(program) => {
                check_program_file(program, scene)?;
                Self::Program(Arc::new(Setup::new(program, simulator.timeout, scene)))
            }
            SimulatorKind::UmBridge(model) => {
                Self::Server(Arc::new(UmBridgeClient::open(model, simulator.timeout, scene)?))
            }
        })
    }

    /// A slot for cycles with this number.
    pub fn cycle_slot(&self, number: usize) -> CycleSlot {
        match self {
            Self::Program(setup) => CycleSlot::Program(ProgramSlot::new(Arc::clone(setup), number)),
            Self::Server(client) => CycleSlot::Model(ModelSlot::new(Arc::clone(client), number)),
        }
    }

    /// A slot of the simulator with this number. Its program is started by [`Slot::start`] or by the first sample.
    pub fn slot(&self, number: usize) -> Box<dyn Slot> {
        match self {
            Self::Program(setup) => Box::new(ProgramSlot::new(Arc::clone(setup), number)),
            Self::Server(client) => Box::new(ModelSlot::new(Arc::clone(client), number)),
        }
    }
}
