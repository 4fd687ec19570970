//! Failed simulations: when they end a campaign, and which region the next samples avoid.
//!
//! The probability that a simulation fails at a point z is estimated from the squared distances f^2 to the nearest failed
//! simulation and s^2 to the nearest result, in standardised inputs [1]:
//!
//!   P(failed at z) = s^2 / (f^2 + s^2),
//!
//! one at a failure, zero at a result, and one half where both are equally near. A candidate's score is multiplied by 1 - P, so that
//! a region without results is not sampled again and again; where P is above 2/3 that is settled, and no sample is requested. The share of the population nearer to a failure than to any result is
//! that which cannot be simulated; the intervals contain that where P is above 1/3, whatever the surrogates predict there. Where failures were simulated more often than elsewhere does not count: more of them divide the same region among
//! themselves. (Indicator Kriging with the lengths of the response was tried and dropped: a response that is nearly linear has lengths far beyond the region, and its
//! trend is the share of failures among the simulations, which learning changes.) With few simulations the estimate is rough.
//!
//! # Source
//! Cover, Hart (1967), Nearest neighbor pattern classification, IEEE Trans. Inf. Theory 13(1), 21-27; weights by inverse squares: Shepard (1968),
//! Proc. 23rd ACM National Conference, 517-524.

use super::CampaignError;
use super::settings::SMALLEST_DESIGN;
use crate::statistics::design::Population;
use common::failure::SimulationFailure;
use faer::{ColRef, Mat, MatRef};
use rayon::prelude::*;
use std::mem::discriminant;

/// Least number of simulations before failures end a campaign.
const FAILED_AFTER: usize = 10;
/// Probability of failure above which a point counts as barred [1].
const BARRED: f64 = 0.5;
/// Probability of failure above which no simulation is requested [1]: the nearest failure is nearer by 1 / sqrt(2) than any
/// result.
const SETTLED: f64 = 2.0 / 3.0;
/// Number of points estimated together.
const BLOCK: usize = 512;

/// A simulation that failed for good.
#[derive(Debug, Clone, PartialEq)]
pub struct Failed {
    /// Standardised point `(d,)` [1].
    pub z: Vec<f64>,
    /// Cause of the failure.
    pub cause: SimulationFailure,
    /// True for a point that learning or exploring requested near an earlier failure: it adds little to what was known, and does not count
    /// against the largest share of failures.
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
    let (cause, count) = most_frequent(failures).expect("more than a share failed");
    Err(CampaignError::TooManyFailures { failed, total, count, cause: cause.clone() })
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
    match most_frequent(failures) {
        Some((cause, count)) if results < SMALLEST_DESIGN => {
            Err(CampaignError::TooFewResults { results, total, count, cause: cause.clone() })
        }
        _ => Ok(()),
    }
}

/// The first failure of the most frequent kind, the earliest of equally frequent ones, and the number of its kind; `None` without
/// failures.
pub(super) fn most_frequent<'a>(
    failures: impl Iterator<Item = &'a SimulationFailure> + Clone,
) -> Option<(&'a SimulationFailure, usize)> {
    let like =
        |a: &SimulationFailure| failures.clone().filter(|b| discriminant(a) == discriminant(b)).count();
    let counted = failures.clone().map(|cause| (cause, like(cause)));
    counted.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

/// Estimated probability that a simulation gives a result.
#[derive(Debug)]
pub struct Feasibility {
    /// Points with results `(d, n)`.
    results: Mat<f64>,
    /// Failed points `(d, k)`.
    failed: Mat<f64>,
}

impl Feasibility {
    /// From the points with results `(d, n)` and the failed simulations.
    pub fn new(points: MatRef<'_, f64>, failed: &[Failed]) -> Self {
        Self {
            results: points.to_owned(),
            failed: Mat::from_fn(points.nrows(), failed.len(), |k, i| failed[i].z[k]),
        }
    }

    /// Estimated probability of a result `(b,)` [1] at points `(d, b)`; 1 everywhere without failures.
    pub fn probability(&self, points: MatRef<'_, f64>) -> Vec<f64> {
        if self.failed.ncols() == 0 {
            return vec![1.0; points.ncols()];
        }
        let probability = |point: ColRef<'_, f64>| {
            let (f, s) = (nearest(point, &self.failed), nearest(point, &self.results));
            // A point that failed before and gave a result later has a result.
            if s > 0.0 { f / (f + s) } else { 1.0 }
        };
        points.col_iter().map(probability).collect()
    }

    /// Share of the population [1] where a simulation is more likely to fail than to succeed.
    pub fn barred_share(&self, population: &Population) -> f64 {
        let barred = self.probable_failures(population, BARRED);
        barred.iter().filter(|barred| **barred).count() as f64 / population.len() as f64
    }

    /// Share of the population [1] where it is not settled that a simulation gives a result: the most that cannot be simulated.
    pub fn largest_barred_share(&self, population: &Population) -> f64 {
        let open = self.probable_failures(population, 1.0 - SETTLED);
        open.iter().filter(|open| **open).count() as f64 / population.len() as f64
    }

    /// Marks the points of the population `(N,)` where it is settled that simulations fail; empty without failures.
    pub fn settled(&self, population: &Population) -> Vec<bool> {
        self.probable_failures(population, SETTLED)
    }

    /// Estimated probability of a result `(b,)` [1] at points `(d, b)`, 0 where failure is settled.
    pub fn open_probability(&self, points: MatRef<'_, f64>) -> Vec<f64> {
        let open = |p: f64| if p < 1.0 - SETTLED { 0.0 } else { p };
        self.probability(points).into_iter().map(open).collect()
    }

    /// Marks the points of the population `(N,)` whose simulation fails with more than this probability [1]; empty without
    /// failures.
    fn probable_failures(&self, population: &Population, probability: f64) -> Vec<bool> {
        if self.failed.ncols() == 0 {
            return vec![];
        }
        let of_block = |start: usize| {
            let columns = population.columns(start..population.len().min(start + BLOCK));
            self.probability(columns).into_iter().map(|p| p < 1.0 - probability).collect::<Vec<bool>>()
        };
        (0..population.len()).into_par_iter().step_by(BLOCK).flat_map_iter(of_block).collect()
    }
}

/// Squared distance of a point `(d,)` to the nearest of some `(d, n)` [1]; infinite without any.
fn nearest(point: ColRef<'_, f64>, of: &Mat<f64>) -> f64 {
    let square =
        |other: ColRef<'_, f64>| point.iter().zip(other.iter()).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    of.col_iter().map(square).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let feasibility = Feasibility::new(points, &failed);
        let share = feasibility.barred_share(&population);
        assert!((share - 0.159).abs() < 0.03, "{share}");
        let most = feasibility.largest_barred_share(&population);
        assert!((0.159..0.25).contains(&most), "{most}");
        let at = Mat::from_fn(2, 2, |k, j| if k == 0 { [-0.5, 1.8][j] } else { 0.3 });
        let probability = feasibility.probability(at.as_ref());
        assert!(probability[0] > 0.9 && probability[1] < 0.1, "{probability:?}");
        // Fifty more failures in the same region, as learning may ask for them, leave its share as it is.
        let beyond = (0..population.len()).map(|j| population.standardised(j)).filter(|z| z[0] > 1.0);
        failed.extend(beyond.skip(100).take(50).map(|z| {
            let cause = SimulationFailure::NotModelled { what: "beyond".into() };
            Failed { z: z.to_vec(), cause, expected: false }
        }));
        let share = Feasibility::new(points, &failed).barred_share(&population);
        assert!((share - 0.159).abs() < 0.03, "{share}");
        let none = Feasibility::new(points, &[]);
        assert_eq!((none.barred_share(&population), none.probability(at.as_ref())), (0.0, vec![1.0; 2]));
    }
}
