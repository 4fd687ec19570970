//! Closure equations of a scene with every joint ideal, and their solution at one time.
//!
//! phi(q, t) = 0 `(m,)` for the coordinates q `(n,)`, (x, y, angle) of every free body. For solving, angles
//! and rows that are angles are scaled to lengths, so that norms and singular values are meaningful: by the
//! mechanism's size [m]; angles of bodies that keep a freedom by their radius of gyration, so that least-norm
//! steps depend neither on the place nor on the direction of the whole. Positions follow by Newton's method with
//! least-norm steps, velocities from (dphi/dq) qd = -dphi/dt, accelerations from its derivative.
//!
//! # Source
//! Position, velocity and acceleration analysis: Haug (1989), Computer Aided Kinematics and Dynamics of
//! Mechanical Systems. Least-norm solution by singular values: Golub, Van Loan (2013), Matrix Computations.

use super::constraint::{Constraint, first_rows};
use super::coupling::JointInput;
use super::extent::{ROUNDING, extent, farthest, gyration};
use super::frame::{End, Frame};
use super::prescribed::Prescribed;
use crate::extremum::largest;
use common::scene::{Attachment, Body, Motion, Scene};
use nalgebra::{DMatrix, DVector};

/// Gap below which a joint counts as closed, relative to the mechanism's size.
const CLOSED: f64 = 1e-12;
const MOST_ITERATIONS: usize = 50;
/// Most that a body moves in one iteration, as a share of the mechanism's size or, if that is larger, of the first gap.
const LONGEST_STEP: f64 = 0.5;
/// Smallest over largest pivot of the closures' derivative below which the ideal motion does not count as
/// determined: accelerations near a dead point are thousands of times those elsewhere.
const DETERMINED: f64 = 1e-4;

/// The closure equations of a scene.
pub struct Closure<'a> {
    pub(super) scene: &'a Scene,
    prescribed: Vec<Option<Prescribed>>,
    /// First coordinate of each free body.
    pub(super) first: Vec<Option<usize>>,
    pub(super) constraints: Vec<Constraint>,
    /// What each joint is given.
    inputs: Vec<Option<JointInput>>,
    /// First row of each joint.
    pub(super) row: Vec<usize>,
    pub(super) n: usize,
    pub(super) m: usize,
    /// Size of the mechanism [m]; see [`extent`].
    pub(super) size: f64,
    /// Length of each coordinate: one of a length [1], that by which an angle is a length [m] `(n,)`.
    pub(super) unit: Vec<f64>,
}

/// Gaps of all joints with their derivatives, all as lengths.
pub(super) struct Gaps {
    /// phi `(m,)` [m].
    phi: DVector<f64>,
    /// dphi/dq `(m, n)` [1].
    pub(super) jacobian: DMatrix<f64>,
    /// dphi/dt `(m,)` [m/s].
    pub(super) rate: DVector<f64>,
}

impl<'a> Closure<'a> {
    /// The closure equations of a checked scene.
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let mut n = 0;
        let mut first = Vec::with_capacity(scene.bodies.len());
        for body in &scene.bodies {
            let free = matches!(body.motion, Motion::Free { .. });
            first.push(free.then_some(n));
            n += if free { 3 } else { 0 };
        }
        let end = |at: &Attachment| End { frame: at.body, arm: scene.arm(at) };
        let constraints: Vec<Constraint> = scene
            .joints
            .iter()
            .enumerate()
            .map(|(k, j)| Constraint::new(k, [end(&j.journal), end(&j.bushing)], &j.kind))
            .collect();
        let (row, m) = first_rows(&constraints);
        let size = extent(scene);
        // Without freedom the weights matter for rounding alone.
        let arm = |body: &Body| gyration(body).map(|radius| if m < n { radius } else { size });
        let unit = scene.bodies.iter().filter_map(arm).flat_map(|arm| [1.0, 1.0, arm]).collect();
        let prescribed = scene.bodies.iter().map(Prescribed::from_body).collect();
        let inputs = scene.joints.iter().map(|joint| JointInput::new(&joint.kind)).collect();
        Closure { scene, prescribed, first, constraints, inputs, row, n, m, size, unit }
    }

    /// Coordinates of the scene's approximate start.
    pub(crate) fn start(&self) -> DVector<f64> {
        let mut q = DVector::zeros(self.n);
        for (body, first) in self.scene.bodies.iter().zip(&self.first) {
            if let (Motion::Free { centre_of_mass, start_position, start_angle, .. }, Some(k)) =
                (&body.motion, *first)
            {
                let frame = Frame::free(&[start_position[0], start_position[1], *start_angle], &[0.0; 3]);
                let x = frame.point(*centre_of_mass);
                (q[k], q[k + 1], q[k + 2]) = (x[0], x[1], *start_angle);
            }
        }
        q
    }

    /// Frame of a body of the scene at rest, at time `t` [s] and coordinates `q`.
    pub(super) fn frame(&self, body: usize, t: f64, q: &DVector<f64>) -> Frame {
        match (self.first[body], &self.prescribed[body]) {
            (Some(k), _) => Frame::free(&[q[k], q[k + 1], q[k + 2]], &[0.0; 3]),
            (None, Some(p)) => p.frame(t),
            (None, None) => Frame::default(),
        }
    }

    /// Joint `k` with what it is given at time `t` [s] and this frame of its second body.
    fn joint_at(&self, k: usize, t: f64, second: &Frame) -> Constraint {
        let mut c = self.constraints[k];
        if let Some(input) = &self.inputs[k] {
            c.input = input.jet(t, second.angle);
        }
        c
    }

    pub(super) fn gaps(&self, t: f64, q: &DVector<f64>) -> Gaps {
        let mut gaps = Gaps {
            phi: DVector::zeros(self.m),
            jacobian: DMatrix::zeros(self.m, self.n),
            rate: DVector::zeros(self.m),
        };
        for (k, &row) in self.row.iter().enumerate() {
            let frames = self.constraints[k].ends.map(|end| self.frame(end.frame, t, q));
            let c = self.joint_at(k, t, &frames[1]);
            if let Some([rate, _]) = c.over_time() {
                gaps.rate[row] += rate;
            }
            let (phi, g) = c.position(&frames[0], &frames[1]);
            for r in 0..c.rows() {
                let unit = if c.is_angle(r) { self.size } else { 1.0 };
                gaps.phi[row + r] = unit * phi[r];
                for (side, end) in c.ends.iter().enumerate() {
                    if let Some(first) = self.first[end.frame] {
                        for k in 0..3 {
                            let unit = unit / self.unit[first + k];
                            gaps.jacobian[(row + r, first + k)] = unit * g[r][3 * side + k];
                        }
                    } else {
                        gaps.rate[row + r] += unit * g[r][3 * side + 2] * frames[side].omega;
                    }
                }
            }
        }
        gaps
    }

    /// From lengths to coordinates.
    pub(super) fn to_coordinates(&self, mut x: DVector<f64>) -> DVector<f64> {
        x.iter_mut().zip(&self.unit).for_each(|(x, unit)| *x /= unit);
        x
    }

    /// From coordinates to lengths.
    pub(super) fn to_lengths(&self, mut x: DVector<f64>) -> DVector<f64> {
        x.iter_mut().zip(&self.unit).for_each(|(x, unit)| *x *= unit);
        x
    }

    /// Largest component of a change of coordinates, as a length [m].
    pub(crate) fn largest(&self, x: &DVector<f64>) -> f64 {
        largest(x.iter().zip(&self.unit).map(|(x, unit)| x.abs() * unit))
    }

    /// The joint with the largest gap in these gaps.
    fn most_open(&self, phi: &DVector<f64>) -> (usize, f64) {
        let mut worst = (0, 0.0);
        for (joint, (c, &row)) in self.constraints.iter().zip(&self.row).enumerate() {
            let gap = phi.rows(row, c.rows()).norm();
            // A comparison with NaN is false: count it as the largest gap.
            if gap > worst.1 || gap.is_nan() {
                worst = (joint, gap);
            }
        }
        worst
    }

    /// The joint that the coordinates `q` leave open most at time `t`, with the distance of its points, of a sliding joint across its line
    /// [m], and the size of the angle between its bodies beyond the one it prescribes [rad].
    pub(crate) fn contradiction(&self, t: f64, q: &DVector<f64>) -> (usize, f64, f64) {
        let phi = self.gaps(t, q).phi;
        let (joint, _) = self.most_open(&phi);
        let (c, row) = (&self.constraints[joint], self.row[joint]);
        let of = |wanted: bool| (0..c.rows()).filter(move |&r| c.is_angle(r) == wanted).map(|r| phi[row + r]);
        let gap = of(false).fold(0.0, libm::hypot);
        (joint, gap, of(true).map(|angle| angle.abs() / self.size).sum())
    }

    /// Closes every joint at time `t` by Newton's method from `q`.
    ///
    /// # Errors
    /// The joint of the largest remaining gap.
    pub(crate) fn close(&self, t: f64, q: &mut DVector<f64>, iterations: &mut u64) -> Result<(), usize> {
        let mut worst = 0;
        let mut bound = None;
        for _ in 0..MOST_ITERATIONS {
            let Gaps { phi, jacobian, .. } = self.gaps(t, q);
            let (joint, gap) = self.most_open(&phi);
            worst = joint;
            if gap <= (CLOSED * self.size).max(ROUNDING * farthest(q.as_slice(), self.size)) {
                return Ok(());
            }
            *iterations += 1;
            let step = self.to_coordinates(least_norm(&jacobian, &phi));
            let bound = *bound.get_or_insert(LONGEST_STEP * gap.max(self.size));
            let longest = self.largest(&step);
            *q -= step * (bound / longest).min(1.0);
        }
        Err(worst)
    }

    /// Velocities at a closed position `(n,)` as far as the drives determine them: the least ones that satisfy drives and joints.
    pub(crate) fn velocity(&self, t: f64, q: &DVector<f64>) -> DVector<f64> {
        let Gaps { jacobian, rate, .. } = self.gaps(t, q);
        let still = DVector::zeros(self.n);
        still - self.to_coordinates(least_norm(&jacobian, &rate))
    }

    /// Accelerations at (q, v) `(n,)`: (dphi/dq) qdd = -(second time derivative of phi at qdd = 0); `None` if
    /// the closures leave a freedom, or nearly so.
    pub(crate) fn acceleration(&self, t: f64, q: &DVector<f64>, v: &DVector<f64>) -> Option<DVector<f64>> {
        let jacobian = self.gaps(t, q).jacobian;
        let mut second = DVector::zeros(self.m);
        for (k, &row) in self.row.iter().enumerate() {
            let frames = self.constraints[k].ends.map(|end| match self.first[end.frame] {
                Some(k) => Frame::free(&[q[k], q[k + 1], q[k + 2]], &[v[k], v[k + 1], v[k + 2]]),
                None => self.frame(end.frame, t, q),
            });
            let c = self.joint_at(k, t, &frames[1]);
            let h = c.centripetal(&frames[0], &frames[1]);
            let (_, g) = c.position(&frames[0], &frames[1]);
            for r in 0..c.rows() {
                let given = c.ends.iter().enumerate().map(|(side, end)| {
                    let alpha = self.prescribed[end.frame].as_ref().map_or(0.0, |p| p.jet(t)[2]);
                    g[r][3 * side + 2] * alpha
                });
                let unit = if c.is_angle(r) { self.size } else { 1.0 };
                second[row + r] = unit * (h[r] + given.sum::<f64>());
            }
        }
        if self.n == 0 || self.m < self.n {
            return None;
        }
        Some(self.to_coordinates(-determined(jacobian, second)?))
    }

    /// Multipliers lambda `(m,)` of the closures that balance a generalised force `gradient` `(n,)` at time `t` [s] with the drives held:
    /// (dphi/dq)' lambda = gradient. By virtual work, gaps phi in the joints move the coordinate whose gradient it is by lambda . phi.
    /// `None` if joints and drives do not just determine the position, or nearly do not.
    pub(crate) fn multipliers(
        &self,
        t: f64,
        q: &DVector<f64>,
        gradient: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        if self.n == 0 || self.m != self.n {
            return None;
        }
        let jacobian = self.gaps(t, q).jacobian;
        let mut lambda = determined(jacobian.transpose(), self.to_coordinates(gradient.clone()))?;
        for (c, &row) in self.constraints.iter().zip(&self.row) {
            for r in (0..c.rows()).filter(|&r| c.is_angle(r)) {
                lambda[row + r] *= self.size;
            }
        }
        Some(lambda)
    }

    /// The multipliers of one joint, of those of all closures `(rows,)`.
    pub(crate) fn of_joint<'l>(&self, joint: usize, lambda: &'l DVector<f64>) -> &'l [f64] {
        &lambda.as_slice()[self.row[joint]..][..self.constraints[joint].rows()]
    }

    /// Gradient `(n,)` of the coordinate that `along` `(3,)` picks from those of a free body of the scene.
    pub(crate) fn gradient(&self, body: usize, along: [f64; 3]) -> Option<DVector<f64>> {
        let first = self.first[body]?;
        let mut gradient = DVector::zeros(self.n);
        gradient.rows_mut(first, 3).copy_from_slice(&along);
        Some(gradient)
    }

    /// Coordinates `(n,)` from those of each free body, by body of the scene.
    pub(crate) fn joined(&self, x: &[Option<[f64; 3]>]) -> DVector<f64> {
        DVector::from_vec(x.iter().flatten().flatten().copied().collect())
    }

    /// Coordinates of each free body, by body of the scene.
    pub(crate) fn split(&self, x: &DVector<f64>) -> Vec<Option<[f64; 3]>> {
        self.first.iter().map(|first| first.map(|k| [x[k], x[k + 1], x[k + 2]])).collect()
    }
}

/// Solution of `a x = b`; `None` if it is not determined.
fn determined(a: DMatrix<f64>, b: DVector<f64>) -> Option<DVector<f64>> {
    let qr = a.qr();
    let r = qr.r();
    let pivots = r.diagonal().abs();
    if pivots.min() < DETERMINED * pivots.max() {
        return None;
    }
    r.solve_upper_triangular(&(qr.q().transpose() * b))
}

/// Least-norm, least-squares solution of `a x = b`: by the normal equations of the rows if these are
/// independent, else by singular values.
pub(super) fn least_norm(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    if a.is_empty() {
        return DVector::zeros(a.ncols());
    }
    if a.nrows() <= a.ncols()
        && let Some(factor) = (a * a.transpose()).cholesky()
    {
        let diagonal = factor.l_dirty().diagonal();
        if diagonal.min() > 1e-4 * diagonal.max() {
            return a.transpose() * factor.solve(b);
        }
    }
    let svd = a.clone().svd(true, true);
    let cut = 1e-10 * svd.singular_values.max();
    let solve = |b: &DVector<f64>| svd.solve(b, cut).unwrap_or_else(|_| DVector::zeros(a.ncols()));
    // Refined once: the decomposition alone left a residual of up to 1e-6 of the solution.
    let x = solve(b);
    let missing = b - a * &x;
    x + solve(&missing)
}
