//! Rows of `summary.json` about surrogates and their predictions, levels of accuracy, variants of the model, outliers, the most probable
//! failures, and what more control points on the worn surfaces change in the nominal mechanism.

use super::life_summary::LifeRow;
use super::reliability_summary::ReliabilityRow;
use crate::statistics::reliability::paired::Change;
use common::outputs::{Diagnostics, PointsError};
use common::scene::Scene;
use serde::{Deserialize, Serialize};

/// The surrogate of one limit state at the end of a study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SurrogateRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Smallest leave-one-out Q2 over the governing checkpoints [1].
    pub q2: f64,
    /// Smallest cross-validated Q2 with the correlation lengths fitted anew [1]; absent with fewer than ten results, and in
    /// studies by earlier versions.
    pub q2_cross_validated: Option<f64>,
    /// Factor on the predicted variances, from cross-validation or leave-one-out errors [1]; absent in studies by earlier
    /// versions.
    pub variance_factor: Option<f64>,
    /// Variance of the noise common to all points over the process variance [1].
    pub nugget: f64,
    /// Mean variance of the noise in proportion to the stated errors over the process variance [1].
    pub stated_noise: f64,
    /// Variance of both noises over that of the simulated values, largest over the governing checkpoints [1]; absent in
    /// studies by earlier versions.
    pub noise_share: Option<f64>,
    /// Name of the correlation kernel; empty in studies by earlier versions.
    pub kernel: String,
    /// Name of the trend; empty in studies by earlier versions.
    pub trend: String,
    /// True if separate correlations for early and late checkpoints would predict clearly better than the common one; absent
    /// with one checkpoint.
    pub separate_would_gain: Option<bool>,
    /// Standard deviation of the noise over the stated errors [1]; absent without stated errors.
    pub share_of_stated_error: Option<f64>,
    /// Number of different values of the response, if it reaches its limit with a jump of more than a tenth of their standard
    /// deviation; absent otherwise, and in studies by earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub different_values: Option<usize>,
    /// Largest distance of a simulated value from the median of all over their interquartile range [1]; absent where it is not that of an
    /// outlier, and in studies by earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outlier: Option<f64>,
    /// True if the logarithms of the response are learned.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub logarithms: bool,
}

/// Failure probabilities that no simulation has tested, whose intervals are bounded by the independent samples alone.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UntestedRow {
    /// Limit states, and `total` for the system.
    pub curves: Vec<String>,
    /// Number of independent samples without a failure.
    pub samples: usize,
    /// Failure probability that these exclude with 95 % [1].
    pub bound: f64,
    /// Upper limit of the failure probability of the system at the end of life by the surrogates alone [1].
    pub predicted: f64,
}

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

/// Levels of accuracy and what pairs of simulations at the same points showed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LevelsRow {
    /// Names of the levels, the working accuracy first.
    pub names: Vec<String>,
    /// Pairs at the second level, and points at the third one.
    pub pairs: [usize; 2],
    /// Simulations at finer levels, failed ones included.
    pub evaluations: usize,
    /// Simulations at finer levels without a result.
    pub failed: usize,
    /// Cause of the first failure.
    #[serde(default)]
    pub cause: Option<String>,
    /// Differences, one row per limit state.
    pub differences: Vec<DifferenceRow>,
}

/// Correction of the output of one limit state at its limit, at the checkpoint where R of the system is nearest 1/2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DifferenceRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Checkpoint of the correction [cycles].
    pub cycles: u32,
    /// `constant`, `line` over the value, or `kriging` over the variables.
    pub form: String,
    /// What is added to a result, over the limit [1]; where the limit is 0 in its own unit.
    pub correction: f64,
    /// Half width of the 95 % interval of the correction, over the limit [1].
    pub error: f64,
    /// Spread of the pairs from point to point, over the limit [1].
    pub rough: f64,
    /// Observed order of convergence under halving; absent without convergence.
    pub order: Option<f64>,
}

/// Result of a variant, by its difference from the study at the same samples.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct VariantRow {
    /// Name of the variant.
    pub name: String,
    /// What it changes, `key = value`.
    pub changes: Vec<String>,
    /// Its simulations, failed ones included.
    pub evaluations: usize,
    /// Those without a result.
    pub failed: usize,
    /// Reliabilities, one row per checkpoint.
    pub reliability: Vec<ReliabilityRow>,
    /// Lives of the system at the usual levels.
    pub lives: Vec<LifeRow>,
    /// Changes of these lives from the study's, with their 95 % limits [cycles]; absent where one of the lives is not known.
    pub changes_of_lives: Vec<Option<Change>>,
}

/// An outlier whose sample was evaluated again.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct OutlierRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Checkpoint of the values [cycles].
    pub cycles: u32,
    /// Distance from the median of all values over their interquartile range [1].
    pub distance: f64,
    /// Evaluations of the sample, that of the outlier first.
    pub evaluations: Vec<OutlierEvaluation>,
}

/// One evaluation of the sample of an outlier.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct OutlierEvaluation {
    /// Number of the evaluation, as in `campaign.db`; absent of a failed one.
    pub number: Option<u64>,
    /// Worker that made it; empty of a failed one.
    pub worker: String,
    /// Value of the output at the checkpoint [unit of the output in files]; absent of a failed one.
    pub value: Option<f64>,
    /// True if it agrees with what the study uses.
    pub used: bool,
}

/// An output of the motion on surfaces with the scene's, twice and four times the control points, at the life where they change it most.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ControlPointsRow {
    /// Name of the output.
    pub output: String,
    /// Unit of the values; may be empty.
    pub unit: String,
    /// Simulated life [cycles].
    pub cycles: u32,
    /// Value with the scene's control points.
    pub value: f64,
    /// Value with twice as many.
    pub with_twice: f64,
    /// Value with four times as many.
    pub with_four_times: f64,
    /// Estimated error due to their number.
    pub error: f64,
    /// False if the value does not converge with the points.
    pub converges: bool,
    /// True if the stated errors contain this one; false if the scene declares its points a part of its model.
    pub stated: bool,
}

/// The rows of an evaluation of `scene` with these `diagnostics`; none where the points were not compared.
pub fn control_points_rows(scene: &Scene, diagnostics: &Diagnostics) -> Vec<ControlPointsRow> {
    let row = |found: &PointsError| {
        let unit = scene.unit_of(scene.outputs.iter().find(|output| output.name == found.output)?);
        let [value, with_twice, with_four_times] = found.values.map(|value| unit.to_shown(value));
        Some(ControlPointsRow {
            output: found.output.clone(),
            unit: unit.symbol().to_owned(),
            cycles: found.cycles,
            value,
            with_twice,
            with_four_times,
            error: unit.to_shown(found.error),
            converges: found.converges,
            stated: found.stated,
        })
    };
    diagnostics.control_points.iter().filter_map(row).collect()
}
