//! Where the search for the contact of a worn journal with its bore begins: two surfaces that turn on each other have no table of starts.
//!
//! The gap closed, g of `touch.rs`, is evaluated at equal angles on both sides of the eccentricity, as far as it can be above zero: g <= |e| cos(phi)
//! minus G at the angle phi from the eccentricity. The search begins at the highest peak, by the parabola through three neighbours, and also at the second one
//! if that is about as high.
//!
//! # Source
//! Chosen here.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::local_hertz::PolarEccentricity;
use super::touch::{Begin, Facing};
use crate::bore::Bore;
use crate::lanes::Real;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Most angles on one side.
const SIDE: usize = 12;
/// Share of the unworn clearance that is left everywhere, ripples of the splines included [1].
const LEAST: f64 = 0.5;
/// In the place of a gap closed where none is evaluated [m].
const ABSENT: f64 = -1.0;
/// A second peak less high than the first one by more than this share of the clearance is not tried [1].
const LOWER: f64 = 0.05;

/// Angles at which the gap is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// Angle between two of them [rad]: the spacing of the control points, where that takes no more than [`SIDE`] a side.
    step: f64,
    /// Cosines of its multiples `(SIDE + 1,)` [1].
    cosine: [f64; SIDE + 1],
}

impl Sweep {
    /// For surfaces with `points` control points.
    pub(super) fn new(points: usize) -> Self {
        let step = (TAU / points as f64).max(FRAC_PI_2 / SIDE as f64);
        Sweep { step, cosine: std::array::from_fn(|k| libm::cos(step * k as f64)) }
    }

    /// Starts between the surfaces `facing` at this eccentricity.
    #[inline(always)]
    pub(super) fn begin<R: Real, B: Bore<R>>(
        &self,
        facing: &Facing<R, B>,
        e: &PolarEccentricity<R>,
    ) -> Begin<R> {
        let nothing = e.psi.zero();
        let absent = nothing.like(ABSENT);
        let least = facing.clearance * LEAST;
        let mut closed = [absent; 2 * SIDE + 3];
        let mut reached = 0;
        for k in 0..=SIDE {
            let along = e.size * self.cosine[k];
            let within = least.below(along);
            if k > 0 && (self.cosine[k] <= 0.0 || !R::any(within)) {
                break;
            }
            reached = k;
            let offset = self.step * k as f64;
            for side in 0..if k == 0 { 1 } else { 2 } {
                let theta = if side == 0 { e.psi + offset } else { e.psi - offset };
                let at = along - facing.walls(theta).gap(facing.radius).r;
                let index = if side == 0 { SIDE + 1 + k } else { SIDE + 1 - k };
                closed[index] = R::select(within, at, absent);
            }
        }
        let (mut first, mut second) = (absent, absent);
        let mut places = [e.psi; 2];
        let lowest = nothing.like(0.5 * ABSENT);
        for k in SIDE + 1 - reached..=SIDE + 1 + reached {
            let (before, at, after) = (closed[k - 1], closed[k], closed[k + 1]);
            let bend = at + at - before - after;
            let bent = R::both(R::both(lowest.below(before), lowest.below(after)), nothing.below(bend));
            let across = R::select(bent, after - before, nothing);
            let per = nothing.like(1.0) / R::select(bent, bend, nothing.like(1.0));
            let height = at.plus_product(across * across, per * 0.125);
            let offset = self.step * (k as f64 - (SIDE + 1) as f64);
            let place = e.psi + (across * per) * (0.5 * self.step) + offset;
            let height = R::select(at.below(before), absent, R::select(at.below(after), absent, height));
            let highest = first.below(height);
            let next = R::both(second.below(height), height.below(first));
            places[1] = R::select(highest, places[0], R::select(next, place, places[1]));
            second = R::select(highest, first, R::select(next, height, second));
            places[0] = R::select(highest, place, places[0]);
            first = R::select(highest, height, first);
        }
        let near = (first - facing.clearance * LOWER).below(second);
        Begin { places, two: R::select(near, nothing.like(1.0), nothing) }
    }
}
