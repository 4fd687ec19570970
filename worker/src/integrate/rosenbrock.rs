//! A linearly implicit Runge-Kutta (Rosenbrock) step of fourth order: one factorisation, three force evaluations and an
//! embedded error estimate of third order.
//!
//! The scheme is GRK4T, A(89.3 deg)-stable; its small numerical damping neither removes a contact vibration nor creates
//! one. For y' = F(t, y) with Jacobian J and step h [s] a stage i solves
//!
//!   (I / (gamma h) - J) u_i = F(t + a_i h, y + sum_j a_ij u_j) + sum_j (c_ij / h) u_j + gamma_i h F_t,
//!
//! then y_new = y + sum b_i u_i with the error estimate sum e_i u_i. For M qdd = f(q, qd, t) [kg, kg m^2; N, N m], with
//! K = df/dq, D = df/dqd and y = (q, qd), the 2n equations of a stage reduce to n:
//!
//!   [M / (gamma h) - D - gamma h K] u_v = M r_v + gamma h K r_q,  u_q = gamma h (r_q + u_v),
//!
//! where (r_q, r_v) is the right-hand side above. The error estimate e is replaced by (I - gamma h J)^-1 e, so that
//! vibrations much faster than the step, which the step damps, do not determine its length.
//!
//! The mass matrix is constant and diagonal; M / (gamma h) - D - gamma h K must be regular without exchange of rows
//! (`linear.rs` reports where it is not, and the step is refused).
//!
//! # Source
//! Kaps, Rentrop: Generalized Runge-Kutta methods of order four with stepsize control for stiff ordinary differential
//! equations, Numerische Mathematik 33 (1979). Coefficients in the transformed form of Hairer, Wanner: Solving Ordinary
//! Differential Equations II (1996), section IV.7. Filter of the estimate: Shampine; Hairer, Wanner, section IV.8.

use super::linear::{add_product, factor, solve};
use super::{Band, Dynamics, Linearised};
use crate::lanes::Real;

/// gamma, the diagonal of the Runge-Kutta matrix.
const GAMMA: f64 = 0.231;
/// a_ij of the second and third stage; the fourth evaluates the force of the third.
const A: [[f64; 2]; 2] = [[2.0, 0.0], [4.524708207373116, 4.163528788597648]];
/// c_ij of the second to fourth stage.
const C: [[f64; 3]; 3] = [
    [-5.071675338776316, 0.0, 0.0],
    [6.020152728650786, 0.1597506846727117, 0.0],
    [-1.856343618686113, -8.505380858179826, -2.084075136023187],
];
/// Weights b_i of the solution, e_i of its error estimate.
const B: [f64; 4] = [3.957503746640777, 4.624892388363313, 0.6174772638750108, 1.282612945269037];
const E: [f64; 4] = [2.302155402932996, 3.073634485392623, -0.8732808018045032, -1.282612945269037];
/// Times a_i of the stages over h, weights gamma_i of df/dt.
const NODE: [f64; 3] = [0.0, 0.462, 0.8802083333333334];
const TIME: [f64; 4] = [0.231, -0.03962966775244303, 0.5507789395789127, -0.05535098457052764];

/// Work space and result of a step; all vectors `(n,)`.
#[derive(Debug, Clone)]
pub struct Rosenbrock<R = f64> {
    matrix: Vec<R>,
    uq: [Vec<R>; 4],
    uv: [Vec<R>; 4],
    q: Vec<R>,
    v: Vec<R>,
    f: Vec<R>,
    rq: Vec<R>,
    /// Positions at the end of the step [m, rad].
    pub new_q: Vec<R>,
    /// Velocities at the end of the step [m/s, rad/s].
    pub new_v: Vec<R>,
    /// Error estimate of the positions [m, rad].
    pub error_q: Vec<R>,
    /// Error estimate of the velocities [m/s, rad/s].
    pub error_v: Vec<R>,
}

/// Where a step starts: linearisation, time [s], length of the step [s] and its inverse [1/s], positions and velocities `(n,)`.
struct Start<'a, R> {
    at: &'a Linearised<R>,
    t: R,
    h: R,
    per_h: R,
    q: &'a [R],
    v: &'a [R],
}

impl<R: Real> Rosenbrock<R> {
    /// Work space for the degrees of freedom of `band`, in as many lanes as `like`.
    pub(crate) fn new(like: R, band: &Band) -> Self {
        let zero = || vec![like.zero(); band.n()];
        Rosenbrock {
            matrix: vec![like.zero(); band.len()],
            uq: std::array::from_fn(|_| zero()),
            uv: std::array::from_fn(|_| zero()),
            q: zero(),
            v: zero(),
            f: zero(),
            rq: zero(),
            new_q: zero(),
            new_v: zero(),
            error_q: zero(),
            error_v: zero(),
        }
    }

    /// Computes a step of length `h` [s] from (`t`, `q`, `v`), where `at` is the linearisation there. Returns zero in lanes
    /// where the matrix of the step is as good as singular, else one.
    #[inline(always)]
    pub(crate) fn step<D: Dynamics<R>>(
        &mut self,
        system: &mut D,
        at: &Linearised<R>,
        t: R,
        h: R,
        q: &[R],
        v: &[R],
    ) -> R {
        let start = Start { at, t, h, per_h: h.like(1.0) / h, q, v };
        // A size known at compile time, of two bodies, makes straight code of the innermost loops.
        let pair = Band::new(6, 6);
        if at.band == pair {
            return self.banded_step(pair, system, &start);
        }
        self.banded_step(at.band, system, &start)
    }

    #[inline(always)]
    fn banded_step<D: Dynamics<R>>(&mut self, band: Band, system: &mut D, start: &Start<R>) -> R {
        let Start { at, h, per_h, .. } = *start;
        let gh = h * GAMMA;
        let per_gh = per_h * (1.0 / GAMMA);
        for ((to, d), k) in self.matrix.iter_mut().zip(&at.d).zip(&at.k) {
            *to = -*d - gh * *k;
        }
        for (i, mass) in system.mass().iter().enumerate() {
            self.matrix[band.index(i, i)] += *mass * per_gh;
        }
        let sound = factor(&mut self.matrix, &band, h);
        // A loop the compiler cannot unroll: the force is inlined once, and the code of a step stays small.
        for stage in 0..std::hint::black_box(4) {
            if stage == 1 || stage == 2 {
                self.stage_force(stage, band, system, start);
            }
            self.solve_stage(stage, band, system.mass(), start);
        }
        self.combine_stages(band, start);
        self.filter_error(&band, at, gh, per_gh, system.mass());
        sound
    }

    /// State and force of the second or third stage.
    // Each loop runs over one row index of several vectors at once.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    fn stage_force<D: Dynamics<R>>(&mut self, stage: usize, band: Band, system: &mut D, start: &Start<R>) {
        let Start { t, h, q, v, .. } = *start;
        let a = A[stage - 1];
        for i in 0..band.n() {
            // The second weight of the first of these stages is zero, and so is what it weighs.
            self.q[i] = q[i] + self.uq[0][i] * a[0] + self.uq[1][i] * a[1];
            self.v[i] = v[i] + self.uv[0][i] * a[0] + self.uv[1][i] * a[1];
        }
        system.force(t + h * NODE[stage], &self.q, &self.v, &mut self.f);
    }

    /// Right-hand sides r_q = v_stage + sum c u_q / h and M r_v = f_stage + d h f_t + M sum c u_v / h, and the stage's solution.
    // Each loop runs over one row index of several vectors at once.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    fn solve_stage(&mut self, stage: usize, band: Band, mass: &[R], start: &Start<R>) {
        let Start { at, h, per_h, v, .. } = *start;
        let n = band.n();
        let gh = h * GAMMA;
        let (before, rest) = self.uv.split_at_mut(stage);
        let rhs = &mut rest[0];
        let (vel, force) = if stage == 0 { (v, at.f.as_slice()) } else { (&*self.v, &*self.f) };
        let ht = h * TIME[stage];
        for i in 0..n {
            let (mut cq, mut cv) = (h.zero(), h.zero());
            for (j, u) in before.iter().enumerate() {
                let c = C[stage - 1][j];
                cq += self.uq[j][i] * c;
                cv += u[i] * c;
            }
            self.rq[i] = vel[i] + cq * per_h;
            rhs[i] = force[i] + ht * at.ft[i] + mass[i] * cv * per_h;
        }
        add_product(&at.k, &band, gh, &self.rq, rhs);
        solve(&self.matrix, &band, rhs);
        for i in 0..n {
            self.uq[stage][i] = gh * (self.rq[i] + rhs[i]);
        }
        if stage == 0 {
            self.uq[1].fill(h.zero());
            self.uv[1].fill(h.zero());
        }
    }

    /// State at the end of the step and its error estimate, before the filter.
    // Each loop runs over one row index of several vectors at once.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    fn combine_stages(&mut self, band: Band, start: &Start<R>) {
        let Start { h, q, v, .. } = *start;
        for i in 0..band.n() {
            let (mut q1, mut v1, mut eq, mut ev) = (q[i], v[i], h.zero(), h.zero());
            for s in 0..4 {
                q1 += self.uq[s][i] * B[s];
                v1 += self.uv[s][i] * B[s];
                eq += self.uq[s][i] * E[s];
                ev += self.uv[s][i] * E[s];
            }
            self.new_q[i] = q1;
            self.new_v[i] = v1;
            self.error_q[i] = eq;
            self.error_v[i] = ev;
        }
    }

    /// Largest error of the step just computed, times the inverse scales of position and velocity that `inverse` returns for each
    /// coordinate [1]; not a number if anything of the step is not finite.
    #[inline(always)]
    pub(crate) fn error(&self, inverse: impl Fn(usize) -> (R, R)) -> R {
        let like = self.new_q[0];
        let (mut worst, mut nothing) = (like.zero(), like.zero());
        for i in 0..self.new_q.len() {
            let (inverse_q, inverse_v) = inverse(i);
            let (eq, ev) = (self.error_q[i].abs() * inverse_q, self.error_v[i].abs() * inverse_v);
            worst = worst.larger(eq).larger(ev);
            // Zero times what is not finite is not a number.
            nothing += (eq + ev + self.new_q[i] + self.new_v[i]) * 0.0;
        }
        worst + nothing
    }

    /// Replaces the error estimate e by (I - gamma h J)^-1 e, which removes vibrations of a contact far faster than the step and
    /// leaves slower motion unchanged.
    #[inline(always)]
    fn filter_error(&mut self, band: &Band, at: &Linearised<R>, gh: R, per_gh: R, mass: &[R]) {
        for (v, mass) in self.error_v.iter_mut().zip(mass) {
            *v = *mass * *v * per_gh;
        }
        add_product(&at.k, band, gh.like(1.0), &self.error_q, &mut self.error_v);
        solve(&self.matrix, band, &mut self.error_v);
        for (q, v) in self.error_q.iter_mut().zip(&self.error_v) {
            *q += gh * *v;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A driven, damped, hardening oscillator: qdd = -q - q^3 - 0.1 qd + cos(3 t) sin(q), in two coordinates.
    struct Duffing;

    impl Dynamics for Duffing {
        fn mass(&self) -> &[f64] {
            &[1.0, 2.0]
        }
        fn force(&mut self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]) {
            f[0] = -q[0] - q[0].powi(3) - 0.1 * v[0] + (3.0 * t).cos() * q[1].sin();
            f[1] = -q[1] - 0.3 * v[1] * v[0] + 0.5 * q[0];
        }
        fn linearise(&mut self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised) {
            self.force(t, q, v, &mut at.f);
            at.k = vec![-1.0 - 3.0 * q[0] * q[0], (3.0 * t).cos() * q[1].cos(), 0.5, -1.0];
            at.d = vec![-0.1, 0.0, -0.3 * v[1], -0.3 * v[0]];
            at.ft = vec![-3.0 * (3.0 * t).sin() * q[1].sin(), 0.0];
        }
    }

    fn end(steps: usize) -> [f64; 4] {
        let mut scheme = Rosenbrock::new(0.0, &Band::new(2, 2));
        let (mut q, mut v) = (vec![1.0, 0.5], vec![0.0, -0.2]);
        let mut at = Linearised::new(0.0, Band::new(2, 2), 0);
        let h = 2.0 / steps as f64;
        for k in 0..steps {
            let t = k as f64 * h;
            Duffing.linearise(t, &q, &v, &mut at);
            assert_eq!(scheme.step(&mut Duffing, &at, t, h, &q, &v), 1.0);
            q.copy_from_slice(&scheme.new_q);
            v.copy_from_slice(&scheme.new_v);
        }
        [q[0], q[1], v[0], v[1]]
    }

    #[test]
    fn order_four_is_observed() {
        let fine = end(2048);
        let error = |n: usize| end(n).iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let order = (error(32) / error(128)).log2() / 2.0;
        assert!((3.8..4.4).contains(&order), "observed order {order}");
    }

    #[test]
    fn embedded_error_is_of_fourth_power() {
        let estimate = |h: f64| {
            let mut scheme = Rosenbrock::new(0.0, &Band::new(2, 2));
            let mut at = Linearised::new(0.0, Band::new(2, 2), 0);
            let (q, v) = ([1.0, 0.5], [0.0, -0.2]);
            Duffing.linearise(0.3, &q, &v, &mut at);
            scheme.step(&mut Duffing, &at, 0.3, h, &q, &v);
            scheme.error_q.iter().chain(&scheme.error_v).fold(0.0, |a: f64, b| a.max(b.abs()))
        };
        let order = (estimate(0.04) / estimate(0.02)).log2();
        assert!((3.5..4.5).contains(&order), "observed order {order}");
    }
}
