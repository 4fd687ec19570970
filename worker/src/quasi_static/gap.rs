//! One step of the gaps: f(t, q_ideal + g, v_ideal + dg/dt) - M a_ideal = 0 by the second-order backward
//! difference formula with variable steps, solved by a full Newton iteration.
//!
//! The equation is implicit in dg/dt and nearly algebraic: in contact g relaxes within microseconds (film over
//! contact stiffness), out of contact within the whole clearance. A backward formula keeps the equation itself
//! at the end of each step (it is stiffly accurate and L-stable), gives the rate that film and sliding need to second
//! order there, and costs one solve a step where a two-stage Runge-Kutta step of equal order costs two and has
//! that rate to first order only.

use super::IdealMotion;
use crate::integrate::{Band, Linearised, Pivoted, Stepped, add_product};

/// Largest change of a coordinate in one Newton iteration, in its scale (1 % of the smallest clearance).
const LONGEST_UPDATE: f64 = 10.0;
/// A Newton update below this share of the scale is the last, and made without looking at the forces again:
/// 1e-4 of 1 % of the clearance is some 1e-4 of a penetration, hence of the force.
const CONVERGED: f64 = 1e-4;
/// Iterations after which a step counts as refused; a good prediction needs one or two.
const MOST_ITERATIONS: usize = 12;
/// Iterations of the search for rest: it approaches from far away.
const MOST_APPROACHES: usize = 200;
/// Factor by which the search for rest lengthens its pseudo-step squared after each iteration.
const LENGTHENING: f64 = 4.0;

/// The gaps, their past and the scratch of the step; all vectors `(n,)` but the matrix.
#[derive(Debug, Clone)]
pub struct Gap {
    n: usize,
    /// Gap vectors at the last times, newest first; how many are known; their times.
    past: [Vec<f64>; 3],
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
    /// State at the end of the step just tried, but for the last Newton update.
    pub q: Vec<f64>,
    /// Rate of that state.
    pub v: Vec<f64>,
    /// Linearisation there.
    pub at: Linearised,
    /// Newton iterations so far, each an evaluation of force and derivatives.
    pub iterations: u64,
}

impl Gap {
    /// With room in `at` for the system's linearisation; closed joints.
    pub fn new(at: Linearised) -> Self {
        let n = at.f.len();
        let zero = || vec![0.0; n];
        Gap {
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

    /// The gaps at the last accepted time `(n,)`.
    pub fn now(&self) -> &[f64] {
        &self.past[0]
    }

    /// Searches for the gaps at rest at time `t`, from the gaps `start`: a step of the dynamics at a time with
    /// its velocity dropped afterwards, (M / tau^2 - df/dq) dg = f - M a_ideal, tau growing until nothing but
    /// the equilibrium is left. False if it does not come to rest.
    pub fn rest<D: Stepped>(&mut self, system: &mut D, ideal: &IdealMotion, t: f64, start: &[f64]) -> bool {
        let n = self.n;
        self.trial.copy_from_slice(start);
        ideal.at(t, &mut self.ideal_q, &mut self.ideal_v, &mut self.ideal_a);
        let mut inverse_square = None;
        for _ in 0..MOST_APPROACHES {
            self.evaluate(system, t, 0.0, [0.0; 3]);
            let (mass, (scale, _)) = (system.mass(), system.scales());
            // The first pseudo-step moves by the length of the scale.
            let inertia = *inverse_square.get_or_insert_with(|| {
                (0..n).map(|i| (self.update[i] / mass[i] / scale[i]).abs()).fold(0.0, f64::max)
            });
            for (i, mass) in mass.iter().enumerate() {
                self.matrix[self.band.index(i, i)] -= mass * inertia;
            }
            let Some(size) = self.newton_update(scale) else { return false };
            self.move_by(size);
            let settled = size <= CONVERGED;
            // At rest when the pseudo-step is so long that it is Newton's.
            if settled && inertia == 0.0 {
                self.past[0].copy_from_slice(&self.trial);
                self.time[0] = t;
                self.known = 1;
                return true;
            }
            inverse_square = Some(if settled { 0.0 } else { inertia / LENGTHENING });
        }
        false
    }

    /// Tries a step of length `h` [s]; false if Newton's iteration does not converge.
    pub fn step<D: Stepped>(&mut self, system: &mut D, ideal: &IdealMotion, h: f64) -> bool {
        let t = self.time[0] + h;
        ideal.at(t, &mut self.ideal_q, &mut self.ideal_v, &mut self.ideal_a);
        self.predict(t);
        self.trial.copy_from_slice(&self.predicted);
        let (alpha, beta) = self.formula(h);
        for _ in 0..MOST_ITERATIONS {
            self.evaluate(system, t, alpha, beta);
            let Some(size) = self.newton_update(system.scales().0) else { return false };
            self.move_by(size);
            if size <= CONVERGED {
                return true;
            }
        }
        false
    }

    /// Local error of the step just tried, largest over the coordinates in their scales: the error of the rate,
    /// from the difference to the extrapolation of the past, carried through the equation to the gaps. Where
    /// stiffness rules there is none, whatever the rate. Overwrites the update and the prediction, not the linearisation.
    pub fn error(&mut self, h: f64, scale: &[f64]) -> f64 {
        let span = self.time[0] + h - self.time[self.known - 1];
        self.update.fill(0.0);
        for (predicted, trial) in self.predicted.iter_mut().zip(&self.trial) {
            *predicted = trial - *predicted;
        }
        add_product(&self.at.d, &self.band, 1.0 / span, &self.predicted, &mut self.update);
        self.factors.solve(&mut self.update);
        worst(&self.update, scale)
    }

    /// Takes the step just tried over; `t` is its end.
    pub fn accept(&mut self, t: f64) {
        self.past.rotate_right(1);
        self.time.rotate_right(1);
        self.past[0].copy_from_slice(&self.trial);
        self.time[0] = t;
        self.known = (self.known + 1).min(3);
    }

    /// Extrapolates the known past (at most a parabola) to time `t`.
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
    fn formula(&self, h: f64) -> (f64, [f64; 3]) {
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

    /// Solves for Newton's update; its size in the scales, none if there is no finite one.
    fn newton_update(&mut self, scale: &[f64]) -> Option<f64> {
        if !self.factors.factor(|place| self.matrix[place]) {
            return None;
        }
        self.factors.solve(&mut self.update);
        let size = worst(&self.update, scale);
        size.is_finite().then_some(size)
    }

    /// Moves the trial gaps by the update of this size, shortened to the longest allowed.
    fn move_by(&mut self, size: f64) {
        let share = (LONGEST_UPDATE / size).min(1.0);
        for (g, u) in self.trial.iter_mut().zip(&self.update) {
            *g += share * u;
        }
    }
}

/// Largest of `x` in the scales; infinite if anything is not finite.
fn worst(x: &[f64], scale: &[f64]) -> f64 {
    x.iter().zip(scale).map(|(x, s)| (x / s).abs()).fold(0.0, |a: f64, b| {
        // A comparison with NaN is false: count it as infinite.
        if b <= f64::MAX { a.max(b) } else { f64::INFINITY }
    })
}
