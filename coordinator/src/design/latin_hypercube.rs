//! The initial design: points of the population chosen by Latin hypercube sampling.

use super::{Population, Stream, open_stream};
use common::random::Distribution;
use rand::RngExt;
use rayon::prelude::*;

/// Latin hypercube of `n` points in the variables' standardised units, `(n, d)` row-major [1]: in every variable
/// each of the n intervals of equal probability holds exactly one point.
///
/// # Source
/// McKay, Beckman, Conover (1979).
pub fn latin_hypercube(variables: &[Distribution], n: usize, seed: u64) -> Vec<f64> {
    let d = variables.len();
    let mut rng = open_stream(seed, Stream::Design);
    let mut z = vec![0.0; n * d];
    for (k, variable) in variables.iter().enumerate() {
        // Fisher-Yates permutation of the strata, then a uniform place within each.
        let mut strata: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            strata.swap(i, rng.random_range(0..=i));
        }
        for (i, stratum) in strata.iter().enumerate() {
            let x = variable.quantile((*stratum as f64 + rng.random::<f64>()) / n as f64);
            z[i * d + k] = (x - variable.parent_mean()) / variable.parent_std();
        }
    }
    z
}

/// Indices of `n` distinct points of the population, each the nearest free one (Euclidean distance in
/// standardised units, lowest index at a tie) to one point of a Latin hypercube; all points if there are fewer.
pub fn choose_by_latin_hypercube(population: &Population, n: usize, seed: u64) -> Vec<usize> {
    let n = n.min(population.len());
    let d = population.dimension();
    let targets = latin_hypercube(population.variables(), n, seed);
    let mut taken = vec![false; population.len()];
    let mut chosen = Vec::with_capacity(n);
    for target in targets.chunks_exact(d) {
        let nearest = (0..population.len())
            .into_par_iter()
            .filter(|j| !taken[*j])
            .map(|j| (squared_distance(population.standardised(j), target), j))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Some((_, j)) = nearest {
            taken[j] = true;
            chosen.push(j);
        }
    }
    chosen
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variables(d: usize) -> Vec<Distribution> {
        vec![Distribution::TruncatedNormal { mean: 1.0, std: 2.0, lower: -5.0, upper: 7.0 }; d]
    }

    #[test]
    fn every_stratum_holds_one_point() {
        let (n, d) = (50, 4);
        let z = latin_hypercube(&variables(d), n, 11);
        let unit = Distribution::TruncatedNormal { mean: 0.0, std: 1.0, lower: -3.0, upper: 3.0 };
        for k in 0..d {
            let mut strata: Vec<usize> =
                (0..n).map(|i| (unit.cdf(z[i * d + k]) * n as f64).floor() as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..n).collect::<Vec<_>>());
        }
    }

    #[test]
    fn chosen_points_are_distinct_and_reproducible() {
        let population = Population::draw(&variables(3), 300, 5);
        let chosen = choose_by_latin_hypercube(&population, 120, 5);
        let mut distinct = chosen.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), 120);
        assert_eq!(chosen, choose_by_latin_hypercube(&population, 120, 5));
        assert_eq!(choose_by_latin_hypercube(&population, 1000, 5).len(), 300);
    }
}
