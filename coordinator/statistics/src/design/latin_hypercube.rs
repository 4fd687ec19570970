//! Latin hypercube sampling of the random variables.
//!
//! In every coordinate each of the n intervals of equal probability holds exactly one point: point i lies at
//! the probability p_ik = (pi_k(i) + U_ik) / n, with pi_k a random permutation of 0 .. n - 1 and U_ik uniform
//! in (0, 1), and x_ik = F_k^-1(p_ik). Correlated variables are stratified in their independent normals, from which the copula
//! makes them, see [`InputModel`]: so every point has the joint distribution of the variables. (Giving every variable
//! the interval of its rank instead adds the scatter within an interval to a difference of two strongly correlated variables.)
//!
//! # Source
//! McKay, Beckman, Conover (1979), A comparison of three methods for selecting values of input variables in
//! the analysis of output from a computer code, Technometrics 21(2).

use super::{InputModel, Stream, open_stream};
use rand::RngExt;

/// A Latin hypercube of `n` points under `seed`, in standardised units `(n, d)` row-major [1].
pub fn latin_hypercube(inputs: &InputModel, n: usize, seed: u64) -> Vec<f64> {
    let d = inputs.dimension();
    let mut rng = open_stream(seed, Stream::Design);
    let mut p = vec![0.0; n * d];
    for k in 0..d {
        // Fisher-Yates permutation of the strata, then a uniform place within each.
        let mut order: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            order.swap(i, rng.random_range(0..=i));
        }
        for (i, stratum) in order.iter().enumerate() {
            let within = rng.random::<f64>();
            p[i * d + k] = ((*stratum as f64 + within) / n as f64).max(f64::EPSILON / 4.0);
        }
    }
    p.chunks_exact(d).flat_map(|p| inputs.standardise(&inputs.from_uniforms(p))).collect()
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
        let z = latin_hypercube(&InputModel::from(&variables(d)), n, 11);
        for k in 0..d {
            let mut strata: Vec<usize> =
                column(&z, k, d).iter().map(|z| (unit.cdf(*z) * n as f64).floor() as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..n).collect::<Vec<_>>());
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

    /// The difference of two normals with correlation r has the variance 2 (1 - r), of which strata of ranks left nothing.
    #[test]
    fn issue_strong_correlations_were_lost_between_few_points() {
        let pair = Correlation { first: 0, second: 1, coefficient: 0.9999 };
        let unit = vec![Distribution::normal(0.0, 1.0).unwrap(); 2];
        let inputs = InputModel::new(unit, GaussianCopula::new(2, &[pair]).unwrap());
        let n = 40;
        let z = latin_hypercube(&inputs, n, 3);
        let variance = z.chunks_exact(2).map(|z| (z[0] - z[1]).powi(2)).sum::<f64>() / n as f64;
        assert!((0.5..1.5).contains(&(variance / 2e-4)), "{variance:e}");
    }
}
