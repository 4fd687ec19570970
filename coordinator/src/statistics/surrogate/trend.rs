//! The trend of a surrogate by generalised least squares.
//!
//! Basis functions f(x) = 1, or 1, x_1 .. x_d in standardised inputs; F `(n, p)` their values at the points. With T = L^-1 F
//! made orthogonal column by column, T = Q U with U unit upper triangular and D = Q'Q diagonal, the trend of an output
//! with z = L^-1 y has the coefficients c = D^-1 Q'z in the basis U^-T f(x), and what it leaves of z is z - Q c.
//! At x with w = L^-1 r(x) the vector v = U^-T f(x) - Q'w says how far the trend is extrapolated: the variance
//! grows by sum_k v_k^2 / D_k.
//!
//! A column that depends on those before it (a variable that never varies) has D_k = 0 and is left out.
//!
//! Source: Sacks, Welch, Mitchell, Wynn (1989), eqs. 7 and 9; modified Gram-Schmidt, twice, as in Golub, Van Loan (2013),
//! section 5.2.

use super::factor::solve_lower;
use crate::statistics::named::named;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_inverse::invert_unit_upper_triangular;
use faer::{Accum, Mat, MatRef, Par};

/// Share of a basis column's square below which what the columns before leave of it is rounding.
const DEPENDENT: f64 = 1e-18;

/// Trend of a surrogate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Trend {
    /// One unknown mean.
    #[default]
    Constant,
    /// An unknown mean and an unknown slope for every variable.
    Linear,
}

// The simplest first: the order in which cross-validation tries them.
named!(Trend { Constant = "constant", Linear = "linear" });

impl Trend {
    /// What `n` points in `d` variables can carry: a linear trend needs d + 1 < n / 2, with fewer it is constant.
    pub fn carried_by(self, d: usize, n: usize) -> Self {
        if self == Self::Linear && 2 * (d + 1) < n { Self::Linear } else { Self::Constant }
    }

    /// Number of basis functions p in `d` variables.
    pub fn functions(self, d: usize) -> usize {
        match self {
            Self::Constant => 1,
            Self::Linear => d + 1,
        }
    }

    /// Values of the basis functions at points `(d, b)`: `(p, b)`.
    pub(crate) fn basis(self, points: MatRef<'_, f64>) -> Mat<f64> {
        Mat::from_fn(self.functions(points.nrows()), points.ncols(), |k, i| {
            if k == 0 { 1.0 } else { points[(k - 1, i)] }
        })
    }
}

/// The trend over the points of one factor L.
#[derive(Debug, Clone)]
pub(super) struct Whitened {
    pub trend: Trend,
    /// T = L^-1 F `(n, p)`.
    pub t: Mat<f64>,
    /// Q `(n, p)`; zero where a column depends on those before.
    pub q: Mat<f64>,
    /// D `(p,)`; zero likewise.
    pub squares: Vec<f64>,
    /// U^-T `(p, p)`.
    to_orthogonal: Mat<f64>,
}

impl Whitened {
    /// Of points `(d, n)` whose C has the factor `l`.
    pub fn new(trend: Trend, points: MatRef<'_, f64>, l: MatRef<'_, f64>) -> Self {
        let mut t = trend.basis(points).transpose().to_owned();
        solve_lower(l, t.as_mut());
        Self::of(trend, t)
    }

    /// From T itself.
    pub fn of(trend: Trend, t: Mat<f64>) -> Self {
        let p = t.ncols();
        let mut q = t.clone();
        let mut u = Mat::<f64>::identity(p, p);
        let mut squares = vec![0.0; p];
        for k in 0..p {
            let whole = q.col(k).squared_norm_l2();
            // The second pass takes what rounding left by the first; a single column needs neither.
            for _ in 0..2 {
                for before in 0..k {
                    let (q_before, q_k) = q.two_cols_mut(before, k);
                    let overlap = ratio(dot(q_before.as_ref(), q_k.as_ref()), squares[before]);
                    u[(before, k)] += overlap;
                    zip_add(q_k, q_before.as_ref(), -overlap);
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

    /// How many coefficients are estimated.
    pub fn rank(&self) -> usize {
        self.squares.iter().filter(|square| **square > 0.0).count()
    }

    /// Takes the trend out of z `(n,)`; its coefficients c `(p,)`.
    pub fn take_from(&self, z: &mut [f64]) -> Vec<f64> {
        let of = |(q, square): (faer::ColRef<'_, f64>, &f64)| {
            let coefficient = ratio(q.iter().zip(z.iter()).map(|(q, z)| z * q).sum(), *square);
            z.iter_mut().zip(q.iter()).for_each(|(z, q)| *z -= coefficient * q);
            coefficient
        };
        self.q.col_iter().zip(&self.squares).map(of).collect()
    }

    /// Orthogonal basis U^-T f at points `(d, b)`: `(p, b)`.
    pub fn at(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        &self.to_orthogonal * self.trend.basis(points)
    }

    /// v = U^-T f - Q'w `(p, b)` at points `(d, b)` with w `(n, b)`.
    pub fn extrapolation(&self, points: MatRef<'_, f64>, w: MatRef<'_, f64>) -> Mat<f64> {
        let mut v = self.at(points);
        matmul(v.as_mut(), Accum::Add, self.q.transpose(), w, -1.0, Par::Seq);
        v
    }

    /// v from u = f - T'w instead of from points: U^-T u `(p, b)`.
    pub fn orthogonal(&self, u: MatRef<'_, f64>) -> Mat<f64> {
        &self.to_orthogonal * u
    }

    /// sum_k v_k^2 / D_k of one column of v.
    pub fn variance(&self, v: faer::ColRef<'_, f64>) -> f64 {
        v.iter().zip(&self.squares).map(|(v, square)| ratio(v * v, *square)).sum()
    }
}

/// a / b, nothing where b is nothing.
pub(super) fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

fn dot(a: faer::ColRef<'_, f64>, b: faer::ColRef<'_, f64>) -> f64 {
    a.transpose() * b
}

fn zip_add(to: faer::ColMut<'_, f64>, from: faer::ColRef<'_, f64>, factor: f64) {
    to.iter_mut().zip(from.iter()).for_each(|(to, from)| *to += factor * from);
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
        let space = Whitened::of(Trend::Linear, t.clone());
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
