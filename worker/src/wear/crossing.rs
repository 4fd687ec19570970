//! Where the circle of a journal crosses a tabulated bore: on the chord between two table angles, and next to the contact on a parabola.
//!
//! With p [m], how far the circle lies beyond the bore (`arc_ends.rs`), at the table angles on both sides of the crossing, it is where the straight
//! line between the two is zero. Before the first table angle the parabola through the penetration delta at the contact, with the slope
//! of p there, takes the place of that line.
//!
//! # Source
//! Chosen here.
//!
//! # On journal
//! Depth of a worn journal at the angles at which its bore is tabulated.
//!
//! The journal's depth is tabulated at equal angles in its own body, which is turned from the bushing's by a fraction of their spacing: its
//! depth at the bore's angles is that of the cubic through four neighbours.
//!
//! Source:
//! Lagrange's interpolation. Chosen here.

use crate::lanes::Real;

/// Where the circle of a journal crosses a bore.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Number of the table angle behind the crossing.
    pub at: usize,
    /// p at the table angle before, or where the contact is, and behind it [m].
    pub before: f64,
    pub next: f64,
}

impl Crossing {
    /// Distance from the direction of the contact, in table intervals: there the penetration is `penetration` [m], p has the `slope` [m per interval]
    /// outwards, and the first table angle is at the distance `offset`.
    #[inline(always)]
    pub(super) fn distance(&self, penetration: f64, slope: f64, offset: f64) -> f64 {
        match self.at {
            0 => first_end(penetration, slope, offset, self.next),
            m => offset + (m - 1) as f64 + self.before / (self.before - self.next),
        }
    }
}

/// End of the arc within the first table interval: positive root of delta + slope x + q x^2, where q makes
/// the parabola pass through (first, p), p <= 0 < delta; lengths in any one unit, `slope` per that unit.
fn first_end(delta: f64, slope: f64, first: f64, p: f64) -> f64 {
    if delta <= 0.0 || first <= 0.0 {
        return first.max(f64::MIN_POSITIVE);
    }
    let q = (p - delta - slope * first) / (first * first);
    let root = (slope * slope - 4.0 * q * delta).max(0.0).sqrt();
    // q x^2 + slope x + delta = 0, the root that stays finite as q -> 0.
    let x = if slope >= 0.0 { (slope + root) / (-2.0 * q) } else { 2.0 * delta / (root - slope) };
    if x.is_finite() && x > 0.0 { x.min(first) } else { first }
}

/// Place of the table's angles on the surface of a turned journal.
#[derive(Clone, Copy)]
pub(super) struct OnJournal<'a> {
    /// Depth from the angle before the first one on [m].
    depth: &'a [f64],
    /// Weights of four neighbouring depths [1].
    weights: [f64; 4],
}

impl<'a> OnJournal<'a> {
    /// Of the surface tabulated in `depth`, from the place `place` on, in intervals of a table of `n`.
    pub(super) fn new(depth: &'a [f64], place: f64, n: usize) -> Self {
        let place = place.rem_euclid(n as f64);
        let place = if place < n as f64 { place } else { 0.0 };
        let base = place as usize;
        let f = place - base as f64;
        // Lagrange's cubic through the places -1, 0, 1, 2.
        let (a, b, c) = (f + 1.0, f - 1.0, f - 2.0);
        let weights = [-f * b * c / 6.0, a * b * c / 2.0, -a * f * c / 2.0, a * f * b / 6.0];
        OnJournal { depth: &depth[base..], weights }
    }

    /// Depths at the angles from the `m`-th on [m].
    #[inline(always)]
    pub(super) fn depth<R: Real>(&self, m: usize, like: R) -> R {
        let at = |k: usize| like.load(&self.depth[m + k..]) * self.weights[k];
        (at(0) + at(1)) + (at(2) + at(3))
    }
}
