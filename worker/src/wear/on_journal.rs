//! Depth of a worn journal at the angles at which its bore is tabulated.
//!
//! The journal's depth is tabulated at equal angles in its own body, which is turned from the bushing's by a fraction of their spacing: its
//! depth at the bore's angles is that of the cubic through four neighbours.
//!
//! # Source
//! Lagrange's interpolation. Chosen here.

use crate::lanes::Real;

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
