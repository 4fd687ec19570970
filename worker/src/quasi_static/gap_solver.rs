//! One step of the gaps g [m, rad]: f(t, q_ideal + g, v_ideal + dg/dt) - M a_ideal = 0 by the second-order backward
//! difference formula (BDF2) with variable steps, solved by Newton's method.
//!
//! With the step h and the step before it h0 [s], the rate at the end of the step is
//!
//!   dg/dt = alpha g_new + beta_0 g_0 + beta_1 g_1,  alpha = 1/h + 1/(h + h0),
//!   beta_0 = -(h + h0) / (h h0),  beta_1 = h / ((h + h0) h0),
//!
//! and after a start, where g_1 is missing, (g_new - g_0) / h. Newton's matrix is df/dq + alpha df/dqd. The local error is
//! estimated from the difference d between g_new and the parabola through the gaps before: the rate is off by d over the time they
//! span, and the gaps by (df/dq + alpha df/dqd)^-1 df/dqd times that.
//!
//! The equation is implicit in dg/dt and nearly algebraic: in contact g relaxes within microseconds (film over
//! contact stiffness), out of contact within the whole clearance. A backward formula satisfies the equation at the end of each
//! step (it is stiffly accurate and L-stable), has the rate that film and sliding need to second order there, and costs one solve a
//! step; a two-stage Runge-Kutta step of equal order costs two and has that rate to first order only. The formula is
//! stable while a step is less than 1 + sqrt 2 times the one before.
//!
//! # Source
//! Variable-step BDF2 and its zero-stability: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section
//! III.5. The search for equilibrium is pseudo-transient continuation: Kelley, Keyes, SIAM Journal on Numerical Analysis 35
//! (1998).

use super::IdealMotion;
use crate::integrate::{Band, Layout, Linearised, Pivoted, Stepped, add_product, nan_as_infinite};

/// Largest change of a coordinate in one Newton iteration, in its scale, 1 % of the smallest clearance [1].
const LONGEST_UPDATE: f64 = 10.0;
/// A Newton update below this share of the scale is the last, and the forces are not evaluated after it [1]:
/// 1e-4 of 1 % of the clearance is some 1e-4 of a penetration, hence of the force.
const CONVERGED: f64 = 1e-4;
/// Iterations after which a step counts as refused; a good prediction needs one or two.
const MOST_ITERATIONS: usize = 12;
/// Iterations of the search for equilibrium, which starts far from it.
const MOST_REST_ITERATIONS: usize = 200;
/// Factor by which the search for equilibrium raises the square of its pseudo-time step after each iteration [1].
const LENGTHENING: f64 = 4.0;

/// The gaps, their past values and the work space of a step; all vectors `(n,)` but the matrix.
#[derive(Debug, Clone)]
pub struct GapSolver {
    n: usize,
    /// Gaps at the last accepted times, newest first; their times [s]; how many are known.
    pub(crate) past: [Vec<f64>; 3],
    time: [f64; 3],
    known: usize,
    predicted: Vec<f64>,
    trial: Vec<f64>,
    ideal_q: Vec<f64>,
    ideal_v: Vec<f64>,
    ideal_a: Vec<f64>,
    matrix: Vec<f64>,
    factors: Pivoted,
    band: Band,
    update: Vec<f64>,
    /// Coordinates at the end of the step just tried, before the last Newton update [m, rad].
    pub q: Vec<f64>,
    /// Velocities there [m/s, rad/s].
    pub v: Vec<f64>,
    /// Linearisation at that state.
    pub at: Linearised,
    /// Newton iterations so far, each an evaluation of force and derivatives.
    pub iterations: u64,
}

impl GapSolver {
    /// Closed joints (gaps of zero), with space in `at` for the system's linearisation.
    pub(crate) fn new(at: Linearised) -> Self {
        let n = at.f.len();
        let zero = || vec![0.0; n];
        GapSolver {
            n,
            past: std::array::from_fn(|_| zero()),
            time: [0.0; 3],
            known: 1,
            predicted: zero(),
            trial: zero(),
            ideal_q: zero(),
            ideal_v: zero(),
            ideal_a: zero(),
            matrix: vec![0.0; at.band.len()],
            factors: Pivoted::new(at.band),
            band: at.band,
            update: zero(),
            q: zero(),
            v: zero(),
            at,
            iterations: 0,
        }
    }

    /// Solves for the gaps at rest at time `t` [s], from the gaps `start` `(n,)`: pseudo-time steps of the dynamics that drop the
    /// velocity, (M / tau^2 - df/dq) dg = f - M a_ideal, with tau growing until the step is Newton's; `None` if no equilibrium is
    /// found.
    pub(crate) fn solve_rest<D: Stepped>(
        &mut self,
        system: &mut D,
        ideal: &IdealMotion,
        t: f64,
        start: &[f64],
    ) -> Option<()> {
        let n = self.n;
        self.trial.copy_from_slice(start);
        ideal.evaluate(t, &mut self.ideal_q, &mut self.ideal_v, &mut self.ideal_a);
        let mut inverse_square = None;
        for _ in 0..MOST_REST_ITERATIONS {
            self.evaluate(system, t, 0.0, [0.0; 3]);
            let (mass, (scale, _)) = (system.mass(), system.scales());
            // The first pseudo-step moves by the length of the scale.
            let inertia = *inverse_square.get_or_insert_with(|| {
                (0..n).map(|i| (self.update[i] / mass[i] / scale[i]).abs()).fold(0.0, f64::max)
            });
            for (i, mass) in mass.iter().enumerate() {
                self.matrix[self.band.index(i, i)] -= mass * inertia;
            }
            let size = self.newton_update(scale)?;
            self.move_by(size);
            let settled = size <= CONVERGED;
            // At rest when the pseudo-step is so long that it is Newton's.
            if settled && inertia == 0.0 {
                self.past[0].copy_from_slice(&self.trial);
                self.time[0] = t;
                self.known = 1;
                return Some(());
            }
            inverse_square = Some(if settled { 0.0 } else { inertia / LENGTHENING });
        }
        None
    }

    /// Tries a step of length `h` [s]; `None` if Newton's method does not converge.
    pub(crate) fn try_step<D: Stepped>(&mut self, system: &mut D, ideal: &IdealMotion, h: f64) -> Option<()> {
        let t = self.time[0] + h;
        ideal.evaluate(t, &mut self.ideal_q, &mut self.ideal_v, &mut self.ideal_a);
        self.predict(t);
        self.trial.copy_from_slice(&self.predicted);
        let (alpha, beta) = self.rate_weights(h);
        for _ in 0..MOST_ITERATIONS {
            self.evaluate(system, t, alpha, beta);
            let size = self.newton_update(system.scales().0)?;
            self.move_by(size);
            if size <= CONVERGED {
                return Some(());
            }
        }
        None
    }

    /// Estimates the local error of the step of length `h` [s] just tried, the largest over the coordinates in their scales [1].
    /// It vanishes where stiffness dominates, whatever the rate. Overwrites the update and the prediction.
    pub(crate) fn estimate_error(&mut self, h: f64, scale: &[f64]) -> f64 {
        let span = self.time[0] + h - self.time[self.known - 1];
        self.update.fill(0.0);
        for (predicted, trial) in self.predicted.iter_mut().zip(&self.trial) {
            *predicted = trial - *predicted;
        }
        add_product(&self.at.d, &self.band, 1.0 / span, &self.predicted, &mut self.update);
        self.factors.solve(&mut self.update);
        largest_scaled(&self.update, scale)
    }

    /// Accepts the step just tried, which ends at time `t` [s].
    pub(crate) fn accept(&mut self, t: f64) {
        self.past.rotate_right(1);
        self.time.rotate_right(1);
        self.past[0].copy_from_slice(&self.trial);
        self.time[0] = t;
        self.known = (self.known + 1).min(3);
    }

    /// Extrapolates the known past gaps, by a parabola at most, to time `t` [s].
    fn predict(&mut self, t: f64) {
        let s = &self.time;
        let mut weight = [0.0; 3];
        for (k, w) in weight.iter_mut().enumerate().take(self.known) {
            *w = (0..self.known).filter(|&j| j != k).map(|j| (t - s[j]) / (s[k] - s[j])).product();
        }
        for i in 0..self.n {
            self.predicted[i] = (0..self.known).map(|k| weight[k] * self.past[k][i]).sum();
        }
    }

    /// Weights of dg/dt at the end of a step: alpha of the new gaps, beta of the past ones [1/s].
    fn rate_weights(&self, h: f64) -> (f64, [f64; 3]) {
        if self.known < 2 {
            return (1.0 / h, [-1.0 / h, 0.0, 0.0]);
        }
        let before = self.time[0] - self.time[1];
        let both = h + before;
        (1.0 / h + 1.0 / both, [-both / (h * before), h / (both * before), 0.0])
    }

    /// State, linearisation, negative residual (in `update`) and matrix K + alpha D (negated) at the trial gaps.
    fn evaluate<D: Stepped>(&mut self, system: &mut D, t: f64, alpha: f64, beta: [f64; 3]) {
        let n = self.n;
        for i in 0..n {
            self.q[i] = self.ideal_q[i] + self.trial[i];
            self.v[i] = self.ideal_v[i]
                + alpha * self.trial[i]
                + beta[0] * self.past[0][i]
                + beta[1] * self.past[1][i];
        }
        system.linearise(t, &self.q, &self.v, &mut self.at);
        self.iterations += 1;
        let mass = system.mass();
        for (miss, (mass, (a, f))) in
            self.update.iter_mut().zip(mass.iter().zip(self.ideal_a.iter().zip(&self.at.f)))
        {
            *miss = mass * a - f;
        }
        for (m, (k, d)) in self.matrix.iter_mut().zip(self.at.k.iter().zip(&self.at.d)) {
            *m = k + alpha * d;
        }
    }

    /// Solves for Newton's update and returns its size in the scales [1]; `None` if there is no finite one.
    fn newton_update(&mut self, scale: &[f64]) -> Option<f64> {
        self.factors.factor(|place| self.matrix[place])?;
        self.factors.solve(&mut self.update);
        let size = largest_scaled(&self.update, scale);
        size.is_finite().then_some(size)
    }

    /// Adds the update of this size to the trial gaps, shortened to the longest allowed.
    fn move_by(&mut self, size: f64) {
        let share = (LONGEST_UPDATE / size).min(1.0);
        for (g, u) in self.trial.iter_mut().zip(&self.update) {
            *g += share * u;
        }
    }
}

/// Largest of `x` in the scales; infinite if anything is not finite.
fn largest_scaled(x: &[f64], scale: &[f64]) -> f64 {
    x.iter().zip(scale).fold(0.0, |largest: f64, (x, s)| largest.max(nan_as_infinite((x / s).abs())))
}
