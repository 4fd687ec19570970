//! The simulator that a scene names: what is wrong with it, and who evaluates samples by it.

use super::Evaluator;
use super::program::{ProgramSlot, Setup};
use super::slots::SlotEvaluator;
use super::umbridge::{ModelSlot, Server};
use common::scene::{ExternalSimulator, Scene, SimulatorKind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use thiserror::Error;

/// What keeps a simulator from being used. What it reports of a single sample is a failed simulation instead.
#[derive(Debug, Error)]
pub enum SimulatorError {
    /// The program cannot be started.
    #[error("simulator.program: \"{program}\" cannot be started in {folder}: {reason}")]
    Start {
        /// The program with its arguments.
        program: String,
        /// Where it should run.
        folder: String,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The program ends without an answer, at the means of the inputs too.
    #[error(
        "simulator.program: \"{program}\" ended with {status} instead of answering{}",
        after_colon(stderr)
    )]
    Dead {
        /// The program with its arguments.
        program: String,
        /// How it ended.
        status: String,
        /// The last lines of its standard error.
        stderr: String,
    },
    /// An answer that is none.
    #[error("simulator: the answer of {who} to evaluation {id} is not one: {fault}")]
    Protocol {
        /// The program, or address and model.
        who: String,
        /// Number of the evaluation.
        id: u64,
        /// What is wrong.
        fault: String,
    },
    /// The server cannot be reached, or does not answer as a UM-Bridge server does.
    #[error("simulator.umbridge: {url}: {reason}")]
    Server {
        /// Its address with the path asked for.
        url: String,
        /// Why.
        reason: String,
    },
    /// The server speaks another version of the protocol.
    #[error("simulator.umbridge: {url} speaks version {found} of the protocol, expected {expected}")]
    Version {
        /// Its address.
        url: String,
        /// Its version.
        found: f64,
        /// Ours.
        expected: f64,
    },
    /// The server has no such model.
    #[error("simulator.model: {url} has no model \"{model}\"; it has: {}", known.join(", "))]
    NoModel {
        /// Its address.
        url: String,
        /// The model asked for.
        model: String,
        /// The models it has.
        known: Vec<String>,
    },
    /// The model offers derivatives at most.
    #[error("simulator.model: model \"{model}\" of {url} does not offer evaluations")]
    NoEvaluation {
        /// Address of the server.
        url: String,
        /// The model.
        model: String,
    },
    /// The model takes other inputs than the scene has.
    #[error("simulator.model: model \"{model}\" takes {} input values {sizes:?}, the scene has {variables} variables", sizes.iter().sum::<usize>())]
    Inputs {
        /// The model.
        model: String,
        /// Lengths of its input vectors.
        sizes: Vec<usize>,
        /// Random variables of the scene.
        variables: usize,
    },
    /// The model returns other outputs than the scene declares.
    #[error("simulator.model: model \"{model}\" returns {} output values {sizes:?}, the outputs of the scene have {} {lengths:?}", sizes.iter().sum::<usize>(), lengths.iter().sum::<usize>())]
    Outputs {
        /// The model.
        model: String,
        /// Lengths of its output vectors.
        sizes: Vec<usize>,
        /// Numbers of values of the scene's outputs.
        lengths: Vec<usize>,
    },
}

fn after_colon(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!(": {text}") }
}

/// Makes the simulator of a scene ready on so many slots: programs are started when they are needed, but that they can be
/// is seen here; a server is asked whether its model fits.
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
            let server = Arc::new(Server::open(model, simulator.timeout, scene)?);
            let all = (0..slots).map(|k| ModelSlot::new(Arc::clone(&server), k)).collect();
            Ok(Box::new(SlotEvaluator::<ModelSlot>::new(all, interrupted)))
        }
    }
}
