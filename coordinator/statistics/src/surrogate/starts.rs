//! Fixed starts of the descents of a likelihood.
//!
//! With w_k the mean squared linear correlation of variable k with the outputs, a weighted start has
//! theta_k = sum (0.02 / d + 0.98 w_k / (w_1 + ... + w_d)); an isotropic one theta_k = sum / d.
//!
//! # Source
//! This project's own choice, from the fits of its built-in scenes.

use super::{Correlation, Kernel, Likelihood};

/// Level of the stated noise at the starts [1].
const STATED_START: f64 = 1e-4;

/// Isotropic starts at three lengths, and two with theta in proportion to the squared linear correlation
/// between variable and outputs, which are close to the optimum if few variables matter.
pub(super) fn fixed_starts(kernel: Kernel, likelihood: &Likelihood<'_>) -> Vec<Correlation> {
    let d = likelihood.points.nrows();
    let isotropic =
        |sum: f64| Correlation { kernel, theta: vec![sum / d as f64; d], nugget: 1e-4, stated: STATED_START };
    let influence: Vec<f64> = (0..d).map(|k| mean_squared_correlation(likelihood, k)).collect();
    let total: f64 = influence.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let weighted = |sum: f64| Correlation {
        kernel,
        theta: influence.iter().map(|w| sum * (0.02 / d as f64 + 0.98 * w / total)).collect(),
        nugget: 1e-4,
        stated: STATED_START,
    };
    vec![isotropic(0.02), isotropic(0.2), isotropic(2.0), weighted(0.02), weighted(0.4)]
}

/// Squared covariance of variable `k` with an output over the variance of the variable, mean over the
/// outputs, which have variance 1.
fn mean_squared_correlation(likelihood: &Likelihood<'_>, k: usize) -> f64 {
    let x = likelihood.points.row(k);
    let n = x.ncols() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let var = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>().max(f64::MIN_POSITIVE);
    let squared = |y: faer::ColRef<'_, f64>| {
        let cov: f64 = x.iter().zip(y.iter()).map(|(x, y)| (x - mean) * y).sum();
        cov * cov / (var * n)
    };
    likelihood.values.col_iter().map(squared).sum::<f64>() / likelihood.values.ncols() as f64
}
