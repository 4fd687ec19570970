//! Samples that explore: the points of largest predicted variance, simulated while a stopping rule is met.
//!
//! A surrogate without a result in some region of failures predicts none there, with small variance near the
//! mean of the variables, and a rule based on its predictions alone stops with that region missing: two of
//! the four branches of the four-branch example lie beyond a kink, and no result near the mean shows them.
//! Further samples at the known limits do not change that. So part of the results over which a rule must hold
//! are taken at the largest predicted variance of the population, which is at its rim, where rare failures
//! lie. A surrogate whose prediction is contradicted there is fitted anew; one that is confirmed has passed a
//! test.
//!
//! The points are chosen one after the other, each by
//!
//!   argmax over x of max over modes of s_t^2(x) times P(result at x),
//!
//! with s_t^2 the variance factor after the points chosen before were believed ([`Posterior::believe`]).
//!
//! # Source
//! Largest predicted variance as a sequential design: Sacks, Welch, Mitchell, Wynn (1989), Design and
//! analysis of computer experiments, Statistical Science 4(4).

use super::Classification;
use crate::statistics::design::Population;
use crate::statistics::surrogate::{Kriging, Posterior};
use faer::{Mat, MatRef};

/// Number of points of largest variance among which the choice is made; each choice lowers the variance of
/// its neighbours.
const CANDIDATES: usize = 128;

/// Input of an exploration.
#[derive(Debug, Clone, Copy)]
pub struct Exploration<'a> {
    /// Models of the modes.
    pub models: &'a [&'a Kriging],
    /// Classification of the population by every mode.
    pub modes: &'a [Classification],
    /// Population to be explored.
    pub population: &'a Population,
    /// Marks the points of the population that were requested `(N,)`.
    pub requested: &'a [bool],
    /// Standardised points `(d,)` with results that are no data of the models.
    pub known: &'a [Vec<f64>],
}

/// Chooses the next `count` points of the population that were not requested, as indices in the order of
/// choice. `feasible` returns the probability of a result `(b,)` [1] at points `(d, b)`. Fewer points are
/// returned if fewer are open.
pub fn explore(
    exploration: &Exploration<'_>,
    feasible: impl Fn(MatRef<'_, f64>) -> Vec<f64>,
    count: usize,
) -> Vec<usize> {
    let Exploration { models, modes, population, requested, known } = *exploration;
    let variance = |j: usize| modes.iter().map(|mode| mode.variance_factor[j]).fold(0.0, f64::max);
    let mut candidates: Vec<usize> = (0..population.len()).filter(|j| !requested[*j]).collect();
    let by_variance = |a: &usize, b: &usize| variance(*b).total_cmp(&variance(*a)).then(a.cmp(b));
    if candidates.len() > CANDIDATES {
        candidates.select_nth_unstable_by(CANDIDATES, by_variance);
        candidates.truncate(CANDIDATES);
    }
    candidates.sort_unstable_by(by_variance);

    let points = Mat::from_fn(population.dimension(), candidates.len() + known.len(), |k, i| {
        candidates.get(i).map_or_else(|| known[i - candidates.len()][k], |j| population.standardised(*j)[k])
    });
    let feasible = feasible(points.as_ref());
    let mut posteriors: Vec<Posterior> =
        models.iter().map(|model| Posterior::new(model, points.as_ref())).collect();
    for place in candidates.len()..points.ncols() {
        posteriors.iter_mut().for_each(|posterior| posterior.believe(place));
    }
    let mut chosen = Vec::with_capacity(count);
    let mut free: Vec<usize> = (0..candidates.len()).collect();
    while chosen.len() < count {
        let score = |i: &usize| posteriors.iter().map(|p| p.variance(*i)).fold(0.0, f64::max) * feasible[*i];
        // The first at a tie: the one of largest initial variance.
        let Some(pick) = free.iter().copied().reduce(|a, b| if score(&b) > score(&a) { b } else { a }) else {
            break;
        };
        posteriors.iter_mut().for_each(|posterior| posterior.believe(pick));
        free.retain(|i| *i != pick);
        chosen.push(candidates[pick]);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::learning::classify;
    use crate::statistics::surrogate::{Correlation, Kernel};
    use common::random::Distribution;

    #[test]
    fn the_rim_is_explored_in_every_direction_and_never_a_requested_point() {
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&[normal; 2], 2000, 1);
        let data = Mat::from_fn(2, 9, |k, i| [i % 3, i / 3][k] as f64 - 1.0);
        let values = Mat::from_fn(9, 1, |i, _| i as f64);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![0.3; 2], nugget: 1e-8, stated: 0.0 };
        let model = Kriging::condition(data.as_ref(), values.as_ref(), &correlation).unwrap();
        let modes = [classify(&model, &population, 20.0, &[0])];
        let explored = |requested: &[bool], known: &[Vec<f64>], feasible: fn(MatRef<'_, f64>) -> Vec<f64>| {
            let models = [&model];
            let exploration =
                Exploration { models: &models, modes: &modes, population: &population, requested, known };
            explore(&exploration, feasible, 4)
        };
        let everywhere = |points: MatRef<'_, f64>| vec![1.0; points.ncols()];
        let first = explored(&vec![false; 2000], &[], everywhere);
        let angle = |j: usize| {
            let z = population.standardised(j);
            assert!(z[0].hypot(z[1]) > 2.0, "{z:?}");
            z[1].atan2(z[0])
        };
        for (a, b) in first.iter().zip(&first[1..]) {
            assert!((angle(*a) - angle(*b)).abs() > 0.3, "{first:?}");
        }
        let mut requested = vec![false; 2000];
        first.iter().for_each(|j| requested[*j] = true);
        // Confirmed points are no data of the model, but known.
        let known: Vec<Vec<f64>> = first.iter().map(|j| population.standardised(*j).to_vec()).collect();
        let distance = |j: usize, z: &[f64]| {
            let at = population.standardised(j);
            (at[0] - z[0]).hypot(at[1] - z[1])
        };
        for j in explored(&requested, &known, everywhere) {
            assert!(!requested[j] && known.iter().all(|z| distance(j, z) > 0.5));
        }
        // To the left no simulation gives a result.
        let right = |points: MatRef<'_, f64>| {
            (0..points.ncols()).map(|j| if points[(0, j)] > 0.0 { 1.0 } else { 0.0 }).collect()
        };
        assert!(explored(&requested, &[], right).iter().all(|j| population.standardised(*j)[0] > 0.0));
    }
}
