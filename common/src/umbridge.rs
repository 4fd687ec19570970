//! Messages of the UM-Bridge protocol, version 1.0: JSON over HTTP. `GET /Info`, then `POST` of `/ModelInfo`,
//! `/InputSizes`, `/OutputSizes`, `/Evaluate`; an error is a reply with the key `error`. The type parameter `C` is the
//! JSON object with which a request configures the model.
//!
//! # Source
//! L. Seelinger et al., UM-Bridge: Uncertainty quantification and modeling bridge, Journal of Open Source Software 8
//! (2023) 4748; the protocol's own page, <https://um-bridge-benchmarks.readthedocs.io/en/docs/umbridge/protocol.html>.

use serde::{Deserialize, Serialize};

/// Version of the UM-Bridge protocol.
pub const PROTOCOL_VERSION: f64 = 1.0;

/// Kind of error: the input does not match the sizes of the model.
pub const INVALID_INPUT: &str = "InvalidInput";
/// Kind of error: the output does not match the sizes of the model.
pub const INVALID_OUTPUT: &str = "InvalidOutput";
/// Kind of error: the server has no model of that name.
pub const MODEL_NOT_FOUND: &str = "ModelNotFound";
/// Kind of error: the model does not support the request.
pub const UNSUPPORTED_FEATURE: &str = "UnsupportedFeature";
/// Kind of error of the server in this program: the simulation failed. The protocol defines no kind for this.
pub const SIMULATION_FAILED: &str = "SimulationFailed";

/// Reply to `/Info`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Info {
    /// Protocol version of the server; see [`PROTOCOL_VERSION`].
    pub protocol_version: f64,
    /// Names of the server's models.
    pub models: Vec<String>,
}

/// Reply to `/ModelInfo`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelInfo {
    /// Requests that the model supports.
    pub support: Support,
}

/// Requests that a model supports; a request missing in the reply is not supported.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "PascalCase", default)]
pub struct Support {
    /// Evaluation of the model.
    pub evaluate: bool,
    /// Gradient of an objective, `/Gradient`.
    pub gradient: bool,
    /// Jacobian times a vector.
    pub apply_jacobian: bool,
    /// Hessian of an objective times a vector.
    pub apply_hessian: bool,
}

/// Request of `/ModelInfo`, whose configuration plays no part, `/InputSizes` or `/OutputSizes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SizesRequest<C> {
    /// Name of the model.
    pub name: String,
    /// Configuration of the model.
    pub config: Option<C>,
}

/// Reply to `/InputSizes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InputSizes {
    /// Lengths of the input vectors.
    pub input_sizes: Vec<usize>,
}

/// Reply to `/OutputSizes`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct OutputSizes {
    /// Lengths of the output vectors.
    pub output_sizes: Vec<usize>,
}

/// Request of `/Evaluate`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvaluateRequest<C> {
    /// Name of the model.
    pub name: String,
    /// Input vectors, of the lengths of [`InputSizes`].
    pub input: Vec<Vec<f64>>,
    /// Configuration of the model.
    pub config: Option<C>,
}

/// Reply to `/Evaluate`. `V` is the type of a number, which may be written as a string if it is not finite.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluated<V> {
    /// Output vectors, of the lengths of [`OutputSizes`].
    pub output: Vec<Vec<V>>,
}

/// Reply to a request that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorReply {
    /// Kind and text of the error.
    pub error: ErrorBody,
}

/// Kind and text of an error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorBody {
    /// Kind of error, e.g. [`INVALID_INPUT`].
    #[serde(rename = "type")]
    pub kind: String,
    /// Text of the error.
    pub message: String,
}
