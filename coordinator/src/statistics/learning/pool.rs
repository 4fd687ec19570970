//! The pool: the uncertain points of the population, few enough for their joint posterior.

use super::Coupled;
use crate::statistics::design::{Stream, open_stream};
use rand::RngExt;

/// U beyond which a point is left to its mean: Phi(-3) = 0.13 % risk each; what they add to the error is added as a
/// bound.
const NEGLIGIBLE: f64 = 3.0;

/// Most points of a pool: their covariance matrix and its factor stay below 20 MB and a second.
const LARGEST: usize = 1500;

/// A pool of points of the population.
#[derive(Debug, Clone, PartialEq)]
pub struct Pool {
    /// Indices into the population: first the `sampled` uncertain points, ascending, then fill.
    pub members: Vec<usize>,
    /// How many of the members are a random sample of the uncertain points.
    pub sampled: usize,
    /// How many points of the population are uncertain.
    pub uncertain: usize,
}

/// Chooses the pool from the points not yet evaluated: those with U < 3 for any mode, or a random sample of 1500 of
/// them; filled up to `least` with the points of lowest U if they are fewer.
pub fn choose_pool(coupled: &[Coupled], evaluated: &[bool], least: usize, seed: u64, round: u32) -> Pool {
    let free = |j: &usize| !evaluated[*j];
    let mut members: Vec<usize> =
        (0..coupled.len()).filter(free).filter(|j| coupled[*j].any < NEGLIGIBLE).collect();
    let uncertain = members.len();
    if uncertain > LARGEST {
        let mut rng = open_stream(seed, Stream::Pool(round));
        for i in 0..LARGEST {
            let other = rng.random_range(i..uncertain);
            members.swap(i, other);
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
