//! Ideal joints of an island, eliminated: the equations of motion keep the form M qdd = f, with the joints'
//! reactions part of f.
//!
//! M a + G' lambda = f and G a + h = 0 (prescribed bodies' accelerations included in h) give, with W = M^-1 and
//! the m x m matrix S = G W G', S lambda = G W f + h and the force f - G' lambda. Its exact derivatives follow
//! from the same matrix: for a column x of coordinates, rates or time, r = df/dx - d(G' lambda)/dx and
//! c = d(G a + h)/dx give r - G' S^-1 (G W r + c). Positions and velocities that the integration lets drift off the
//! constraints are moved back along W G'.

use super::constraint::{Constraint, first_rows};
use super::frame::Frame;
use super::table::Jet;
use crate::integrate::Linearised;
use crate::integrate::linear::{cholesky, cholesky_solve};

/// The ideal joints of an island with `n` coordinates and `m` rows of constraints.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// The joints.
    pub constraints: Vec<Constraint>,
    /// First row of each.
    first: Vec<usize>,
    /// Number of coordinates n.
    n: usize,
    /// Number of rows m.
    m: usize,
    /// Values of the constraints, or another column `(m,)`.
    phi: Vec<f64>,
    /// Their derivative G `(m, n)`.
    g: Vec<f64>,
    /// Factor of S `(m, m)`.
    s: Vec<f64>,
    /// h, later the multipliers lambda `(m,)`.
    lambda: Vec<f64>,
    /// c and S^-1 (G W r + c) `(m, n)`.
    c: Vec<f64>,
}

/// Where the bodies of an island are, prescribed ones after the free ones.
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
    /// The prescribed body that frame `index` belongs to, if it is not a free one.
    fn jet(&self, index: usize) -> Option<&Jet> {
        index.checked_sub(self.frames.len() - self.jets.len()).map(|k| &self.jets[k])
    }
}

impl Elimination {
    /// For an island with `n` coordinates.
    pub fn new(constraints: Vec<Constraint>, n: usize) -> Self {
        let (first, m) = first_rows(&constraints);
        Elimination {
            constraints,
            first,
            n,
            m,
            phi: vec![0.0; m],
            g: vec![0.0; m * n],
            s: vec![0.0; m * m],
            lambda: vec![0.0; m],
            c: vec![0.0; m * n],
        }
    }

    /// Number of scalar constraints m.
    pub fn rows(&self) -> usize {
        self.m
    }

    /// First row and constraint of joint `k`.
    fn joint(&self, k: usize) -> (usize, Constraint) {
        (self.first[k], self.constraints[k])
    }

    /// Fills phi, G and the factor of S; false if the joints' directions are dependent here.
    fn factor(&mut self, at: Placed) -> bool {
        let n = self.n;
        self.g.fill(0.0);
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            let (phi, rows) = c.position(&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            for r in 0..c.rows() {
                self.phi[first + r] = phi[r];
                for (side, end) in c.ends.iter().enumerate() {
                    if at.jet(end.frame).is_none() {
                        for k in 0..3 {
                            self.g[(first + r) * n + 3 * end.frame + k] = rows[r][3 * side + k];
                        }
                    }
                }
            }
        }
        for i in 0..self.m {
            for j in 0..=i {
                let (a, b) = (&self.g[i * n..(i + 1) * n], &self.g[j * n..(j + 1) * n]);
                self.s[i * self.m + j] =
                    a.iter().zip(b).zip(at.mass).map(|((a, b), mass)| a * b / mass).sum();
            }
        }
        cholesky(&mut self.s, self.m)
    }

    /// Adds the reactions to the applied force `f`; false if the joints' directions are dependent here.
    pub fn add_reactions(&mut self, at: Placed, f: &mut [f64]) -> bool {
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
                    for r in 0..c.rows() {
                        self.lambda[first + r] += rows[r][3 * side + 2] * alpha;
                    }
                }
            }
        }
        let rows = self.g.chunks_exact(self.n);
        for (lambda, g) in self.lambda.iter_mut().zip(rows) {
            *lambda += g.iter().zip(f.iter()).zip(at.mass).map(|((g, f), mass)| g * f / mass).sum::<f64>();
        }
        cholesky_solve(&self.s, self.m, &mut self.lambda, 1);
        for (lambda, g) in self.lambda.iter().zip(self.g.chunks_exact(self.n)) {
            f.iter_mut().zip(g).for_each(|(f, g)| *f -= g * lambda);
        }
        true
    }

    /// After [`Self::add_reactions`] to `to.f`: turns the derivatives of the applied force in `to` into those of the
    /// whole one, keeps the multipliers, and adds the reactions on prescribed bodies.
    pub fn reduce_derivatives(&mut self, at: Placed, to: &mut Linearised) {
        let n = self.n;
        to.lambda.copy_from_slice(&self.lambda);
        self.explicit_reaction_terms(at, to);
        for rates in [false, true] {
            self.constraint_derivatives(at, &to.f, rates);
            let matrix = if rates { &mut to.d } else { &mut to.k };
            reduce(&self.g, &self.s, at.mass, &mut self.c, matrix, [self.m, n, n]);
        }
        self.time_derivative(at, &to.f);
        reduce(&self.g, &self.s, at.mass, &mut self.phi, &mut to.ft, [self.m, n, 1]);
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

    /// Accelerations of the pair that a constraint joins, where the force is `f`.
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
                    for r in 0..c.rows() {
                        for k in 0..3 {
                            self.c[(first + r) * self.n + 3 * end.frame + k] = rows[r][3 * side + k];
                        }
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

    /// One Newton step of the positions back onto the constraints, dq = -W G' S^-1 phi; returns the largest gap
    /// before it (angles at arm `size`) [m], or nothing if the joints' directions are dependent here.
    pub fn close_positions(&mut self, at: Placed, size: f64, q: &mut [f64]) -> Option<f64> {
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
        self.move_along(at.mass, q);
        Some(gap)
    }

    /// After [`Self::close_positions`] where nothing was left to close: takes from the velocities what the joints
    /// forbid, dv = -W G' S^-1 (G v + dphi/dt).
    pub fn close_velocities(&mut self, at: Placed, v: &mut [f64]) {
        for joint in 0..self.constraints.len() {
            let (first, c) = self.joint(joint);
            let (_, rows) = c.position(&at.frames[c.ends[0].frame], &at.frames[c.ends[1].frame]);
            for r in 0..c.rows() {
                let g = &self.g[(first + r) * self.n..(first + r + 1) * self.n];
                self.lambda[first + r] = g.iter().zip(v.iter()).map(|(g, v)| g * v).sum();
                for (side, end) in c.ends.iter().enumerate() {
                    if let Some([_, omega, ..]) = at.jet(end.frame) {
                        self.lambda[first + r] += rows[r][3 * side + 2] * omega;
                    }
                }
            }
        }
        self.move_along(at.mass, v);
    }

    /// x -= W G' S^-1 lambda.
    fn move_along(&mut self, mass: &[f64], x: &mut [f64]) {
        cholesky_solve(&self.s, self.m, &mut self.lambda, 1);
        for (lambda, g) in self.lambda.iter().zip(self.g.chunks_exact(self.n)) {
            x.iter_mut().zip(g).zip(mass).for_each(|((x, g), mass)| *x -= g * lambda / mass);
        }
    }
}

/// x - G' S^-1 (G W x + c) for the columns of `x` `(n, columns)` and `c` `(m, columns)`, in place.
fn reduce(g: &[f64], s: &[f64], mass: &[f64], c: &mut [f64], x: &mut [f64], [m, n, columns]: [usize; 3]) {
    for (row, c) in c.chunks_exact_mut(columns).enumerate() {
        for k in 0..n {
            let share = g[row * n + k] / mass[k];
            if share != 0.0 {
                c.iter_mut().zip(&x[k * columns..]).for_each(|(c, x)| *c += share * x);
            }
        }
    }
    cholesky_solve(s, m, c, columns);
    for (row, c) in c.chunks_exact(columns).enumerate() {
        for k in 0..n {
            let share = g[row * n + k];
            if share != 0.0 {
                x[k * columns..(k + 1) * columns].iter_mut().zip(c).for_each(|(x, c)| *x -= share * c);
            }
        }
    }
}
