//! Anisotropic correlation of two points,
//!
//!   r(x, x') = R(r2),   r2 = sum over k of theta_k (x_k - x'_k)^2,   theta_k = 1 / (2 length_k^2),
//!
//! with the correlation function R of the [`Kernel`] and standardised inputs x [1]. The matrix of the data is
//! C = R + nugget I + stated W, with W the diagonal of the points' noise weights. Distances are computed as
//! |a|^2 + |b|^2 - 2 a.b, by one matrix product; very small ones are accurate to rounding of the norms only.
//!
//! # Source
//! Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, sections 4.2 and 5.1.

use super::Kernel;
use super::factor::mirror;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::prelude::ReborrowMut;
use faer::{Accum, ColMut, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Parameters of the correlation of one surrogate.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Correlation function R.
    pub kernel: Kernel,
    /// theta_k = 1 / (2 length_k^2) in standardised inputs `(d,)` [1].
    pub theta: Vec<f64>,
    /// Variance of the noise common to all points over the process variance [1], added to the diagonal.
    pub nugget: f64,
    /// Mean variance of the noise in proportion to stated errors over the process variance [1]; multiplied by
    /// the weight of each point it is added to the diagonal, see [`super::NoiseShape`].
    pub stated: f64,
}

impl Correlation {
    /// Expected noise variance of a further point over the process variance [1].
    pub fn noise(&self) -> f64 {
        self.nugget + self.stated
    }

    /// Adds the noise to the diagonal of a correlation matrix `(n, n)`; `weights` `(n,)` have mean 1 [1].
    pub(crate) fn add_noise(&self, mut matrix: MatMut<'_, f64>, weights: Option<&[f64]>) {
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += self.nugget + weights.map_or(0.0, |weights| self.stated * weights[i]);
        }
    }

    /// Points `(d, n)` multiplied by sqrt(theta) `(d, n)`, so that r2 is their squared distance.
    pub(crate) fn scale(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let root: Vec<f64> = self.theta.iter().map(|theta| theta.sqrt()).collect();
        Mat::from_fn(points.nrows(), points.ncols(), |k, i| root[k] * points[(k, i)])
    }
}

/// Least number of columns of a parallel task: fewer are not worth another thread.
const COLUMNS: usize = 64;

/// Correlation matrix `(n, n)` of points `(d, n)`, without the noise; the diagonal is exactly 1.
pub fn correlation_matrix(correlation: &Correlation, points: MatRef<'_, f64>) -> Mat<f64> {
    let mut r = correlation_below(correlation, points);
    mirror(&mut r);
    r
}

/// Lower triangle of the correlation matrix `(n, n)` of points `(d, n)`, without the noise; zero above the
/// diagonal.
pub(crate) fn correlation_below(correlation: &Correlation, points: MatRef<'_, f64>) -> Mat<f64> {
    let n = points.ncols();
    let mut r = Mat::zeros(n, n);
    squares_below(correlation, points, r.as_mut());
    r.par_col_iter_mut().with_min_len(COLUMNS).enumerate().for_each(|(j, column)| {
        let column = &mut as_slice(column)[j..];
        correlation.kernel.correlate(column);
        column[0] = 1.0;
    });
    r
}

/// Writes the lower triangles of the correlation matrix to `r` and of -dR/dr2 to `slopes`, `(n, n)` each, the
/// latter with a diagonal of zeros; entries above the diagonal are not touched.
pub(crate) fn correlation_and_slopes_into(
    correlation: &Correlation,
    points: MatRef<'_, f64>,
    mut r: MatMut<'_, f64>,
    slopes: MatMut<'_, f64>,
) {
    squares_below(correlation, points, r.as_mut());
    let columns = r.par_col_iter_mut().zip(slopes.par_col_iter_mut());
    columns.with_min_len(COLUMNS).enumerate().for_each(|(j, (column, slopes))| {
        let (column, slopes) = (&mut as_slice(column)[j..], &mut as_slice(slopes)[j..]);
        correlation.kernel.correlate_with_slopes(column, slopes);
        (column[0], slopes[0]) = (1.0, 0.0);
    });
}

/// Writes the scaled squared distances of points `(d, n)` to the lower triangle of `squares` `(n, n)`.
fn squares_below(correlation: &Correlation, points: MatRef<'_, f64>, mut squares: MatMut<'_, f64>) {
    let scaled = correlation.scale(points);
    let norms = squared_norms(scaled.as_ref());
    triangular_matmul(
        squares.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        scaled.transpose(),
        BlockStructure::Rectangular,
        scaled.as_ref(),
        BlockStructure::Rectangular,
        2.0,
        Par::Seq,
    );
    for (j, column) in squares.col_iter_mut().enumerate() {
        subtract_from_norms(&mut as_slice(column)[j..], &norms[j..], norms[j]);
    }
}

/// Replaces the products 2 a.b `(n,)` by |a|^2 + |b|^2 - 2 a.b, for all a and one b.
fn subtract_from_norms(products: &mut [f64], a_norms: &[f64], b_norm: f64) {
    for (product, a_norm) in products.iter_mut().zip(a_norms) {
        *product = -(*product - a_norm - b_norm);
    }
}

/// Writes the correlations between scaled points `a` `(d, n)`, with the squared norms `a_norms` `(n,)`, and
/// scaled points `b` `(d, b)` to `r` `(n, b)`.
pub(crate) fn cross_of_scaled_into(
    kernel: Kernel,
    mut r: MatMut<'_, f64>,
    a: MatRef<'_, f64>,
    a_norms: &[f64],
    b: MatRef<'_, f64>,
) {
    matmul(r.as_mut(), Accum::Replace, a.transpose(), b, 2.0, Par::Seq);
    for (j, b_norm) in squared_norms(b).into_iter().enumerate() {
        let column = as_slice(r.rb_mut().col_mut(j));
        subtract_from_norms(column, a_norms, b_norm);
        kernel.correlate(column);
    }
}

fn as_slice(column: ColMut<'_, f64>) -> &mut [f64] {
    column.try_as_col_major_mut().expect("matrices are column-major").as_slice_mut()
}

/// Squared norms of the columns `(n,)` of points `(d, n)`.
pub(crate) fn squared_norms(points: MatRef<'_, f64>) -> Vec<f64> {
    points.col_iter().map(|column| column.iter().map(|x| x * x).sum()).collect()
}

#[cfg(test)]
pub(super) mod tests;
