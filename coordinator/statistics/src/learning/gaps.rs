//! Gaps between the simulations inside of the population, which exploring fills while a stopping rule is met.
//!
//! The predicted variance ([`super::explore`]) leads to the rim, and it is the surrogate's own word: where the response changes over
//! a distance that no two simulations have shown, the lengths are too long and the variance too small. A region of failures
//! about one standard deviation wide between the simulations is found only by a simulation in it. So points are placed by
//! distances in the population alone, in two places:
//!
//! - in the bulk, where a simulation brings a random sample of S points of the population nearer to the simulations than anywhere
//!   else: argmax over x in the sample of sum over i of max(0, D_i - |x_i - x|^2), with D_i the square of the distance
//!   of sample i from the nearest simulation;
//! - near a limit, where the response comes nearest to a threshold: argmax of D among the twentieth of the sample nearest to a
//!   limit in standard deviations of the process.
//!
//! Distances are those of standardised points, times the probability of a result.
//!
//! # Source
//! The first is the next step of k-means by exchange, a design that represents a distribution: MacQueen (1967), Some methods for
//! classification and analysis of multivariate observations, Proceedings of the Fifth Berkeley Symposium 1; Flury (1990), Principal
//! points, Biometrika 77(1). Maximin distance: Johnson, Moore, Ylvisaker (1990), Journal of Statistical Planning and Inference 26(2).

use super::{Classification, classification::distance_over_std, exploration::farthest};
use crate::design::Population;
use rand::{Rng, RngExt};
use rayon::prelude::*;

/// Points of the population among which a gap is looked for.
const SAMPLE: usize = 1024;
/// Points of the population by which the largest gap is measured.
const LOOKED_AT: usize = 2048;
/// Share of the sample that are nearest to a limit [1].
const NEAREST: f64 = 0.05;

/// Where a gap is filled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gap {
    /// Anywhere in the population.
    Bulk,
    /// Near a limit.
    Limit,
}

/// Share of the population [1] in the largest ball around one of its points without any of the standardised points `known` `(d,)` in it,
/// by its first 2048 points: a region of failures apart from all others could lie there unseen.
///
/// With n points that were drawn like the population the share of a ball is 1 / (n + 1) in the mean, in any number of variables; the
/// largest is a few times that.
pub fn largest_gap(population: &Population, known: &[&[f64]]) -> f64 {
    let points: Vec<&[f64]> =
        (0..population.len().min(LOOKED_AT)).map(|j| population.standardised(j)).collect();
    let share = |at: &&[f64]| {
        let nearest = known.iter().map(|known| squared_distance(at, known)).fold(f64::INFINITY, f64::min);
        points.iter().filter(|point| squared_distance(at, point) < nearest).count()
    };
    let largest = points.par_iter().map(share).max().unwrap_or(0);
    largest as f64 / points.len().max(1) as f64
}

/// A random sample of the open points of a population, as indices; `closed` `(N,)` marks the others.
pub fn sample_of_open(population: &Population, closed: &[bool], rng: &mut impl Rng) -> Vec<usize> {
    let n = population.len();
    if n <= 4 * SAMPLE {
        let mut open: Vec<usize> = (0..n).filter(|j| !closed[*j]).collect();
        let count = SAMPLE.min(open.len());
        for i in 0..count {
            let other = rng.random_range(i..open.len());
            open.swap(i, other);
        }
        open.truncate(count);
        return open;
    }
    let mut sample: Vec<usize> = (0..SAMPLE).map(|_| rng.random_range(0..n)).collect();
    sample.sort_unstable();
    sample.dedup();
    sample.retain(|j| !closed[*j]);
    sample
}

/// The point of the `sample` of a population whose simulation fills the widest gap at `place` between the standardised points `known`
/// `(d,)`, which have factors on squared distances from them [1]; `feasible` `(sample,)` is the probability of a result [1], and
/// distances from limits are those of checkpoint `n` of the grid. `None` if no result is possible anywhere.
pub fn widest_gap<'a>(
    population: &Population,
    (sample, feasible): (&[usize], &[f64]),
    known: impl Iterator<Item = (&'a [f64], f64)>,
    place: Gap,
    (modes, n): (&[Classification], usize),
) -> Option<usize> {
    let points: Vec<&[f64]> = sample.iter().map(|j| population.standardised(*j)).collect();
    match place {
        Gap::Bulk => most_representative(&points, known, feasible).map(|i| sample[i]),
        Gap::Limit => {
            let distance = |j: usize| {
                let of = |mode: &Classification| {
                    distance_over_std(mode.means_of(j)[n] - mode.threshold, mode.sigma[n])
                };
                modes.iter().map(of).fold(f64::INFINITY, f64::min)
            };
            let mut order: Vec<usize> = (0..sample.len()).collect();
            order.sort_by(|a, b| distance(sample[*a]).total_cmp(&distance(sample[*b])));
            order.truncate((NEAREST * sample.len() as f64).ceil() as usize);
            let near: Vec<&[f64]> = order.iter().map(|i| points[*i]).collect();
            let feasible: Vec<f64> = order.iter().map(|i| feasible[*i]).collect();
            farthest(&near, known, &feasible, 1).first().map(|place| sample[order[*place]])
        }
    }
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Gap of the point that brings all of these `points` `(c)(d,)` nearest to the known ones and itself, see the head of this file.
fn most_representative<'a>(
    points: &[&[f64]],
    known: impl Iterator<Item = (&'a [f64], f64)>,
    feasible: &[f64],
) -> Option<usize> {
    let mut nearest = vec![f64::MAX; points.len()];
    for (at, factor) in known {
        nearest
            .iter_mut()
            .zip(points)
            .for_each(|(d, point)| *d = d.min(factor * squared_distance(at, point)));
    }
    let gain = |i: usize| {
        let gained = |(d, point): (&f64, &&[f64])| (d - squared_distance(point, points[i])).max(0.0);
        feasible[i] * nearest.iter().zip(points).map(gained).sum::<f64>()
    };
    let gains: Vec<f64> = (0..points.len()).into_par_iter().map(gain).collect();
    (0..points.len()).reduce(|a, b| if gains[b] > gains[a] { b } else { a }).filter(|i| gains[*i] > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Stream, open_stream};
    use crate::learning::classification::tests::mode;
    use common::random::Distribution;

    #[test]
    fn the_largest_gap_is_the_mass_of_a_ball_without_a_simulation() {
        let normal = Distribution::normal(0.0, 1.0).unwrap();
        let population = Population::draw(&vec![normal; 2], 20_000, 1);
        // Points on a grid of spacing 1, but for the origin: nothing within 1 of it, P(|z|^2 < 1) = 1 - exp(-1/2).
        let grid = (-5..=5).flat_map(|i| (-5..=5).map(move |k| [f64::from(i), f64::from(k)]));
        let known: Vec<[f64; 2]> = grid.filter(|z| *z != [0.0; 2]).collect();
        let known: Vec<&[f64]> = known.iter().map(|z| &z[..]).collect();
        let found = largest_gap(&population, &known);
        assert!((found - (1.0 - (-0.5_f64).exp())).abs() < 0.04, "{found}");
        assert_eq!(largest_gap(&population, &[]), 1.0);
    }

    #[test]
    fn the_bulk_is_filled_where_most_points_are_far_and_a_limit_along_itself() {
        let normal = Distribution::normal(0.0, 1.0).unwrap();
        let population = Population::draw(&vec![normal; 2], 20_000, 1);
        let closed = vec![false; 20_000];
        let sample = sample_of_open(&population, &closed, &mut open_stream(1, Stream::Gaps(0)));
        assert!(sample.len() > 950);
        let feasible = vec![1.0; sample.len()];
        // Failure at the right of x = 1.5.
        let means: Vec<f64> = (0..20_000).map(|j| population.standardised(j)[0]).collect();
        let modes = [mode(&means, &vec![1.0; 20_000], 1.5)];
        let known = [[0.0, 0.0], [-1.5, 0.0], [0.0, -1.5], [0.0, 1.5]];
        let gap = |known: &[[f64; 2]], feasible: &[f64], place| {
            let known = known.iter().map(|z| (&z[..], 1.0));
            let j = widest_gap(&population, (&sample, feasible), known, place, (&modes, 0)).unwrap();
            population.standardised(j).to_vec()
        };
        let bulk = gap(&known, &feasible, Gap::Bulk);
        assert!((bulk[0] - 1.5).abs() < 0.5 && bulk[1].abs() < 0.5, "{bulk:?}");
        let limit = gap(&known, &feasible, Gap::Limit);
        assert!((limit[0] - 1.5).abs() < 0.5 && limit[1].abs() > 1.5, "{limit:?}");
        // No result is possible to the right.
        let left: Vec<f64> =
            sample.iter().map(|j| f64::from(u8::from(population.standardised(*j)[0] < 0.0))).collect();
        assert!(gap(&known, &left, Gap::Bulk)[0] < 0.0);
        let none = widest_gap(
            &population,
            (&sample, &vec![0.0; sample.len()]),
            std::iter::empty(),
            Gap::Bulk,
            (&modes, 0),
        );
        assert_eq!(none, None);
        // Of a small population every open point is there.
        let few = Population::draw(&population.inputs, 10, 1);
        let mut closed = vec![false; 10];
        closed[3] = true;
        let mut all = sample_of_open(&few, &closed, &mut open_stream(1, Stream::Gaps(0)));
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 4, 5, 6, 7, 8, 9]);
    }
}
