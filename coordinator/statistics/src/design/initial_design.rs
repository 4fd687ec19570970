//! The initial design: the points of the population nearest to a Latin hypercube.
//!
//! Choosing among the population keeps every simulated point a sample of the variables, whose classification
//! counts.
//!
//! # Source
//! A design among the Monte Carlo population: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2);
//! the nearest points to a Latin hypercube: Cui et al. (2026), China Mechanical Engineering 37(6), 1472-1485,
//! doi 10.3969/j.issn.1004-132X.2026.06.020, who choose the design by Latin hypercube.

use super::{Population, latin_hypercube};
use rayon::prelude::*;

/// Returns the indices of `n` distinct points of the population, each the nearest free one (Euclidean
/// distance in standardised units, lowest index at a tie) to one point of a Latin hypercube under `seed`; all
/// points if the population has fewer.
pub fn choose_by_latin_hypercube(population: &Population, n: usize, seed: u64) -> Vec<usize> {
    let n = n.min(population.len());
    let d = population.dimension();
    let targets = latin_hypercube(population.inputs(), n, seed);
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
    use common::random::Distribution;

    fn variables(d: usize) -> Vec<Distribution> {
        vec![Distribution::truncated_normal(1.0, 2.0, -5.0, 7.0).unwrap(); d]
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
