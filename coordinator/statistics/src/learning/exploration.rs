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
//! Rare failures lie beyond the rim of any population that can be drawn, and a population conditional on them
//! has points in the known regions only. There the candidates lie in random directions, in independent
//! standard normals u at the radius
//!
//!   |u|^2 = beta^2 + d - 1,   beta = -Phi^-1(P_f / 100),
//!
//! where a half-space of a hundredth of the present failure probability is cut at its most probable point, the
//! other variables being as large as they usually are: a region that changes P_f by more comes nearer to the mean
//! than that, and covers a cone of these directions. The directions are not chosen by the predicted variance, which
//! knows nothing of kinks, but each as far as possible from all results (maximin distance).
//!
//! # Source
//! Largest predicted variance as a sequential design: Sacks, Welch, Mitchell, Wynn (1989), Design and
//! analysis of computer experiments, Statistical Science 4(4). Distance of the most probable point: Hasofer,
//! Lind (1974), Exact and invariant second-moment code format, Journal of the Engineering Mechanics Division
//! 100(1); maximin distance: Johnson, Moore, Ylvisaker (1990), Minimax and maximin distance designs, Journal of
//! Statistical Planning and Inference 26(2); samples on spheres: Bucher (2009), Asymptotic sampling for high-dimensional reliability analysis,
//! Probabilistic Engineering Mechanics 24(4).

use super::Classification;
use crate::design::{InputModel, Population};
use crate::surrogate::{Kriging, Posterior};
use common::random::standard_normal_quantile;
use faer::{Mat, MatRef};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Number of points of largest variance among which the choice is made; each choice lowers the variance of
/// its neighbours.
const CANDIDATES: usize = 128;
/// Number of directions of the rim among which the choice is made.
const DIRECTIONS: usize = 2048;
/// Probability of a region that matters over the present failure probability [1].
const MATTERS: f64 = 0.01;
/// Failure probabilities between which the radius of the rim follows the present one [1].
const RIM: (f64, f64) = (1e-12, 0.1);

/// Chooses the next point of the population that is not `closed` `(N,)`, as an index; `None` if all are. `modes` are the
/// classifications by the `models`, `known` the standardised points `(d,)` with results that are no data of the models, or chosen
/// before. `feasible` returns the probability of a result `(b,)` [1] at points `(d, b)`.
pub fn explore(
    (models, modes): (&[&Kriging], &[Classification]),
    population: &Population,
    closed: &[bool],
    known: &[Vec<f64>],
    feasible: impl Fn(MatRef<'_, f64>) -> Vec<f64>,
) -> Option<usize> {
    let variance = |j: usize| modes.iter().map(|mode| mode.variance_factor[j]).fold(0.0, f64::max);
    let mut candidates: Vec<usize> = (0..population.len()).filter(|j| !closed[*j]).collect();
    let by_variance = |a: &usize, b: &usize| variance(*b).total_cmp(&variance(*a)).then(a.cmp(b));
    if candidates.len() > CANDIDATES {
        candidates.select_nth_unstable_by(CANDIDATES, by_variance);
        candidates.truncate(CANDIDATES);
    }
    candidates.sort_unstable_by(by_variance);
    let count = candidates.len();
    let points = Mat::from_fn(population.dimension(), count + known.len(), |k, i| {
        candidates.get(i).map_or_else(|| known[i - count][k], |j| population.standardised(*j)[k])
    });
    let feasible = feasible(points.as_ref());
    let mut posteriors: Vec<Posterior> =
        models.iter().map(|model| Posterior::new(model, points.as_ref())).collect();
    for place in count..points.ncols() {
        posteriors.iter_mut().for_each(|posterior| posterior.believe(place));
    }
    let score = |i: usize| posteriors.iter().map(|p| p.variance(i)).fold(0.0, f64::max) * feasible[i];
    // The first at a tie: the one of largest initial variance.
    let best = (0..count).reduce(|a, b| if score(b) > score(a) { b } else { a });
    best.map(|place| candidates[place])
}

/// Points of the rim for a failure probability `pf` [1], standardised `(DIRECTIONS)(d,)` [1], in random
/// directions.
pub fn draw_rim(inputs: &InputModel, pf: f64, rng: &mut impl Rng) -> Vec<Vec<f64>> {
    let d = inputs.dimension();
    let beta = -standard_normal_quantile((MATTERS * pf).clamp(RIM.0, RIM.1));
    let radius = (beta * beta + d as f64 - 1.0).sqrt();
    let point = |_| {
        let u: Vec<f64> = (0..d).map(|_| StandardNormal.sample(rng)).collect();
        let length = u.iter().map(|u| u * u).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        let on_rim: Vec<f64> = u.iter().map(|u| u * radius / length).collect();
        inputs.standardise(&inputs.from_independent_normals(&on_rim))
    };
    (0..DIRECTIONS).map(point).collect()
}

/// Chooses `count` of the standardised `points` `(c)(d,)` one after the other, each with the largest square of the
/// distance from the points `known` `(d,)`, which have factors on it [1], and those chosen before, times the
/// probability of a result `feasible` `(c,)` [1]; returns their places, fewer if no result is possible at any other point.
pub fn farthest<'a>(
    points: &[&[f64]],
    known: impl Iterator<Item = (&'a [f64], f64)>,
    feasible: &[f64],
    count: usize,
) -> Vec<usize> {
    let mut distances = vec![f64::MAX; points.len()];
    let approach = |distances: &mut [f64], known: &[f64], factor: f64| {
        for (distance, point) in distances.iter_mut().zip(points) {
            let square = point.iter().zip(known).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            *distance = distance.min(factor * square);
        }
    };
    known.for_each(|(known, factor)| approach(&mut distances, known, factor));
    let mut chosen = Vec::with_capacity(count);
    while chosen.len() < count.min(points.len()) {
        let score = |i: usize| distances[i] * feasible[i];
        let best = (0..points.len()).reduce(|a, b| if score(b) > score(a) { b } else { a });
        // Zero where no result is possible, and at the points chosen: one variable has a rim of two points.
        let Some(pick) = best.filter(|pick| score(*pick) > 0.0) else { break };
        approach(&mut distances, points[pick], 1.0);
        chosen.push(pick);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Stream, open_stream};
    use crate::learning::ClassifiedMode;
    use crate::learning::classification::tests::classify;
    use crate::surrogate::{Correlation, Kernel};
    use common::random;

    #[test]
    fn the_rim_is_explored_in_every_direction_and_never_a_requested_point() {
        let normal = random::Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&vec![normal; 2], 2000, 1);
        let data = Mat::from_fn(2, 9, |k, i| [i % 3, i / 3][k] as f64 - 1.0);
        let values = Mat::from_fn(9, 1, |i, _| i as f64);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![0.3; 2], nugget: 1e-8, stated: 0.0 };
        let model = Kriging::condition(data.as_ref(), values.as_ref(), &correlation).unwrap();
        let mode = ClassifiedMode { index: 0, threshold: 20.0, grid: &[0], inflation: 1.0, by_mean: false };
        let modes = [classify(&model, &population, &mode)];
        let explored = |requested: &[bool], known: &[Vec<f64>], feasible: fn(MatRef<'_, f64>) -> Vec<f64>| {
            let (mut closed, mut known) = (requested.to_vec(), known.to_vec());
            let one = |_| {
                let chosen = explore((&[&model], &modes), &population, &closed, &known, feasible)?;
                closed[chosen] = true;
                known.push(population.standardised(chosen).to_vec());
                Some(chosen)
            };
            (0..4).map_while(one).collect::<Vec<usize>>()
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
        // On the rim of a rare event, at its distance and in all directions but the one that is known.
        let inputs = &population.inputs;
        let rim = draw_rim(inputs, 1e-5, &mut open_stream(1, Stream::Rim(0)));
        let points: Vec<&[f64]> = rim.iter().map(Vec::as_slice).collect();
        let known = [5.0, 0.0];
        let mut angles: Vec<f64> =
            farthest(&points, [(&known[..], 1.0)].into_iter(), &vec![1.0; points.len()], 5)
                .into_iter()
                .map(|place| {
                    assert!((points[place][0].hypot(points[place][1]) - 5.294).abs() < 1e-3);
                    points[place][1].atan2(points[place][0])
                })
                .collect();
        angles.push(0.0);
        let nearest = |a: f64| angles.iter().map(|b| (a - b).cos().acos()).fold(f64::INFINITY, f64::min);
        let widest = (0..360).map(|a| nearest(f64::from(a).to_radians())).fold(0.0, f64::max);
        assert!(widest < 0.8, "{widest} {angles:?}");
        // To the left no simulation gives a result.
        let right = |points: MatRef<'_, f64>| {
            (0..points.ncols()).map(|j| if points[(0, j)] > 0.0 { 1.0 } else { 0.0 }).collect()
        };
        assert!(explored(&requested, &[], right).iter().all(|j| population.standardised(*j)[0] > 0.0));
    }
}
