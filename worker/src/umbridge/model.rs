//! The evaluation of a scene as a model of the UM-Bridge protocol: one input vector, the random variables in the order of
//! the scene; one output vector per output, its values at the checkpoints. All in SI.

use crate::simulate::{SimulateOptions, simulate};
use common::accuracy::NamedAccuracy;
use common::failure::SimulationFailure;
use common::scene::{Faults, SceneSource};
use common::umbridge::{
    ErrorBody, EvaluateRequest, Evaluated, INVALID_INPUT, MODEL_NOT_FOUND, SIMULATION_FAILED,
};
use common::wire::find_non_finite;
use serde_json::{Map, Value};

/// Name of the model, as UM-Bridge models are named by convention.
pub const NAME: &str = "forward";

/// Configuration of a request, e.g. `{"accuracy": "draft"}`.
pub type Config = Map<String, Value>;

/// The evaluation of one scene as a UM-Bridge model.
#[derive(Debug, Clone)]
pub struct Model {
    source: SceneSource,
    accuracy: NamedAccuracy,
}

/// A request that passed its checks.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedRequest {
    sample: Vec<f64>,
    accuracy: NamedAccuracy,
}

impl Model {
    /// A model of a scene; `accuracy` applies unless a request names another one.
    pub fn new(source: SceneSource, accuracy: NamedAccuracy) -> Self {
        Self { source, accuracy }
    }

    /// Lengths of the input vectors.
    pub fn input_sizes(&self) -> Vec<usize> {
        vec![self.source.variables().len()]
    }

    /// Lengths of the output vectors.
    pub fn output_sizes(&self) -> Vec<usize> {
        let scene = self.source.nominal();
        vec![scene.life.checkpoints().len(); scene.outputs.len()]
    }

    /// Checks name and configuration of a request; returns the accuracy to use.
    ///
    /// # Errors
    /// The error to send to the client.
    pub fn configured(&self, name: &str, config: Option<&Config>) -> Result<NamedAccuracy, ErrorBody> {
        if name != NAME {
            let message = format!("unknown model \"{name}\"; available: {NAME}");
            return Err(ErrorBody { kind: MODEL_NOT_FOUND.into(), message });
        }
        let mut accuracy = self.accuracy.clone();
        for (key, value) in config.into_iter().flatten() {
            if key != "accuracy" {
                return Err(invalid(format!("config: unknown key \"{key}\"; allowed: accuracy")));
            }
            let text = value
                .as_str()
                .ok_or_else(|| invalid(format!("config: accuracy is {value}, expected a string")))?;
            accuracy =
                text.parse().map_err(|reason| invalid(format!("config: accuracy \"{text}\": {reason}")))?;
        }
        Ok(accuracy)
    }

    /// Checks an evaluation request.
    ///
    /// # Errors
    /// The error to send to the client.
    pub fn check(&self, request: EvaluateRequest<Config>) -> Result<CheckedRequest, ErrorBody> {
        let accuracy = self.configured(&request.name, request.config.as_ref())?;
        let sizes: Vec<usize> = request.input.iter().map(Vec::len).collect();
        if sizes != self.input_sizes() {
            let expected = self.input_sizes();
            return Err(invalid(format!("input has vectors of {sizes:?} values, expected {expected:?}")));
        }
        let sample = request.input.into_iter().flatten().collect();
        Ok(CheckedRequest { sample, accuracy })
    }

    /// Simulates the sample of a request.
    ///
    /// # Errors
    /// The error to send to the client.
    pub fn evaluate(&self, request: &CheckedRequest) -> Result<Evaluated<f64>, ErrorBody> {
        let body = |message: String| ErrorBody { kind: SIMULATION_FAILED.into(), message };
        let failed = |failure: SimulationFailure| body(failure.to_string());
        let invalid =
            |faults: Faults| failed(SimulationFailure::InvalidSample { faults: faults.to_string() });
        let scene = self.source.resolve_sample(&request.sample).map_err(invalid)?;
        let evaluation =
            simulate(&scene, &request.accuracy.accuracy, SimulateOptions::default()).map_err(failed)?;
        match find_non_finite(&evaluation) {
            Some((quantity, _)) => Err(body(format!("{quantity} is not finite"))),
            None => Ok(Evaluated { output: evaluation.histories }),
        }
    }
}

/// The error for an invalid request.
pub fn invalid(message: String) -> ErrorBody {
    ErrorBody { kind: INVALID_INPUT.into(), message }
}
