//! Cholesky factor, triangular solves and inverses of correlation matrices, C = L L'.
//!
//! All are sequential: below about 1000 points a parallel factorisation costs more in waiting than it gains,
//! and the surrogates of several limit states run in parallel.
//!
//! # Source
//! Golub, Van Loan (2013), Matrix Computations, section 4.2; the kernels are those of the crate `faer`.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::linalg::triangular_inverse::invert_lower_triangular;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, MatRef, Par, Spec};

/// Lower Cholesky factor L `(n, n)` of a symmetric matrix A = L L' `(n, n)`, of which only the lower triangle
/// is read; zero above the diagonal.
pub(crate) fn cholesky(mut a: Mat<f64>) -> Result<Mat<f64>, usize> {
    factor_in_place(a.as_mut())?;
    for j in 1..a.ncols() {
        a.col_as_slice_mut(j)[..j].fill(0.0);
    }
    Ok(a)
}

/// Overwrites the lower triangle of A with L; entries above the diagonal are neither read nor written.
pub(crate) fn factor_in_place(a: MatMut<'_, f64>) -> Result<(), usize> {
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(a.nrows(), Par::Seq, Spec::default()));
    cholesky_in_place(a, Default::default(), Par::Seq, MemStack::new(&mut memory), Spec::default())
        .map(|_| ())
        .map_err(|LltError::NonPositivePivot { index }| index)
}

/// Copies the lower triangle of a square matrix to the upper.
pub(crate) fn mirror(a: &mut Mat<f64>) {
    for j in 1..a.ncols() {
        for i in 0..j {
            a[(i, j)] = a[(j, i)];
        }
    }
}

/// Overwrites b `(n, k)` with L^-1 b.
pub(crate) fn solve_lower(l: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    solve_lower_triangular_in_place(l, b, Par::Seq);
}

/// Overwrites b `(n, k)` with L'^-1 b.
pub(crate) fn solve_lower_transposed(l: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    solve_upper_triangular_in_place(l.transpose(), b, Par::Seq);
}

/// The lower triangle of (L L')^-1 `(n, n)`.
pub(crate) fn inverse_below(l: MatRef<'_, f64>) -> Mat<f64> {
    let n = l.nrows();
    let (mut l_inverse, mut inverse) = (Mat::zeros(n, n), Mat::zeros(n, n));
    invert_factor(l, l_inverse.as_mut());
    square_of_inverse(l_inverse.as_ref(), inverse.as_mut());
    inverse
}

/// Writes the lower triangle of L^-1; entries above the diagonal are not touched.
pub(crate) fn invert_factor(l: MatRef<'_, f64>, l_inverse: MatMut<'_, f64>) {
    invert_lower_triangular(l_inverse, l, Par::Seq);
}

/// Writes the lower triangle of L'^-1 L^-1 from that of L^-1; entries above the diagonal are not touched.
pub(crate) fn square_of_inverse(l_inverse: MatRef<'_, f64>, inverse: MatMut<'_, f64>) {
    triangular_matmul(
        inverse,
        BlockStructure::TriangularLower,
        Accum::Replace,
        l_inverse.transpose(),
        BlockStructure::TriangularUpper,
        l_inverse,
        BlockStructure::TriangularLower,
        1.0,
        Par::Seq,
    );
}

/// ln det(L L') = 2 sum over i of ln L_ii.
pub(crate) fn log_determinant(l: MatRef<'_, f64>) -> f64 {
    (0..l.nrows()).map(|i| 2.0 * l[(i, i)].ln()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_inverse_and_determinant_agree() {
        let n = 40;
        let a = Mat::from_fn(n, n, |i, j| {
            (-0.05 * (i as f64 - j as f64).powi(2)).exp() + if i == j { 0.1 } else { 0.0 }
        });
        let l = cholesky(a.clone()).unwrap();
        let mut inverse = inverse_below(l.as_ref());
        mirror(&mut inverse);
        let identity = &a * inverse;
        for i in 0..n {
            for j in 0..n {
                assert!((identity[(i, j)] - f64::from(u8::from(i == j))).abs() < 1e-11);
            }
        }
        assert!((log_determinant(l.as_ref()) - a.determinant().ln()).abs() < 1e-9);
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let a = Mat::from_fn(3, 3, |i, j| if i == j { 1.0 } else { 1.5 });
        assert_eq!(cholesky(a), Err(1));
    }
}
