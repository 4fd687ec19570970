//! The trend of a surrogate by generalised least squares.
//!
//! The basis functions are f(x) = 1, or 1, x_1 .. x_d in standardised inputs; F `(n, p)` holds their values
//! at the points. T = L^-1 F is made orthogonal column by column, T = Q U, with U unit upper triangular and D
//! = Q'Q diagonal. The trend of an output with z = L^-1 y has the coefficients
//!
//!   c = D^-1 Q'z  in the basis U^-T f(x),
//!
//! and the residual z - Q c. At x with w = L^-1 r(x) the vector v = U^-T f(x) - Q'w measures the
//! extrapolation of the trend, which enlarges the variance by sum over k of v_k^2 / D_k.
//!
//! A column that depends on those before it (a variable that never varies) has D_k = 0 and is left out.
//!
//! # Source
//! Sacks, Welch, Mitchell, Wynn (1989), Design and analysis of computer experiments, Statistical Science
//! 4(4), eqs. 7 and 9; modified Gram-Schmidt, applied twice: Golub, Van Loan (2013), Matrix Computations,
//! section 5.2.

use super::factor::solve_lower;
use crate::named::named;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_inverse::invert_unit_upper_triangular;
use faer::{Accum, Mat, MatRef, Par};

/// Share of a basis column's square [1] below which its part orthogonal to the columns before is rounding.
const DEPENDENT: f64 = 1e-18;

/// Trend of a surrogate, by its basis functions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Trend {
    /// Constant trend: an unknown mean.
    #[default]
    Constant,
    /// Linear trend: an unknown mean and an unknown slope for every variable.
    Linear,
}

// The simplest first: the order in which cross-validation tries them.
named!(Trend { Constant = "constant", Linear = "linear" });

impl Trend {
    /// The trend that `n` points in `d` variables can carry: a linear trend needs d + 1 < n / 2, with fewer
    /// points it is constant.
    pub fn carried_by(self, d: usize, n: usize) -> Self {
        if self == Self::Linear && 2 * (d + 1) < n { Self::Linear } else { Self::Constant }
    }

    /// Values of the basis functions `(p, b)` at standardised points `(d, b)`.
    pub(crate) fn basis(self, points: MatRef<'_, f64>) -> Mat<f64> {
        let functions = if self == Self::Linear { points.nrows() + 1 } else { 1 };
        Mat::from_fn(functions, points.ncols(), |k, i| if k == 0 { 1.0 } else { points[(k - 1, i)] })
    }
}

/// The trend over the points of one factor L.
#[derive(Debug, Clone)]
pub(super) struct Whitened {
    /// Kind of the trend.
    pub trend: Trend,
    /// T = L^-1 F `(n, p)`.
    pub t: Mat<f64>,
    /// Q `(n, p)`; a column that depends on those before is zero.
    pub q: Mat<f64>,
    /// D `(p,)`; zero for a dependent column.
    pub squares: Vec<f64>,
    /// Transformation U^-T `(p, p)` to the orthogonal basis.
    to_orthogonal: Mat<f64>,
}

impl Whitened {
    /// The trend over points `(d, n)` whose C has the factor `l` `(n, n)`.
    pub fn new(trend: Trend, points: MatRef<'_, f64>, l: MatRef<'_, f64>) -> Self {
        let mut t = trend.basis(points).transpose().to_owned();
        solve_lower(l, t.as_mut());
        Self::from_basis(trend, t)
    }

    /// The trend from T `(n, p)`.
    pub fn from_basis(trend: Trend, t: Mat<f64>) -> Self {
        let p = t.ncols();
        let mut q = t.clone();
        let mut u = Mat::<f64>::identity(p, p);
        let mut squares = vec![0.0; p];
        for k in 0..p {
            let whole = q.col(k).squared_norm_l2();
            // The second pass removes what rounding left after the first; a single column needs neither.
            for _ in 0..2 {
                for before in 0..k {
                    let (q_before, q_k) = q.two_cols_mut(before, k);
                    let overlap = ratio(q_before.as_ref().transpose() * q_k.as_ref(), squares[before]);
                    u[(before, k)] += overlap;
                    q_k.iter_mut().zip(q_before.iter()).for_each(|(to, from)| *to += -overlap * from);
                }
            }
            let left = q.col(k).squared_norm_l2();
            if left > DEPENDENT * whole {
                squares[k] = left;
            } else {
                q.col_mut(k).fill(0.0);
            }
        }
        let mut inverse = Mat::identity(p, p);
        invert_unit_upper_triangular(inverse.as_mut(), u.as_ref(), Par::Seq);
        Self { trend, t, q, squares, to_orthogonal: inverse.transpose().to_owned() }
    }

    /// Number of coefficients that are estimated.
    pub fn rank(&self) -> usize {
        self.squares.iter().filter(|square| **square > 0.0).count()
    }

    /// Subtracts the trend from z `(n,)` and returns its coefficients c `(p,)`.
    pub fn take_from(&self, z: &mut [f64]) -> Vec<f64> {
        let take_column = |(q, square): (faer::ColRef<'_, f64>, &f64)| {
            let coefficient = ratio(q.iter().zip(z.iter()).map(|(q, z)| z * q).sum(), *square);
            z.iter_mut().zip(q.iter()).for_each(|(z, q)| *z -= coefficient * q);
            coefficient
        };
        self.q.col_iter().zip(&self.squares).map(take_column).collect()
    }

    /// Orthogonal basis U^-T f `(p, b)` at standardised points `(d, b)`.
    pub fn orthogonal_basis(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        &self.to_orthogonal * self.trend.basis(points)
    }

    /// v = U^-T f - Q'w `(p, b)` at standardised points `(d, b)`, from w `(n, b)`.
    pub fn extrapolation(&self, points: MatRef<'_, f64>, w: MatRef<'_, f64>) -> Mat<f64> {
        let mut v = self.orthogonal_basis(points);
        matmul(v.as_mut(), Accum::Add, self.q.transpose(), w, -1.0, Par::Seq);
        v
    }

    /// v = U^-T u `(p, b)`, from u = f - T'w `(p, b)`.
    pub fn orthogonal(&self, u: MatRef<'_, f64>) -> Mat<f64> {
        &self.to_orthogonal * u
    }

    /// Coefficients of the plain basis f `(p, m)`, from those of the orthogonal one `(p, m)`.
    pub fn in_plain_basis(&self, coefficients: &Mat<f64>) -> Mat<f64> {
        self.to_orthogonal.transpose() * coefficients
    }

    /// sum over k of v_k^2 / D_k [1] of one column of v `(p,)`.
    pub fn variance(&self, v: faer::ColRef<'_, f64>) -> f64 {
        v.iter().zip(&self.squares).map(|(v, square)| ratio(v * v, *square)).sum()
    }
}

/// a / b; 0 unless b is positive.
pub(super) fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_become_orthogonal_and_a_dependent_one_is_left_out() {
        let n = 12;
        // The third basis column is the sum of the two before it.
        let t = Mat::from_fn(n, 4, |i, k| {
            let (one, two) = (1.0 + 0.1 * i as f64, (i as f64).sin());
            [one, two, one + two, (0.3 * i as f64).cos()][k]
        });
        let space = Whitened::from_basis(Trend::Linear, t.clone());
        assert_eq!((space.rank(), space.squares[2]), (3, 0.0));
        let gram = space.q.transpose() * &space.q;
        for i in 0..4 {
            for j in 0..i {
                assert!(gram[(i, j)].abs() < 1e-13 * n as f64, "{i} {j} {}", gram[(i, j)]);
            }
        }
        // T = Q U, that is U^-T T' = Q'.
        assert!((space.orthogonal(t.transpose()) - space.q.transpose()).norm_max() < 1e-13);
        // Whatever lies in the columns is taken altogether.
        let mut z: Vec<f64> = (0..n).map(|i| 2.0 * t[(i, 0)] - 3.0 * t[(i, 1)] + 0.5 * t[(i, 3)]).collect();
        space.take_from(&mut z);
        assert!(z.iter().all(|z| z.abs() < 1e-13));
    }

    #[test]
    fn few_points_carry_a_constant_only() {
        assert_eq!(Trend::Linear.carried_by(10, 22), Trend::Constant);
        assert_eq!(Trend::Linear.carried_by(10, 23), Trend::Linear);
        assert_eq!(Trend::Constant.carried_by(1, 100), Trend::Constant);
    }
}
