//! Subset simulation: samples conditional on a rare event, by intermediate events that each have the share p0 of the one
//! before.
//!
//! With y(u) the response in independent standard normals u, failing at y >= 0, and levels b_1 < b_2 < ... < 0:
//! P(y >= 0) = p0^k P(y >= 0 | y >= b_k), where b_(i+1) is the (1 - p0) quantile of y given y >= b_i. Samples of a level are Markov
//! chains from those of the one before that passed it, u' = rho u + sqrt(1 - rho^2) xi accepted where y(u') >= b_i: stationary under the
//! condition, whatever the number of variables. The scale sqrt(1 - rho^2) follows the acceptance, towards 0.44.
//!
//! The coefficient of variation of the estimate follows from the descent of the samples: with S_j the number of those beyond the
//! limit that descend from sample j of the first level and S = sum_j S_j,
//!
//!   cov^2 = sum_j (S_j / S)^2,
//!
//! which has the correlation of the levels in it. That of the last share alone, (1 - p) / (p N) (1 + gamma) with gamma from the
//! correlation of the indicator along the chains, is taken off for that of p0^k, since the share is counted anew as surrogates
//! learn. Levels that count as independent, sum_i (1 - p0) / (p0 N) (1 + gamma_i), make it too small.
//!
//! Source: Au, Beck (2001), eqs. 12 to 29; the chains, Papaioannou et al. (2015), section 3.3; the variance, Lee, Whiteley (2018),
//! Variance estimation in the particle filter.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Share of a level that passes to the next.
const SHARE: f64 = 0.1;
/// Acceptance that the step of the chains is led to.
const ACCEPTANCE: f64 = 0.44;

/// Samples conditional on the last level.
#[derive(Debug, Clone, PartialEq)]
pub struct Subset {
    /// Independent standard normals `(N, d)` row-major, y >= the last level.
    pub u: Vec<f64>,
    /// Response y of each `(N,)`.
    pub y: Vec<f64>,
    /// Probability of the last level [1].
    pub probability: f64,
    /// Its coefficient of variation [1].
    pub cov: f64,
    /// Intermediate levels, ascending; none if the event is not rare.
    pub levels: Vec<f64>,
    /// Factor by which the chains' correlation makes the variance of the failed share larger, less 1 [1].
    pub gamma: f64,
}

impl Subset {
    /// Share of the samples at or beyond the limit [1]; zero if it was not reached in the levels allowed.
    pub fn failed_share(&self) -> f64 {
        self.y.iter().filter(|y| **y >= 0.0).count() as f64 / self.y.len() as f64
    }
}

/// Runs up to `most` levels of `n` samples (a multiple of ten) of `d` variables. `respond` gives y at points `(k, d)` row-major.
pub fn subset_simulation(
    (d, n, most): (usize, usize, usize),
    rng: &mut impl Rng,
    respond: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Subset {
    let mut u: Vec<f64> = (0..n * d).map(|_| StandardNormal.sample(rng)).collect();
    let mut y = respond(&u);
    let (mut probability, mut levels) = (1.0, Vec::new());
    // The sample of the first level that each descends from.
    let mut origin: Vec<usize> = (0..n).collect();
    // Samples of the level by chain, for the correlation of the indicator; independent at first.
    let mut length = 1;
    let mut scale: f64 = 0.6;
    let seeds = (SHARE * n as f64).round() as usize;
    while levels.len() < most {
        let failed = y.iter().filter(|y| **y >= 0.0).count();
        if failed >= seeds {
            break;
        }
        // The seeds: the largest responses, in the order of the samples.
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| y[*b].total_cmp(&y[*a]).then(a.cmp(b)));
        let level = 0.5 * (y[order[seeds - 1]] + y[order[seeds]]);
        let mut from: Vec<usize> = order[..seeds].to_vec();
        from.sort_unstable();
        probability *= SHARE;
        levels.push(level);

        // One chain a seed; step t of all chains side by side.
        length = n / seeds;
        let mut state_u: Vec<f64> = from.iter().flat_map(|j| u[j * d..(j + 1) * d].iter().copied()).collect();
        let mut state_y: Vec<f64> = from.iter().map(|j| y[*j]).collect();
        let (mut next_u, mut next_y) = (state_u.clone(), state_y.clone());
        for _ in 1..length {
            let rho = (1.0 - scale * scale).sqrt();
            let normal = |u: &f64, rng: &mut _| {
                let xi: f64 = StandardNormal.sample(rng);
                rho * u + scale * xi
            };
            let proposed: Vec<f64> = state_u.iter().map(|u| normal(u, rng)).collect();
            let response = respond(&proposed);
            let mut accepted = 0;
            for (i, y) in response.into_iter().enumerate() {
                if y >= level {
                    state_u[i * d..(i + 1) * d].copy_from_slice(&proposed[i * d..(i + 1) * d]);
                    state_y[i] = y;
                    accepted += 1;
                }
            }
            let acceptance = f64::from(accepted) / seeds as f64;
            scale = (scale * ((acceptance - ACCEPTANCE) / 2.0).exp()).clamp(0.01, 1.0);
            next_u.extend_from_slice(&state_u);
            next_y.extend_from_slice(&state_y);
        }
        (u, y) = (next_u, next_y);
        let parents: Vec<usize> = from.iter().map(|j| origin[*j]).collect();
        origin = parents.iter().copied().cycle().take(length * seeds).collect();
    }
    let gamma = chain_correlation(&y, 0.0, length).max(0.0);
    let cov = if levels.is_empty() { 0.0 } else { level_variation(&y, &origin, gamma) };
    Subset { u, y, probability, cov, levels, gamma }
}

/// Coefficient of variation of the last level's probability, from the descent of the samples beyond the limit, or where there are
/// none of all samples.
fn level_variation(y: &[f64], origin: &[usize], gamma: f64) -> f64 {
    let any = y.iter().any(|y| *y >= 0.0);
    let mut descendants = vec![0.0; y.len()];
    let counted = origin.iter().zip(y).filter(|(_, y)| !any || **y >= 0.0);
    counted.for_each(|(j, _)| descendants[*j] += 1.0);
    let sum: f64 = descendants.iter().sum();
    let all = descendants.iter().map(|s| (s / sum).powi(2)).sum::<f64>();
    let (share, n) = (sum / y.len() as f64, y.len() as f64);
    let last = (1.0 - share) / (share * n) * (1.0 + gamma);
    (all - last).max(0.0).sqrt()
}

/// gamma = 2 sum_t (1 - t / length) rho(t), with rho(t) the correlation of the indicator y >= level at t steps' distance along the chains;
/// samples stand step after step, all chains of a step together.
fn chain_correlation(y: &[f64], level: f64, length: usize) -> f64 {
    let chains = y.len() / length;
    let passed: Vec<f64> = y.iter().map(|y| f64::from(u8::from(*y >= level))).collect();
    let mean = passed.iter().sum::<f64>() / y.len() as f64;
    let variance = mean * (1.0 - mean);
    if variance <= 0.0 {
        return 0.0;
    }
    let covariance = |t: usize| {
        let pairs = (length - t) * chains;
        let products = passed[..pairs].iter().zip(&passed[t * chains..]).map(|(a, b)| a * b);
        products.sum::<f64>() / pairs as f64 - mean * mean
    };
    2.0 * (1..length).map(|t| (1.0 - t as f64 / length as f64) * covariance(t) / variance).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::standard_normal_cdf;
    use rand_chacha::ChaCha12Rng;
    use rand_chacha::rand_core::SeedableRng;

    /// Estimate and stated coefficient of variation for a linear response of reliability index beta in d variables.
    fn linear(d: usize, beta: f64, n: usize, seed: u64) -> (f64, f64) {
        let respond = |u: &[f64]| -> Vec<f64> {
            u.chunks_exact(d).map(|u| u.iter().sum::<f64>() / (d as f64).sqrt() - beta).collect()
        };
        let mut rng = ChaCha12Rng::seed_from_u64(seed);
        let subset = subset_simulation((d, n, 14), &mut rng, &respond);
        let share = subset.failed_share();
        let level = *subset.levels.last().unwrap();
        assert!(subset.y.iter().all(|y| *y >= level) && share >= 0.1);
        assert_eq!((subset.u.len(), subset.y.len()), (n * d, n));
        let last = (1.0 - share) / (share * n as f64) * (1.0 + subset.gamma);
        (subset.probability * share, (subset.cov * subset.cov + last).sqrt())
    }

    #[test]
    fn rare_events_of_few_and_many_variables_are_found_within_their_stated_error() {
        for (d, beta) in [(2, 4.0), (2, 6.0), (40, 4.75), (100, 3.0)] {
            let exact = standard_normal_cdf(-beta);
            let mut squares = 0.0;
            for seed in 0..10 {
                let (pf, cov) = linear(d, beta, 4000, seed);
                let distance = (pf / exact - 1.0) / cov;
                assert!(distance.abs() < 4.0, "{d} {beta} {seed}: {pf} {exact} {cov}");
                squares += distance * distance / 10.0;
            }
            // Ten standardised squares: 1 on the average, with a standard deviation of 0.45.
            assert!(squares < 2.0, "{d} {beta}: {squares}");
        }
    }

    #[test]
    fn what_is_not_rare_needs_no_level_and_what_never_happens_ends() {
        let mut rng = ChaCha12Rng::seed_from_u64(1);
        let often = subset_simulation((1, 1000, 9), &mut rng, &|u| u.iter().map(|u| u - 0.5).collect());
        assert_eq!((often.levels.len(), often.probability, often.cov), (0, 1.0, 0.0));
        let never =
            subset_simulation((1, 1000, 3), &mut rng, &|u| u.iter().map(|u| u.tanh() - 2.0).collect());
        assert_eq!((never.levels.len(), never.failed_share()), (3, 0.0));
        assert!((never.probability - 1e-3).abs() < 1e-15);
    }
}
