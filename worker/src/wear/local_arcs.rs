//! Wear under `local-hertz`: each contact sample distributes its work evenly over its contact arc on the
//! present bore.
//!
//! Share of control point i: q_i = sum F S a_i / |AB| [N], with the work F S [N m] of a sample, the length
//! |AB| [m] of its arc along the worn bore (Simpson's rule over the angle) and the degree a_i in [0, 1] to
//! which the point lies inside the arc. a_i rises linearly over [`ENTRY`] at both ends of the arc, which
//! makes the rate continuous in the profile. `archard.rs` multiplies by K_H / L.
//!
//! # Source
//! Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020:
//! every control point inside the arc AB receives K_H F S / (|AB| L). The linear entry is added here.

use super::arc_ends::{ArcEnds, SUBDIVISION, Spot};
use super::history::ContactSample;
use crate::bore::{Profile, Radius};
use std::f64::consts::TAU;

/// Width over which a control point enters the arc [rad]: half a degree, below the distance the arc's end
/// moves between two samples, so that the wear rate is a smooth function of the profile.
pub const ENTRY: f64 = 0.5 * TAU / 360.0;

/// Contacts of a frozen history on a bore.
///
/// The direction of the eccentricity and the penetration stay as they were, so that a sample's angle is found
/// once for all stages of a wear step.
#[derive(Debug, Clone)]
pub struct LocalArcs {
    ends: ArcEnds,
    samples: Vec<Sample>,
    /// Shares on three turns, one before and one after the bore's own `(3 points,)`: there an arc is one
    /// piece.
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

    /// Sum over the samples of work per length of arc, F S / |AB|, at every control point inside the arc
    /// `(points,)` [N].
    pub(crate) fn shares(&mut self, profile: &Profile, shares: &mut [f64]) {
        self.ends.profile_changed(profile);
        self.unrolled.fill(0.0);
        let points = shares.len();
        let radians = TAU / self.ends.intervals() as f64;
        for Sample { spot, penetration, work } in &mut self.samples {
            let (interval, s) = spot.within();
            let Radius { r, d1, .. } = profile.within(interval, s);
            let (before, after) = self.ends.find(spot, *penetration, r, d1);
            // Length of the arc along the worn bore, by Simpson's rule over its angle.
            let start = (spot.place - before) / SUBDIVISION as f64;
            let end = (spot.place + after) / SUBDIVISION as f64;
            let mean = (profile.turned(start) + 4.0 * r + profile.turned(end)) / 6.0;
            let share = *work / (mean * (before + after) * radians);
            enter(&mut self.unrolled, points, start, end, share);
        }
        let (first, rest) = self.unrolled.split_at(points);
        let (second, third) = rest.split_at(points);
        for (i, sum) in shares.iter_mut().enumerate() {
            *sum = first[i] + second[i] + third[i];
        }
    }
}

/// Adds `share` at the control points from `start` to `end`, counted in control points from that at angle
/// zero; at the ends of the arc in proportion to how far a point has entered it over the width [`ENTRY`].
#[inline]
fn enter(unrolled: &mut [f64], points: usize, start: f64, end: f64, share: f64) {
    let per_width = TAU / (ENTRY * points as f64);
    let half = 0.5 / per_width;
    // Points above these; the offset makes truncation the floor.
    let offset = points as f64;
    let above = |x: f64| (x + offset) as usize + 1;
    let first = above(start - half);
    // At most a turn: an arc does not meet itself.
    let end_of = above(end + half).min(first + points);
    let full = above(start + half).min(end_of);
    let end_of_full = above(end - half).clamp(full, end_of);
    let partly = |k: usize| {
        let at = k as f64 - offset;
        share
            * (0.5 + (end - at) * per_width).clamp(0.0, 1.0)
            * (0.5 + (at - start) * per_width).clamp(0.0, 1.0)
    };
    unrolled[first..full].iter_mut().zip(first..).for_each(|(sum, k)| *sum += partly(k));
    unrolled[full..end_of_full].iter_mut().for_each(|sum| *sum += share);
    unrolled[end_of_full..end_of].iter_mut().zip(end_of_full..).for_each(|(sum, k)| *sum += partly(k));
}
