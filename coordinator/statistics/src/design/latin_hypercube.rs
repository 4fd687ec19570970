//! Latin hypercube sampling of the random variables.
//!
//! In every variable each of the n intervals of equal probability holds exactly one point: point i lies at
//! the probability p_ik = (pi_k(i) + U_ik) / n, with pi_k a random permutation of 0 .. n - 1 and U_ik uniform
//! in (0, 1), and x_ik = F_k^-1(p_ik). Correlated variables keep the order of the points among their
//! correlated normals: each point takes the interval of its rank, so the correlation is that of the ranks.
//!
//! # Source
//! McKay, Beckman, Conover (1979), A comparison of three methods for selecting values of input variables in
//! the analysis of output from a computer code, Technometrics 21(2); with correlations by ranks Stein (1987),
//! Large sample properties of simulations using Latin hypercube sampling, Technometrics 29(2).

use super::{InputModel, Stream, open_stream};
use common::random::standard_normal_quantile;
use rand::RngExt;

/// A Latin hypercube of `n` points under `seed`, in standardised units `(n, d)` row-major [1].
pub fn latin_hypercube(inputs: &InputModel, n: usize, seed: u64) -> Vec<f64> {
    let d = inputs.dimension();
    let mut rng = open_stream(seed, Stream::Design);
    // Stratum of every point, and its place within the stratum in (0, 1) `(n, d)`.
    let mut strata = vec![0; n * d];
    let mut within = vec![0.0; n * d];
    for k in 0..d {
        // Fisher-Yates permutation of the strata, then a uniform place within each.
        let mut order: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            order.swap(i, rng.random_range(0..=i));
        }
        for (i, stratum) in order.iter().enumerate() {
            strata[i * d + k] = *stratum;
            within[i * d + k] = rng.random::<f64>();
        }
    }
    let place = |stratum: usize, within: f64| ((stratum as f64 + within) / n as f64).max(f64::EPSILON / 4.0);
    if !inputs.copula.is_independent() {
        reorder(inputs, n, &mut strata, |i, stratum| standard_normal_quantile(place(stratum, within[i])));
    }
    let mut z = vec![0.0; n * d];
    for (k, variable) in inputs.variables().iter().enumerate() {
        for i in (k..n * d).step_by(d) {
            z[i] = inputs.standardised_value(k, variable.quantile(place(strata[i], within[i])));
        }
    }
    z
}

/// Sets the stratum of every point of a correlated variable to its rank among the variable's correlated
/// normals; `normal` returns the independent normal of an entry of the strata `(n, d)`.
fn reorder(inputs: &InputModel, n: usize, strata: &mut [usize], normal: impl Fn(usize, usize) -> f64) {
    let d = inputs.dimension();
    let v: Vec<f64> = strata.iter().enumerate().map(|(i, stratum)| normal(i, *stratum)).collect();
    let u: Vec<Vec<f64>> = v.chunks_exact(d).map(|v| inputs.copula.correlate(v)).collect();
    for k in (0..d).filter(|k| inputs.copula.is_correlated(*k)) {
        let mut points: Vec<usize> = (0..n).collect();
        points.sort_by(|a, b| u[*a][k].total_cmp(&u[*b][k]));
        for (rank, i) in points.into_iter().enumerate() {
            strata[i * d + k] = rank;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Correlation, Distribution, GaussianCopula};

    fn variables(d: usize) -> Vec<Distribution> {
        vec![Distribution::truncated_normal(1.0, 2.0, -5.0, 7.0).unwrap(); d]
    }

    /// Every variable correlated to the one before it.
    fn chained(d: usize) -> InputModel {
        let pairs: Vec<_> =
            (1..d).map(|k| Correlation { first: k - 1, second: k, coefficient: 0.6 }).collect();
        InputModel::new(variables(d), GaussianCopula::new(d, &pairs).unwrap())
    }

    fn column(z: &[f64], k: usize, d: usize) -> Vec<f64> {
        z.iter().skip(k).step_by(d).copied().collect()
    }

    #[test]
    fn every_stratum_holds_one_point() {
        let (n, d) = (50, 4);
        let unit = Distribution::truncated_normal(0.0, 1.0, -3.0, 3.0).unwrap();
        for inputs in [InputModel::from(&variables(d)), chained(d)] {
            let z = latin_hypercube(&inputs, n, 11);
            for k in 0..d {
                let mut strata: Vec<usize> =
                    column(&z, k, d).iter().map(|z| (unit.cdf(*z) * n as f64).floor() as usize).collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..n).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn neighbours_of_a_chain_are_correlated() {
        let (n, d) = (400, 3);
        let z = latin_hypercube(&chained(d), n, 5);
        let columns: Vec<_> = (0..d).map(|k| column(&z, k, d)).collect();
        for (i, j, expected) in [(0, 1, 0.6), (1, 2, 0.6)] {
            let sum = |f: &dyn Fn(f64, f64) -> f64| {
                columns[i].iter().zip(&columns[j]).map(|(a, b)| f(*a, *b)).sum::<f64>()
            };
            let found = sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
            // Standard error of a correlation coefficient: (1 - rho^2) / sqrt(n).
            let error = (1.0 - expected * expected) / (n as f64).sqrt();
            assert!((found - expected).abs() < 4.0 * error, "{i} {j} {found}");
        }
    }
}
