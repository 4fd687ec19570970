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
//! The coupled learning function U_c of a point over competing modes and checkpoints, and the dominance
//! weight of two modes.
//!
//!   U_c(x) = min over n of min over s of U_s(x, n),   U_s as in [`Classification::u`],
//!
//! where a mode s is left out at a checkpoint n by which another mode has certainly failed (U >= 2): the
//! system has failed there whatever mode s does. U_c >= 2 everywhere means that every point is classified
//! with a risk of at most Phi(-2) per mode and checkpoint. The dominance weight of two modes is
//!
//!   k = (mean_2 / mean_1) (sigma_1 s_1 / (sigma_2 s_2)),
//!
//! the relative uncertainty of the first mode over that of the second [1].
//!
//! # Source
//! U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2). Posterior mean of the failure
//! probability: Dubourg, Sudret, Deheeger (2013), Metamodel-based importance sampling for structural reliability
//! analysis, Probabilistic Engineering Mechanics 33.
//! U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2). Minimum over the components of a
//! series system: Fauriat, Gayton (2014), AK-SYS, Reliability Engineering & System Safety 123. U_c and k for
//! competing failures: Cui et al. (2026), China Mechanical Engineering 37(6), 1472-1485, doi
//! 10.3969/j.issn.1004-132X.2026.06.020.

use crate::design::{Population, deviation};
use crate::surrogate::{Kriging, Prediction, PredictionCache};
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
        let std = self.sigma[n] * self.variance_factor[j].sqrt();
        distance_over_std(self.means_of(j)[n] - self.threshold, std)
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

/// Classifies the population by a model whose m outputs are the checkpoints of one mode, through a cache of its predictions, which is
/// updated first. Blocks that the cache has no room for are predicted. If the model is that of the last call with more points at the
/// same lengths ([`Kriging::extended`]), only the new points are computed. The result does not depend on the number of threads:
/// blocks are fixed and independent.
pub fn classify_cached(
    cache: &mut PredictionCache,
    model: &Kriging,
    population: &Population,
    classified: &ClassifiedMode<'_>,
) -> Classification {
    cache.update(model, population);
    let (cache, points) = (&*cache, population.len());
    let anew = |start: usize| model.predict(population.columns(start..points.min(start + BLOCK)));
    let predict = |block: usize| cache.block(block).unwrap_or_else(|| anew(block * BLOCK));
    let ClassifiedMode { index, threshold, grid, inflation, by_mean } = *classified;
    let deviations = if by_mean { 0.0 } else { 1.0 };
    let sigma: Vec<f64> = model.sigma2.iter().map(|sigma2| (sigma2 * inflation).sqrt()).collect();
    let a = grid.len();
    let mut mean = vec![0.0; points * a];
    let mut variance_factor = vec![0.0; points];
    let mut first_failure = vec![0; points];
    mean.par_chunks_mut(BLOCK * a)
        .zip(variance_factor.par_chunks_mut(BLOCK))
        .zip(first_failure.par_chunks_mut(BLOCK))
        .enumerate()
        .for_each(|(block, ((mean, variance_factor), first_failure))| {
            let Prediction { mean: means, variance_factor: factors } = predict(block);
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

/// Failure shares of the first `m` checkpoints `(curves, m)` [1] from the indices of the first failures `(curves)(N,)`.
pub fn curves<F: AsRef<[u32]>>(first_failures: &[F], m: usize) -> Vec<Vec<f64>> {
    let share = |first: &F| {
        let mut counts = vec![0usize; m + 1];
        first.as_ref().iter().for_each(|n| counts[*n as usize] += 1);
        let mut failed = 0;
        let cumulate = |count: &usize| {
            failed += count;
            failed as f64 / first.as_ref().len() as f64
        };
        counts[..m].iter().map(cumulate).collect()
    };
    first_failures.iter().map(share).collect()
}

/// U below which a classification counts as uncertain: Phi(-2) = 2.3 % risk of a wrong sign (Echard et al.
/// 2011).
pub const UNCERTAIN: f64 = 2.0;

/// Coupled learning functions of one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupled {
    /// U_c: smallest U over the checkpoints and the modes that decide on the system there [1].
    pub system: f64,
    /// Smallest U over the checkpoints and all modes, which decides on the curves of the single modes [1].
    pub any: f64,
}

/// Coupled learning functions of every point `(N,)`, from the classifications by all modes on the same grid.
pub fn coupled_criterion(modes: &[Classification]) -> Vec<Coupled> {
    (0..modes[0].variance_factor.len()).into_par_iter().map(|j| coupled(modes, j)).collect()
}

fn coupled(modes: &[Classification], j: usize) -> Coupled {
    let mut smallest = Coupled { system: f64::INFINITY, any: f64::INFINITY };
    for n in 0..modes[0].grid() {
        for (s, mode) in modes.iter().enumerate() {
            let u = mode.u(j, n);
            smallest.any = smallest.any.min(u);
            if u < smallest.system && !another_has_certainly_failed(modes, s, j, n) {
                smallest.system = u;
            }
        }
    }
    smallest
}

/// True if a mode other than `s` has certainly failed at point `j` by grid checkpoint `n`: it is predicted to
/// have failed, with U >= 2.
pub(super) fn another_has_certainly_failed(modes: &[Classification], s: usize, j: usize, n: usize) -> bool {
    let certain = |mode: &Classification| mode.means_of(j)[n] >= mode.threshold && mode.u(j, n) >= UNCERTAIN;
    modes.iter().enumerate().any(|(other, mode)| other != s && certain(mode))
}

/// Dominance weight k [1] of two competing modes at point `j` and grid checkpoint `n`, from means and
/// predicted standard deviations; scaling the outputs by their thresholds would not change it.
///
/// `None` unless there are exactly two modes, both with a positive standard deviation, and a first mean other
/// than zero.
pub fn dominance(modes: &[Classification], j: usize, n: usize) -> Option<f64> {
    let [first, second] = modes else { return None };
    let std = |mode: &Classification| mode.sigma[n] * mode.variance_factor[j].sqrt();
    let k = second.means_of(j)[n] / first.means_of(j)[n] * std(first) / std(second);
    k.is_finite().then_some(k)
}

#[cfg(test)]
pub(super) mod tests;
