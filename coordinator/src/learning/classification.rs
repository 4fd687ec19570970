//! What one mode's surrogate says of every point of the population.

use crate::design::Population;
use crate::surrogate::Kriging;
use rayon::prelude::*;

/// Points predicted together: r(x) and w(x) of a block stay in the second-level cache.
const BLOCK: usize = 512;

/// Prediction of one mode over N points.
#[derive(Debug, Clone)]
pub struct Classification {
    /// Running maximum of the predicted mean at the a checkpoints of the grid `(N, a)`, row-major [unit of output].
    pub mean: Vec<f64>,
    /// Variance of the prediction over sigma2 `(N,)` [1].
    pub variance_factor: Vec<f64>,
    /// Process standard deviation at the checkpoints of the grid `(a,)` [unit of output].
    pub sigma: Vec<f64>,
    /// Index of the first checkpoint by which the point is predicted to have failed, m if never `(N,)`.
    pub first_failure: Vec<u32>,
    /// The mode's threshold.
    pub threshold: f64,
}

impl Classification {
    /// Number of checkpoints of the grid, a.
    pub fn grid(&self) -> usize {
        self.sigma.len()
    }

    /// Running maximum of the predicted mean of point `j` `(a,)`.
    pub fn means_of(&self, j: usize) -> &[f64] {
        &self.mean[j * self.grid()..(j + 1) * self.grid()]
    }

    /// U = |mean - threshold| / standard deviation of point `j` at grid checkpoint `n`; infinite where the standard
    /// deviation is zero.
    pub fn u(&self, j: usize, n: usize) -> f64 {
        distance_over_std(
            self.means_of(j)[n] - self.threshold,
            self.sigma[n] * self.variance_factor[j].sqrt(),
        )
    }
}

/// |distance| / std; a certain prediction (std zero) is infinitely far from its limit.
pub(super) fn distance_over_std(distance: f64, std: f64) -> f64 {
    if std > 0.0 { distance.abs() / std } else { f64::INFINITY }
}

/// Classifies the population by a model whose m outputs are the checkpoints of one mode; `grid` holds the checkpoints
/// at which means are kept. The result does not depend on the number of threads: blocks are fixed and independent.
pub fn classify(model: &Kriging, population: &Population, threshold: f64, grid: &[usize]) -> Classification {
    let (points, a) = (population.len(), grid.len());
    let sigma = grid.iter().map(|n| model.sigma2()[*n].sqrt()).collect();
    let mut mean = vec![0.0; points * a];
    let mut variance_factor = vec![0.0; points];
    let mut first_failure = vec![0; points];
    mean.par_chunks_mut(BLOCK * a)
        .zip(variance_factor.par_chunks_mut(BLOCK))
        .zip(first_failure.par_chunks_mut(BLOCK))
        .enumerate()
        .for_each(|(block, ((mean, variance_factor), first_failure))| {
            let start = block * BLOCK;
            let prediction = model.predict(population.columns(start..start + first_failure.len()));
            variance_factor.copy_from_slice(&prediction.variance_factor);
            for (j, first) in first_failure.iter_mut().enumerate() {
                let history = prediction.mean.col_as_slice(j);
                let failed = history.iter().position(|y| *y >= threshold).unwrap_or(history.len());
                *first = u32::try_from(failed).expect("a life has fewer than 2^32 checkpoints");
                let (mut largest, mut next) = (f64::NEG_INFINITY, 0);
                for (n, kept) in grid.iter().zip(&mut mean[j * a..(j + 1) * a]) {
                    largest = history[next..=*n].iter().copied().fold(largest, f64::max);
                    next = n + 1;
                    *kept = largest;
                }
            }
        });
    Classification { mean, variance_factor, sigma, first_failure, threshold }
}

/// Failure shares by checkpoint, `(modes + 1, m)`: each mode alone, then the system, from the first failures of the
/// modes `(modes, N)`.
pub fn curves(first_failures: &[&[u32]], m: usize) -> Vec<Vec<f64>> {
    let points = first_failures[0].len();
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
        first_failures.iter().map(|first| share(&mut first.iter().copied())).collect();
    let earliest = |j: usize| first_failures.iter().map(|first| first[j]).min().unwrap_or(0);
    curves.push(share(&mut (0..points).map(earliest)));
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_count_each_mode_and_the_first_of_them() {
        let (a, b) = ([0, 2, 3, 3], [3, 1, 3, 2]);
        let curves = curves(&[&a, &b], 3);
        assert_eq!(curves[0], vec![0.25, 0.25, 0.5]);
        assert_eq!(curves[1], vec![0.0, 0.25, 0.5]);
        assert_eq!(curves[2], vec![0.25, 0.5, 0.75]);
    }
}
