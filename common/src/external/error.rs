//! Errors of external simulators: programs that do not start or reply, servers whose model does not fit the scene.

use crate::failure::last_words;
use thiserror::Error;

/// Reasons why a simulator cannot be used. A failure it reports for a single sample is a failed simulation instead.
#[derive(Debug, Error)]
pub enum SimulatorError {
    /// The program cannot be started.
    #[error("simulator.{key}: \"{program}\" cannot be started in {folder}: {reason}")]
    Start {
        /// The key of the scene that states it.
        key: &'static str,
        /// The program with its arguments, or the FMU.
        program: String,
        /// Working folder of the program.
        folder: String,
        /// Error of the operating system.
        reason: std::io::Error,
    },
    /// The program exits without a reply, also at the means of the inputs.
    #[error("simulator.{key}: \"{program}\" ended with {status} instead of answering{}", last_words(stderr))]
    Dead {
        /// The key of the scene that states it.
        key: &'static str,
        /// The program with its arguments, or the FMU.
        program: String,
        /// Exit status of the program.
        status: String,
        /// The last lines of its standard error.
        stderr: String,
    },
    /// A reply breaks the protocol.
    #[error("simulator: invalid reply of {simulator} to evaluation {id}: {fault}")]
    Protocol {
        /// The program, or address and model.
        simulator: String,
        /// Number of the evaluation.
        id: u64,
        /// What is wrong with the reply.
        fault: String,
    },
    /// The journal of a life cannot be read or written.
    #[error("simulator.journal: {folder}: {reason}")]
    Journal {
        /// Folder of the journals.
        folder: String,
        /// Error of the operating system.
        reason: std::io::Error,
    },
    /// The server cannot be reached, or its reply is no UM-Bridge reply.
    #[error("simulator.umbridge: {url}: {reason}")]
    Server {
        /// Address with the requested path.
        url: String,
        /// Error of the connection, or the unexpected reply.
        reason: String,
    },
    /// The server uses another version of the protocol.
    #[error("simulator.umbridge: {url} uses version {found} of the protocol, expected {expected}")]
    Version {
        /// Address of the server.
        url: String,
        /// Version of the server.
        found: f64,
        /// Protocol version supported by this program.
        expected: f64,
    },
    /// The server has no such model.
    #[error("simulator.model: {url} has no model \"{model}\"; it has: {}", known.join(", "))]
    NoModel {
        /// Address of the server.
        url: String,
        /// Name of the model in the scene.
        model: String,
        /// Names of the server's models.
        known: Vec<String>,
    },
    /// The model does not support evaluation.
    #[error("simulator.model: model \"{model}\" of {url} does not offer evaluations")]
    NoEvaluation {
        /// Address of the server.
        url: String,
        /// Name of the model.
        model: String,
    },
    /// The number of input values differs from the number of random variables.
    #[error("simulator.model: model \"{model}\" takes {} input values {sizes:?}, the scene has {variables} variables", sizes.iter().sum::<usize>())]
    Inputs {
        /// Name of the model.
        model: String,
        /// Lengths of its input vectors.
        sizes: Vec<usize>,
        /// Random variables of the scene.
        variables: usize,
    },
    /// The vectors of a model that gives cycles are not those of the scene.
    #[error("simulator.model: model \"{model}\" has vectors of {sizes:?} values, expected {expected}")]
    Vectors {
        /// Name of the model.
        model: String,
        /// Lengths of its input or output vectors.
        sizes: Vec<usize>,
        /// The vectors of the scene, in words.
        expected: String,
    },
    /// The number of output values differs from the outputs declared by the scene.
    #[error("simulator.model: model \"{model}\" returns {} output values {sizes:?}, the outputs of the scene have {} {lengths:?}", sizes.iter().sum::<usize>(), lengths.iter().sum::<usize>())]
    Outputs {
        /// Name of the model.
        model: String,
        /// Lengths of its output vectors.
        sizes: Vec<usize>,
        /// Numbers of values of the scene's outputs.
        lengths: Vec<usize>,
    },
}
