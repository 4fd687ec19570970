//! A linearly implicit Runge-Kutta step of fourth order: one factorisation, three force evaluations, embedded
//! error of third order.
//!
//! Kaps-Rentrop's GRK4T, A(89.3 deg)-stable, whose small numerical damping keeps a contact vibration that a
//! damping scheme would lose or invent. For M qdd = f the 2n x 2n system of a stage reduces to
//! [M / (gamma h) - D - gamma h K] u_v = M r_v + gamma h K r_q, u_q = gamma h (r_q + u_v).
//!
//! # Source
//! Kaps, Rentrop (1979); coefficients in the transformed form of Hairer, Wanner (1996), section IV.7.

use super::linear::{factor, solve};
use super::{Dynamics, Linearised};

const GAMMA: f64 = 0.231;
const A: [[f64; 2]; 2] = [[2.0, 0.0], [4.524708207373116, 4.163528788597648]];
const C: [[f64; 3]; 3] = [
    [-5.071675338776316, 0.0, 0.0],
    [6.020152728650786, 0.1597506846727117, 0.0],
    [-1.856343618686113, -8.505380858179826, -2.084075136023187],
];
const B: [f64; 4] = [3.957503746640777, 4.624892388363313, 0.6174772638750108, 1.282612945269037];
const E: [f64; 4] = [2.302155402932996, 3.073634485392623, -0.8732808018045032, -1.282612945269037];
/// Stage times and weights of df/dt.
const NODE: [f64; 3] = [0.0, 0.462, 0.8802083333333334];
const TIME: [f64; 4] = [0.231, -0.03962966775244303, 0.5507789395789127, -0.05535098457052764];

/// Scratch of the step; all vectors `(n,)`.
#[derive(Debug, Clone)]
pub struct Rosenbrock {
    n: usize,
    matrix: Vec<f64>,
    pivot: Vec<usize>,
    uq: [Vec<f64>; 4],
    uv: [Vec<f64>; 4],
    q: Vec<f64>,
    v: Vec<f64>,
    f: Vec<f64>,
    rq: Vec<f64>,
    /// Positions at the end of the step.
    pub new_q: Vec<f64>,
    /// Velocities at the end of the step.
    pub new_v: Vec<f64>,
    /// Error estimate of the positions.
    pub error_q: Vec<f64>,
    /// Error estimate of the velocities.
    pub error_v: Vec<f64>,
}

impl Rosenbrock {
    /// Room for `n` degrees of freedom.
    pub fn new(n: usize) -> Self {
        let zero = || vec![0.0; n];
        Rosenbrock {
            n,
            matrix: vec![0.0; n * n],
            pivot: vec![0; n],
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

    /// Computes the step of length `h` [s] from (`t`, `q`, `v`), where `at` is the linearisation there; false
    /// if its matrix is singular.
    // Each loop runs over one row index of several vectors and matrices at once.
    #[allow(clippy::needless_range_loop)]
    pub fn step<D: Dynamics>(
        &mut self,
        system: &mut D,
        at: &Linearised,
        t: f64,
        h: f64,
        q: &[f64],
        v: &[f64],
    ) -> bool {
        let n = self.n;
        let gh = GAMMA * h;
        for i in 0..n {
            for j in 0..n {
                self.matrix[i * n + j] = -at.d[i * n + j] - gh * at.k[i * n + j];
            }
            self.matrix[i * n + i] += system.mass()[i] / gh;
        }
        if !factor(&mut self.matrix, &mut self.pivot, n) {
            return false;
        }
        for stage in 0..4 {
            if stage == 1 || stage == 2 {
                let a = A[stage - 1];
                for i in 0..n {
                    self.q[i] = q[i] + a[0] * self.uq[0][i];
                    self.v[i] = v[i] + a[0] * self.uv[0][i];
                    if stage == 2 {
                        self.q[i] += a[1] * self.uq[1][i];
                        self.v[i] += a[1] * self.uv[1][i];
                    }
                }
                system.force(t + NODE[stage] * h, &self.q, &self.v, &mut self.f);
            }
            // Right-hand sides: r_q = v_stage + sum c u_q / h, M r_v = f_stage + d h f_t + M sum c u_v / h.
            let mass = system.mass();
            let (before, rest) = self.uv.split_at_mut(stage);
            let rhs = &mut rest[0];
            for i in 0..n {
                let (mut cq, mut cv) = (0.0, 0.0);
                if stage > 0 {
                    for (j, u) in before.iter().enumerate() {
                        cq += C[stage - 1][j] * self.uq[j][i];
                        cv += C[stage - 1][j] * u[i];
                    }
                }
                let (vel, force) = if stage == 0 { (v[i], at.f[i]) } else { (self.v[i], self.f[i]) };
                self.rq[i] = vel + cq / h;
                rhs[i] = force + TIME[stage] * h * at.ft[i] + mass[i] * cv / h;
            }
            for i in 0..n {
                let row = &at.k[i * n..(i + 1) * n];
                let kr: f64 = row.iter().zip(&self.rq).map(|(k, r)| k * r).sum();
                rhs[i] += gh * kr;
            }
            solve(&self.matrix, &self.pivot, n, rhs);
            for i in 0..n {
                self.uq[stage][i] = gh * (self.rq[i] + rhs[i]);
            }
        }
        for i in 0..n {
            let (mut q1, mut v1, mut eq, mut ev) = (q[i], v[i], 0.0, 0.0);
            for s in 0..4 {
                q1 += B[s] * self.uq[s][i];
                v1 += B[s] * self.uv[s][i];
                eq += E[s] * self.uq[s][i];
                ev += E[s] * self.uv[s][i];
            }
            self.new_q[i] = q1;
            self.new_v[i] = v1;
            self.error_q[i] = eq;
            self.error_v[i] = ev;
        }
        self.filter_error(at, gh, system.mass());
        true
    }
}

impl Rosenbrock {
    /// Replaces the error estimate e by (I - gamma h J)^-1 e: what the step damps anyway, the vibration of a
    /// contact far faster than the step, no longer counts, slower motion counts as before (Shampine's filter).
    fn filter_error(&mut self, at: &Linearised, gh: f64, mass: &[f64]) {
        let n = self.n;
        for ((v, row), mass) in self.error_v.iter_mut().zip(at.k.chunks_exact(n)).zip(mass) {
            let kq: f64 = row.iter().zip(&self.error_q).map(|(k, e)| k * e).sum();
            *v = mass * *v / gh + kq;
        }
        solve(&self.matrix, &self.pivot, n, &mut self.error_v);
        for (q, v) in self.error_q.iter_mut().zip(&self.error_v) {
            *q += gh * v;
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
        fn scales(&self) -> (&[f64], &[f64]) {
            (&[1.0, 1.0], &[1.0, 1.0])
        }
    }

    fn end(steps: usize) -> [f64; 4] {
        let mut scheme = Rosenbrock::new(2);
        let (mut q, mut v) = (vec![1.0, 0.5], vec![0.0, -0.2]);
        let mut at = Linearised::new(2, 0);
        let h = 2.0 / steps as f64;
        for k in 0..steps {
            let t = k as f64 * h;
            Duffing.linearise(t, &q, &v, &mut at);
            assert!(scheme.step(&mut Duffing, &at, t, h, &q, &v));
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
            let mut scheme = Rosenbrock::new(2);
            let mut at = Linearised::new(2, 0);
            let (q, v) = ([1.0, 0.5], [0.0, -0.2]);
            Duffing.linearise(0.3, &q, &v, &mut at);
            scheme.step(&mut Duffing, &at, 0.3, h, &q, &v);
            scheme.error_q.iter().chain(&scheme.error_v).fold(0.0, |a: f64, b| a.max(b.abs()))
        };
        let order = (estimate(0.04) / estimate(0.02)).log2();
        assert!((3.5..4.5).contains(&order), "observed order {order}");
    }
}
