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

// Each loop runs over one row index of several vectors at once.
#![allow(clippy::needless_range_loop)]

use super::layout::with_layout;
use super::{Band, Dynamics, Layout, Linearised, add_product, factor, solve};
use crate::lanes::{Real, Vectorised};

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
    rhs: Vec<R>,
    /// Positions at the end of the step [m, rad].
    pub new_q: Vec<R>,
    /// Velocities at the end of the step [m/s, rad/s].
    pub new_v: Vec<R>,
    /// Error estimate of the positions [m, rad].
    pub error_q: Vec<R>,
    /// Error estimate of the velocities [m/s, rad/s].
    pub error_v: Vec<R>,
}

/// Where a step starts: linearisation, length of the step [s] and its inverse [1/s], positions and velocities `(n,)`.
struct Start<'a, R> {
    at: &'a Linearised<R>,
    h: R,
    per_h: R,
    q: &'a [R],
    v: &'a [R],
}

/// The matrix of a step and its first stage; zero where the matrix is as good as singular, else one.
struct FirstStage<'a, R, L> {
    scheme: &'a mut Rosenbrock<R>,
    layout: L,
    mass: &'a [R],
    start: &'a Start<'a, R>,
}

impl<R: Real, L: Layout> Vectorised for FirstStage<'_, R, L> {
    type Output = R;

    #[inline(always)]
    fn run(self) -> R {
        let FirstStage { scheme, layout, mass, start } = self;
        let sound = scheme.factor(layout, mass, start);
        scheme.solve_stage::<_, 0>(0, layout, mass, start);
        sound
    }
}

/// The second or third stage.
struct InnerStage<'a, R, L> {
    scheme: &'a mut Rosenbrock<R>,
    stage: usize,
    layout: L,
    mass: &'a [R],
    start: &'a Start<'a, R>,
}

impl<R: Real, L: Layout> Vectorised for InnerStage<'_, R, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.scheme.solve_stage::<_, 2>(self.stage, self.layout, self.mass, self.start);
    }
}

/// The fourth stage and the end of the step.
struct LastStage<'a, R, L> {
    scheme: &'a mut Rosenbrock<R>,
    layout: L,
    mass: &'a [R],
    start: &'a Start<'a, R>,
}

impl<R: Real, L: Layout> Vectorised for LastStage<'_, R, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let LastStage { scheme, layout, mass, start } = self;
        scheme.solve_stage::<_, 3>(3, layout, mass, start);
        scheme.combine_stages(layout, mass, start);
    }
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
            rhs: zero(),
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
        let band = at.band;
        let start = Start { at, h, per_h: h.like(1.0) / h, q, v };
        let sound = with_layout!(band, layout => h.apart(FirstStage { scheme: self, layout, mass: system.mass(), start: &start }));
        // A loop the compiler cannot unroll: the force is inlined once, and the code of a step stays small.
        for stage in 1..std::hint::black_box(3) {
            with_layout!(band, layout => self.stage_state(stage, layout, &start));
            system.force(t.plus_product(h, h.like(NODE[stage])), &self.q, &self.v, &mut self.f);
            with_layout!(band, layout => h.apart(InnerStage { scheme: self, stage, layout, mass: system.mass(), start: &start }));
        }
        with_layout!(band, layout => h.apart(LastStage { scheme: self, layout, mass: system.mass(), start: &start }));
        sound
    }

    /// Factors the matrix M / (gamma h) - D - gamma h K.
    #[inline(always)]
    fn factor<L: Layout>(&mut self, layout: L, mass: &[R], start: &Start<R>) -> R {
        let Start { at, h, per_h, .. } = *start;
        let (gh, per_gh) = (h * GAMMA, per_h * (1.0 / GAMMA));
        let (n, len) = (layout.n(), layout.len());
        let (matrix, d, k, mass) = (&mut self.matrix[..len], &at.d[..len], &at.k[..len], &mass[..n]);
        for i in 0..len {
            matrix[i] = (-d[i]).minus_product(gh, k[i]);
        }
        for i in 0..n {
            let diagonal = &mut matrix[layout.index(i, i)];
            *diagonal = diagonal.plus_product(mass[i], per_gh);
        }
        factor(matrix, &layout, h)
    }

    /// State of the second or third stage.
    #[inline(always)]
    fn stage_state<L: Layout>(&mut self, stage: usize, layout: L, start: &Start<R>) {
        let Start { h, q, v, .. } = *start;
        let n = layout.n();
        let [first, second] = A[stage - 1];
        let (first, second) = (h.like(first), h.like(second));
        // The second weight of the first of these stages is zero: it takes the vector of the first stage, since there is no other yet.
        let (uq0, uq1) = (&self.uq[0][..n], &self.uq[stage - 1][..n]);
        let (uv0, uv1) = (&self.uv[0][..n], &self.uv[stage - 1][..n]);
        let (stage_q, stage_v, q, v) = (&mut self.q[..n], &mut self.v[..n], &q[..n], &v[..n]);
        for i in 0..n {
            stage_q[i] = q[i].plus_product(uq0[i], first).plus_product(uq1[i], second);
            stage_v[i] = v[i].plus_product(uv0[i], first).plus_product(uv1[i], second);
        }
    }

    /// Right-hand sides r_q = v_stage + sum c u_q / h and M r_v = f_stage + d h f_t + M sum c u_v / h, with sums over the first `BEFORE`
    /// stages, and the solution of stage `stage`; terms of stages yet to come are zero.
    #[inline(always)]
    fn solve_stage<L: Layout, const BEFORE: usize>(
        &mut self,
        stage: usize,
        layout: L,
        mass: &[R],
        start: &Start<R>,
    ) {
        let Start { at, h, per_h, v, .. } = *start;
        let n = layout.n();
        let gh = h * GAMMA;
        let ht = h * TIME[stage];
        let zero = h.zero();
        let (velocity, force) = if BEFORE == 0 { (v, at.f.as_slice()) } else { (&*self.v, &*self.f) };
        let (velocity, force, ft, mass) = (&velocity[..n], &force[..n], &at.ft[..n], &mass[..n]);
        let (rq, rhs) = (&mut self.rq[..n], &mut self.rhs[..n]);
        let mut c = [zero; 3];
        for j in 0..BEFORE {
            c[j] = h.like(C[stage - 1][j]);
        }
        // As in the state of the stage: where the second weight is zero it takes the vector of the first stage.
        let second = if BEFORE == 2 { stage - 1 } else { 1 };
        let (uq1, uv1) = (&self.uq[second], &self.uv[second]);
        let ([uq0, _, uq2, _], [uv0, _, uv2, _]) = (&self.uq, &self.uv);
        let (uq, uv) = ([&uq0[..n], &uq1[..n], &uq2[..n]], [&uv0[..n], &uv1[..n], &uv2[..n]]);
        for i in 0..n {
            let (mut cq, mut cv) = (zero, zero);
            for j in 0..BEFORE {
                cq = cq.plus_product(uq[j][i], c[j]);
                cv = cv.plus_product(uv[j][i], c[j]);
            }
            rq[i] = velocity[i].plus_product(cq, per_h);
            rhs[i] = force[i].plus_product(ht, ft[i]).plus_product(mass[i] * cv, per_h);
        }
        add_product(&at.k, &layout, gh, rq, rhs);
        solve(&self.matrix, &layout, rhs);
        let (uq, uv) = (&mut self.uq[stage][..n], &mut self.uv[stage][..n]);
        for i in 0..n {
            uq[i] = gh * (rq[i] + rhs[i]);
            uv[i] = rhs[i];
        }
    }

    /// State at the end of the step and its error estimate e, replaced by (I - gamma h J)^-1 e, which removes vibrations of a contact far
    /// faster than the step and leaves slower motion unchanged.
    #[inline(always)]
    fn combine_stages<L: Layout>(&mut self, layout: L, mass: &[R], start: &Start<R>) {
        let Start { at, h, per_h, q, v } = *start;
        let (gh, per_gh) = (h * GAMMA, per_h * (1.0 / GAMMA));
        let n = layout.n();
        let (q, v, mass) = (&q[..n], &v[..n], &mass[..n]);
        let ([uq0, uq1, uq2, uq3], [uv0, uv1, uv2, uv3]) = (&self.uq, &self.uv);
        let uq = [&uq0[..n], &uq1[..n], &uq2[..n], &uq3[..n]];
        let uv = [&uv0[..n], &uv1[..n], &uv2[..n], &uv3[..n]];
        let (new_q, new_v) = (&mut self.new_q[..n], &mut self.new_v[..n]);
        let (error_q, error_v) = (&mut self.error_q[..n], &mut self.error_v[..n]);
        for i in 0..n {
            let (mut q1, mut v1, mut eq, mut ev) = (q[i], v[i], h.zero(), h.zero());
            for s in 0..4 {
                let (b, e) = (h.like(B[s]), h.like(E[s]));
                q1 = q1.plus_product(uq[s][i], b);
                v1 = v1.plus_product(uv[s][i], b);
                eq = eq.plus_product(uq[s][i], e);
                ev = ev.plus_product(uv[s][i], e);
            }
            (new_q[i], new_v[i]) = (q1, v1);
            (error_q[i], error_v[i]) = (eq, mass[i] * ev * per_gh);
        }
        add_product(&at.k, &layout, h.like(1.0), error_q, error_v);
        solve(&self.matrix, &layout, error_v);
        for i in 0..n {
            error_q[i] = error_q[i].plus_product(gh, error_v[i]);
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
            nothing = nothing.plus_product(eq + ev + self.new_q[i] + self.new_v[i], like.zero());
        }
        worst + nothing
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
