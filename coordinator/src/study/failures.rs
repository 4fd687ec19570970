//! Failed simulations: when they end a campaign, and which region the next samples avoid.
//!
//! The probability of failure of a simulation is estimated by Kriging of an indicator,
//!
//!   P(failed at z) = trend + r(z)' C^-1 (i - trend),   i_j = 1 for a failed simulation, 0 for a successful one,
//!
//! with the correlation r of the first limit state's surrogate and a nugget of 0.05 (symbols as in
//! [`crate::statistics::surrogate`]). A candidate's score is multiplied by 1 - P, clamped to [0, 1], so that
//! a region without results is not sampled again and again. The estimate is rough: the lengths are those of
//! the response, and nothing bounds the Kriging mean to [0, 1] before the clamp.
//!
//! # Source
//! Journel (1983), Nonparametric estimation of spatial distributions (indicator Kriging).

use super::CampaignError;
use super::settings::SMALLEST_DESIGN;
use crate::statistics::design::Population;
use crate::statistics::surrogate::{Correlation, Kriging};
use common::failure::SimulationFailure;
use faer::{Mat, MatRef};
use rayon::prelude::*;
use std::mem::discriminant;

/// Least number of simulations before failures end a campaign.
const FAILED_AFTER: usize = 10;
/// Probability of failure above which a point counts as barred [1].
const BARRED: f64 = 0.5;
/// Noise of the indicator over its variance [1]: one failure alone does not bar its neighbourhood.
const NUGGET: f64 = 0.05;
/// Number of points predicted together.
const BLOCK: usize = 512;

/// A simulation that failed for good.
#[derive(Debug, Clone, PartialEq)]
pub struct Failed {
    /// Standardised point `(d,)` [1].
    pub z: Vec<f64>,
    /// Cause of the failure.
    pub cause: SimulationFailure,
    /// True for an exploring point nearer to an earlier failure than to any result: it adds nothing to what was
    /// known, and does not count against the largest share of failures.
    pub expected: bool,
}

/// Fails if more than `share` of at least ten simulations failed.
///
/// # Errors
/// [`CampaignError::TooManyFailures`] with the most frequent kind of failure.
pub(super) fn check_failures<'a>(
    failures: impl Iterator<Item = &'a SimulationFailure> + Clone,
    total: usize,
    share: f64,
) -> Result<(), CampaignError> {
    let failed = failures.clone().count();
    if total < FAILED_AFTER || failed as f64 <= share * total as f64 {
        return Ok(());
    }
    let MostFrequent { cause, count } = MostFrequent::among(failures).expect("more than a share failed");
    Err(CampaignError::TooManyFailures { failed, total, count, cause: cause.clone() })
}

/// Fails if the simulation of the nominal point, the only one so far, failed for good.
///
/// # Errors
/// [`CampaignError::Nominal`].
pub(super) fn check_nominal(failed: &[Failed]) -> Result<(), CampaignError> {
    failed.first().map_or(Ok(()), |failed| Err(CampaignError::Nominal { cause: failed.cause.clone() }))
}

/// Fails if simulations failed and the `results` of the others, of `total` samples, do not suffice for a surrogate.
///
/// # Errors
/// [`CampaignError::TooFewResults`] with the most frequent kind of failure.
pub(super) fn check_results<'a>(
    results: usize,
    failures: impl Iterator<Item = &'a SimulationFailure> + Clone,
    total: usize,
) -> Result<(), CampaignError> {
    match MostFrequent::among(failures) {
        Some(MostFrequent { cause, count }) if results < SMALLEST_DESIGN => {
            Err(CampaignError::TooFewResults { results, total, count, cause: cause.clone() })
        }
        _ => Ok(()),
    }
}

/// The most frequent kind of failure.
pub(super) struct MostFrequent<'a> {
    /// The first failure of this kind.
    pub cause: &'a SimulationFailure,
    /// Number of failures of this kind.
    pub count: usize,
}

impl<'a> MostFrequent<'a> {
    /// The most frequent kind among these failures, the earliest of equally frequent ones; `None` without failures.
    pub fn among(failures: impl Iterator<Item = &'a SimulationFailure> + Clone) -> Option<Self> {
        let like =
            |a: &SimulationFailure| failures.clone().filter(|b| discriminant(a) == discriminant(b)).count();
        failures.clone().fold(None, |best: Option<Self>, cause| {
            let count = like(cause);
            if best.as_ref().is_some_and(|best| count <= best.count) {
                best
            } else {
                Some(Self { cause, count })
            }
        })
    }
}

/// Estimated probability that a simulation gives a result.
#[derive(Debug)]
pub struct Feasibility {
    /// Kriging of the failure indicator; `None` without failures.
    model: Option<Kriging>,
}

impl Feasibility {
    /// From the points with results `(d, n)`, the failed simulations, and the correlation of the indicator.
    pub fn new(points: MatRef<'_, f64>, failed: &[Failed], correlation: &Correlation) -> Self {
        if failed.is_empty() {
            return Self { model: None };
        }
        let (d, n) = (points.nrows(), points.ncols());
        let all =
            Mat::from_fn(d, n + failed.len(), |k, i| if i < n { points[(k, i)] } else { failed[i - n].z[k] });
        let indicator = Mat::from_fn(n + failed.len(), 1, |i, _| if i < n { 0.0 } else { 1.0 });
        let correlation = Correlation { nugget: NUGGET, stated: 0.0, ..correlation.clone() };
        // Without a Cholesky factor the region is unknown, and nothing is barred.
        Self { model: Kriging::condition(all.as_ref(), indicator.as_ref(), &correlation).ok() }
    }

    /// Estimated probability of a result `(b,)` [1] at points `(d, b)`; 1 everywhere without failures.
    pub fn probability(&self, points: MatRef<'_, f64>) -> Vec<f64> {
        match &self.model {
            None => vec![1.0; points.ncols()],
            Some(model) => {
                let mean = model.predict_means(points, &model.dual(), 0..1);
                (0..points.ncols()).map(|j| (1.0 - mean[(0, j)]).clamp(0.0, 1.0)).collect()
            }
        }
    }

    /// Share of the population [1] where a simulation is more likely to fail than to succeed.
    pub fn barred_share(&self, population: &Population) -> f64 {
        if self.model.is_none() {
            return 0.0;
        }
        let starts: Vec<usize> = (0..population.len()).step_by(BLOCK).collect();
        let barred: usize = starts
            .into_par_iter()
            .map(|start| {
                let end = population.len().min(start + BLOCK);
                let probability = self.probability(population.columns(start..end));
                probability.iter().filter(|p| **p < 1.0 - BARRED).count()
            })
            .sum();
        barred as f64 / population.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::surrogate::Kernel;
    use common::random::Distribution;

    #[test]
    fn a_region_of_failures_is_found_and_its_share_of_the_population() {
        // Points beyond 1 in the first variable fail: 15.9 % of a standard normal population.
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&vec![normal; 2], 20_000, 3);
        let (mut points, mut failed) = (vec![], vec![]);
        for j in 0..120 {
            let z = population.standardised(j);
            if z[0] > 1.0 {
                let cause = SimulationFailure::NotModelled { what: "beyond".into() };
                failed.push(Failed { z: z.to_vec(), cause, expected: false });
            } else {
                points.extend_from_slice(z);
            }
        }
        let points = MatRef::from_column_major_slice(&points, 2, points.len() / 2);
        let theta = vec![0.5, 0.01];
        let correlation = Correlation { kernel: Kernel::Gaussian, theta, nugget: 1e-8, stated: 0.0 };
        let feasibility = Feasibility::new(points, &failed, &correlation);
        let share = feasibility.barred_share(&population);
        assert!((share - 0.159).abs() < 0.03, "{share}");
        let at = Mat::from_fn(2, 2, |k, j| if k == 0 { [-0.5, 1.8][j] } else { 0.3 });
        let probability = feasibility.probability(at.as_ref());
        assert!(probability[0] > 0.9 && probability[1] < 0.1, "{probability:?}");
        let none = Feasibility::new(points, &[], &correlation);
        assert_eq!((none.barred_share(&population), none.probability(at.as_ref())), (0.0, vec![1.0; 2]));
    }
}
