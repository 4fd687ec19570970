//! LU factorisation of small banded or dense matrices without pivoting, in place and without allocation: the step loop solves
//! millions of such systems an evaluation.
//!
//! A = L U with unit diagonal of L. Rows are not exchanged: the matrices are M / (gamma h) - D - gamma h K, whose diagonal
//! grows as the step h [s] shrinks, and SIMD lanes cannot exchange different rows. A pivot below 1e-9 of the diagonal entry it came
//! from marks the matrix as singular, and the step is refused.
//!
//! # Source
//! Gaussian elimination without pivoting: Golub, Van Loan, Matrix Computations (2013), section 3.2; banded: section 4.3.
//!
//! # With pivoting
//! LU factorisation with partial pivoting, P A = L U, for matrices that are not diagonally dominant: those of a search for
//! equilibrium are indefinite wherever a contact force turns with its journal.
//!
//! Source:
//! Golub, Van Loan: Matrix Computations (2013), section 3.4; banded: section 4.3.

use super::Band;
use super::layout::{Layout, each_row};
use crate::lanes::Real;

/// A pivot below this share of the diagonal entry it came from has lost too many digits [1].
const CANCELLED: f64 = 1e-9;

/// Factors the matrix `a` in place: L below the diagonal, the inverses of the pivots on it, U above. Returns one in lanes
/// where every pivot kept its digits, else zero.
#[inline(always)]
pub(crate) fn factor<R: Real, L: Layout>(a: &mut [R], band: &L, like: R) -> R {
    let a = &mut a[..band.len()];
    let (one, zero) = (like.like(1.0), like.zero());
    let mut sound = one;
    each_row!(band: L, k => {
        let kept = band.kept(k);
        let pivot = a[band.index(k, k)];
        // Size of the diagonal entry before the elimination: pivot plus what the rows above took from it.
        let mut taken = zero;
        for j in kept.start..k {
            taken = taken.plus_product(a[band.index(k, j)].abs(), a[band.index(j, k)].abs());
        }
        let enough = (pivot.abs() + taken) * CANCELLED;
        sound = R::select(enough.below(pivot.abs()), sound, zero);
        let inverse = one / pivot;
        a[band.index(k, k)] = inverse;
        for i in k + 1..kept.end {
            let l = a[band.index(i, k)] * inverse;
            a[band.index(i, k)] = l;
            let (from, to) = (band.index(k, k + 1), band.index(i, k + 1));
            let (upper, lower) = a.split_at_mut(to);
            let row = &upper[from..from + kept.end - k - 1];
            for (x, u) in lower.iter_mut().zip(row) {
                *x = x.minus_product(l, *u);
            }
        }
    });
    sound
}

/// Solves A x = b with the factors of [`factor`]; `x` holds b `(n,)` at first, then the solution.
#[inline(always)]
pub(crate) fn solve<R: Real, L: Layout>(a: &[R], band: &L, x: &mut [R]) {
    let n = band.n();
    let (a, x) = (&a[..band.len()], &mut x[..n]);
    each_row!(band: L, i => {
        let kept = band.kept(i);
        let row = &a[band.index(i, kept.start)..band.index(i, i)];
        let mut sum = x[i];
        for (l, x) in row.iter().zip(&x[kept.start..]) {
            sum = sum.minus_product(*l, *x);
        }
        x[i] = sum;
    });
    each_row!(band: L, backwards i => {
        let kept = band.kept(i);
        let row = &a[band.index(i, i)..band.index(i, i) + kept.end - i];
        let mut sum = x[i];
        for (u, x) in row[1..].iter().zip(&x[i + 1..]) {
            sum = sum.minus_product(*u, *x);
        }
        x[i] = sum * row[0];
    });
}

/// Adds `factor` times the product of the matrix `a` with `x` `(n,)` to `y` `(n,)`.
#[inline(always)]
pub(crate) fn add_product<R: Real, L: Layout>(a: &[R], band: &L, factor: R, x: &[R], y: &mut [R]) {
    let n = band.n();
    let (a, x, y) = (&a[..band.len()], &x[..n], &mut y[..n]);
    each_row!(band: L, i => {
        let kept = band.kept(i);
        let row = &a[band.index(i, kept.start)..band.index(i, kept.start) + kept.len()];
        let mut sum = factor.zero();
        for (a, x) in row.iter().zip(&x[kept]) {
            sum = sum.plus_product(*a, *x);
        }
        y[i] = y[i].plus_product(factor, sum);
    });
}

/// A banded or dense matrix and its factors.
#[derive(Debug, Clone)]
pub struct Pivoted {
    /// Layout of the matrix, and of its factors: exchanged rows reach twice as far.
    narrow: Band,
    wide: Band,
    a: Vec<f64>,
    pivots: Vec<usize>,
}

impl Pivoted {
    /// Space for the factors of a matrix of this layout.
    pub(crate) fn new(narrow: Band) -> Self {
        let wide = narrow.widened();
        Pivoted { narrow, wide, a: vec![0.0; wide.len()], pivots: vec![0; narrow.n()] }
    }

    /// Factors the matrix whose stored entry at index i of its layout is `entry(i)`; `None` if a pivot is zero or not finite.
    pub(crate) fn factor(&mut self, entry: impl Fn(usize) -> f64) -> Option<()> {
        let Pivoted { narrow, wide, a, pivots } = self;
        a.fill(0.0);
        for i in 0..narrow.n() {
            for j in narrow.kept(i) {
                a[wide.index(i, j)] = entry(narrow.index(i, j));
            }
        }
        for k in 0..wide.n() {
            let (rows, columns) = (k..narrow.kept(k).end, wide.kept(k));
            let mut best = k;
            for i in rows.clone() {
                if a[wide.index(i, k)].abs() > a[wide.index(best, k)].abs() {
                    best = i;
                }
            }
            pivots[k] = best;
            if best != k {
                (k..columns.end).for_each(|j| a.swap(wide.index(k, j), wide.index(best, j)));
            }
            let diagonal = a[wide.index(k, k)];
            if diagonal == 0.0 || !diagonal.is_finite() {
                return None;
            }
            a[wide.index(k, k)] = 1.0 / diagonal;
            for i in k + 1..rows.end {
                let l = a[wide.index(i, k)] / diagonal;
                a[wide.index(i, k)] = l;
                for j in k + 1..columns.end {
                    a[wide.index(i, j)] -= l * a[wide.index(k, j)];
                }
            }
        }
        Some(())
    }

    /// Solves A x = b with the factors; `x` holds b `(n,)` at first, then the solution.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let Pivoted { narrow, wide, a, pivots } = self;
        for k in 0..wide.n() {
            x.swap(k, pivots[k]);
            for i in k + 1..narrow.kept(k).end {
                x[i] -= a[wide.index(i, k)] * x[k];
            }
        }
        for i in (0..wide.n()).rev() {
            let sum: f64 = (i + 1..wide.kept(i).end).map(|j| a[wide.index(i, j)] * x[j]).sum();
            x[i] = (x[i] - sum) * a[wide.index(i, i)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Band;
    use super::super::layout::Dense;
    use super::*;

    /// A matrix with dominant diagonal and entries that follow no rule.
    fn matrix(band: &Band) -> Vec<f64> {
        let mut a = vec![0.0; band.len()];
        for i in 0..band.n() {
            for j in band.kept(i) {
                let x = ((7 * i + 3 * j) as f64).sin();
                a[band.index(i, j)] = if i == j { 20.0 + x } else { x };
            }
        }
        a
    }

    #[test]
    fn solves_dense_and_banded_systems() {
        for band in [Band::new(1, 0), Band::new(6, 5), Band::new(60, 5), Band::new(60, 2)] {
            let a = matrix(&band);
            let x: Vec<f64> = (0..band.n()).map(|i| (i as f64).cos()).collect();
            let mut b = vec![0.0; band.n()];
            add_product(&a, &band, 1.0, &x, &mut b);
            let mut lu = a.clone();
            assert_eq!(factor(&mut lu, &band, 0.0), 1.0);
            solve(&lu, &band, &mut b);
            let off = b.iter().zip(&x).map(|(b, x)| (b - x).abs()).fold(0.0, f64::max);
            assert!(off < 1e-14, "{band:?}: {off}");
        }
    }

    #[test]
    fn a_size_known_when_compiled_changes_no_bit() {
        let (band, dense) = (Band::new(6, 5), Dense::<6>);
        let a = matrix(&band);
        let b: Vec<f64> = (0..6).map(|i| (i as f64).cos()).collect();
        let (mut lu, mut straight) = (a.clone(), a.clone());
        assert_eq!(factor(&mut lu, &band, 0.0), factor(&mut straight, &dense, 0.0));
        assert_eq!(lu, straight);
        let (mut x, mut y) = (b.clone(), b.clone());
        solve(&lu, &band, &mut x);
        solve(&lu, &dense, &mut y);
        add_product(&a, &band, 0.3, &b, &mut x);
        add_product(&a, &dense, 0.3, &b, &mut y);
        assert_eq!(x, y);
    }

    #[test]
    fn a_matrix_whose_pivot_cancels_is_not_sound() {
        let band = Band::new(2, 1);
        for entries in [[1.0, 2.0, 2.0, 4.0], [0.0, 1.0, 1.0, 0.0], [f64::NAN, 0.0, 0.0, 1.0]] {
            assert_eq!(factor(&mut entries.to_vec(), &band, 0.0), 0.0, "{entries:?}");
        }
    }
}

#[cfg(test)]
mod pivoted_tests {
    use super::super::add_product;
    use super::*;

    #[test]
    fn solves_systems_that_need_pivoting() {
        for band in [Band::new(3, 2), Band::new(60, 59), Band::new(60, 5), Band::new(60, 2)] {
            let mut a = vec![0.0; band.len()];
            for i in 0..band.n() {
                for j in band.kept(i) {
                    // Nothing on the diagonal.
                    a[band.index(i, j)] = if i == j { 0.0 } else { 1.0 + ((7 * i + 3 * j) as f64).sin() };
                }
            }
            let x: Vec<f64> = (0..band.n()).map(|i| (i as f64).cos()).collect();
            let mut b = vec![0.0; band.n()];
            add_product(&a, &band, 1.0, &x, &mut b);
            let mut lu = Pivoted::new(band);
            assert_eq!(lu.factor(|place| a[place]), Some(()));
            lu.solve(&mut b);
            let off = b.iter().zip(&x).map(|(b, x)| (b - x).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{band:?}: {off}");
        }
    }

    #[test]
    fn reports_a_singular_matrix() {
        for a in [[1.0, 2.0, 2.0, 4.0], [f64::NAN, 0.0, 0.0, 1.0]] {
            let factored = Pivoted::new(Band::new(2, 1)).factor(|place| a[place]);
            assert_eq!(factored, None, "{a:?}");
        }
    }
}
