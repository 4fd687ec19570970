//! What the simulations of a campaign gave: results in the surrogates, exploring results that confirmed them,
//! and failures.

use super::failures::Failed;
use super::observations::{Observations, Observed};
use super::outliers::Outlier;
use super::prediction_check::{Judgement, Verdict};
use common::failure::SimulationFailure;

/// What the simulations gave.
#[derive(Debug)]
pub(super) struct CampaignData {
    /// Results the surrogates are conditioned on.
    pub observations: Observations,
    /// Standardised points `(d,)` of exploring results that agreed with their prediction and are in no
    /// surrogate.
    confirmed: Vec<Vec<f64>>,
    /// Standardised points `(d,)` of exploring results nearer to a limit than predicted, with their
    /// [`Judgement::approach`].
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
    pub fn add_exploring(&mut self, z: Vec<f64>, observed: Observed, judgement: Judgement) {
        self.contradicted |= judgement.verdict == Verdict::Contradicted;
        if judgement.approach > 0.0 {
            self.approaches.push((z.clone(), judgement.approach));
        }
        match judgement.verdict {
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
        let failed = self.failed.iter().map(|failed| (&failed.z[..], 1.0));
        results.map(|z| (z, factor(z))).chain(failed).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

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
        let judged = |verdict, approach| Judgement { verdict, approach };
        data.add_exploring(vec![1.0], result(), judged(Verdict::Confirmed, 0.0));
        data.add_exploring(vec![2.0], result(), judged(Verdict::Near, 0.5));
        data.add_exploring(vec![3.0], result(), judged(Verdict::Contradicted, 1.0));
        let mut factors = data.explored_with_factors();
        factors.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let expected = [(0.0, 1.0), (1.0, 1.0), (2.0, 8.0), (3.0, 1000.0)];
        for ((at, factor), (z, exact)) in factors.into_iter().zip(expected) {
            assert_eq!(at, [z]);
            assert!((factor / exact - 1.0_f64).abs() < 1e-12, "{z}: {factor}");
        }
        assert!(data.contradicted && data.results() == 4);
    }
}
