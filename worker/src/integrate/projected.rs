//! An explicit Runge-Kutta step of fifth order whose stages lie on the constraints of ideal joints, with an embedded error estimate.
//!
//! In positions where constraints become dependent their forces grow without bound on either side of the manifold of closed joints, but
//! on it the accelerations along the motion are smooth. Each stage is therefore moved back onto the manifold, in positions and
//! velocities, before the force is evaluated:
//!
//!   x_i = P(x_0 + h sum_j a_ij k_j),  k_i = (v_i, M^-1 f(t_0 + c_i h, q_i, v_i)),  x_1 = P(x_0 + h sum_i b_i k_i),
//!
//! for the state x = (q, v) and the projection P of [`Stepped::close`]. The field k(P(x)) is smooth around the manifold and tangential
//! on it, so that the order of the scheme is kept. The error estimate is h sum_i e_i k_i. The step is not stable for stiff forces: error
//! control shortens it there.
//!
//! # Source
//! Coefficients: Dormand, Prince (1980), J. Comput. Appl. Math. 6, 19-26. Projected stages: Hairer, Lubich, Wanner (2006), Geometric
//! Numerical Integration, section IV.4. Singular positions without singular forces: Bayo, Avello (1994), Nonlinear Dynamics 5, 209-231.

use super::{Rosenbrock, Stepped};

const STAGES: usize = 7;
/// a_ij of the second to sixth stage.
const A: [[f64; 5]; 5] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
];
/// Times c_i of these stages over h.
const C: [f64; 5] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0];
/// Weights b_i of the solution and e_i of its error estimate; the last stage is the end of the step.
const B: [f64; 6] = [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
const E: [f64; STAGES] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Work space of a step; all vectors `(n,)`.
#[derive(Debug, Clone)]
pub struct ProjectedStep {
    kq: [Vec<f64>; STAGES],
    kv: [Vec<f64>; STAGES],
    q: Vec<f64>,
    v: Vec<f64>,
    /// Force with reactions at the end of the step [N, N m].
    pub f: Vec<f64>,
}

impl ProjectedStep {
    /// Work space for `n` coordinates.
    pub(crate) fn new(n: usize) -> Self {
        let zero = || vec![0.0; n];
        let stages = || std::array::from_fn(|_| zero());
        ProjectedStep { kq: stages(), kv: stages(), q: zero(), v: zero(), f: zero() }
    }

    /// Computes a step of length `h` [s] from (`t`, `q`, `v`), where the force with reactions is `f` `(n,)`; its end, not yet closed,
    /// goes to `to`. Returns false if the joints cannot be closed or the force does not exist at a stage.
    pub(crate) fn step<D: Stepped>(
        &mut self,
        system: &mut D,
        f: &[f64],
        (t, h): (f64, f64),
        (q, v): (&[f64], &[f64]),
        to: &mut Rosenbrock,
    ) -> bool {
        self.f.copy_from_slice(f);
        self.keep_stage(0, v, system.mass());
        for stage in 1..6 {
            let weights = A[stage - 1];
            let (mut stage_q, mut stage_v) = (std::mem::take(&mut self.q), std::mem::take(&mut self.v));
            self.combine(&weights[..stage], h, (q, v), (&mut stage_q, &mut stage_v));
            let time = t + C[stage - 1] * h;
            let closed = system.close(time, &mut stage_q, &mut stage_v).is_some();
            if closed {
                system.force(time, &stage_q, &stage_v, &mut self.f);
                self.keep_stage(stage, &stage_v, system.mass());
            }
            (self.q, self.v) = (stage_q, stage_v);
            if !closed || !self.f.iter().all(|f| f.is_finite()) {
                return false;
            }
        }
        self.combine(&B, h, (q, v), (&mut to.new_q, &mut to.new_v));
        true
    }

    /// After [`Self::step`], when the joints are closed at its end: evaluates the force there, at time `t` [s], and the error estimate of
    /// the step of length `h` [s] in `to`.
    pub(crate) fn finish<D: Stepped>(&mut self, system: &mut D, (t, h): (f64, f64), to: &mut Rosenbrock) {
        system.force(t, &to.new_q, &to.new_v, &mut self.f);
        self.keep_stage(6, &to.new_v, system.mass());
        to.error_q.fill(0.0);
        to.error_v.fill(0.0);
        for (e, (kq, kv)) in E.iter().zip(self.kq.iter().zip(&self.kv)) {
            add(h * e, kq, &mut to.error_q);
            add(h * e, kv, &mut to.error_v);
        }
    }

    /// Keeps velocity and acceleration of a stage.
    fn keep_stage(&mut self, stage: usize, v: &[f64], mass: &[f64]) {
        self.kq[stage].copy_from_slice(v);
        for ((k, f), mass) in self.kv[stage].iter_mut().zip(&self.f).zip(mass) {
            *k = f / mass;
        }
    }

    /// State plus h times the weighted sum of the first stages.
    fn combine(
        &self,
        weights: &[f64],
        h: f64,
        (q, v): (&[f64], &[f64]),
        (to_q, to_v): (&mut [f64], &mut [f64]),
    ) {
        to_q.copy_from_slice(q);
        to_v.copy_from_slice(v);
        for (weight, (kq, kv)) in weights.iter().zip(self.kq.iter().zip(&self.kv)) {
            add(h * weight, kq, to_q);
            add(h * weight, kv, to_v);
        }
    }
}

/// Adds `factor` times `x` to `to`.
fn add(factor: f64, x: &[f64], to: &mut [f64]) {
    to.iter_mut().zip(x).for_each(|(to, x)| *to += factor * x);
}
