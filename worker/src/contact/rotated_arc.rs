//! Integrals of the gap function over the arc in contact, on a tabulated bore in which a worn journal turns.
//!
//! g(psi) = e.u(psi) + R1 - R(psi) - h(psi - alpha) [m], with the eccentricity e [m], the unit vector u at the
//! angle psi, the unworn radius R1 of the journal, the worn bore R, the wear depth h of the journal and the
//! angle alpha [rad] of the journal's body from that of the bushing. V = integral of g^2 / 2 over g > 0 [m^2
//! rad], with g piecewise linear between the angles of the table, is a function of e and alpha; all
//! derivatives are exact. Which intervals touch is found segment by segment as for the bore alone
//! (`segment.rs`), less the least depth of the journal there; they are then evaluated one by one, without
//! branches, since the coefficients of an interval change with alpha.
//!
//! # Source
//! Derived here, for the Winkler foundation of `foundation.rs` (Winkler 1867; Johnson 1985).

use super::arc::{Arc, Arcs, peak};
use super::integrals::{Integrals, RotatedIntegrals, UnitIntegrals};
use super::journal_table::{JournalTable, Rotated};
use super::segment::{GROUP, SEGMENT, Segment};
use crate::plane::{dot, length};
use std::f64::consts::TAU;

/// Angles at which the intervals of a segment begin or end.
pub(super) const ANGLES: usize = SEGMENT + 1;

/// A tabulated bore with a worn journal in it.
#[derive(Debug, Clone, Copy)]
pub struct RotatedArc<'a> {
    /// The tabulated bore.
    pub arc: &'a Arc,
    /// The tabulated journal.
    pub journal: &'a JournalTable,
}

impl Arcs<f64> for RotatedArc<'_> {
    const JOURNAL: bool = true;

    #[inline(always)]
    fn integrate<const SECOND: bool>(&self, e: [f64; 2], alpha: f64) -> RotatedIntegrals {
        self.integrals::<true>(e, alpha)
    }
}

/// Gaps at the angles of a segment [m], with their first and second derivatives to alpha [m/rad, m/rad^2].
type RotatedGaps = [[f64; ANGLES]; 3];

impl RotatedArc<'_> {
    /// Integrals over the arc in contact at the eccentricity `e` [m] with the journal turned by `alpha` [rad]; zeros for the derivatives to
    /// alpha unless `ALPHA`.
    #[inline(always)]
    pub(super) fn integrals<const ALPHA: bool>(&self, e: [f64; 2], alpha: f64) -> RotatedIntegrals {
        let mut sums = [[0.0; SEGMENT]; 10];
        let mut touched = false;
        let at = self.journal.turned(alpha);
        for g in 0..self.groups(e) {
            let mut any = self.touching(e, at, g, 0.0);
            touched |= any != 0;
            while any != 0 {
                let (s, segment) = self.next_segment(g, &mut any);
                add_segment::<ALPHA>(&mut sums, segment, &self.gaps::<ALPHA>(e, at, s, segment));
            }
        }
        if !touched {
            return RotatedIntegrals::none(0.0);
        }
        let sum = sums.map(|of| of.iter().sum::<f64>());
        let to_e = Integrals { v: sum[0], p: [sum[1], sum[2]], d: [sum[3], sum[4], sum[5]] };
        let spacing = self.arc.spacing;
        RotatedIntegrals {
            to_e: UnitIntegrals { sums: to_e, extent: to_e.d[0] + to_e.d[2] }.scaled(spacing),
            t: sum[6] * spacing,
            et: [sum[7] * spacing, sum[8] * spacing],
            tt: sum[9] * spacing,
        }
    }

    /// Number of groups of segments that may touch.
    #[inline(always)]
    fn groups(&self, e: [f64; 2]) -> usize {
        if length(e) <= self.arc.reach { 0 } else { self.arc.segments.groups.len() }
    }

    /// The segments of group `g` that may touch within `margin` of `e` [m], one bit each.
    #[inline(always)]
    pub(super) fn touching(&self, e: [f64; 2], at: Rotated, g: usize, margin: f64) -> u32 {
        let segments = &self.arc.segments;
        let mut least = [0.0; GROUP];
        let rest = GROUP.min(segments.each.len() - g * GROUP);
        for i in 0..rest {
            least[i] = self.journal.least(at, (g * GROUP + i) * SEGMENT) - margin;
        }
        segments.groups[g].touched_beyond(e, segments.widening, &least)
    }

    /// Takes the first segment of group `g` from the bits `any`: its number and itself. (Not a closure called for each segment: that
    /// would be compiled for the least processor.)
    #[inline(always)]
    pub(super) fn next_segment(&self, g: usize, any: &mut u32) -> (usize, &Segment) {
        let s = g * GROUP + any.trailing_zeros() as usize;
        *any &= *any - 1;
        (s, &self.arc.segments.each[s])
    }

    /// Gaps at the angles of segment `s`; beyond its end they are not positive.
    #[inline(always)]
    fn gaps<const ALPHA: bool>(&self, e: [f64; 2], at: Rotated, s: usize, segment: &Segment) -> RotatedGaps {
        let depth = self.journal.depths::<ANGLES>(at, s * SEGMENT);
        let mut gaps = [[0.0; ANGLES]; 3];
        for i in 0..SEGMENT {
            let bore = e[0] * segment.begin.x[i] + e[1] * segment.begin.y[i] - segment.begin.radial_gap[i];
            gaps[0][i] = bore - depth[0][i];
        }
        let last = segment.intervals;
        let (v, radial_gap) = segment.angle(last);
        gaps[0][last] = dot(e, v) - radial_gap - depth[0][last];
        if ALPHA {
            for i in 0..ANGLES {
                (gaps[1][i], gaps[2][i]) = (-depth[1][i], -depth[2][i]);
            }
        }
        gaps
    }

    /// Gap function in the direction of the eccentricity itself [m].
    #[inline(always)]
    pub(crate) fn gap_along(&self, e: [f64; 2], alpha: f64) -> f64 {
        let n = self.arc.intervals();
        let x = libm::atan2(e[1], e[0]).rem_euclid(TAU) / TAU * n as f64;
        let k = x as usize;
        let [depth, ..] = self.journal.depths::<2>(self.journal.turned(alpha), k % n);
        self.arc.gap_along(e) - depth[0] - (x - k as f64) * (depth[1] - depth[0])
    }

    /// Penetration in free flight, not above zero [m].
    pub(super) fn free_penetration(&self, e: [f64; 2], alpha: f64) -> f64 {
        let beyond = length(e) - self.arc.reach;
        if beyond <= 0.0 { beyond } else { self.gap_along(e, alpha).min(0.0) }
    }

    /// Direction in which the gap function is largest `(2,)` [1], and its derivative to alpha there [m/rad].
    pub(super) fn nearest(&self, e: [f64; 2], alpha: f64) -> ([f64; 2], f64) {
        let n = self.arc.intervals();
        let at = self.journal.turned(alpha);
        let gap = |k: usize| self.arc.gap(e, k % n) - self.journal.depths::<1>(at, k % n)[0][0];
        let (nearest, direction, offset) = peak(n, gap);
        let turned = self.journal.turned(alpha - offset * TAU / n as f64);
        (direction, -self.journal.depths::<1>(turned, nearest)[1][0])
    }

    /// Parts of the integral of g that belong to the angles of each segment in contact, for intervals of length one, into `parts`, and the integral of g
    /// u `(2,)` [m]; the angle between two segments gets a part from either.
    #[inline(always)]
    pub(crate) fn weigh(&self, e: [f64; 2], alpha: f64, parts: &mut Vec<SegmentParts>) -> [f64; 2] {
        parts.clear();
        let at = self.journal.turned(alpha);
        let (mut x, mut y) = ([0.0; SEGMENT], [0.0; SEGMENT]);
        for g in 0..self.groups(e) {
            let mut any = self.touching(e, at, g, 0.0);
            while any != 0 {
                let (s, segment) = self.next_segment(g, &mut any);
                let [gaps, ..] = self.gaps::<false>(e, at, s, segment);
                let (mut to_a, mut to_b) = ([0.0; SEGMENT], [0.0; SEGMENT]);
                for i in 0..SEGMENT {
                    ([to_a[i], to_b[i]], _) = interval_weights(gaps[i], gaps[i + 1]);
                }
                let mut of = SegmentParts { first: s * SEGMENT, part: [0.0; ANGLES] };
                of.part[..SEGMENT].copy_from_slice(&to_a);
                for i in 0..SEGMENT {
                    x[i] += to_a[i] * segment.begin.x[i];
                    y[i] += to_a[i] * segment.begin.y[i];
                }
                for i in 0..SEGMENT {
                    of.part[i + 1] += to_b[i];
                }
                for i in 0..SEGMENT - 1 {
                    x[i] += to_b[i] * segment.begin.x[i + 1];
                    y[i] += to_b[i] * segment.begin.y[i + 1];
                }
                let (end, _) = segment.angle(segment.intervals);
                x[0] += to_b[segment.intervals - 1] * end[0];
                y[0] += to_b[segment.intervals - 1] * end[1];
                parts.push(of);
            }
        }
        let (mut all_x, mut all_y) = (0.0, 0.0);
        for i in 0..SEGMENT {
            (all_x, all_y) = (all_x + x[i], all_y + y[i]);
        }
        [all_x, all_y]
    }

    /// Table interval of the journal turned by `alpha` [rad] at the first angle of the bore's table, and the fraction there.
    #[inline(always)]
    pub(crate) fn place(&self, alpha: f64) -> (usize, f64) {
        self.journal.turned(alpha)
    }
}

/// What the angles of a segment get of an integral.
#[derive(Debug, Clone, Copy)]
pub struct SegmentParts {
    /// Its first angle.
    pub first: usize,
    /// Parts of its angles; beyond its end zero.
    pub part: [f64; ANGLES],
}

impl SegmentParts {
    /// Number of angles of the longest segment.
    pub(crate) const ANGLES: usize = ANGLES;
}

/// First and second derivatives aa, ab, bb of the potential of an interval of length one to the gaps at its ends; zero where neither
/// is positive. Of an interval with the larger gap h and the smaller one l the share f = h / (h - l), at most one, is in contact; the
/// formulas are those of `integrals.rs`, without branches.
#[inline(always)]
fn interval_weights(a: f64, b: f64) -> ([f64; 2], [f64; 3]) {
    let falls = b < a;
    let (high, low) = if falls { (a, b) } else { (b, a) };
    let high = if high > 0.0 { high } else { 0.0 };
    let (over, under) = if low > 0.0 { (low, 0.0) } else { (0.0, low) };
    let f = high / (high - under + f64::MIN_POSITIVE);
    let (f2, f3) = (f * f, f * f * f * (1.0 / 3.0));
    let near = high * (0.5 * f - f2 * (1.0 / 6.0)) + over * (1.0 / 6.0);
    let far = high * f2 * (1.0 / 6.0) + over * (1.0 / 3.0);
    let (near_2, mixed, far_2) = (f - f2 + f3, 0.5 * f2 - f3, f3);
    let (wa, wb) = if falls { (near, far) } else { (far, near) };
    let (aa, bb) = if falls { (near_2, far_2) } else { (far_2, near_2) };
    ([wa, wb], [aa, mixed, bb])
}

/// Adds twice the potential, its gradient x, y, its second derivative xx, xy, yy and, if `ALPHA`, its derivative to alpha and the mixed and second
/// ones, for intervals of length one.
#[inline(always)]
fn add_segment<const ALPHA: bool>(sums: &mut [[f64; SEGMENT]; 10], segment: &Segment, gaps: &RotatedGaps) {
    let (last, [end]) = (segment.intervals, [segment.angle(segment.intervals).0]);
    let (mut x, mut y) = ([0.0; ANGLES], [0.0; ANGLES]);
    x[..SEGMENT].copy_from_slice(&segment.begin.x);
    y[..SEGMENT].copy_from_slice(&segment.begin.y);
    (x[last], y[last]) = (end[0], end[1]);
    for i in 0..last {
        let (ux, uy, vx, vy) = (x[i], y[i], x[i + 1], y[i + 1]);
        let (a, b, da, db) = (gaps[0][i], gaps[0][i + 1], gaps[1][i], gaps[1][i + 1]);
        let ([wa, wb], [aa, ab, bb]) = interval_weights(a, b);
        sums[0][i] += wa * a + wb * b;
        sums[1][i] += wa * ux + wb * vx;
        sums[2][i] += wa * uy + wb * vy;
        sums[3][i] += aa * ux * ux + 2.0 * ab * ux * vx + bb * vx * vx;
        sums[4][i] += aa * ux * uy + ab * (ux * vy + vx * uy) + bb * vx * vy;
        sums[5][i] += aa * uy * uy + 2.0 * ab * uy * vy + bb * vy * vy;
        if !ALPHA {
            continue;
        }
        sums[6][i] += wa * da + wb * db;
        // Columns of the second derivative that alpha moves.
        let (to_a, to_b) = (aa * da + ab * db, ab * da + bb * db);
        sums[7][i] += to_a * ux + to_b * vx;
        sums[8][i] += to_a * uy + to_b * vy;
        sums[9][i] += to_a * da + to_b * db + wa * gaps[2][i] + wb * gaps[2][i + 1];
    }
}
