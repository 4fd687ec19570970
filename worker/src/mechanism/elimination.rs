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
//! repaired.
//!
//! # Source
//! Udwadia, Kalaba (1992), Proc. R. Soc. Lond. A 439, 407-410 (the force with reactions; here the
//! pseudo-inverse is Q R^-T). QR factors for constrained mechanisms: Kim, Vanderploeg (1986), J. Mech. Trans.
//! Autom. Des. 108, 183-188. Null space method: Benzi, Golub, Liesen (2005), Acta Numerica 14, 1-137.
//! Coordinate projection: Eich (1993), SIAM J. Numer. Anal. 30, 1467-1482.

use super::constraint::{Constraint, first_rows};
use super::frame::Frame;
use super::piecewise_cubic::Jet;
use crate::integrate::Linearised;

/// The ideal joints of an island with `n` coordinates and `m` rows of constraints.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// The ideal joints as constraints.
    pub constraints: Vec<Constraint>,
    /// First row of each.
    first: Vec<usize>,
    /// Number of coordinates n.
    n: usize,
    /// Number of rows m.
    m: usize,
    /// Values phi of the constraints, or another column `(m,)`.
    phi: Vec<f64>,
    /// Q', orthonormal rows `(m, n)`.
    basis: Vec<f64>,
    /// R', lower triangular `(m, m)`.
    r: Vec<f64>,
    /// h, later the multipliers lambda `(m,)`.
    lambda: Vec<f64>,
    /// Derivatives of G a + h `(m, n)`.
    c: Vec<f64>,
    /// Square roots of the masses `(n,)`.
    root: Vec<f64>,
}

/// A row counts as dependent if its part normal to the rows before it is below this share of its length.
const DEPENDENT: f64 = 1e-10;

/// State of an island's bodies, free ones first.
#[derive(Clone, Copy)]
pub struct Placed<'a> {
    /// Frames of the free bodies, then of the prescribed ones.
    pub frames: &'a [Frame],
    /// Angle and derivatives of the prescribed bodies.
    pub jets: &'a [Jet],
    /// Diagonal of M `(n,)` [kg, kg m^2].
    pub mass: &'a [f64],
}

impl Placed<'_> {
    /// Angle and derivatives of the prescribed body of frame `index`; `None` for a free body.
    fn jet(&self, index: usize) -> Option<&Jet> {
        index.checked_sub(self.frames.len() - self.jets.len()).map(|k| &self.jets[k])
    }
}

impl Elimination {
    /// The elimination for an island with the diagonal mass matrix `mass` `(n,)` [kg, kg m^2].
    pub(crate) fn new(constraints: Vec<Constraint>, mass: &[f64]) -> Self {
        let n = mass.len();
        let (first, m) = first_rows(&constraints);
        Elimination {
            constraints,
            first,
            n,
            m,
            phi: vec![0.0; m],
            basis: vec![0.0; m * n],
            r: vec![0.0; m * m],
            lambda: vec![0.0; m],
            c: vec![0.0; m * n],
            root: mass.iter().map(|mass| mass.sqrt()).collect(),
        }
    }

    /// Number m of scalar constraints.
    pub(crate) fn rows(&self) -> usize {
        self.m
    }

    /// First row and constraint of joint `k`.
    fn joint(&self, k: usize) -> (usize, Constraint) {
        (self.first[k], self.constraints[k])
    }

    /// Fills phi, Q and R; false if the constraints are dependent here.
    fn factor(&mut self, at: Placed) -> bool {
        let n = self.n;
        self.basis.fill(0.0);
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            let (phi, rows) = c.position(&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            for r in 0..c.rows() {
                self.phi[first + r] = phi[r];
                for (side, end) in c.ends.iter().enumerate().filter(|(_, end)| at.jet(end.frame).is_none()) {
                    for k in 3 * end.frame..3 * end.frame + 3 {
                        self.basis[(first + r) * n + k] =
                            rows[r][3 * side + k - 3 * end.frame] / self.root[k];
                    }
                }
            }
        }
        self.orthonormalise()
    }

    /// Turns the rows of `basis` into Q' and R' by the Gram-Schmidt method, twice; false if they are
    /// dependent.
    fn orthonormalise(&mut self) -> bool {
        let n = self.n;
        self.r.fill(0.0);
        for i in 0..self.m {
            let (done, rest) = self.basis.split_at_mut(i * n);
            let row = &mut rest[..n];
            let length = row.iter().map(|x| x * x).sum::<f64>().sqrt();
            for _ in 0..2 {
                for (j, other) in done.chunks_exact(n).enumerate() {
                    let share: f64 = row.iter().zip(other).map(|(x, y)| x * y).sum();
                    self.r[i * self.m + j] += share;
                    row.iter_mut().zip(other).for_each(|(x, y)| *x -= share * y);
                }
            }
            let left = row.iter().map(|x| x * x).sum::<f64>().sqrt();
            if left.is_nan() || left <= DEPENDENT * length {
                return false;
            }
            self.r[i * self.m + i] = left;
            row.iter_mut().for_each(|x| *x /= left);
        }
        true
    }

    /// Adds the reactions to the applied force `f`; false if the constraints are dependent here.
    pub(crate) fn add_reactions(&mut self, at: Placed, f: &mut [f64]) -> bool {
        if !self.factor(at) {
            return false;
        }
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            let (a, b) = (&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            let h = c.centripetal(a, b);
            self.lambda[first..first + c.rows()].copy_from_slice(&h[..c.rows()]);
            for (side, end) in c.ends.iter().enumerate() {
                if let Some([_, _, alpha, _]) = at.jet(end.frame)
                    && *alpha != 0.0
                {
                    let (_, rows) = c.position(a, b);
                    for (lambda, row) in self.lambda[first..].iter_mut().zip(&rows[..c.rows()]) {
                        *lambda += row[3 * side + 2] * alpha;
                    }
                }
            }
        }
        // z = R^-T h in the place of h, then lambda = R^-1 (Q' M^-1/2 f + z) and the force left.
        forward(&self.r, self.m, &mut self.lambda, 1);
        let weighted = |row: &[f64], f: &[f64], root: &[f64]| -> f64 {
            row.iter().zip(f).zip(root).map(|((q, f), root)| q * f / root).sum()
        };
        for (lambda, row) in self.lambda.iter_mut().zip(self.basis.chunks_exact(self.n)) {
            *lambda += weighted(row, f, &self.root);
        }
        for (share, row) in self.lambda.iter().zip(self.basis.chunks_exact(self.n)) {
            f.iter_mut().zip(row).zip(&self.root).for_each(|((f, q), root)| *f -= share * q * root);
        }
        backward(&self.r, self.m, &mut self.lambda);
        true
    }

    /// After [`Self::add_reactions`] to `to.f`: turns the derivatives of the applied force in `to` into those
    /// of the force with reactions, stores the multipliers, and adds the reactions on prescribed bodies.
    pub(crate) fn reduce_derivatives(&mut self, at: Placed, to: &mut Linearised) {
        let n = self.n;
        to.lambda.copy_from_slice(&self.lambda);
        self.explicit_reaction_terms(at, to);
        for rates in [false, true] {
            self.constraint_derivatives(at, &to.f, rates);
            let matrix = if rates { &mut to.d } else { &mut to.k };
            reduce(&self.basis, &self.r, &self.root, &mut self.c, matrix, n);
        }
        self.time_derivative(at, &to.f);
        reduce(&self.basis, &self.r, &self.root, &mut self.phi, &mut to.ft, 1);
    }

    /// Subtracts d(G' lambda)/dx, and the reactions on prescribed bodies.
    fn explicit_reaction_terms(&self, at: Placed, to: &mut Linearised) {
        let n = self.n;
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            let (a, b) = (&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            let lambda = &self.lambda[first..first + c.rows()];
            let derivative = c.reaction_derivative(a, b, lambda);
            let (_, rows) = c.position(a, b);
            for (side, end) in c.ends.iter().enumerate() {
                if at.jet(end.frame).is_some() {
                    let on = &mut to.prescribed[end.frame - n / 3];
                    for k in 0..3 {
                        on[k] -= (0..c.rows()).map(|r| rows[r][3 * side + k] * lambda[r]).sum::<f64>();
                    }
                    continue;
                }
                for r in 0..3 {
                    let row = 3 * end.frame + r;
                    for (other, to_end) in c.ends.iter().enumerate() {
                        let entries = &derivative[3 * side + r][3 * other..3 * other + 3];
                        match at.jet(to_end.frame) {
                            Some([_, omega, ..]) => to.ft[row] -= entries[2] * omega,
                            None => {
                                for (k, entry) in entries.iter().enumerate() {
                                    to.k[row * n + 3 * to_end.frame + k] -= entry;
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Accelerations of the pair that a constraint joins `(6,)`, at the force with reactions `f`.
    fn accelerations(c: &Constraint, at: Placed, f: &[f64]) -> [f64; 6] {
        let mut a = [0.0; 6];
        for (side, end) in c.ends.iter().enumerate() {
            match at.jet(end.frame) {
                Some([_, _, alpha, _]) => a[3 * side + 2] = *alpha,
                None => {
                    for k in 3 * end.frame..3 * end.frame + 3 {
                        a[3 * side + k - 3 * end.frame] = f[k] / at.mass[k];
                    }
                }
            }
        }
        a
    }

    /// Fills c with the derivatives of G a + h to the coordinates, or to their rates.
    fn constraint_derivatives(&mut self, at: Placed, f: &[f64], rates: bool) {
        self.c.fill(0.0);
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            let (a, b) = (&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            let (to_q, to_v) = c.acceleration_derivatives(a, b, &Self::accelerations(&c, at, f));
            let rows = if rates { &to_v } else { &to_q };
            for (side, end) in c.ends.iter().enumerate() {
                if at.jet(end.frame).is_none() {
                    for (r, row) in rows[..c.rows()].iter().enumerate() {
                        let to = (first + r) * self.n + 3 * end.frame;
                        self.c[to..to + 3].copy_from_slice(&row[3 * side..3 * side + 3]);
                    }
                }
            }
        }
    }

    /// Fills phi with the derivative of G a + h to time through the prescribed bodies.
    fn time_derivative(&mut self, at: Placed, f: &[f64]) {
        self.phi.fill(0.0);
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            if c.ends.iter().all(|end| at.jet(end.frame).is_none_or(|jet| jet[1..] == [0.0; 3])) {
                continue;
            }
            let (a, b) = (&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            let (_, g) = c.position(a, b);
            let (to_q, to_v) = c.acceleration_derivatives(a, b, &Self::accelerations(&c, at, f));
            for (side, end) in c.ends.iter().enumerate() {
                if let Some([_, omega, alpha, jerk]) = at.jet(end.frame) {
                    let k = 3 * side + 2;
                    for r in 0..c.rows() {
                        self.phi[first + r] += to_q[r][k] * omega + to_v[r][k] * alpha + g[r][k] * jerk;
                    }
                }
            }
        }
    }

    /// One Newton step of the positions back onto the constraints, dq = -M^-1/2 Q R^-T phi; returns the
    /// largest gap before it (angles times `size`) [m], or `None` if the constraints are dependent here.
    pub(crate) fn close_positions(&mut self, at: Placed, size: f64, q: &mut [f64]) -> Option<f64> {
        if !self.factor(at) {
            return None;
        }
        let mut gap: f64 = 0.0;
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            for k in 0..c.rows() {
                gap = gap.max(self.phi[first + k].abs() * if c.is_angle(k) { size } else { 1.0 });
            }
        }
        self.lambda.copy_from_slice(&self.phi);
        forward(&self.r, self.m, &mut self.lambda, 1);
        self.move_along(q);
        Some(gap)
    }

    /// After [`Self::close_positions`] has found no gap: projects the velocities onto the constraints, dv =
    /// -M^-1/2 Q (Q' M^1/2 v + R^-T dphi/dt).
    pub(crate) fn close_velocities(&mut self, at: Placed, v: &mut [f64]) {
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            let (_, rows) = c.position(&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            for (lambda, row) in self.lambda[first..].iter_mut().zip(&rows[..c.rows()]) {
                let given = c.ends.iter().enumerate().filter_map(|(side, end)| {
                    at.jet(end.frame).map(|[_, omega, ..]| row[3 * side + 2] * omega)
                });
                *lambda = given.sum();
            }
        }
        forward(&self.r, self.m, &mut self.lambda, 1);
        for (lambda, row) in self.lambda.iter_mut().zip(self.basis.chunks_exact(self.n)) {
            *lambda +=
                row.iter().zip(v.iter()).zip(&self.root).map(|((q, v), root)| q * v * root).sum::<f64>();
        }
        self.move_along(v);
    }

    /// x -= M^-1/2 Q lambda.
    fn move_along(&self, x: &mut [f64]) {
        for (lambda, row) in self.lambda.iter().zip(self.basis.chunks_exact(self.n)) {
            x.iter_mut().zip(row).zip(&self.root).for_each(|((x, q), root)| *x -= lambda * q / root);
        }
    }
}

/// Replaces `x` by R^-T x `(m, columns)`.
fn forward(r: &[f64], m: usize, x: &mut [f64], columns: usize) {
    for i in 0..m {
        let (done, row) = x.split_at_mut(i * columns);
        for (known, factor) in done.chunks_exact(columns).zip(&r[i * m..]) {
            row.iter_mut().zip(known).for_each(|(x, y)| *x -= factor * y);
        }
        row[..columns].iter_mut().for_each(|x| *x /= r[i * m + i]);
    }
}

/// Replaces `x` by R^-1 x `(m,)`.
fn backward(r: &[f64], m: usize, x: &mut [f64]) {
    for i in (0..m).rev() {
        for k in i + 1..m {
            x[i] -= r[k * m + i] * x[k];
        }
        x[i] /= r[i * m + i];
    }
}

/// Replaces `x` by M^1/2 [(1 - Q Q') M^-1/2 x - Q R^-T c] `(n, columns)`, with `c` `(m, columns)`.
fn reduce(basis: &[f64], r: &[f64], root: &[f64], c: &mut [f64], x: &mut [f64], columns: usize) {
    let (n, m) = (root.len(), c.len() / columns);
    forward(r, m, c, columns);
    for (c, row) in c.chunks_exact_mut(columns).zip(basis.chunks_exact(n)) {
        for ((q, root), x) in row.iter().zip(root).zip(x.chunks_exact(columns)) {
            c.iter_mut().zip(x).for_each(|(c, x)| *c += q / root * x);
        }
    }
    for (c, row) in c.chunks_exact(columns).zip(basis.chunks_exact(n)) {
        for ((q, root), x) in row.iter().zip(root).zip(x.chunks_exact_mut(columns)) {
            x.iter_mut().zip(c).for_each(|(x, c)| *x -= q * root * c);
        }
    }
}
