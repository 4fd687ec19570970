//! Distribution of an output at every checkpoint: moments, quantiles, histogram.
//!
//! Over N values y_j: mean = sum y_j / N, variance = sum (y_j - mean)^2 / N, to which the mean predicted
//! variance is added for surrogates; the quantile at p interpolates linearly between the order statistics
//! around place p (N - 1).
//!
//! # Source
//! Quantiles: Hyndman, Fan (1996), Sample quantiles in statistical packages, The American Statistician 50(4),
//! type 7.

use crate::design::Population;
use crate::surrogate::{Kriging, ResponseScale};
use rayon::prelude::*;

/// Probabilities of the reported quantiles.
pub const PROBABILITIES: [f64; 11] = [0.001, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99, 0.999];

/// Number of bins of the histogram.
const BINS: usize = 40;

/// Most values kept at once, points times checkpoints (128 MiB): the correlations of the population with the
/// design are computed anew for every set of checkpoints, so the sets are few.
const VALUES: usize = 1 << 24;

/// Number of points predicted together.
const BLOCK: usize = 512;

/// Distribution of an output at one checkpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputDistribution {
    /// Mean [unit of output].
    pub mean: f64,
    /// Standard deviation, for surrogates with their mean predicted variance [unit of output].
    pub std: f64,
    /// Quantiles at [`PROBABILITIES`] `(11,)` [unit of output].
    pub quantiles: Vec<f64>,
    /// Histogram between the smallest and the largest value.
    pub histogram: Histogram,
}

/// Counts in bins of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Lower edge of the first bin [unit of output].
    pub from: f64,
    /// Upper edge of the last bin [unit of output].
    pub to: f64,
    /// Counts `(40,)`; all in the first bin if all values are equal.
    pub counts: Vec<u64>,
}

/// Distributions `(m,)` of the predicted values of a model's m outputs, `learned` in this scale, over the population.
pub fn predict_distributions(
    model: &Kriging,
    learned: ResponseScale,
    population: &Population,
) -> Vec<OutputDistribution> {
    let m = model.sigma2.len();
    let dual = model.dual();
    // Mean variance factor over a fixed part of the population: it enters the spread only.
    let part = population.len().min(2000);
    let factors = model.predict(population.columns(0..part)).variance_factor;
    let factor = factors.iter().sum::<f64>() / part.max(1) as f64;
    let mut distributions = Vec::with_capacity(m);
    let columns = (VALUES / population.len().max(1)).max(1);
    for first in (0..m).step_by(columns) {
        let count = columns.min(m - first);
        let mut values = vec![0.0; population.len() * count];
        values.par_chunks_mut(BLOCK * count).enumerate().for_each(|(block, values)| {
            let start = block * BLOCK;
            let points = population.columns(start..start + values.len() / count);
            let means = model.predict_means(points, &dual, first..first + count);
            for (j, values) in values.chunks_exact_mut(count).enumerate() {
                let predicted = means.col_as_slice(j).iter().map(|mean| learned.value(*mean));
                values.iter_mut().zip(predicted).for_each(|(value, predicted)| *value = predicted);
            }
        });
        let column = |o: usize| values.iter().skip(o).step_by(count).copied().collect::<Vec<f64>>();
        let by_checkpoint = |o: usize| {
            let values = column(o);
            let squares = values.iter().map(|y| learned.slope(*y).powi(2)).sum::<f64>();
            let slope = squares / values.len() as f64;
            distribution(values, slope * model.sigma2[first + o] * factor)
        };
        distributions.extend((0..count).into_par_iter().map(by_checkpoint).collect::<Vec<_>>());
    }
    distributions
}

/// Distributions `(m,)` of simulated histories `(samples)(m,)` [unit of output]; none without histories.
pub fn distributions_from_samples(histories: &[Vec<f64>]) -> Vec<OutputDistribution> {
    let m = histories.first().map_or(0, |history| history.len());
    (0..m).map(|n| distribution(histories.iter().map(|history| history[n]).collect(), 0.0)).collect()
}

/// Distribution of values `(N,)`, whose variance is enlarged by `extra_variance`.
fn distribution(mut values: Vec<f64>, extra_variance: f64) -> OutputDistribution {
    let count = values.len() as f64;
    // Over a power of two of their size, so that no square of a large value overflows and none of a small one is lost.
    let size = values.iter().map(|y| y.abs()).fold(0.0, f64::max);
    let scale = if size > 0.0 && size.is_finite() { size.log2().floor().exp2() } else { 1.0 };
    let scaled = values.iter().map(|y| y / scale).sum::<f64>() / count;
    let variance = values.iter().map(|y| (y / scale - scaled).powi(2)).sum::<f64>() / count;
    let mean = scale * scaled;
    let smallest = |values: &[f64]| values.iter().copied().min_by(f64::total_cmp);
    let (Some(from), Some(to)) = (smallest(&values), values.iter().copied().max_by(f64::total_cmp)) else {
        unreachable!("a distribution has values");
    };
    // Each quantile puts the values below it in front, so that the next one is sought behind it.
    let mut front = 0;
    let quantile = |p: f64| {
        let place = p * (count - 1.0);
        let at = place.floor() as usize;
        let (_, low, behind) = values[front..].select_nth_unstable_by(at - front, f64::total_cmp);
        let next = smallest(behind).unwrap_or(*low);
        front = at;
        *low + (next - *low) * place.fract()
    };
    let quantiles = PROBABILITIES.map(quantile).to_vec();
    let mut counts = vec![0; BINS];
    for y in &values {
        let place = if to > from { (y - from) / (to - from) * BINS as f64 } else { 0.0 };
        counts[(place as usize).min(BINS - 1)] += 1;
    }
    OutputDistribution {
        mean,
        std: scale * (variance + extra_variance / scale / scale).sqrt(),
        quantiles,
        histogram: Histogram { from, to, counts },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Correlation, Kernel};
    use common::random::Distribution;
    use faer::Mat;

    #[test]
    fn equal_steps_have_their_closed_form() {
        let histories: Vec<Vec<f64>> = (0..=1000).map(|i| vec![i as f64, 5.0]).collect();
        let d = distributions_from_samples(&histories);
        assert!(
            (d[0].mean - 500.0).abs() < 1e-9 && (d[0].std - (1001.0f64.powi(2) / 12.0).sqrt()).abs() < 1e-3
        );
        assert!((d[0].quantiles[3] - 100.0).abs() < 1e-9);
        assert_eq!(d[0].histogram.counts.iter().sum::<u64>(), 1001);
        assert!(d[0].histogram.counts.iter().all(|c| (25..=26).contains(c)));
        assert_eq!((d[1].std, d[1].histogram.counts[0]), (0.0, 1001));
    }

    #[test]
    fn issue_moments_of_large_values_overflowed() {
        let unit: Vec<Vec<f64>> = (0..1000).map(|i| vec![f64::from(i) / 1000.0 - 0.3]).collect();
        let rows = |factor: f64| unit.iter().map(|row| vec![factor * row[0]]).collect::<Vec<_>>();
        let of = |rows: &[Vec<f64>]| distributions_from_samples(rows).remove(0);
        let expected = of(&unit);
        for factor in [1e300, 1e-300] {
            let found = of(&rows(factor));
            assert!((found.std / factor / expected.std - 1.0).abs() < 1e-12, "{found:?}");
            assert!((found.mean / factor / expected.mean - 1.0).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn a_linear_output_keeps_its_moments() {
        let variables = vec![Distribution::truncated_normal(3.0, 0.5, 1.5, 4.5).unwrap(); 2];
        let population = Population::draw(&variables, 20_000, 1);
        let x = Mat::from_fn(2, 40, |k, i| population.standardised(i)[k]);
        // Nine checkpoints, more than are predicted together.
        let y = Mat::from_fn(40, 9, |i, o| 10.0 + (1.0 + o as f64) * (x[(0, i)] + 2.0 * x[(1, i)]));
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1e-3, 1e-3], nugget: 1e-10, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        let distributions = predict_distributions(&model, ResponseScale::Values, &population);
        let std = 5.0_f64.sqrt() * variables[0].std() / 0.5;
        for (o, d) in distributions.iter().enumerate() {
            let expected = (1.0 + o as f64) * std;
            // Standard errors: std / sqrt(N) of the mean, std / sqrt(2 N) of the standard deviation.
            assert!((d.mean - 10.0).abs() < 4.0 * expected / 20_000_f64.sqrt());
            assert!((d.std / expected - 1.0).abs() < 4.0 / 40_000_f64.sqrt());
        }
    }
}
