//! Derivatives of failure probabilities to the means and standard deviations of the random variables, from the
//! classified population alone.
//!
//! With I the failure indicator and s = d ln f(x_k) / dp the score of variable k for its parameter p,
//! dP_f/dp = E[I s] = E[(I - P_f) s], since a score has mean zero; the second form has the smaller variance, above all
//! where P_f is near 1. Its standard error is sqrt(Var[(I - P_f) s] / N): sampling only, the surrogates' doubt is not
//! in it. The bounds of truncated variables are held fixed.
//!
//! Source: Wu (1994); Song, Lu, Qiao (2009).

use crate::design::Population;
use rayon::prelude::*;

/// Derivatives of one curve at one checkpoint to the parameters of one variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// Index of the curve: the modes in order, then the system.
    pub curve: usize,
    /// Index of the checkpoint.
    pub checkpoint: usize,
    /// Index of the variable.
    pub variable: usize,
    /// dP_f / dmean [1/unit of the variable].
    pub to_mean: Estimate,
    /// dP_f / dstd [1/unit of the variable].
    pub to_std: Estimate,
}

/// A value and its standard error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// Sums of a score and of its square, over failed points by first failure and over all.
struct ScoreSums {
    /// `(m + 1, 2)`.
    by_first_failure: Vec<[f64; 2]>,
}

impl ScoreSums {
    fn new(scores: &[f64], first_failure: &[u32], m: usize) -> Self {
        let mut by_first_failure = vec![[0.0; 2]; m + 1];
        for (s, first) in scores.iter().zip(first_failure) {
            let sums = &mut by_first_failure[*first as usize];
            sums[0] += s;
            sums[1] += s * s;
        }
        Self { by_first_failure }
    }

    /// Estimate at checkpoint `n`, where the share `pf` of `points` has failed.
    fn estimate(&self, n: usize, pf: f64, points: usize) -> Estimate {
        let sum = |range: &[[f64; 2]]| range.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        let (failed, all) = (sum(&self.by_first_failure[..=n]), sum(&self.by_first_failure));
        let count = points as f64;
        let value = (failed[0] - pf * all[0]) / count;
        let square = ((1.0 - 2.0 * pf) * failed[1] + pf * pf * all[1]) / count;
        Estimate { value, standard_error: ((square - value * value).max(0.0) / count).sqrt() }
    }
}

/// Derivatives of every curve at the given checkpoints to every variable, ordered by checkpoint, curve, variable.
///
/// `first_failures` holds, per curve, the index of the checkpoint by which each of the population's first points has
/// failed, m if never `(curves)(N,)`; `points` says which points of the population they are.
pub fn sensitivities(
    population: &Population,
    points: &[usize],
    first_failures: &[Vec<u32>],
    checkpoints: &[usize],
    m: usize,
) -> Vec<Sensitivity> {
    let count = points.len();
    let failed_share = |first: &[u32], n: usize| {
        first.iter().filter(|first| **first as usize <= n).count() as f64 / count as f64
    };
    // Sums per variable, parameter and curve.
    let sums: Vec<[Vec<ScoreSums>; 2]> = population
        .variables()
        .par_iter()
        .enumerate()
        .map(|(k, variable)| {
            let values: Vec<f64> = points
                .iter()
                .map(|j| variable.parent_mean() + variable.parent_std() * population.standardised(*j)[k])
                .collect();
            let of = |score: &dyn Fn(f64) -> f64| -> Vec<ScoreSums> {
                let scores: Vec<f64> = values.iter().map(|x| score(*x)).collect();
                first_failures.iter().map(|first| ScoreSums::new(&scores, first, m)).collect()
            };
            [of(&|x| variable.score_mean(x)), of(&|x| variable.score_std(x))]
        })
        .collect();
    let mut rows = Vec::new();
    for checkpoint in checkpoints {
        for (curve, first) in first_failures.iter().enumerate() {
            let pf = failed_share(first, *checkpoint);
            for (variable, [mean, std]) in sums.iter().enumerate() {
                rows.push(Sensitivity {
                    curve,
                    checkpoint: *checkpoint,
                    variable,
                    to_mean: mean[curve].estimate(*checkpoint, pf, count),
                    to_std: std[curve].estimate(*checkpoint, pf, count),
                });
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::Distribution;

    /// P(x_1 + 2 x_2 >= limit) for truncated normals, by Simpson's rule over x_1 and the exact distribution of x_2.
    fn exact(a: Distribution, b: Distribution, limit: f64) -> f64 {
        let (lower, upper) = a.support();
        let n = 40_000;
        let h = (upper - lower) / n as f64;
        let f = |x: f64| a.pdf(x.clamp(lower, upper)) * (1.0 - b.cdf((limit - x) / 2.0));
        let weight = |i: usize| if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        (0..=n).map(|i| weight(i) * f(lower + h * i as f64)).sum::<f64>() * h / 3.0
    }

    #[test]
    fn a_linear_limit_state_agrees_with_finite_differences_of_the_exact_probability() {
        let tn = |mean, std| Distribution::TruncatedNormal { mean, std, lower: -1.5, upper: 3.5 };
        let (a, b) = (tn(1.0, 0.9), tn(0.5, 0.6));
        let points = 200_000;
        let population = Population::draw(&[a, b], points, 17);
        let limits = [2.0, 3.5];
        let value = |j: usize| {
            let x = population.physical(j);
            x[0] + 2.0 * x[1]
        };
        // Two checkpoints: the higher limit is passed first in life, the lower one by the second checkpoint.
        let first: Vec<u32> = (0..points)
            .map(|j| if value(j) >= limits[1] { 0 } else { 1 + u32::from(value(j) < limits[0]) })
            .collect();
        let all: Vec<usize> = (0..points).collect();
        let rows = sensitivities(&population, &all, &[first], &[0, 1], 2);
        let h = 1e-4;
        for row in rows {
            let limit = limits[1 - row.checkpoint];
            let with = |dm: f64, ds: f64| {
                if row.variable == 0 {
                    exact(tn(1.0 + dm, 0.9 + ds), b, limit)
                } else {
                    exact(a, tn(0.5 + dm, 0.6 + ds), limit)
                }
            };
            let to_mean = (with(h, 0.0) - with(-h, 0.0)) / (2.0 * h);
            let to_std = (with(0.0, h) - with(0.0, -h)) / (2.0 * h);
            for (estimate, truth) in [(row.to_mean, to_mean), (row.to_std, to_std)] {
                assert!((estimate.value - truth).abs() < 4.0 * estimate.standard_error, "{row:?}: {truth}");
                assert!(estimate.standard_error < 0.01 * truth.abs().max(0.3));
            }
        }
    }
}
