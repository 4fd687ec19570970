//! What the simulations of a campaign gave: results in the surrogates, exploring results that confirmed them,
//! and failures.
//!
//! Tests of the surrogates by results they were not fitted to: whether a result concerns the limit, and how
//! large the error of its prediction was.
//!
//! A result concerns the limit if it lies on the other side of the threshold than predicted, or nearer to it
//! than 95 % of the predicted distance. An exploring result that does not has tested the surrogates and is not
//! added to them: far from the limit a response may be so steep (`rp31` among the published problems, 256
//! x^4) that no stationary correlation fits both it and the surroundings of the limit.

use super::mode_results::ModeResults;
use super::surrogates::Surrogate;
use super::{Failed, Observations, Observed, Outlier};
use crate::statistics::learning::Mode;
use common::failure::SimulationFailure;
use faer::{Mat, MatRef};

/// What the simulations gave.
#[derive(Debug)]
pub(super) struct CampaignData {
    /// Results the surrogates are conditioned on.
    pub observations: Observations,
    /// Standardised points `(d,)` of exploring results that agreed with their prediction and are in no
    /// surrogate.
    confirmed: Vec<Vec<f64>>,
    /// Standardised points `(d,)` of exploring results nearer to a limit than predicted, with their
    /// [`judge`].
    approaches: Vec<(Vec<f64>, f64)>,
    /// Simulations that failed for good.
    pub failed: Vec<Failed>,
    /// Results that no other one makes probable, with their further evaluations.
    pub outliers: Vec<Outlier>,
    /// True if an exploring result since the last assessment lies on the other side of a limit than predicted.
    pub contradicted: bool,
}

impl CampaignData {
    /// Nothing yet, of `d` variables.
    pub fn new(d: usize) -> Self {
        Self {
            observations: Observations::new(d),
            confirmed: Vec::new(),
            approaches: Vec::new(),
            failed: Vec::new(),
            outliers: Vec::new(),
            contradicted: false,
        }
    }

    /// Number of results, confirmed ones included.
    pub fn results(&self) -> usize {
        self.observations.len() + self.confirmed.len()
    }

    /// Adds an exploring result at the standardised point `z` `(d,)`: to the data of the surrogates if it
    /// concerns a limit.
    pub fn add_exploring(&mut self, z: Vec<f64>, observed: Observed, judged: (Verdict, f64)) {
        let (verdict, approach) = judged;
        self.contradicted |= verdict == Verdict::Contradicted;
        if approach > 0.0 {
            self.approaches.push((z.clone(), approach));
        }
        match verdict {
            Verdict::Confirmed => self.confirmed.push(z),
            Verdict::Near | Verdict::Contradicted => self.observations.add(&z, observed),
        }
    }

    /// Adds a simulation that failed for good at the standardised point `z` `(d,)`. A failure was to be expected
    /// `beyond` the population, where the simulator may not reach, and of a `learning` request, one after the initial
    /// design, near a failure.
    pub fn add_failed(&mut self, z: Vec<f64>, cause: SimulationFailure, learning: bool, beyond: bool) {
        let expected = learning && (beyond || self.is_near_a_failure(&z));
        self.failed.push(Failed { z, cause, expected });
    }

    /// Causes of the failures that were not to be expected.
    pub fn unexpected_failures(&self) -> impl Iterator<Item = &SimulationFailure> + Clone {
        self.failed.iter().filter(|failed| !failed.expected).map(|failed| &failed.cause)
    }

    /// Standardised points `(d,)` that exploring need not try again and that are in no surrogate: confirmed
    /// results and failures.
    pub fn explored(&self) -> Vec<Vec<f64>> {
        self.confirmed.iter().chain(self.failed.iter().map(|failed| &failed.z)).cloned().collect()
    }

    /// All simulated points `(d,)` [1] with a factor on squared distances from them [1]: around results that came nearer
    /// to a limit than predicted, by the share a of the predicted distance, the factor is 1 / (1 - a)^3, 1000 at most,
    /// so that exploring follows the first sign of a region of failures.
    pub fn explored_with_factors(&self) -> Vec<(&[f64], f64)> {
        let factor = |z: &[f64]| {
            let approach =
                self.approaches.iter().find(|(at, _)| at == z).map_or(0.0, |(_, approach)| *approach);
            (1.0 - approach).max(0.1).powi(-3)
        };
        let results = self.observations.standardised().chain(self.confirmed.iter().map(Vec::as_slice));
        results.map(|z| (z, factor(z))).chain(self.failed.iter().map(|failed| (&failed.z[..], 1.0))).collect()
    }

    /// True if a failure at the standardised point `z` `(d,)` has a probability of a third or more by the distances from failures and
    /// results.
    fn is_near_a_failure(&self, z: &[f64]) -> bool {
        let distance = |known: &[f64]| z.iter().zip(known).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let results = self.observations.standardised().chain(self.confirmed.iter().map(Vec::as_slice));
        let result = results.map(distance).fold(f64::INFINITY, f64::min);
        self.failed.iter().any(|failed| distance(&failed.z) <= 2.0 * result)
    }
}

impl Surrogate {
    /// Largest error of the predictions of results that are not in the surrogate and concern the limit, in
    /// predicted standard deviations with the [`Surrogate::inflation`] [1]; 0 without such results.
    fn prediction_error(&self, results: &ModeResults<'_>) -> f64 {
        let (n, all) = (self.model.points(), results.points.ncols());
        if all == n {
            return 0.0;
        }
        let prediction = self.model.predict(results.points.subcols(n, all - n));
        let (noise, inflation) = (self.model.correlation.noise(), self.inflation());
        let standardised_error = |i: usize, o: usize| {
            let (value, mean) = (self.scale.learned(results.values[(n + i, o)]), prediction.mean[(o, i)]);
            let variance = self.model.sigma2[o] * (prediction.variance_factor[i] + noise) * inflation;
            let error = (value - mean).abs() / variance.max(f64::MIN_POSITIVE).sqrt();
            if verdict(value, mean, self.threshold.value) > Verdict::Confirmed { error } else { 0.0 }
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

/// The share of the predicted distance by which `value` is nearer to the threshold than predicted, 0 to 1 [1].
fn approach(value: f64, predicted: f64, threshold: f64) -> f64 {
    if predicted >= threshold { 0.0 } else { ((value - predicted) / (threshold - predicted)).clamp(0.0, 1.0) }
}

/// Judges a result at the standardised point `z` `(d,)` over the modes and the checkpoints their surrogates were
/// fitted on: the gravest verdict, and the largest share of the predicted distance from a limit by which the result is nearer to it [1];
/// 1 beyond it.
pub(super) fn judge(
    surrogates: &[Surrogate],
    modes: &[Mode],
    z: &[f64],
    observed: &Observed,
) -> (Verdict, f64) {
    let point: Mat<f64> = MatRef::from_column_major_slice(z, z.len(), 1).to_owned();
    let mut gravest = (Verdict::Confirmed, 0.0_f64);
    for (surrogate, mode) in surrogates.iter().zip(modes) {
        let mean = surrogate.model.predict(point.as_ref()).mean;
        let values = observed.running_maximum(mode.output);
        for o in &surrogate.fitted_on {
            let (value, mean) = (surrogate.scale.learned(values[*o]), mean[(*o, 0)]);
            let threshold = surrogate.threshold.value;
            gravest.0 = gravest.0.max(verdict(value, mean, threshold));
            gravest.1 = gravest.1.max(approach(value, mean, threshold));
        }
    }
    gravest
}

#[cfg(test)]
mod tests {
    use super::{Verdict, approach, verdict, *};

    #[test]
    fn issue_one_corner_without_results_counts_once() {
        let mut data = CampaignData::new(1);
        data.observations.add(&[0.0], Observed::exact(vec![vec![1.0]]));
        let cause = SimulationFailure::NotModelled { what: "beyond".into() };
        // The first failure of a corner counts, the requests of learning that follow it do not, another corner does, and
        // so does every failure of the initial design.
        for (z, learning) in [(4.0, true), (4.2, true), (3.5, true), (-4.0, true), (4.1, false)] {
            data.add_failed(vec![z], cause.clone(), learning, false);
        }
        let expected = data.failed.iter().map(|failed| failed.expected).collect::<Vec<_>>();
        assert_eq!(expected, [false, true, true, false, false]);
        assert_eq!((data.unexpected_failures().count(), data.explored().len(), data.results()), (3, 5, 1));
        // Beyond the population no failure counts.
        data.add_failed(vec![0.1], cause, true, true);
        assert_eq!((data.unexpected_failures().count(), data.failed.len()), (3, 6));
    }

    #[test]
    fn a_result_nearer_to_a_limit_than_predicted_draws_exploring_points() {
        let mut data = CampaignData::new(1);
        data.observations.add(&[0.0], Observed::exact(vec![vec![1.0]]));
        let result = || Observed::exact(vec![vec![1.0]]);
        data.add_exploring(vec![1.0], result(), (Verdict::Confirmed, 0.0));
        data.add_exploring(vec![2.0], result(), (Verdict::Near, 0.5));
        data.add_exploring(vec![3.0], result(), (Verdict::Contradicted, 1.0));
        let mut factors = data.explored_with_factors();
        factors.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let expected = [(0.0, 1.0), (1.0, 1.0), (2.0, 8.0), (3.0, 1000.0)];
        for ((at, factor), (z, exact)) in factors.into_iter().zip(expected) {
            assert_eq!(at, [z]);
            assert!((factor / exact - 1.0_f64).abs() < 1e-12, "{z}: {factor}");
        }
        assert!(data.contradicted && data.results() == 4);
    }

    #[test]
    fn a_result_concerns_the_limit_if_nearer_than_predicted_or_beyond() {
        let cases = [(9.0, 5.0), (10.5, 9.9), (12.0, 20.0), (9.0, 11.0)]
            .map(|(v, p)| verdict(v, p, 10.0) > Verdict::Confirmed);
        assert_eq!(cases, [true; 4]);
        let cases = [(5.0, 5.0), (-90.0, 5.0), (5.0, 4.9), (20.0, 12.0)]
            .map(|(v, p)| verdict(v, p, 10.0) > Verdict::Confirmed);
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
