//! Wear under `local-hertz`: each contact sample wears its contact arc evenly on the present bore, shared out
//! over the control points so that the worn volume is Archard's.
//!
//! Share of control point i: q_i = sum F S w_i / R [N], with the work F S [N m] of a sample and the mean
//! radius R [m] of the worn bore along its arc AB (Simpson's rule over the angle). w_i is the mean over the arc
//! of the hat function phi_i [1], which is 1 at point i and falls to 0 at its neighbours: the w_i of a sample
//! sum to 1 for every arc, wherever it lies between the points. `archard.rs` multiplies by K_H / (L spacing).
//! An arc many spacings long gives F S / |AB| to every point inside, as the published rule does; a narrow one
//! is smeared over the points next to it, whose depth then falls short of that in the middle of the arc
//! (`finer_bore.rs` estimates that error).
//!
//! # Source
//! Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020:
//! the arc AB wears evenly by K_H F S / (|AB| L), at the control points inside it. The shares by hat functions
//! are chosen here: the published rule gives an arc between two points no wear at all.

use super::arc_ends::{ArcEnds, SUBDIVISION, Spot};
use super::history::ContactSample;
use crate::bore::{Profile, Radius};
use std::ops::Range;

/// Width of an arc below which its work goes to its middle, in spacings of the points [1]: there the
/// difference of two integrals of a hat function has lost its digits.
const NARROWEST: f64 = 1e-6;

/// Contacts of a frozen history on a bore.
///
/// The direction of the eccentricity and the penetration stay as they were, so that a sample's angle is found
/// once for all stages of a wear step.
#[derive(Debug, Clone)]
pub struct LocalArcs {
    ends: ArcEnds,
    samples: Vec<Sample>,
    /// Shares on three turns, one before and one after the bore's own `(3 points,)`: there
    /// an arc is one piece.
    unrolled: Vec<f64>,
}

/// The parts of a contact sample that the wear law uses.
#[derive(Debug, Clone, Copy)]
struct Sample {
    spot: Spot,
    /// Penetration delta [m].
    penetration: f64,
    /// Work F S [N m].
    work: f64,
}

impl LocalArcs {
    /// Without samples, for a journal of radius `journal_radius` [m] in a bore with `points` control points.
    pub(crate) fn new(journal_radius: f64, points: usize) -> Self {
        LocalArcs {
            ends: ArcEnds::new(journal_radius, points),
            samples: Vec::new(),
            unrolled: vec![0.0; 3 * points],
        }
    }

    /// Replaces the history by the samples of a cycle.
    pub(crate) fn freeze(&mut self, samples: &[ContactSample]) {
        let n = self.ends.intervals();
        let sample =
            |s: &ContactSample| Sample { spot: Spot::new(s.e, n), penetration: s.penetration, work: s.work };
        self.samples.clear();
        self.samples.extend(samples.iter().map(sample));
    }

    /// Sum over the samples of work per radius, shared out over the control points: F S w_i / R `(points,)` [N].
    pub(crate) fn shares(&mut self, profile: &Profile, shares: &mut [f64]) {
        self.ends.profile_changed(profile);
        let points = shares.len();
        self.unrolled.fill(0.0);
        for Sample { spot, penetration, work } in &mut self.samples {
            let (interval, s) = spot.within();
            let Radius { r, d1, .. } = profile.within(interval, s);
            let (before, after) = self.ends.find(spot, *penetration, r, d1);
            // Mean radius along the arc, by Simpson's rule over its angle.
            let start = (spot.place - before) / SUBDIVISION as f64;
            let end = (spot.place + after) / SUBDIVISION as f64;
            let mean = (profile.turned(start) + 4.0 * r + profile.turned(end)) / 6.0;
            share_out(&mut self.unrolled, points, start..end, *work / mean);
        }
        let (first, rest) = self.unrolled.split_at(points);
        let (second, third) = rest.split_at(points);
        for (i, sum) in shares.iter_mut().enumerate() {
            *sum = first[i] + second[i] + third[i];
        }
    }
}

/// Shares `amount` out over the points next to and inside the `arc`, counted in points from that at angle
/// zero: to each in proportion to the integral of its hat function over the arc.
#[inline]
fn share_out(unrolled: &mut [f64], points: usize, arc: Range<f64>, amount: f64) {
    // The offset of a turn makes truncation the floor.
    let (start, end) = (arc.start + points as f64, arc.end + points as f64);
    let width = end - start;
    if width < NARROWEST {
        let middle = 0.5 * (start + end);
        let (below, s) = (middle as usize, middle.fract());
        unrolled[below] += (1.0 - s) * amount;
        unrolled[below + 1] += s * amount;
        return;
    }
    let density = amount / width;
    let (first, last) = (start as usize, end as usize + 1);
    // Points whose hat the arc covers wholly: those of the intervals wholly inside.
    let covered = first + 2..(last - 1).max(first + 2);
    let partly = |k: usize| density * (below_hat(end - k as f64) - below_hat(start - k as f64));
    (first..covered.start.min(last + 1)).for_each(|k| unrolled[k] += partly(k));
    unrolled[covered.clone()].iter_mut().for_each(|sum| *sum += density);
    (covered.end..=last).for_each(|k| unrolled[k] += partly(k));
}

/// Integral up to `x` of the hat function max(0, 1 - |x|) [1].
#[inline]
fn below_hat(x: f64) -> f64 {
    let outside = 1.0 - x.abs().min(1.0);
    let tail = 0.5 * outside * outside;
    if x < 0.0 { tail } else { 1.0 - tail }
}
