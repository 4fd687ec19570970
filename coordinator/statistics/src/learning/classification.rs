//! Classification of the population by the surrogate of one mode.
//!
//! At checkpoint n point j has failed if
//!
//!   max over k <= n of mean_k(x_j) + sigma_k s(x_j) zeta_j >= threshold,
//!
//! with mean_k the Kriging mean of the running maximum at checkpoint k, the process standard deviation sigma_k
//! [unit of the output], the variance factor s^2 [1] of the prediction, and zeta_j a standard normal number of
//! its own for every point and mode ([`deviation`]). The share of the points that failed is then the
//! posterior mean of the failure probability,
//!
//!   E P_f = mean over j of Phi((mean_n(x_j) - threshold) / (sigma_n s(x_j))),
//!
//! up to a scatter of sqrt(sum of Phi (1 - Phi)) / N, which is below that of counting. Counting the means instead
//! takes every place where no simulation has been for safe where failures are the exception: regions not yet
//! found are missing from such a count.
//!
//! The learning function of a point is
//!
//!   U(x, n) = |mean_n(x) - threshold| / (sigma_n s(x)),
//!
//! with the running maximum of the means. Phi(-U) is the probability that the sign of the prediction is wrong, if
//! the response is Gaussian as the surrogate assumes.
//!
//! # Source
//! U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2). Posterior mean of the failure
//! probability: Dubourg, Sudret, Deheeger (2013), Metamodel-based importance sampling for structural reliability
//! analysis, Probabilistic Engineering Mechanics 33.

use crate::design::{Population, deviation};
use crate::surrogate::{Kriging, PredictionCache};
use faer::Mat;
use rayon::prelude::*;

/// Number of points predicted together.
const BLOCK: usize = PredictionCache::BLOCK;

/// Prediction of one mode over N points.
#[derive(Debug, Clone)]
pub struct Classification {
    /// Running maximum of the predicted mean at the a checkpoints of the grid `(N, a)`, row-major
    /// [unit of output].
    pub mean: Vec<f64>,
    /// Variance of the prediction over the process variance `(N,)` [1].
    pub variance_factor: Vec<f64>,
    /// Process standard deviation at the checkpoints of the grid `(a,)`, enlarged by
    /// [`ClassifiedMode::inflation`] [unit of output].
    pub sigma: Vec<f64>,
    /// Index of the checkpoint by which the point is taken to have failed `(N,)`; m if never.
    pub first_failure: Vec<u32>,
    /// Threshold of the mode [unit of the output].
    pub threshold: f64,
}

impl Classification {
    /// Number a of checkpoints of the grid.
    pub fn grid(&self) -> usize {
        self.sigma.len()
    }

    /// Running maximum of the predicted mean of point `j` `(a,)` [unit of the output].
    pub fn means_of(&self, j: usize) -> &[f64] {
        &self.mean[j * self.grid()..(j + 1) * self.grid()]
    }

    /// U = |mean - threshold| / standard deviation [1] of point `j` at grid checkpoint `n`; infinite where
    /// the standard deviation is zero.
    pub fn u(&self, j: usize, n: usize) -> f64 {
        distance_over_std(
            self.means_of(j)[n] - self.threshold,
            self.sigma[n] * self.variance_factor[j].sqrt(),
        )
    }
}

/// |distance| / std [1]; infinite for a certain prediction (std zero).
pub(super) fn distance_over_std(distance: f64, std: f64) -> f64 {
    if std > 0.0 { distance.abs() / std } else { f64::INFINITY }
}

/// The limit state by which a population is classified.
#[derive(Debug, Clone, Copy)]
pub struct ClassifiedMode<'a> {
    /// Index of the mode: that of its deviations.
    pub index: usize,
    /// Threshold [unit of the output].
    pub threshold: f64,
    /// Indices of the checkpoints at which means are kept `(a,)`, ascending.
    pub grid: &'a [usize],
    /// Factor by which predicted variances are enlarged [1].
    pub inflation: f64,
    /// True if the share of points that failed is counted by their means, as in AK-MCS.
    pub by_mean: bool,
}

/// Classifies the population by a model whose m outputs are the checkpoints of one mode. The result does not
/// depend on the number of threads: blocks are fixed and independent.
pub fn classify(model: &Kriging, population: &Population, mode: &ClassifiedMode<'_>) -> Classification {
    classify_blocks(population.len(), model, mode, |block| predict_block(model, population, block))
}

/// Classifies the population as [`classify`] does, through a cache of this mode's predictions, which is
/// updated first. Blocks that the cache has no room for are predicted. If the model is that of the last call with more points at the same lengths
/// ([`Kriging::extended`]), only the new points are computed.
pub fn classify_cached(
    cache: &mut PredictionCache,
    model: &Kriging,
    population: &Population,
    mode: &ClassifiedMode<'_>,
) -> Classification {
    cache.update(model, population);
    classify_blocks(population.len(), model, mode, |block| {
        cache.block(block).map_or_else(
            || predict_block(model, population, block),
            |prediction| (prediction.mean, prediction.variance_factor),
        )
    })
}

/// Means `(m, b)` [unit of the output] and variance factors `(b,)` [1] of one block.
fn predict_block(model: &Kriging, population: &Population, block: usize) -> (Mat<f64>, Vec<f64>) {
    let start = block * BLOCK;
    let prediction = model.predict(population.columns(start..population.len().min(start + BLOCK)));
    (prediction.mean, prediction.variance_factor)
}

/// Classifies `points` points from the means `(m, b)` and variance factors `(b,)` that `predict` returns for
/// each block.
fn classify_blocks(
    points: usize,
    model: &Kriging,
    classified: &ClassifiedMode<'_>,
    predict: impl Fn(usize) -> (Mat<f64>, Vec<f64>) + Sync,
) -> Classification {
    let ClassifiedMode { index, threshold, grid, inflation, by_mean } = *classified;
    let deviations = if by_mean { 0.0 } else { 1.0 };
    let sigma: Vec<f64> = model.sigma2().iter().map(|sigma2| (sigma2 * inflation).sqrt()).collect();
    let a = grid.len();
    let mut mean = vec![0.0; points * a];
    let mut variance_factor = vec![0.0; points];
    let mut first_failure = vec![0; points];
    mean.par_chunks_mut(BLOCK * a)
        .zip(variance_factor.par_chunks_mut(BLOCK))
        .zip(first_failure.par_chunks_mut(BLOCK))
        .enumerate()
        .for_each(|(block, ((mean, variance_factor), first_failure))| {
            let (means, factors) = predict(block);
            variance_factor.copy_from_slice(&factors);
            for (j, first) in first_failure.iter_mut().enumerate() {
                let history = means.col_as_slice(j);
                let in_sigma = deviations * factors[j].max(0.0).sqrt() * deviation(index, block * BLOCK + j);
                let reached = |(y, sigma): (&f64, &f64)| y + sigma * in_sigma >= threshold;
                let failed = history.iter().zip(&sigma).position(reached).unwrap_or(history.len());
                *first = u32::try_from(failed).expect("a life has fewer than 2^32 checkpoints");
                let (mut largest, mut next) = (f64::NEG_INFINITY, 0);
                for (n, kept) in grid.iter().zip(&mut mean[j * a..(j + 1) * a]) {
                    largest = history[next..=*n].iter().copied().fold(largest, f64::max);
                    next = n + 1;
                    *kept = largest;
                }
            }
        });
    let sigma = grid.iter().map(|n| sigma[*n]).collect();
    Classification { mean, variance_factor, sigma, first_failure, threshold }
}

/// First failures of the modes `(modes)(N,)` and of the system, the last row.
pub fn with_system(mut first_failures: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    let earliest = |j: usize| first_failures.iter().map(|first| first[j]).min().unwrap_or(0);
    let system = (0..first_failures[0].len()).map(earliest).collect();
    first_failures.push(system);
    first_failures
}

/// Failure shares by checkpoint `(modes + 1, m)` [1], each mode alone and last the system, from the first
/// failures of the modes `(modes, N)`; `m` is the number of checkpoints.
pub fn curves<F: AsRef<[u32]>>(first_failures: &[F], m: usize) -> Vec<Vec<f64>> {
    let points = first_failures[0].as_ref().len();
    let share = |first: &mut dyn Iterator<Item = u32>| {
        let mut counts = vec![0usize; m + 1];
        first.for_each(|n| counts[n as usize] += 1);
        let mut failed = 0;
        let cumulate = |count: &usize| {
            failed += count;
            failed as f64 / points as f64
        };
        counts[..m].iter().map(cumulate).collect::<Vec<f64>>()
    };
    let mut curves: Vec<Vec<f64>> =
        first_failures.iter().map(|first| share(&mut first.as_ref().iter().copied())).collect();
    let earliest = |j: usize| first_failures.iter().map(|first| first.as_ref()[j]).min().unwrap_or(0);
    curves.push(share(&mut (0..points).map(earliest)));
    curves
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Correlation, Kernel};
    use common::random::{Distribution, standard_normal_cdf};

    #[test]
    fn curves_count_each_mode_and_the_first_of_them() {
        let (a, b) = ([0, 2, 3, 3], [3, 1, 3, 2]);
        let curves = curves(&[&a, &b], 3);
        assert_eq!(curves[0], vec![0.25, 0.25, 0.5]);
        assert_eq!(curves[1], vec![0.0, 0.25, 0.5]);
        assert_eq!(curves[2], vec![0.25, 0.5, 0.75]);
    }

    #[test]
    fn a_region_without_simulations_counts_with_its_probability() {
        // Simulated near zero only, where the response is 0: beyond a few lengths the prediction is the mean of
        // zero again, with a standard deviation that makes a failure at 1 as probable as the posterior says.
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&[normal], 50_000, 1);
        let x = Mat::from_fn(1, 5, |_, i| 0.4 * i as f64 - 0.8);
        let y = Mat::from_fn(5, 1, |i, _| [0.3, -0.4, 0.1, 0.5, -0.5][i]);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![4.0], nugget: 1e-9, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        for inflation in [1.0, 2.0] {
            let mode = ClassifiedMode { index: 0, threshold: 1.0, grid: &[0], inflation, by_mean: false };
            let classified = classify(&model, &population, &mode);
            let counted = curves(&[&classified.first_failure], 1)[0][0];
            let by_means = classified.mean.iter().filter(|mean| **mean >= 1.0).count();
            let probability = |j: usize| {
                let std = classified.sigma[0] * classified.variance_factor[j].sqrt();
                standard_normal_cdf((classified.mean[j] - 1.0) / std.max(1e-12))
            };
            let expected = (0..population.len()).map(probability).sum::<f64>() / 5e4;
            assert!(by_means == 0 && expected > 5e-3, "{by_means} {expected}");
            assert!((counted - expected).abs() < 4.0 * (expected / 5e4).sqrt(), "{counted} {expected}");
        }
    }

    #[test]
    fn through_the_cache_every_point_is_classified_as_from_scratch() {
        let variable = Distribution::truncated_normal(0.0, 1.0, -5.0, 5.0).unwrap();
        let population = Population::draw(&vec![variable; 4], 20_000, 11);
        let n = 60;
        let x = population.columns(0..n).to_owned();
        // A history of five checkpoints that passes its limit at some of them.
        let y = Mat::from_fn(n, 5, |i, o| {
            let x = population.standardised(i);
            (0.2 + 0.2 * o as f64) * (1.0 + 0.3 * x[0] + 0.2 * (x[1] * x[2]).sin() + 0.05 * x[3] * x[3])
        });
        let theta = vec![0.02, 0.1, 0.1, 0.03];
        let correlation = Correlation { kernel: Kernel::Gaussian, theta, nugget: 1e-9, stated: 0.0 };
        let mode =
            ClassifiedMode { index: 0, threshold: 1.0, grid: &[1, 3, 4], inflation: 1.0, by_mean: false };
        let mut cache = PredictionCache::default();
        let mut model = Kriging::condition(x.subcols(0, 40), y.subrows(0, 40), &correlation).unwrap();
        for (from, to) in [(40, 41), (41, 48), (48, 60)] {
            classify_cached(&mut cache, &model, &population, &mode);
            model = model.extended(x.subcols(from, to - from), y.subrows(from, to - from), None).unwrap();
        }
        let cached = classify_cached(&mut cache, &model, &population, &mode);
        let whole = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        let fresh = classify(&whole, &population, &mode);
        assert_eq!(cached.first_failure, fresh.first_failure);
        assert!(fresh.first_failure.iter().any(|n| *n < 5) && fresh.first_failure.contains(&5));
        for j in 0..population.len() {
            let (a, b) = (cached.u(j, 1), fresh.u(j, 1));
            assert!((a - b).abs() < 1e-3 * (1.0 + b) || b > 50.0, "{j} {a} {b}");
        }
    }
}
