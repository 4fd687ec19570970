//! Tests of the surrogates by results they were not fitted to: whether a result concerns the limit, and how
//! large the error of its prediction was.
//!
//! A result concerns the limit if it lies on the other side of the threshold than predicted, or nearer to it
//! than 95 % of the predicted distance. An exploring result that does not has tested the surrogates and is not
//! added to them: far from the limit a response may be so steep (`rp31` among the published problems, 256
//! x^4) that no stationary correlation fits both it and the surroundings of the limit.

use super::observations::{Observations, Observed};
use super::surrogates::{ModeResults, Surrogate};
use crate::statistics::learning::Mode;
use faer::{Mat, MatRef};

impl Surrogate {
    /// Largest error of the predictions of results that are not in the surrogate and concern the limit, in
    /// predicted standard deviations with the [`Surrogate::inflation`] [1]; 0 without such results.
    fn prediction_error(&self, results: &ModeResults<'_>) -> f64 {
        let (n, all) = (self.model.points(), results.points.ncols());
        if all == n {
            return 0.0;
        }
        let prediction = self.model.predict(results.points.subcols(n, all - n));
        let (noise, inflation) = (self.model.correlation().noise(), self.inflation());
        let standardised_error = |i: usize, o: usize| {
            let (value, mean) = (results.values[(n + i, o)], prediction.mean[(o, i)]);
            let variance = self.model.sigma2()[o] * (prediction.variance_factor[i] + noise) * inflation;
            let error = (value - mean).abs() / variance.max(f64::MIN_POSITIVE).sqrt();
            if concerns_limit(value, mean, self.threshold.value) { error } else { 0.0 }
        };
        let pairs = (0..all - n).flat_map(|i| self.fitted_on.iter().map(move |o| (i, *o)));
        pairs.map(|(i, o)| standardised_error(i, o)).fold(0.0, f64::max)
    }
}

/// Share of the predicted distance from the limit below which a result is near [1]: the first sign of a branch
/// of failures beyond a kink may be a response that has come a little nearer only.
const NEAR: f64 = 0.95;

/// What a result says about its prediction; the later the graver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Verdict {
    /// On the predicted side of the threshold, no nearer than [`NEAR`] of the predicted distance.
    Confirmed,
    /// On the predicted side, at less than [`NEAR`] of the predicted distance.
    Near,
    /// On the other side.
    Contradicted,
}

/// The verdict of `value` on a prediction.
fn verdict(value: f64, predicted: f64, threshold: f64) -> Verdict {
    let (left, predicted) = (threshold - value, threshold - predicted);
    if (left > 0.0) != (predicted > 0.0) {
        Verdict::Contradicted
    } else if left.abs() < NEAR * predicted.abs() {
        Verdict::Near
    } else {
        Verdict::Confirmed
    }
}

/// True if `value` lies beyond the threshold against the prediction, or at less than [`NEAR`] of the predicted
/// distance from it.
fn concerns_limit(value: f64, predicted: f64, threshold: f64) -> bool {
    verdict(value, predicted, threshold) > Verdict::Confirmed
}

/// Largest error [1] of any surrogate at the results observed since its fit, in predicted standard
/// deviations.
pub(super) fn largest_prediction_error(
    surrogates: &[Surrogate],
    modes: &[Mode],
    observations: &Observations,
) -> f64 {
    let points = observations.points();
    let error_of = |(surrogate, mode): (&Surrogate, &Mode)| {
        surrogate.prediction_error(&ModeResults::new(observations, &points, mode))
    };
    surrogates.iter().zip(modes).map(error_of).fold(0.0, f64::max)
}

/// Comparison of a result with its prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judgement {
    /// The gravest verdict over modes and checkpoints.
    pub verdict: Verdict,
    /// Largest share of the predicted distance from a limit by which the result is nearer to it [1]; 1 beyond it.
    pub approach: f64,
}

/// The share of the predicted distance by which `value` is nearer to the threshold than predicted, 0 to 1 [1].
fn approach(value: f64, predicted: f64, threshold: f64) -> f64 {
    if predicted >= threshold { 0.0 } else { ((value - predicted) / (threshold - predicted)).clamp(0.0, 1.0) }
}

/// Judges a result at the standardised point `z` `(d,)` over the modes and the checkpoints their surrogates were
/// fitted on.
pub(super) fn judge(surrogates: &[Surrogate], modes: &[Mode], z: &[f64], observed: &Observed) -> Judgement {
    let point: Mat<f64> = MatRef::from_column_major_slice(z, z.len(), 1).to_owned();
    let mut gravest = Judgement { verdict: Verdict::Confirmed, approach: 0.0 };
    for (surrogate, mode) in surrogates.iter().zip(modes) {
        let mean = surrogate.model.predict(point.as_ref()).mean;
        let values = observed.running_maximum(mode.output);
        for o in &surrogate.fitted_on {
            let (value, mean) = (values[*o], mean[(*o, 0)]);
            let threshold = surrogate.threshold.value;
            gravest.verdict = gravest.verdict.max(verdict(value, mean, threshold));
            gravest.approach = gravest.approach.max(approach(value, mean, threshold));
        }
    }
    gravest
}

#[cfg(test)]
mod tests {
    use super::{Verdict, approach, concerns_limit, verdict};

    #[test]
    fn a_result_concerns_the_limit_if_nearer_than_predicted_or_beyond() {
        let cases =
            [(9.0, 5.0), (10.5, 9.9), (12.0, 20.0), (9.0, 11.0)].map(|(v, p)| concerns_limit(v, p, 10.0));
        assert_eq!(cases, [true; 4]);
        let cases =
            [(5.0, 5.0), (-90.0, 5.0), (5.0, 4.9), (20.0, 12.0)].map(|(v, p)| concerns_limit(v, p, 10.0));
        assert_eq!(cases, [false; 4]);
        let cases = [(9.0, 5.0), (10.5, 9.9), (9.0, 11.0), (5.0, 5.0)].map(|(v, p)| verdict(v, p, 10.0));
        let [near, contradicted] = [Verdict::Near, Verdict::Contradicted];
        assert_eq!(cases, [near, contradicted, contradicted, Verdict::Confirmed]);
    }
    #[test]
    fn an_approach_is_a_share_of_the_predicted_distance() {
        let cases = [(8.0, 5.0), (11.0, 5.0), (4.0, 5.0), (10.5, 12.0)].map(|(v, p)| approach(v, p, 10.0));
        assert_eq!(cases, [0.6, 1.0, 0.0, 0.0]);
    }
}
