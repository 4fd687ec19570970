//! LU factorisation with partial pivoting, P A = L U, for matrices that are not diagonally dominant: those of a search for
//! equilibrium are indefinite wherever a contact force turns with its journal.
//!
//! # Source
//! Golub, Van Loan: Matrix Computations (2013), section 3.4; banded: section 4.3.

use super::Band;

/// The matrix has a pivot that is zero or not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SingularMatrix;

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

    /// Factors the matrix whose stored entry at index i of its layout is `entry(i)`.
    ///
    /// # Errors
    /// [`SingularMatrix`] if a pivot is zero or not finite.
    pub(crate) fn factor(&mut self, entry: impl Fn(usize) -> f64) -> Result<(), SingularMatrix> {
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
                return Err(SingularMatrix);
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
        Ok(())
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
            assert_eq!(lu.factor(|place| a[place]), Ok(()));
            lu.solve(&mut b);
            let off = b.iter().zip(&x).map(|(b, x)| (b - x).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{band:?}: {off}");
        }
    }

    #[test]
    fn reports_a_singular_matrix() {
        for a in [[1.0, 2.0, 2.0, 4.0], [f64::NAN, 0.0, 0.0, 1.0]] {
            let factored = Pivoted::new(Band::new(2, 1)).factor(|place| a[place]);
            assert_eq!(factored, Err(SingularMatrix), "{a:?}");
        }
    }
}
