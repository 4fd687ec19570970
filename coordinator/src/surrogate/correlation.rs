//! Anisotropic Gaussian correlation: r(x, x') = exp(-sum_k theta_k (x_k - x'_k)^2).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Parameters of the correlation of one surrogate.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// theta_k = 1 / (2 length_k^2), in standardised inputs `(d,)` [1].
    pub theta: Vec<f64>,
    /// Variance of the simulator's numerical noise over the process variance, added to the diagonal [1].
    pub nugget: f64,
}

impl Correlation {
    /// Points `(d, n)` multiplied by sqrt(theta), so that correlation is exp(-distance^2).
    pub(crate) fn scale(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let root: Vec<f64> = self.theta.iter().map(|theta| theta.sqrt()).collect();
        Mat::from_fn(points.nrows(), points.ncols(), |k, i| root[k] * points[(k, i)])
    }
}

/// Correlation matrix `(n, n)` of points `(d, n)`, without the nugget; the diagonal is exactly 1.
pub fn correlation_matrix(correlation: &Correlation, points: MatRef<'_, f64>) -> Mat<f64> {
    let scaled = correlation.scale(points);
    let mut r = cross_of_scaled(scaled.as_ref(), scaled.as_ref());
    for i in 0..points.ncols() {
        r[(i, i)] = 1.0;
        for j in 0..i {
            r[(j, i)] = r[(i, j)];
        }
    }
    r
}

/// Correlation `(n, b)` between points `(d, n)` and points `(d, b)`, without the nugget.
pub fn cross_correlation(correlation: &Correlation, a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    cross_of_scaled(correlation.scale(a).as_ref(), correlation.scale(b).as_ref())
}

/// exp(-|a_i - b_j|^2) through one matrix product: |a|^2 + |b|^2 - 2 a.b, held at or above zero against rounding.
pub(crate) fn cross_of_scaled(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut r = Mat::zeros(a.ncols(), b.ncols());
    cross_of_scaled_into(r.as_mut(), a, &squared_norms(a), b);
    r
}

/// As [`cross_of_scaled`], into `(n, b)` and with the squared norms of `a` known.
pub(crate) fn cross_of_scaled_into(
    mut r: MatMut<'_, f64>,
    a: MatRef<'_, f64>,
    a_norms: &[f64],
    b: MatRef<'_, f64>,
) {
    matmul(r.as_mut(), Accum::Replace, a.transpose(), b, 2.0, Par::Seq);
    let b_norms = squared_norms(b);
    for (column, b_norm) in r.col_iter_mut().zip(b_norms) {
        for (value, a_norm) in column.iter_mut().zip(a_norms) {
            *value = (*value - a_norm - b_norm).min(0.0).exp();
        }
    }
}

/// Squared norm of each column.
pub(crate) fn squared_norms(points: MatRef<'_, f64>) -> Vec<f64> {
    points.col_iter().map(|column| column.iter().map(|x| x * x).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_the_definition() {
        let correlation = Correlation { theta: vec![0.3, 2.0], nugget: 0.0 };
        let points = Mat::from_fn(2, 5, |k, i| (i as f64 * 0.7 + k as f64).sin() * 1.5);
        let r = correlation_matrix(&correlation, points.as_ref());
        for i in 0..5 {
            for j in 0..5 {
                let exponent: f64 =
                    (0..2).map(|k| correlation.theta[k] * (points[(k, i)] - points[(k, j)]).powi(2)).sum();
                assert!((r[(i, j)] - (-exponent).exp()).abs() < 1e-14);
            }
        }
    }
}
