//! The most probable failure of each limit state: of all failed points of a population the one with the highest density in the space
//! of independent standard normals, the one nearest to its origin. The point of the first order reliability method (FORM) is the
//! limit of this one for a large population.
//!
//! # Source
//! Hasofer, Lind (1974), Exact and invariant second-moment code format, Journal of the Engineering Mechanics Division 100(1).

use crate::results::point_summary::{CoordinateRow, FailurePointRow};
use crate::statistics::design::Population;
use crate::statistics::sensitivity::Sampled;
use common::random::RandomVariable;
use common::scene::{LimitState, Scene};

/// Least number of points that have failed at the checkpoint of the most probable failure: early failures are what a study is made for,
/// and the nearest of twenty does not depend on a single one.
const LEAST: usize = 20;

/// One row per limit state with failures, at the first checkpoint by which twenty points have failed, or the last one.
/// `first_failures` `(modes)(points,)` are indices of checkpoints; m if never.
pub(super) fn failure_points(
    scene: &Scene,
    sampled: &Sampled<'_>,
    first_failures: &[Vec<u32>],
) -> Vec<FailurePointRow> {
    let cycles = scene.life.checkpoints();
    let limits = scene.limit_states.iter().zip(first_failures);
    let row = |(limit, first): (&LimitState, &Vec<u32>)| {
        let count = |n: usize| first.iter().filter(|at| **at as usize <= n).count();
        let last = cycles.len() - 1;
        let n = (0..last).find(|n| count(*n) >= LEAST).unwrap_or(last);
        let failed = sampled.points.iter().zip(first).filter(|(_, at)| **at as usize <= n);
        let normals = failed.map(|(point, _)| (*point, normals(sampled.population, *point)));
        let distances = normals.map(|(point, (u, distance))| (distance, point, u));
        let (distance, point, normals) =
            distances.filter(|(distance, ..)| distance.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let coordinates = scene.variables.iter().zip(sampled.population.physical(point)).zip(normals);
        let coordinate = |((variable, value), normal): ((&RandomVariable, f64), f64)| CoordinateRow {
            variable: variable.name.clone(),
            value,
            normal,
        };
        Some(FailurePointRow {
            limit_state: limit.name.clone(),
            cycles: cycles[n],
            failed: sampled.probability * count(n) as f64 / first.len().max(1) as f64,
            distance,
            variables: coordinates.map(coordinate).collect(),
        })
    };
    limits.filter_map(row).collect()
}

/// The correlated standard normals of a point `(d,)`, and its distance from the origin of the independent ones [1].
fn normals(population: &Population, point: usize) -> (Vec<f64>, f64) {
    let inputs = &population.inputs;
    let normals = inputs.normals(&population.physical(point));
    let distance = inputs.copula.decorrelate(&normals).iter().map(|v| v * v).sum::<f64>().sqrt();
    (normals, distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    /// Of two independent normals whose sum fails above 2 sqrt(2), the nearest failure is at (2, 2) / sqrt(2) standard deviations.
    #[test]
    fn the_nearest_failure_of_a_sum_lies_on_the_diagonal() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\noutputs = [{ name = \"a\" }]\n\
                    limit_states = [{ name = \"high\", output = \"a\", threshold = 5 }]\n\
                    life = { cycles = 3, checkpoint_every = 1 }\n\
                    variables = [{ name = \"x\", mean = 10, std = 2, distribution = \"normal\" },\n\
                    { name = \"y\", mean = -1, std = 0.5, distribution = \"normal\" }]\n";
        let scene = SceneSource::parse(text, "s").unwrap().nominal().clone();
        let population = Population::draw(crate::study::Problem::from_scene(&scene).inputs, 100_000, 3);
        let points: Vec<usize> = (0..population.len()).collect();
        let bound = 2.0 * 2.0f64.sqrt();
        // Few fail at the first checkpoint, P(v > 2) at the second, all at the last.
        let first = |j: usize| {
            let sum: f64 = population.standardised(j).iter().sum();
            if sum > 6.0 {
                0
            } else if sum > bound {
                1
            } else {
                2
            }
        };
        let first_failures = vec![points.iter().map(|j| first(*j)).collect::<Vec<u32>>()];
        let sampled = Sampled { population: &population, points: &points, probability: 1.0 };
        let [row] = &failure_points(&scene, &sampled, &first_failures)[..] else { panic!("one row") };
        assert_eq!((row.limit_state.as_str(), row.cycles), ("high", 2));
        assert!((row.failed - 0.02275).abs() < 4.0 * (0.02275f64 / 1e5).sqrt(), "{}", row.failed);
        assert!(row.distance >= 2.0 && row.distance < 2.05, "{}", row.distance);
        for (found, (mean, std)) in row.variables.iter().zip([(10.0, 2.0), (-1.0, 0.5)]) {
            assert!((found.value - mean - std * found.normal).abs() < 1e-9, "{found:?}");
            assert!((found.normal - 2.0f64.sqrt()).abs() < 0.5, "{found:?}");
        }
        let nothing = vec![vec![3; points.len()]];
        assert!(failure_points(&scene, &sampled, &nothing).is_empty());
    }
}
