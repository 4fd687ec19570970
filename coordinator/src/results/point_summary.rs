//! Points of the space of the random variables, as written to `summary.json`: simulations predicted from all others, and the most
//! probable failures.

use serde::{Deserialize, Serialize};

/// Simulated values of a limit state's output at one checkpoint, and the predictions of its surrogate at the end of the study, each
/// from all other simulations; arrays over the simulations in the order of their numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// Unit of the values, that of the output in all files.
    pub unit: String,
    /// Simulated largest value up to the checkpoint, smallest where values below the threshold fail `(n,)`.
    pub simulated: Vec<f64>,
    /// Its prediction from all other simulations `(n,)`.
    pub predicted: Vec<f64>,
    /// Standard deviation of the prediction, with the factor of the validation on its variance `(n,)`.
    pub std: Vec<f64>,
    /// Q2 = 1 - sum of squared errors / sum of squared deviations from the mean [1].
    pub q2: f64,
}

/// The failed point of the population with the highest density in the space of independent standard normals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailurePointRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Checkpoint of life by which the point has failed [cycles].
    pub cycles: u32,
    /// Share of the population that has failed by then [1].
    pub failed: f64,
    /// Distance from the origin of that space [1].
    pub distance: f64,
    /// The point, one row per variable in the order of the scene.
    pub variables: Vec<CoordinateRow>,
}

/// A coordinate of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoordinateRow {
    /// Name of the variable.
    pub variable: String,
    /// Its value [SI].
    pub value: f64,
    /// Standard normal with the same probability, the distance from the median in standard deviations [1].
    pub normal: f64,
}
