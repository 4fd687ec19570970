//! Subset simulation: samples conditional on a rare event, through intermediate events each of which has the
//! share p0 = 0.1 of the one before.
//!
//! With y(u) the response in d independent standard normals u, failure at y >= 0, and levels b_1 < b_2 < ...
//! < b_k < 0:
//!
//!   P(y >= 0) = p0^k P(y >= 0 | y >= b_k),
//!
//! where b_(i+1) is the (1 - p0) quantile of y given y >= b_i. The samples of a level are Markov chains that
//! start at the samples of the level before that passed it: the proposal u' = rho u + sqrt(1 - rho^2) xi,
//! with xi standard normal, is accepted if y(u') >= b_i, else u is repeated. The chain is stationary under
//! the condition for any number of variables. The scale sqrt(1 - rho^2) is adapted towards an acceptance of
//! 0.44.
//!
//! The coefficient of variation of the estimate follows from the genealogy of the samples: with S_j the
//! number of samples beyond the limit that descend from sample j of the first level, and S = sum over j of
//! S_j,
//!
//!   cov^2 = sum over j of (S_j / S)^2,
//!
//! which contains the correlation of the levels. The part of the last share, (1 - p) / (p N) (1 + gamma) with
//!
//!   gamma = 2 sum over t of (1 - t / length) rho(t)
//!
//! from the autocorrelation rho(t) of the indicator along the chains, is subtracted to obtain the part of
//! p0^k, because the share is counted anew as surrogates learn. Levels treated as independent, sum over i of
//! (1 - p0) / (p0 N) (1 + gamma_i), would make it too small.
//!
//! Levels that no longer rise end the simulation: if the last rise was smaller than the one before, and as large
//! a rise at every level left would cover less than a hundredth of the distance to the limit, the limit lies
//! beyond what the response can reach, or at least beyond the levels.
//!
//! Valid for continuous responses; an event that consists of separate regions needs enough samples in each of
//! them at every level.
//!
//! # Source
//! Au, Beck (2001), Estimation of small failure probabilities in high dimensions by subset simulation,
//! Probabilistic Engineering Mechanics 16(4), also for gamma. Conditional sampling with adapted scale:
//! Papaioannou, Betz, Zwirglmaier, Straub (2015), MCMC algorithms for subset simulation, Probabilistic
//! Engineering Mechanics 41. Variance from the genealogy: Lee, Whiteley (2018), Variance estimation in the
//! particle filter, Biometrika 105(3).

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Share p0 of a level that passes to the next [1].
const SHARE: f64 = 0.1;
/// Acceptance to which the scale of the proposals is adapted [1].
const ACCEPTANCE: f64 = 0.44;
/// Scale sqrt(1 - rho^2) of the first proposals [1].
const FIRST_SCALE: f64 = 0.6;
/// Share of the distance to the limit that the levels left must cover at the last rise [1].
const LEAST_RISE: f64 = 0.01;

/// The responses `(k,)` at points `(k, d)` row-major of independent standard normals.
pub type Responses<'a> = dyn Fn(&[f64]) -> Vec<f64> + 'a;

/// Samples conditional on the last level, and the probability of that level.
#[derive(Debug, Clone, PartialEq)]
pub struct Subset {
    /// Independent standard normals `(N, d)` row-major [1]; y >= the last level at each.
    pub u: Vec<f64>,
    /// Response y of each sample `(N,)`.
    pub y: Vec<f64>,
    /// Probability of the last level [1].
    pub probability: f64,
    /// Coefficient of variation of that probability [1].
    pub cov: f64,
    /// Intermediate levels b_i, ascending; none if the event is not rare.
    pub levels: Vec<f64>,
    /// Effect of the correlation along the chains [1]: the variance of the failed share is larger by the
    /// factor 1 + gamma.
    pub gamma: f64,
    /// Index of the independent sample of the first level from which each sample descends `(N,)`.
    pub origin: Vec<u32>,
}

impl Subset {
    /// Share of the samples at or beyond the limit [1]; zero if the limit was not reached within the allowed
    /// levels.
    pub fn failed_share(&self) -> f64 {
        self.y.iter().filter(|y| **y >= 0.0).count() as f64 / self.y.len() as f64
    }
}

/// Size of a subset simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubsetSimulation {
    /// Number d of independent standard normal variables.
    pub variables: usize,
    /// Number N of samples of each level, a multiple of ten.
    pub samples: usize,
    /// Largest number of levels.
    pub most_levels: usize,
}

/// Samples of one level.
struct LevelSamples {
    /// Independent standard normals `(N, d)` row-major [1].
    u: Vec<f64>,
    /// Responses of the samples `(N,)`.
    y: Vec<f64>,
    /// Index of the sample of the first level from which each descends `(N,)`.
    origin: Vec<usize>,
    /// Length of the chains; 1 for independent samples.
    length: usize,
}

impl SubsetSimulation {
    /// Runs the simulation. `respond` returns the responses `(k,)` at points `(k, d)` row-major.
    pub fn run(&self, rng: &mut impl Rng, respond: &Responses<'_>) -> Subset {
        let Self { variables, samples: n, most_levels } = *self;
        let u: Vec<f64> = (0..n * variables).map(|_| StandardNormal.sample(rng)).collect();
        let y = respond(&u);
        let mut samples = LevelSamples { u, y, origin: (0..n).collect(), length: 1 };
        let (mut probability, mut levels) = (1.0, Vec::new());
        let mut scale = FIRST_SCALE;
        let seeds = (SHARE * n as f64).round() as usize;
        while levels.len() < most_levels {
            if samples.y.iter().filter(|y| **y >= 0.0).count() >= seeds {
                break;
            }
            let (level, from) = next_level(&samples.y, seeds);
            if no_longer_rise(&levels, level, most_levels) {
                break;
            }
            probability *= SHARE;
            levels.push(level);
            samples = self.advance_chains(&samples, &from, level, &mut scale, rng, respond);
        }
        let LevelSamples { u, y, origin, length } = samples;
        let gamma = chain_correlation(&y, 0.0, length).max(0.0);
        let cov = if levels.is_empty() { 0.0 } else { level_variation(&y, &origin, gamma) };
        let origin = origin.into_iter().map(|j| u32::try_from(j).expect("fewer than 2^32 samples")).collect();
        Subset { u, y, probability, cov, levels, gamma, origin }
    }

    /// Samples of the next level: one chain from each sample `from` of the level before, step t of all chains
    /// together. Adapts the scale of the proposals after each step.
    fn advance_chains(
        &self,
        before: &LevelSamples,
        from: &[usize],
        level: f64,
        scale: &mut f64,
        rng: &mut impl Rng,
        respond: &Responses<'_>,
    ) -> LevelSamples {
        let (d, seeds) = (self.variables, from.len());
        let length = self.samples / seeds;
        let mut state_u: Vec<f64> =
            from.iter().flat_map(|j| before.u[j * d..(j + 1) * d].iter().copied()).collect();
        let mut state_y: Vec<f64> = from.iter().map(|j| before.y[*j]).collect();
        let (mut u, mut y) = (state_u.clone(), state_y.clone());
        for _ in 1..length {
            let rho = (1.0 - *scale * *scale).sqrt();
            let mut xi = || -> f64 { StandardNormal.sample(rng) };
            let proposed: Vec<f64> = state_u.iter().map(|u| rho * u + *scale * xi()).collect();
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
            *scale = (*scale * ((acceptance - ACCEPTANCE) / 2.0).exp()).clamp(0.01, 1.0);
            u.extend_from_slice(&state_u);
            y.extend_from_slice(&state_y);
        }
        let parents: Vec<usize> = from.iter().map(|j| before.origin[*j]).collect();
        let origin = parents.iter().copied().cycle().take(length * seeds).collect();
        LevelSamples { u, y, origin, length }
    }
}

/// The next level, which `seeds` of the responses pass, and the indices of those that do, ascending.
fn next_level(y: &[f64], seeds: usize) -> (f64, Vec<usize>) {
    let mut order: Vec<usize> = (0..y.len()).collect();
    order.sort_by(|a, b| y[*b].total_cmp(&y[*a]).then(a.cmp(b)));
    let level = 0.5 * (y[order[seeds - 1]] + y[order[seeds]]);
    let mut from: Vec<usize> = order[..seeds].to_vec();
    from.sort_unstable();
    (level, from)
}

/// True if the next `level` rises less than the one before it did, and too little to reach the limit in `most`
/// levels.
fn no_longer_rise(levels: &[f64], level: f64, most: usize) -> bool {
    let [.., earlier, last] = levels else { return levels.last().is_some_and(|last| level <= *last) };
    let (rise, before) = (level - last, last - earlier);
    let left = (most - levels.len()) as f64;
    rise <= 0.0 || (rise < before && rise * left < LEAST_RISE * -last)
}

/// Coefficient of variation [1] of the last level's probability, from the genealogy of the samples beyond the
/// limit, or of all samples if none is.
fn level_variation(y: &[f64], origin: &[usize], gamma: f64) -> f64 {
    let any = y.iter().any(|y| *y >= 0.0);
    let mut descendants = vec![0.0; y.len()];
    origin.iter().zip(y).filter(|(_, y)| !any || **y >= 0.0).for_each(|(j, _)| descendants[*j] += 1.0);
    let sum: f64 = descendants.iter().sum();
    let all = descendants.iter().map(|s| (s / sum).powi(2)).sum::<f64>();
    let (share, n) = (sum / y.len() as f64, y.len() as f64);
    let last = (1.0 - share) / (share * n) * (1.0 + gamma);
    (all - last).max(0.0).sqrt()
}

/// gamma [1] of the indicator y >= level over chains of `length` samples; the samples are ordered step by
/// step, all chains of a step together. Zero if the indicator is constant.
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

    /// Estimate and stated coefficient of variation for a linear response of reliability index beta in d
    /// variables.
    fn linear(d: usize, beta: f64, n: usize, seed: u64) -> (f64, f64) {
        let respond = |u: &[f64]| -> Vec<f64> {
            u.chunks_exact(d).map(|u| u.iter().sum::<f64>() / (d as f64).sqrt() - beta).collect()
        };
        let mut rng = ChaCha12Rng::seed_from_u64(seed);
        let subset = SubsetSimulation { variables: d, samples: n, most_levels: 14 }.run(&mut rng, &respond);
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
    fn a_frequent_event_needs_no_level_and_an_impossible_one_ends() {
        let mut rng = ChaCha12Rng::seed_from_u64(1);
        let run = |most_levels, rng: &mut ChaCha12Rng, respond: fn(&[f64]) -> Vec<f64>| {
            SubsetSimulation { variables: 1, samples: 1000, most_levels }.run(rng, &respond)
        };
        let often = run(9, &mut rng, |u| u.iter().map(|u| u - 0.5).collect());
        assert_eq!((often.levels.len(), often.probability, often.cov), (0, 1.0, 0.0));
        let never = run(3, &mut rng, |u| u.iter().map(|u| u.tanh() - 2.0).collect());
        assert_eq!((never.levels.len(), never.failed_share()), (3, 0.0));
        assert!((never.probability - 1e-3).abs() < 1e-15);
    }

    #[test]
    fn issue_levels_of_an_impossible_event_end_when_they_no_longer_rise() {
        // The sum of two uniforms never reaches 10.
        let sum = |u: &[f64]| -> Vec<f64> {
            u.chunks_exact(2).map(|u| standard_normal_cdf(u[0]) + standard_normal_cdf(u[1]) - 10.0).collect()
        };
        let mut rng = ChaCha12Rng::seed_from_u64(1);
        let subset = SubsetSimulation { variables: 2, samples: 2000, most_levels: 12 }.run(&mut rng, &sum);
        assert!(subset.levels.len() < 8 && subset.failed_share() == 0.0, "{:?}", subset.levels);
        // A constant response has no level at all above the first.
        let constant = |u: &[f64]| vec![-1.0; u.len() / 2];
        let subset =
            SubsetSimulation { variables: 2, samples: 2000, most_levels: 12 }.run(&mut rng, &constant);
        assert_eq!(subset.levels.len(), 1);
    }
}
