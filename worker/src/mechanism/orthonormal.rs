//! The constraints' derivative G M^-1/2 = R' Q' with orthonormal rows Q', and products with its factors, of one island or one island per SIMD
//! lane.
//!
//! # Source
//! Gram-Schmidt with reorthogonalisation: Golub, Van Loan (2013), Matrix Computations, section 5.2; twice is enough: Giraud,
//! Langou, Rozloznik (2005), Comput. Math. Appl. 50, 1069-1075.

use crate::lanes::Real;

/// A row counts as dependent if its part normal to the rows before it is below this share of its length.
pub(super) const DEPENDENT: f64 = 1e-10;
/// Share below which the rows are nearly dependent.
const NEARLY: f64 = 0.2;

/// Rows G `(m, n)` in the metric of the diagonal mass matrix M, orthonormalised.
#[derive(Debug, Clone)]
pub struct OrthonormalRows<R = f64> {
    m: usize,
    /// Q', orthonormal rows `(m, n)`.
    basis: Vec<R>,
    /// Q' M^-1/2 and Q' M^1/2 `(m, n)` each.
    per_root: Vec<R>,
    by_root: Vec<R>,
    /// R', lower triangular, with the inverses of its diagonal on it `(m, m)`.
    r: Vec<R>,
    /// Square roots of the masses, and their inverses `(n,)` each.
    pub(super) root: Vec<R>,
    inverse_root: Vec<R>,
    /// One where no row was nearly dependent on those before it when they were orthonormalised last, else zero.
    pub(super) apart: R,
}

impl<R: Real> OrthonormalRows<R> {
    /// Space for `m` rows, for masses with the square roots `root` `(n,)`; `like` sets the number of lanes.
    pub(super) fn new(m: usize, root: Vec<R>, like: R) -> Self {
        let (zero, n) = (like.zero(), root.len());
        OrthonormalRows {
            m,
            basis: vec![zero; m * n],
            per_root: vec![zero; m * n],
            by_root: vec![zero; m * n],
            r: vec![zero; m * m],
            inverse_root: root.iter().map(|root| like.like(1.0) / *root).collect(),
            root,
            apart: like.like(1.0),
        }
    }

    /// Writes the masses of `from` into lane `lane`.
    pub(super) fn set_lane(&mut self, lane: usize, from: &OrthonormalRows) {
        for k in 0..self.root.len() {
            self.root[k].set_lane(lane, from.root[k]);
            self.inverse_root[k].set_lane(lane, from.inverse_root[k]);
        }
    }

    /// Sets all entries of G to zero.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        let zero = self.root[0].zero();
        self.basis.fill(zero);
    }

    /// Sets entry (i, k) of G.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, k: usize, value: R) {
        self.basis[i * self.root.len() + k] = value * self.inverse_root[k];
    }

    /// Acceleration f_k / m_k of coordinate `k`, with its force `f`.
    #[inline(always)]
    pub(super) fn acceleration(&self, k: usize, f: R) -> R {
        f * self.inverse_root[k] * self.inverse_root[k]
    }

    /// Turns the rows of `basis` into Q' and R' by the Gram-Schmidt method, twice. Returns one, zero in lanes where the rows are
    /// dependent.
    #[inline(always)]
    pub(super) fn orthonormalise(&mut self) -> R {
        let (n, m) = (self.root.len(), self.m);
        let zero = self.root[0].zero();
        let one = zero.like(1.0);
        let (mut independent, mut apart) = (one, one);
        self.r.fill(zero);
        for i in 0..m {
            let (done, rest) = self.basis.split_at_mut(i * n);
            let row = &mut rest[..n];
            let before = squares(row, zero);
            for _ in 0..2 {
                for j in 0..i {
                    let other = &done[j * n..j * n + n];
                    let mut share = zero;
                    for k in 0..n {
                        share = share.plus_product(row[k], other[k]);
                    }
                    self.r[i * m + j] += share;
                    for k in 0..n {
                        row[k] = row[k].minus_product(share, other[k]);
                    }
                }
            }
            let left = squares(row, zero);
            // A comparison with what is not a number is false.
            let enough = (before * (DEPENDENT * DEPENDENT)).below(left);
            independent = R::select(enough, independent, zero);
            apart = R::select((before * (NEARLY * NEARLY)).below(left), apart, zero);
            let inverse = one / left.sqrt();
            self.r[i * m + i] = inverse;
            for k in 0..n {
                row[k] = row[k] * inverse;
            }
        }
        for i in 0..m {
            for k in 0..n {
                self.per_root[i * n + k] = self.basis[i * n + k] * self.inverse_root[k];
                self.by_root[i * n + k] = self.basis[i * n + k] * self.root[k];
            }
        }
        self.apart = apart;
        independent
    }

    /// Replaces `x` by R^-T x `(m, columns)`.
    #[inline(always)]
    pub(super) fn forward(&self, x: &mut [R], columns: usize) {
        let m = self.m;
        for i in 0..m {
            let (done, rest) = x.split_at_mut(i * columns);
            let row = &mut rest[..columns];
            for j in 0..i {
                let (known, factor) = (&done[j * columns..j * columns + columns], self.r[i * m + j]);
                for k in 0..columns {
                    row[k] = row[k].minus_product(factor, known[k]);
                }
            }
            for k in 0..columns {
                row[k] = row[k] * self.r[i * m + i];
            }
        }
    }

    /// Replaces `x` by R^-1 x `(m,)`.
    #[inline(always)]
    pub(super) fn backward(&self, x: &mut [R]) {
        let m = self.m;
        for back in 0..m {
            let i = m - 1 - back;
            for k in i + 1..m {
                x[i] = x[i].minus_product(self.r[k * m + i], x[k]);
            }
            x[i] = x[i] * self.r[i * m + i];
        }
    }

    /// Adds Q' M^-1/2 x to `sums` `(m, columns)`, with `x` `(n, columns)`.
    #[inline(always)]
    pub(super) fn add_forces(&self, x: &[R], sums: &mut [R], columns: usize) {
        add_rows(&self.per_root, self.root.len(), x, sums, columns);
    }

    /// Adds Q' M^-1/2 x to `sums` `(m,)`, where x is zero but for `value` at coordinate `k`.
    #[inline(always)]
    pub(super) fn add_force(&self, k: usize, value: R, sums: &mut [R]) {
        for i in 0..self.m {
            sums[i] = sums[i].plus_product(self.per_root[i * self.root.len() + k], value);
        }
    }

    /// Adds Q' M^1/2 v to `sums` `(m,)`, with `v` `(n,)`.
    #[inline(always)]
    pub(super) fn add_velocities(&self, v: &[R], sums: &mut [R]) {
        add_rows(&self.by_root, self.root.len(), v, sums, 1);
    }

    /// Subtracts M^1/2 Q c from `x` `(n, columns)`, with `c` `(m, columns)`.
    #[inline(always)]
    pub(super) fn subtract_reactions(&self, c: &[R], x: &mut [R], columns: usize) {
        let n = self.root.len();
        for row in 0..n {
            let x = &mut x[row * columns..row * columns + columns];
            for i in 0..self.m {
                let (q, c) = (self.by_root[i * n + row], &c[i * columns..i * columns + columns]);
                for k in 0..columns {
                    x[k] = x[k].minus_product(q, c[k]);
                }
            }
        }
    }

    /// Coordinate `k` of x - M^-1/2 Q c, with `c` `(m,)`.
    #[inline(always)]
    pub(super) fn moved_back(&self, k: usize, x: R, c: &[R]) -> R {
        let mut new = x;
        for i in 0..self.m {
            new = new.minus_product(c[i], self.per_root[i * self.root.len() + k]);
        }
        new
    }
}

/// Adds the product of `rows` `(m, n)` with `x` `(n, columns)` to `sums` `(m, columns)`.
#[inline(always)]
fn add_rows<R: Real>(rows: &[R], n: usize, x: &[R], sums: &mut [R], columns: usize) {
    for i in 0..rows.len() / n {
        let sums = &mut sums[i * columns..i * columns + columns];
        for row in 0..n {
            let (q, x) = (rows[i * n + row], &x[row * columns..row * columns + columns]);
            for k in 0..columns {
                sums[k] = sums[k].plus_product(q, x[k]);
            }
        }
    }
}

/// Sum of the squares of `row`.
#[inline(always)]
fn squares<R: Real>(row: &[R], zero: R) -> R {
    let mut sum = zero;
    for x in row {
        sum = sum.plus_product(*x, *x);
    }
    sum
}
