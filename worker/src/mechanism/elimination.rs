//! Elimination of an island's ideal joints: the equations of motion keep the form M qdd = f, with the joints'
//! reactions part of f.
//!
//! M a + G' lambda = f and G a + h = 0, with the diagonal mass matrix M [kg, kg m^2], the accelerations a
//! `(n,)`, the derivative G `(m, n)` of the constraints to the coordinates, the multipliers lambda `(m,)` [N,
//! N m] and the centripetal part h `(m,)` (accelerations of prescribed bodies included). With G M^-1/2 = R'
//! Q', Q `(n, m)` orthonormal and R `(m, m)` upper triangular, and z = R^-T h, the force with reactions is
//!
//! f - G' lambda = M^1/2 [(1 - Q Q') M^-1/2 f - Q z]:
//!
//! the part of f in the null space of the constraints, and the part that keeps them closed. No product G M^-1
//! G' is formed, so that bodies almost without inertia do no harm. The exact derivatives follow from the same
//! Q and R: for a column x of coordinates, rates or time, f is replaced by df/dx - d(G' lambda)/dx and h by
//! d(G a + h)/dx. Positions and velocities that the integration lets drift off the constraints are moved back
//! along M^-1/2 Q.
//!
//! Valid where the rows of G are independent: a redundant or singular set of joints is reported, not
//! repaired. One source serves one island and one island per SIMD lane.
//!
//! # Source
//! Udwadia, Kalaba (1992), Proc. R. Soc. Lond. A 439, 407-410 (the force with reactions; here the
//! pseudo-inverse is Q R^-T). QR factors for constrained mechanisms: Kim, Vanderploeg (1986), J. Mech. Trans.
//! Autom. Des. 108, 183-188. Null space method: Benzi, Golub, Liesen (2005), Acta Numerica 14, 1-137.
//! Coordinate projection: Eich (1993), SIAM J. Numer. Anal. 30, 1467-1482.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use super::constraint::{Constraint, first_rows};
use super::frame::Frame;
use super::piecewise_cubic::Jet;
use crate::integrate::Linearised;
use crate::lanes::{Lanewise, Real};

/// The ideal joints of an island with `n` coordinates and `m` rows of constraints, or of one island per lane.
#[derive(Debug, Clone)]
pub struct Elimination<R = f64> {
    /// The ideal joints as constraints.
    pub constraints: Vec<Constraint<R>>,
    /// First row of each.
    first: Vec<usize>,
    /// Number of coordinates n.
    n: usize,
    /// Number of rows m.
    m: usize,
    /// Values phi of the constraints, or another column `(m,)`.
    phi: Vec<R>,
    /// Q', orthonormal rows `(m, n)`.
    basis: Vec<R>,
    /// Q' M^-1/2 and Q' M^1/2 `(m, n)` each.
    per_root: Vec<R>,
    by_root: Vec<R>,
    /// R', lower triangular, with the inverses of its diagonal on it `(m, m)`.
    r: Vec<R>,
    /// h, later the multipliers lambda `(m,)`.
    lambda: Vec<R>,
    /// Derivatives of G a + h `(m, n)`.
    c: Vec<R>,
    /// Square roots of the masses, and their inverses `(n,)` each.
    root: Vec<R>,
    inverse_root: Vec<R>,
}

/// A row counts as dependent if its part normal to the rows before it is below this share of its length.
const DEPENDENT: f64 = 1e-10;

/// State of an island's bodies, free ones first.
#[derive(Clone, Copy)]
pub struct Placed<'a, R = f64> {
    /// Frames of the free bodies, then of the prescribed ones.
    pub frames: &'a [Frame<R>],
    /// Angle and derivatives of the prescribed bodies.
    pub jets: &'a [Jet<R>],
    /// Diagonal of M `(n,)` [kg, kg m^2].
    pub mass: &'a [R],
}

impl<'a, R: Real> Placed<'a, R> {
    /// Angle and derivatives of the prescribed body of frame `index`; `None` for a free body.
    #[inline(always)]
    fn jet(&self, index: usize) -> Option<&'a Jet<R>> {
        let free = self.frames.len() - self.jets.len();
        if index < free { None } else { Some(&self.jets[index - free]) }
    }

    /// Frames of the two bodies that a constraint joins.
    #[inline(always)]
    fn pair(&self, c: &Constraint<R>) -> [&'a Frame<R>; 2] {
        [&self.frames[c.ends[0].frame], &self.frames[c.ends[1].frame]]
    }
}

impl Elimination {
    /// The elimination for an island with the diagonal mass matrix `mass` `(n,)` [kg, kg m^2].
    pub(crate) fn new(constraints: Vec<Constraint>, mass: &[f64]) -> Self {
        let root = mass.iter().map(|mass| mass.sqrt()).collect();
        Self::with_roots(constraints, root, 0.0)
    }

    /// This elimination in every lane; `like` sets the number of lanes.
    pub(crate) fn in_lanes<R: Real>(&self, like: R) -> Elimination<R> {
        let constraints = self.constraints.iter().map(|c| c.in_lanes(like)).collect();
        let root = self.root.iter().map(|root| root.in_lanes(like)).collect();
        Elimination::with_roots(constraints, root, like)
    }

    /// Writes the constants of this elimination into lane `lane` of `to`, an elimination of the same topology.
    pub(crate) fn write_lane<R: Real>(&self, lane: usize, to: &mut Elimination<R>) {
        for (to, from) in to.constraints.iter_mut().zip(&self.constraints) {
            from.write_lane::<R>(lane, to);
        }
        for k in 0..self.n {
            to.root[k].set_lane(lane, self.root[k]);
            to.inverse_root[k].set_lane(lane, self.inverse_root[k]);
        }
    }

    /// Whether both join the same bodies by the same kinds of joints.
    pub(crate) fn has_same_topology(&self, other: &Self) -> bool {
        let pairs = self.constraints.iter().zip(&other.constraints);
        self.constraints.len() == other.constraints.len()
            && pairs.into_iter().all(|(a, b)| a.has_same_topology(b))
    }
}

impl<R: Real> Elimination<R> {
    /// The elimination for masses with the square roots `root` `(n,)`; `like` sets the number of lanes.
    fn with_roots(constraints: Vec<Constraint<R>>, root: Vec<R>, like: R) -> Self {
        let (zero, one) = (like.zero(), like.like(1.0));
        let n = root.len();
        let (first, m) = first_rows(&constraints);
        Elimination {
            constraints,
            first,
            n,
            m,
            phi: vec![zero; m],
            basis: vec![zero; m * n],
            per_root: vec![zero; m * n],
            by_root: vec![zero; m * n],
            r: vec![zero; m * m],
            lambda: vec![zero; m],
            c: vec![zero; m * n],
            inverse_root: root.iter().map(|root| one / *root).collect(),
            root,
        }
    }

    /// Number m of scalar constraints.
    #[inline(always)]
    pub(crate) fn rows(&self) -> usize {
        self.m
    }

    /// Fills phi, Q and R. Returns one, zero in lanes where the constraints are dependent.
    #[inline(always)]
    fn factor(&mut self, at: Placed<R>) -> R {
        let n = self.n;
        let zero = at.mass[0].zero();
        self.basis.fill(zero);
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c);
            let (phi, rows) = c.position(a, b);
            for r in 0..c.rows() {
                self.phi[first + r] = phi[r];
                for side in 0..2 {
                    let frame = c.ends[side].frame;
                    if at.jet(frame).is_some() {
                        continue;
                    }
                    for k in 0..3 {
                        self.basis[(first + r) * n + 3 * frame + k] =
                            rows[r][3 * side + k] * self.inverse_root[3 * frame + k];
                    }
                }
            }
        }
        self.orthonormalise(zero)
    }

    /// Turns the rows of `basis` into Q' and R' by the Gram-Schmidt method, twice. Returns one, zero in lanes where the rows are
    /// dependent.
    #[inline(always)]
    fn orthonormalise(&mut self, zero: R) -> R {
        let (n, m) = (self.n, self.m);
        let one = zero.like(1.0);
        let mut independent = one;
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
        independent
    }

    /// Adds the reactions to the applied force `f`. Returns one, zero in lanes where the constraints are dependent; there the force is
    /// not a number.
    #[inline(always)]
    pub(crate) fn add_reactions(&mut self, at: Placed<R>, f: &mut [R]) -> R {
        let independent = self.factor(at);
        let (n, m) = (self.n, self.m);
        let zero = independent.zero();
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c);
            let h = c.centripetal(a, b);
            for r in 0..c.rows() {
                self.lambda[first + r] = h[r];
            }
            for side in 0..2 {
                if let Some(jet) = at.jet(c.ends[side].frame) {
                    let (_, rows) = c.position(a, b);
                    for r in 0..c.rows() {
                        self.lambda[first + r] =
                            self.lambda[first + r].plus_product(rows[r][3 * side + 2], jet[2]);
                    }
                }
            }
        }
        // z = R^-T h in the place of h, then lambda = R^-1 (Q' M^-1/2 f + z) and the force left.
        forward(&self.r, m, &mut self.lambda, 1);
        for i in 0..m {
            let row = &self.per_root[i * n..i * n + n];
            let mut sum = self.lambda[i];
            for k in 0..n {
                sum = sum.plus_product(row[k], f[k]);
            }
            self.lambda[i] = sum;
        }
        for i in 0..m {
            let (row, share) = (&self.by_root[i * n..i * n + n], self.lambda[i]);
            for k in 0..n {
                f[k] = f[k].minus_product(share, row[k]);
            }
        }
        backward(&self.r, m, &mut self.lambda);
        let nothing = zero.like(f64::NAN);
        let exists = zero.below(independent);
        for k in 0..n {
            f[k] = R::select(exists, f[k], nothing);
        }
        independent
    }

    /// After [`Self::add_reactions`] to `to.f`: turns the derivatives of the applied force in `to` into those
    /// of the force with reactions, stores the multipliers, and adds the reactions on prescribed bodies.
    #[inline(always)]
    pub(crate) fn reduce_derivatives(&mut self, at: Placed<R>, to: &mut Linearised<R>) {
        let n = self.n;
        to.lambda.copy_from_slice(&self.lambda);
        self.explicit_reaction_terms(at, to);
        // The accelerations are those with reactions, the same for both.
        self.constraint_derivatives(at, &to.f, false);
        reduce(&self.per_root, &self.by_root, &self.r, &mut self.c, &mut to.k, n, n);
        self.constraint_derivatives(at, &to.f, true);
        reduce(&self.per_root, &self.by_root, &self.r, &mut self.c, &mut to.d, n, n);
        self.time_derivative(at, &to.f);
        reduce(&self.per_root, &self.by_root, &self.r, &mut self.phi, &mut to.ft, n, 1);
    }

    /// Subtracts d(G' lambda)/dx, and the reactions on prescribed bodies.
    #[inline(always)]
    fn explicit_reaction_terms(&self, at: Placed<R>, to: &mut Linearised<R>) {
        let n = self.n;
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c);
            let lambda = &self.lambda[first..first + c.rows()];
            let derivative = c.reaction_derivative(a, b, lambda);
            let (_, rows) = c.position(a, b);
            for side in 0..2 {
                let frame = c.ends[side].frame;
                if at.jet(frame).is_some() {
                    let on = &mut to.prescribed[frame - n / 3];
                    for k in 0..3 {
                        for r in 0..c.rows() {
                            on[k] = on[k].minus_product(rows[r][3 * side + k], lambda[r]);
                        }
                    }
                    continue;
                }
                for r in 0..3 {
                    let row = 3 * frame + r;
                    for other in 0..2 {
                        let to_frame = c.ends[other].frame;
                        let entries = &derivative[3 * side + r];
                        match at.jet(to_frame) {
                            Some(jet) => {
                                to.ft[row] = to.ft[row].minus_product(entries[3 * other + 2], jet[1]);
                            }
                            None => {
                                for k in 0..3 {
                                    to.k[row * n + 3 * to_frame + k] -= entries[3 * other + k];
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Accelerations of the pair that a constraint joins `(6,)`, at the force with reactions `f`.
    #[inline(always)]
    fn accelerations(&self, c: &Constraint<R>, at: Placed<R>, f: &[R]) -> [R; 6] {
        let mut a = [f[0].zero(); 6];
        for side in 0..2 {
            let frame = c.ends[side].frame;
            match at.jet(frame) {
                Some(jet) => a[3 * side + 2] = jet[2],
                None => {
                    for k in 0..3 {
                        let inverse = self.inverse_root[3 * frame + k];
                        a[3 * side + k] = f[3 * frame + k] * inverse * inverse;
                    }
                }
            }
        }
        a
    }

    /// Fills c with the derivatives of G a + h to the coordinates, or to their rates.
    #[inline(always)]
    fn constraint_derivatives(&mut self, at: Placed<R>, f: &[R], rates: bool) {
        let n = self.n;
        self.c.fill(f[0].zero());
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c);
            let (to_q, to_v) = c.acceleration_derivatives(a, b, &self.accelerations(&c, at, f));
            let rows = if rates { &to_v } else { &to_q };
            for side in 0..2 {
                let frame = c.ends[side].frame;
                if at.jet(frame).is_some() {
                    continue;
                }
                for r in 0..c.rows() {
                    for k in 0..3 {
                        self.c[(first + r) * n + 3 * frame + k] = rows[r][3 * side + k];
                    }
                }
            }
        }
    }

    /// Fills phi with the derivative of G a + h to time through the prescribed bodies.
    #[inline(always)]
    fn time_derivative(&mut self, at: Placed<R>, f: &[R]) {
        self.phi.fill(f[0].zero());
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            if at.jet(c.ends[0].frame).is_none() && at.jet(c.ends[1].frame).is_none() {
                continue;
            }
            let [a, b] = at.pair(&c);
            let (_, g) = c.position(a, b);
            let (to_q, to_v) = c.acceleration_derivatives(a, b, &self.accelerations(&c, at, f));
            for side in 0..2 {
                if let Some([_, omega, alpha, jerk]) = at.jet(c.ends[side].frame) {
                    let k = 3 * side + 2;
                    for r in 0..c.rows() {
                        let phi = &mut self.phi[first + r];
                        *phi = phi
                            .plus_product(to_q[r][k], *omega)
                            .plus_product(to_v[r][k], *alpha)
                            .plus_product(g[r][k], *jerk);
                    }
                }
            }
        }
    }

    /// Prepares a Newton step of the positions back onto the constraints, dq = -M^-1/2 Q R^-T phi. Returns the largest gap before it
    /// (angles times `size`) [m], and one, zero in lanes where the constraints are dependent.
    #[inline(always)]
    pub(crate) fn measure_gaps(&mut self, at: Placed<R>, size: R) -> (R, R) {
        let independent = self.factor(at);
        let mut gap = independent.zero();
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            for k in 0..c.rows() {
                let phi = self.phi[first + k].abs();
                gap = gap.larger(if c.is_angle(k) { phi * size } else { phi });
            }
        }
        self.lambda.copy_from_slice(&self.phi);
        forward(&self.r, self.m, &mut self.lambda, 1);
        (gap, independent)
    }

    /// After [`Self::measure_gaps`] has found no gap: prepares the projection of the velocities onto the constraints, dv =
    /// -M^-1/2 Q (Q' M^1/2 v + R^-T dphi/dt).
    #[inline(always)]
    pub(crate) fn measure_velocities(&mut self, at: Placed<R>, v: &[R]) {
        let (n, m) = (self.n, self.m);
        let zero = v[0].zero();
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c);
            let (_, rows) = c.position(a, b);
            for r in 0..c.rows() {
                let mut given = zero;
                for side in 0..2 {
                    if let Some(jet) = at.jet(c.ends[side].frame) {
                        given = given.plus_product(rows[r][3 * side + 2], jet[1]);
                    }
                }
                self.lambda[first + r] = given;
            }
        }
        forward(&self.r, m, &mut self.lambda, 1);
        for i in 0..m {
            let row = &self.by_root[i * n..i * n + n];
            let mut sum = self.lambda[i];
            for k in 0..n {
                sum = sum.plus_product(row[k], v[k]);
            }
            self.lambda[i] = sum;
        }
    }

    /// x -= M^-1/2 Q lambda with what was prepared last, in lanes where `which` is one.
    #[inline(always)]
    pub(crate) fn move_back(&self, which: R, x: &mut [R]) {
        let n = self.n;
        let moves = which.zero().below(which);
        for k in 0..n {
            let mut new = x[k];
            for i in 0..self.m {
                new = new.minus_product(self.lambda[i], self.per_root[i * n + k]);
            }
            x[k] = R::select(moves, new, x[k]);
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

/// Replaces `x` by R^-T x `(m, columns)`.
#[inline(always)]
fn forward<R: Real>(r: &[R], m: usize, x: &mut [R], columns: usize) {
    for i in 0..m {
        let (done, rest) = x.split_at_mut(i * columns);
        let row = &mut rest[..columns];
        for j in 0..i {
            let (known, factor) = (&done[j * columns..j * columns + columns], r[i * m + j]);
            for k in 0..columns {
                row[k] = row[k].minus_product(factor, known[k]);
            }
        }
        for k in 0..columns {
            row[k] = row[k] * r[i * m + i];
        }
    }
}

/// Replaces `x` by R^-1 x `(m,)`.
#[inline(always)]
fn backward<R: Real>(r: &[R], m: usize, x: &mut [R]) {
    for back in 0..m {
        let i = m - 1 - back;
        for k in i + 1..m {
            x[i] = x[i].minus_product(r[k * m + i], x[k]);
        }
        x[i] = x[i] * r[i * m + i];
    }
}

/// Replaces `x` by M^1/2 [(1 - Q Q') M^-1/2 x - Q R^-T c] `(n, columns)`, with `c` `(m, columns)` and Q' M^-1/2, Q' M^1/2 `(m, n)`.
#[inline(always)]
fn reduce<R: Real>(
    per_root: &[R],
    by_root: &[R],
    r: &[R],
    c: &mut [R],
    x: &mut [R],
    n: usize,
    columns: usize,
) {
    let m = per_root.len() / n;
    forward(r, m, c, columns);
    for i in 0..m {
        let sums = &mut c[i * columns..i * columns + columns];
        for row in 0..n {
            let (q, x) = (per_root[i * n + row], &x[row * columns..row * columns + columns]);
            for k in 0..columns {
                sums[k] = sums[k].plus_product(q, x[k]);
            }
        }
    }
    for row in 0..n {
        let x = &mut x[row * columns..row * columns + columns];
        for i in 0..m {
            let (q, c) = (by_root[i * n + row], &c[i * columns..i * columns + columns]);
            for k in 0..columns {
                x[k] = x[k].minus_product(q, c[k]);
            }
        }
    }
}
