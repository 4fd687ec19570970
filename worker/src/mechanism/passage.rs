//! Positions in which ideal joints become dependent for an instant, and how a time step passes them.
//!
//! Let row i of G, lengths and angles made alike by the size of the mechanism, have the part r_i `(n,)` normal to the rows before it.
//! Rows are dependent where some r_i vanish. The motion passes such a position on one branch alone if these r_i cross zero at a rate
//! other than zero: then w' dG/dt Z, with the dependent combinations w of the rows and the velocities Z that the joints admit in that
//! position, has full rank, the velocity v is a regular point of the cone w' (d^2 phi/dq^2)(v, v) = 0, and one smooth branch runs
//! through it (implicit function theorem). Along it the directions r_i / |r_i| are continuous but for their sign, which a crossing
//! reverses.
//!
//! A step goes through if
//!
//! - each r_i that was small comes back reversed, with a cosine below -0.9, and its mean rate (|r_i| before + |r_i| after) / h is at
//!   least 1e-3 of the fastest body's angular velocity;
//! - at the instant of the crossing the joints are closed to 1e-8 of the size of the mechanism on the quintic path through positions,
//!   velocities and accelerations at both ends: the linkage reaches the position, and does not turn away before it as one of slightly
//!   other lengths does.
//!
//! A step is refused, and tried with another length, if it ends with a share |r_i| below 1e-3, if an r_i shrinks within the step and
//! grows again without a reversal, or if the directions at both ends differ otherwise: it was too long, or the motion touches a
//! position where branches meet. In the latter case no length passes, and the evaluation fails with the name of the joint.
//!
//! Rounding moves closed bodies by some 1e-16 of their coordinates over the share |r_i|, and turns the directions along which velocities
//! are closed by as much over its square. Steps towards a position are therefore halves of the time left until one may cross it with
//! no stage near it, and no step is asked for less error than rounding leaves.
//!
//! # Source
//! Regular points of the cone of second order and branches of the motion: Müller (2002), Multibody System Dynamics 8, 299-328.

use super::constraint::{Constraint, first_rows};
use super::envelope_qr::EnvelopeQr;
use super::extent::ROUNDING;
use super::frame::Placed;
use super::sparse_elimination::SparseElimination;
use crate::extremum::smallest;

/// Share of a row normal to those before it, below which the row is observed over a step [1].
const OBSERVED: f64 = 0.35;
/// Share below which the ideal joints are nearly dependent [1].
const NEAR: f64 = 0.1;
/// Smallest share at the end of a step [1].
const NEAREST: f64 = 1e-3;
/// Share below which a step goes through the position however short steps are elsewhere [1].
const AT_HAND: f64 = 5.0 * NEAREST;
/// Least cosine between directions at both ends of a step that count as equal [1].
const ALIGNED: f64 = 0.9;
/// Least rate of a crossing over the angular velocity of the fastest body [1].
const LEAST_RATE: f64 = 1e-3;
/// Share within a step, over the smaller one of its ends, below which it has a minimum within [1].
const DIP: f64 = 0.5;

/// Position ahead over the length of a step that crosses it, in the middle of the widest gap between stages [1].
const CROSSED_AT: f64 = 0.55;
/// Position ahead over the length of a longer step that crosses it before its first stage [1].
const CROSSED_FIRST: f64 = 0.1;
/// Time of the stages over the length of a step [1].
const STAGES: [f64; 6] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0];

/// Observes the dependence of the ideal joints over a time step.
#[derive(Debug, Clone)]
pub struct Passage {
    /// The joints, for explicit steps.
    pub(super) joints: SparseElimination,
    /// Whether every step is explicit.
    pub(super) is_large: bool,
    /// Factors of G in lengths, whatever the masses.
    geometry: EnvelopeQr,
    /// Share of each row normal to those before it, where they were factored last and at the start of the step `(m,)` [1].
    shares: Vec<f64>,
    start: Vec<f64>,
    /// Rows observed, and their r_i at the start of the step `(rows, n)`.
    rows: Vec<usize>,
    remainders: Vec<f64>,
    /// Work space `(n,)`.
    end: Vec<f64>,
    pub(super) is_observing: bool,
    /// The most dependent row if the joints are nearly dependent at the start of the step.
    near: Option<usize>,
    /// Of a position of dependence that the motion approaches: time to it, infinite if the motion leaves it behind [s], smallest share at the start
    /// of the step [1], and rounding of a gap times the angular velocity of the fastest body [m/s].
    ahead: Option<[f64; 3]>,
}

/// How the rows at the end of a step compare with those at its start.
#[derive(Debug, PartialEq)]
pub(super) enum Comparison {
    /// No row crosses zero; `near` if the joints are nearly dependent at both ends.
    Clear { near: bool },
    /// Rows cross zero at these fractions of the step, the slowest at this rate times the length of the step [1].
    Crossing { fractions: Vec<f64>, slowest: f64 },
    /// The step is too long to tell.
    Unclear,
}

impl Passage {
    /// For these ideal joints of an island of bodies with the masses `mass` `(n,)` [kg, kg m^2]; `None` if no position can make them
    /// dependent for an instant: they form no loop, or leave no freedom. With `is_large` every step is explicit.
    pub(super) fn new(constraints: &[Constraint], mass: &[f64], is_large: bool) -> Option<Self> {
        let (n, m) = (mass.len(), first_rows(constraints).1);
        if m >= n || !has_loop(constraints, n / 3) {
            return None;
        }
        let joints = SparseElimination::new(constraints, mass)?;
        Some(Passage {
            geometry: joints.factors.clone(),
            joints,
            is_large,
            shares: vec![1.0; m],
            start: vec![1.0; m],
            rows: vec![],
            remainders: vec![],
            end: vec![0.0; n],
            is_observing: false,
            near: None,
            ahead: None,
        })
    }

    /// Index into the scene's joints of the most dependent joint, if the joints are nearly dependent at the start of the step.
    pub(super) fn nearly_dependent(&self) -> Option<usize> {
        self.near.map(|row| self.joints.scene_joint(row))
    }

    /// Whether the next step has to be explicit.
    pub(super) fn is_projected(&self) -> bool {
        self.is_large || self.near.is_some()
    }

    /// Starts a step far from positions of dependence.
    pub(super) fn begin_apart(&mut self) {
        self.rows.clear();
        (self.is_observing, self.near, self.ahead) = (false, None, None);
    }

    /// Starts a step in the state `at`; `size` is that of the mechanism [m].
    pub(super) fn begin(&mut self, at: Placed, size: f64) {
        self.begin_apart();
        self.is_observing = true;
        if !self.factor(at, size) {
            self.near = self.weakest_row();
            return;
        }
        self.start.copy_from_slice(&self.shares);
        self.rows.extend((0..self.shares.len()).filter(|&i| self.shares[i] < OBSERVED));
        let n = self.end.len();
        self.remainders.resize(self.rows.len() * n, 0.0);
        for (&i, remainder) in self.rows.iter().zip(self.remainders.chunks_exact_mut(n)) {
            self.geometry.remainder(i, remainder);
        }
        self.near = self.weakest_row().filter(|&row| self.shares[row] < NEAR);
    }

    /// The row of which the smallest share is normal to those before it.
    fn weakest_row(&self) -> Option<usize> {
        (0..self.shares.len()).min_by(|&a, &b| self.shares[a].total_cmp(&self.shares[b]))
    }

    /// After [`Self::begin`]: a time that changes the smallest share little, for [`Self::look_ahead`], where the fastest body has this
    /// angular velocity [rad/s]; `None` if no row is observed or nothing turns [s].
    pub(super) fn short_time(&self, fastest: f64) -> Option<f64> {
        let least = smallest(self.start.iter().copied());
        (!self.rows.is_empty() && fastest > 0.0).then(|| 0.1 * least / fastest)
    }

    /// Extrapolates from the state `at`, which velocities reach after `short` [s], when the first observed row vanishes; coordinates
    /// are up to `farthest` [m], and the fastest body has the angular velocity `fastest` [rad/s].
    pub(super) fn look_ahead(
        &mut self,
        (at, size): (Placed, f64),
        short: f64,
        (farthest, fastest): (f64, f64),
    ) {
        let n = self.end.len();
        let mut time = f64::INFINITY;
        if self.factor(at, size) {
            for (&i, start) in self.rows.iter().zip(self.remainders.chunks_exact(n)) {
                self.geometry.remainder(i, &mut self.end);
                let before = start.iter().map(|x| x * x).sum::<f64>();
                let after: f64 = start.iter().zip(&self.end).map(|(a, b)| a * b).sum();
                if after < before {
                    time = time.min(short * before / (before - after));
                }
            }
        }
        // Gaps round independently of each other, and close together.
        let gaps = (self.shares.len() as f64).sqrt() * ROUNDING * farthest;
        let rounding = gaps * fastest;
        self.ahead = Some([time, smallest(self.start.iter().copied()), rounding]);
    }

    /// A length of a step whose stages are not too near a position of dependence: at most `h` [s], unless that is too short for the first
    /// step tried from here to go through a position that is near.
    pub(super) fn step_length(&self, h: f64, is_first: bool) -> f64 {
        match self.ahead {
            Some([time, share, _])
                if is_first && share < AT_HAND && time.is_finite() && h < time / CROSSED_AT =>
            {
                time / CROSSED_AT
            }
            Some([time, ..]) if h < time / CROSSED_FIRST && h >= time / CROSSED_AT => time / CROSSED_AT,
            Some([time, ..]) if h < time / CROSSED_AT => h.min(0.5 * time),
            _ => h,
        }
    }

    /// Errors of velocities by rounding in a step of length `h` [s] [m/s].
    pub(super) fn rounding(&self, h: f64) -> f64 {
        let Some([time, share, rounding]) = self.ahead else { return 0.0 };
        // The share changes in proportion to the time to the position.
        let nearest = smallest(STAGES.iter().map(|c| (1.0 - c * h / time).abs()));
        rounding / (share * nearest).powi(2)
    }

    /// Factors G in lengths in the state `at`; false if its rows are dependent there.
    fn factor(&mut self, at: Placed, size: f64) -> bool {
        self.joints.fill(at, |k| if k % 3 == 2 { size } else { 1.0 }, &mut self.geometry);
        self.geometry.factor(&mut self.shares)
    }

    /// Compares the state `at` at the end of the step with its start.
    pub(super) fn compare(&mut self, at: Placed, size: f64) -> Comparison {
        if !self.factor(at, size) || smallest(self.shares.iter().copied()) < NEAREST {
            return Comparison::Unclear;
        }
        let (mut fractions, mut slowest, mut near) = (vec![], f64::INFINITY, false);
        let n = self.end.len();
        let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        for i in (0..self.shares.len()).filter(|i| !self.rows.contains(i)) {
            if self.shares[i] < NEAR {
                return Comparison::Unclear;
            }
        }
        for (&i, start) in self.rows.iter().zip(self.remainders.chunks_exact(n)) {
            self.geometry.remainder(i, &mut self.end);
            let (before, after) = (length(start), length(&self.end));
            let product: f64 = start.iter().zip(&self.end).map(|(a, b)| a * b).sum();
            let cosine = product / (before * after);
            let (from, to) = (self.start[i], self.shares[i]);
            if cosine < 0.0 {
                if cosine > -ALIGNED {
                    return Comparison::Unclear;
                }
                fractions.push(before / (before + after));
                slowest = slowest.min(from + to);
            } else if from < NEAR && to < NEAR {
                if cosine < ALIGNED {
                    return Comparison::Unclear;
                }
                near = true;
            }
        }
        if fractions.is_empty() {
            Comparison::Clear { near }
        } else {
            Comparison::Crossing { fractions, slowest }
        }
    }

    /// Whether a row that is small at both ends is smaller in the state `at` between them: call after [`Self::compare`].
    pub(super) fn finds_minimum_between(&mut self, at: Placed, size: f64, ends: &[f64]) -> bool {
        if !self.factor(at, size) {
            return true;
        }
        self.rows.iter().zip(ends).any(|(&i, end)| *end < NEAR && self.shares[i] < DIP * end)
    }

    /// The smaller share of each observed row at the two ends of the step: call after [`Self::compare`] `(rows,)` [1].
    pub(super) fn smaller_shares(&self) -> Vec<f64> {
        self.rows.iter().map(|&i| self.start[i].min(self.shares[i])).collect()
    }

    /// Whether a crossing at this rate [1/s] is fast enough where the fastest body has this angular velocity [rad/s].
    pub(super) fn is_transversal(rate: f64, fastest: f64) -> bool {
        rate >= LEAST_RATE * fastest && rate > 0.0
    }
}

/// Whether some of these joints form a loop on `bodies` free bodies; all others count as one.
fn has_loop(constraints: &[Constraint], bodies: usize) -> bool {
    let mut group: Vec<usize> = (0..=bodies).collect();
    for c in constraints {
        let [a, b] = c.ends.map(|end| group[end.frame.min(bodies)]);
        if a == b {
            return true;
        }
        group.iter_mut().filter(|group| **group == b).for_each(|group| *group = a);
    }
    false
}

/// Position on the quintic path through position, velocity and acceleration at both ends of a step of length `h` [s], at the fraction
/// `s` of it.
pub(super) fn on_path(s: f64, h: f64, [q0, v0, a0]: [f64; 3], [q1, v1, a1]: [f64; 3]) -> f64 {
    // Remainders of the Taylor polynomial from the start at the end, in powers of s.
    let (b0, c0) = (h * v0, 0.5 * h * h * a0);
    let dq = q1 - (q0 + b0 + c0);
    let dv = h * v1 - (b0 + 2.0 * c0);
    let da = h * h * a1 - 2.0 * c0;
    let (d3, d4, d5) =
        (10.0 * dq - 4.0 * dv + 0.5 * da, -15.0 * dq + 7.0 * dv - da, 6.0 * dq - 3.0 * dv + 0.5 * da);
    q0 + s * (b0 + s * (c0 + s * (d3 + s * (d4 + s * d5))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_is_exact_for_polynomials_of_fifth_degree() {
        let c = [0.3, -1.2, 0.7, 2.0, -0.4, 1.1];
        let value = |t: f64| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
        let rate = |t: f64| (1..6).rev().fold(0.0, |sum, k| sum * t + c[k] * k as f64);
        let second = |t: f64| (2..6).rev().fold(0.0, |sum, k| sum * t + c[k] * (k * (k - 1)) as f64);
        let at = |t: f64| [value(t), rate(t), second(t)];
        let (from, h) = (0.2, 0.7);
        for s in [0.0, 0.25, 0.6, 1.0] {
            let found = on_path(s, h, at(from), at(from + h));
            assert!((found - value(from + s * h)).abs() < 1e-14, "{found} at {s}");
        }
    }
}
