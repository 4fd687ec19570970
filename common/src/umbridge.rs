//! What client and server of the UM-Bridge protocol, version 1.0, say to each other: JSON over HTTP. `GET /Info`, then
//! `POST` of `/ModelInfo`, `/InputSizes`, `/OutputSizes`, `/Evaluate`; an error is an answer with `error` in it. `C` is
//! whatever stands for a JSON object, with which a request configures the model.
//!
//! # Source
//! L. Seelinger et al., UM-Bridge: Uncertainty quantification and modeling bridge, Journal of Open Source Software 8
//! (2023) 4748; the protocol's own page, <https://um-bridge-benchmarks.readthedocs.io/en/docs/umbridge/protocol.html>.

use serde::{Deserialize, Serialize};

/// Version of the protocol.
pub const PROTOCOL_VERSION: f64 = 1.0;

/// Kind of error: the input does not fit the model.
pub const INVALID_INPUT: &str = "InvalidInput";
/// Kind of error: the model returned what does not fit its own sizes.
pub const INVALID_OUTPUT: &str = "InvalidOutput";
/// Kind of error: the server has no model of that name.
pub const MODEL_NOT_FOUND: &str = "ModelNotFound";
/// Kind of error: the model does not offer what is asked for.
pub const UNSUPPORTED_FEATURE: &str = "UnsupportedFeature";
/// Kind of error of our own server: the simulation has no result. The protocol names no kind for that.
pub const SIMULATION_FAILED: &str = "SimulationFailed";

/// Answer to `/Info`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Info {
    /// [`PROTOCOL_VERSION`].
    pub protocol_version: f64,
    /// Names of the models.
    pub models: Vec<String>,
}

/// Asks for `/ModelInfo`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelInfoRequest {
    /// Name of the model.
    pub name: String,
}

/// Answer to `/ModelInfo`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelInfo {
    /// What the model offers.
    pub support: Support,
}

/// What a model offers; what a server does not mention it does not offer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "PascalCase", default)]
pub struct Support {
    /// Evaluation.
    pub evaluate: bool,
    /// Gradient of an objective.
    pub gradient: bool,
    /// Jacobian times a vector.
    pub apply_jacobian: bool,
    /// Hessian of an objective times a vector.
    pub apply_hessian: bool,
}

/// Asks for `/InputSizes` or `/OutputSizes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SizesRequest<C> {
    /// Name of the model.
    pub name: String,
    /// Configuration.
    #[serde(default = "Option::default")]
    pub config: Option<C>,
}

/// Answer to `/InputSizes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InputSizes {
    /// Lengths of the input vectors.
    pub input_sizes: Vec<usize>,
}

/// Answer to `/OutputSizes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct OutputSizes {
    /// Lengths of the output vectors.
    pub output_sizes: Vec<usize>,
}

/// Asks for `/Evaluate`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvaluateRequest<C> {
    /// Name of the model.
    pub name: String,
    /// Input vectors, of the lengths of [`InputSizes`].
    pub input: Vec<Vec<f64>>,
    /// Configuration.
    #[serde(default = "Option::default")]
    pub config: Option<C>,
}

/// Answer to `/Evaluate`. `V` is a number, or what stands for one that is not finite.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluated<V> {
    /// Output vectors, of the lengths of [`OutputSizes`].
    pub output: Vec<Vec<V>>,
}

/// An answer instead of the one asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorReply {
    /// What is wrong.
    pub error: ErrorBody,
}

/// What is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorBody {
    /// Kind of error, e.g. [`INVALID_INPUT`].
    #[serde(rename = "type")]
    pub kind: String,
    /// In words.
    pub message: String,
}
