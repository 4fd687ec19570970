//! Simulations that failed: when they end a campaign, and where not to ask again.
//!
//! The region without results is estimated by Kriging of an indicator, 1 where a simulation failed and 0 where it did not,
//! with the correlation of the first limit state's surrogate: what is far in its variables is far here. A candidate's
//! score is multiplied by the share 1 - indicator, so that a region is not asked again and again.
//!
//! Source: an indicator kriged as a probability, Journel (1983), Nonparametric estimation of spatial distributions.

use super::CampaignError;
use crate::statistics::design::Population;
use crate::statistics::surrogate::{Correlation, Kriging};
use common::failure::SimulationFailure;
use faer::{Mat, MatRef};
use rayon::prelude::*;
use std::mem::discriminant;

/// Least number of simulations before failures end a campaign.
const FAILED_AFTER: usize = 10;
/// Indicator above which a place counts as without results.
const BARRED: f64 = 0.5;
/// Noise of the indicator over its variance: one failure is not the neighbourhood's fate.
const NUGGET: f64 = 0.05;
/// Points predicted together.
const BLOCK: usize = 512;

/// A simulation that failed for good.
#[derive(Debug, Clone, PartialEq)]
pub struct Failed {
    /// Where, in standardised units `(d,)` [1].
    pub z: Vec<f64>,
    /// Why.
    pub cause: SimulationFailure,
}

/// Refuses to go on when more than `share` of at least ten simulations failed.
pub(super) fn check_failures<'a>(
    failures: impl Iterator<Item = &'a SimulationFailure> + Clone,
    total: usize,
    share: f64,
) -> Result<(), CampaignError> {
    let failed = failures.clone().count();
    if total < FAILED_AFTER || failed as f64 <= share * total as f64 {
        return Ok(());
    }
    let like =
        |a: &SimulationFailure| failures.clone().filter(|b| discriminant(a) == discriminant(b)).count();
    // The first of the commonest kind.
    let cause = failures.clone().fold(None, |best: Option<(&SimulationFailure, usize)>, a| {
        let count = like(a);
        if best.is_some_and(|(_, most)| count <= most) { best } else { Some((a, count)) }
    });
    let (cause, count) = cause.expect("more than a share failed");
    Err(CampaignError::TooManyFailures { failed, total, count, cause: cause.clone() })
}

/// Where simulations give results.
#[derive(Debug)]
pub struct Feasibility {
    /// Kriging of the indicator; `None` while nothing failed.
    model: Option<Kriging>,
}

impl Feasibility {
    /// From the points with results `(d, n)`, those without, and the correlation that says what is near.
    pub fn new(points: MatRef<'_, f64>, failed: &[Failed], correlation: &Correlation) -> Self {
        if failed.is_empty() {
            return Self { model: None };
        }
        let (d, n) = (points.nrows(), points.ncols());
        let all =
            Mat::from_fn(d, n + failed.len(), |k, i| if i < n { points[(k, i)] } else { failed[i - n].z[k] });
        let indicator = Mat::from_fn(n + failed.len(), 1, |i, _| if i < n { 0.0 } else { 1.0 });
        let correlation = Correlation { nugget: NUGGET, stated: 0.0, ..correlation.clone() };
        // Without a factor nothing is known of the region, and nothing is barred.
        Self { model: Kriging::condition(all.as_ref(), indicator.as_ref(), &correlation).ok() }
    }

    /// Estimated probability of a result at points `(d, b)` `(b,)` [1].
    pub fn probability(&self, points: MatRef<'_, f64>) -> Vec<f64> {
        match &self.model {
            None => vec![1.0; points.ncols()],
            Some(model) => {
                let mean = model.predict_means(points, &model.dual(), 0..1);
                (0..points.ncols()).map(|j| (1.0 - mean[(0, j)]).clamp(0.0, 1.0)).collect()
            }
        }
    }

    /// Share of the population where a simulation is more likely to fail than not [1].
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
        // Whatever lies beyond 1 in the first variable fails: 15.9 % of a standard normal population.
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&[normal; 2], 20_000, 3);
        let (mut points, mut failed) = (vec![], vec![]);
        for j in 0..120 {
            let z = population.standardised(j);
            if z[0] > 1.0 {
                let cause = SimulationFailure::NotModelled { what: "beyond".into() };
                failed.push(Failed { z: z.to_vec(), cause });
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
