//! The pool: the uncertain points of the population, few enough for their joint posterior covariance.
//!
//! # Source
//! Candidates among the population by U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2); the bound
//! on their number and the sample of them are this project's own.

use super::Coupled;
use crate::design::{Population, Stream, open_stream};
use crate::surrogate::{Kriging, Posterior};
use faer::Mat;
use rand::RngExt;
use rayon::prelude::*;
use std::ops::Range;

/// U from which a point is classified by its mean alone: its risk is at most Phi(-3) = 0.13 %, and the sum of
/// these risks enters the error as a bound.
const NEGLIGIBLE: f64 = 3.0;

/// Most points of a pool: their covariance matrix and its factor take less than 20 MB and a second.
const LARGEST: usize = 1500;

/// Points of the population among which the next samples are chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Pool {
    /// Indices in the population: first the `sampled` uncertain points, ascending, then points of larger U.
    pub members: Vec<usize>,
    /// Number of members that are a random sample of the uncertain points.
    pub sampled: usize,
    /// Number of uncertain points of the population.
    pub uncertain: usize,
}

/// A pool with the joint posteriors of all modes at its members.
#[derive(Debug)]
pub struct JointPool {
    /// Indices of the members in the population `(p,)`: those of the [`Pool`], then those whose simulation is under way.
    pub members: Vec<usize>,
    /// Number of the members, the first ones, that are a random sample of the uncertain points.
    pub sampled: usize,
    /// Number of uncertain points of the population.
    pub uncertain: usize,
    /// Standardised points of the members `(d, p)` [1].
    pub points: Mat<f64>,
    /// Posteriors of the modes at the members.
    pub posteriors: Vec<Posterior>,
    /// Places of the members whose simulation is under way.
    pub under_way: Range<usize>,
}

impl JointPool {
    /// Adds the points of the population with the indices `under_way` to the pool and computes the posterior
    /// of every mode's model at all members.
    pub fn new(pool: Pool, under_way: &[usize], population: &Population, models: &[&Kriging]) -> Self {
        let Pool { mut members, sampled, uncertain } = pool;
        let places = members.len()..members.len() + under_way.len();
        members.extend(under_way);
        let (d, p) = (population.dimension(), members.len());
        let points = Mat::from_fn(d, p, |k, i| population.standardised(members[i])[k]);
        let posteriors = models.par_iter().map(|model| Posterior::new(model, points.as_ref())).collect();
        Self { members, sampled, uncertain, points, posteriors, under_way: places }
    }

    /// Adds member `i` to the data of all modes without its value, see [`Posterior::believe`].
    pub fn believe(&mut self, i: usize) {
        self.posteriors.iter_mut().for_each(|posterior| posterior.believe(i));
    }
}

/// Chooses the pool from the points that `requested` `(N,)` does not mark: those with U < 3 for any mode, or
/// a random sample of 1500 of them. Fewer than `least` are filled up with the points of lowest U.
pub fn choose_pool(coupled: &[Coupled], requested: &[bool], least: usize, seed: u64, round: u32) -> Pool {
    let free = |j: &usize| !requested[*j];
    let mut members: Vec<usize> =
        (0..coupled.len()).filter(free).filter(|j| coupled[*j].any < NEGLIGIBLE).collect();
    let uncertain = members.len();
    if uncertain > LARGEST {
        let mut rng = open_stream(seed, Stream::Pool(round));
        for i in 0..LARGEST {
            members.swap(i, rng.random_range(i..uncertain));
        }
        members.truncate(LARGEST);
        members.sort_unstable();
    }
    let sampled = members.len();
    if sampled < least {
        let mut rest: Vec<usize> =
            (0..coupled.len()).filter(free).filter(|j| coupled[*j].any >= NEGLIGIBLE).collect();
        let by_u = |a: &usize, b: &usize| coupled[*a].any.total_cmp(&coupled[*b].any).then(a.cmp(b));
        let wanted = (least - sampled).min(rest.len());
        if wanted > 0 && wanted < rest.len() {
            rest.select_nth_unstable_by(wanted - 1, by_u);
        }
        rest.truncate(wanted);
        rest.sort_unstable_by(by_u);
        members.extend(rest);
    }
    Pool { members, sampled, uncertain }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(u: f64) -> Coupled {
        Coupled { system: u, any: u }
    }

    #[test]
    fn few_uncertain_points_are_all_taken_and_filled_up() {
        let coupled: Vec<Coupled> = [9.0, 1.0, 5.0, 2.0, 4.0, 0.5].map(at).to_vec();
        let evaluated = [false, false, false, false, false, true];
        let pool = choose_pool(&coupled, &evaluated, 4, 1, 0);
        assert_eq!(pool, Pool { members: vec![1, 3, 4, 2], sampled: 2, uncertain: 2 });
    }

    #[test]
    fn many_are_sampled_without_repetition() {
        let pool = choose_pool(&vec![at(0.1); 10_000], &vec![false; 10_000], 10, 1, 3);
        assert_eq!((pool.sampled, pool.uncertain, pool.members.len()), (LARGEST, 10_000, LARGEST));
        assert!(pool.members.windows(2).all(|w| w[0] < w[1]));
        assert_ne!(pool, choose_pool(&vec![at(0.1); 10_000], &vec![false; 10_000], 10, 1, 4));
    }
}
