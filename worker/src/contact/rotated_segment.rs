//! A segment of a bore with a worn journal in one interval of its table: gaps and sums as functions of the fraction f of that interval.
//!
//! Every gap is linear in the eccentricity and cubic in f. Over intervals in contact from end to end the integral of its square is a
//! polynomial, whose coefficients summed over the first intervals of the segment give those of any number of its intervals.
//!
//! # Source
//! Derived here, as `segment.rs` for a round journal.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::journal_table::{JournalTable, Rotated};
use super::rotated_arc::ANGLES;
use super::segment::{SEGMENT, Segment, positive};

/// Number of sums over the intervals of a segment: 3 of D, 8 of P, 7 of C.
pub(super) const SUMS: usize = 18;

/// A segment of a bore with the journal in one interval of its table; angles beyond its end are out of reach.
#[derive(Debug, Clone)]
pub struct RotatedSegment {
    /// That interval, infinite if none is prepared.
    pub base: f64,
    /// Unit vectors at its angles `(angles,)` each [1].
    pub x: [f64; ANGLES],
    pub y: [f64; ANGLES],
    /// Coefficients in f of the gaps there with the journal in the middle of the bore `(4, angles)` [m], and bounds of their slopes to f
    /// `(angles,)` [m].
    pub gaps: [[f64; ANGLES]; 4],
    steepest: [f64; ANGLES],
    /// Sums over its first 0 to [`SEGMENT`] intervals at the eccentricity from which the segment of the bore counts others: of D, then the
    /// coefficients of P and of C.
    sums: [[f64; SUMS]; ANGLES],
}

impl RotatedSegment {
    /// Nothing prepared, and nothing in reach.
    pub(super) const NONE: Self = RotatedSegment {
        base: f64::INFINITY,
        x: [0.0; ANGLES],
        y: [0.0; ANGLES],
        gaps: [[-1.0; ANGLES], [0.0; ANGLES], [0.0; ANGLES], [0.0; ANGLES]],
        steepest: [0.0; ANGLES],
        sums: [[0.0; SUMS]; ANGLES],
    };

    /// Prepares the segment `of` a bore that begins at the table angle `first`, with the journal `at` the beginning of an interval.
    #[inline(always)]
    pub(super) fn prepare(&mut self, of: &Segment, journal: &JournalTable, at: Rotated, first: usize) {
        let last = of.intervals;
        for i in 0..SEGMENT {
            (self.x[i], self.y[i], self.gaps[0][i]) = (of.begin.x[i], of.begin.y[i], -of.begin.radial_gap[i]);
        }
        let (end, radial_gap) = of.angle(last);
        (self.x[last], self.y[last], self.gaps[0][last]) = (end[0], end[1], -radial_gap);
        let depth = journal.cubics(at, first, ANGLES);
        for i in 0..ANGLES {
            self.gaps[0][i] -= depth[0][i];
            for k in 1..4 {
                self.gaps[k][i] = -depth[k][i];
            }
        }
        for i in last + 1..ANGLES {
            (self.x[i], self.y[i], self.gaps[0][i]) = (0.0, 0.0, -1.0);
            (self.gaps[1][i], self.gaps[2][i], self.gaps[3][i]) = (0.0, 0.0, 0.0);
        }
        // The slope of a cubic lies between the least and the largest of its Bezier coefficients.
        for i in 0..ANGLES {
            let (b, c, d) = (self.gaps[1][i], self.gaps[2][i], self.gaps[3][i]);
            let (from, within, to) = (b.abs(), (b + c).abs(), (b + 2.0 * c + 3.0 * d).abs());
            let larger = if within > from { within } else { from };
            self.steepest[i] = if to > larger { to } else { larger };
        }
        let from = of.relative_to_centre([0.0; 2]);
        self.add_up([-from[0], -from[1]], last);
    }

    /// Bits of the angles with gaps above `margin` at the eccentricity `e` [m] for all fractions that differ from `f` by at most `half` [1], and of
    /// those with gaps above -`margin` for some.
    #[inline(always)]
    pub(super) fn bounds(&self, e: [f64; 2], margin: f64, (f, half): (f64, f64)) -> [u32; 2] {
        let [a, b, c, d] = &self.gaps;
        let (mut inside, mut reached) = ([0.0; ANGLES], [0.0; ANGLES]);
        for i in 0..ANGLES {
            let gap = e[0] * self.x[i] + e[1] * self.y[i] + (a[i] + f * (b[i] + f * (c[i] + f * d[i])));
            let change = margin + half * self.steepest[i];
            inside[i] = gap - change;
            reached[i] = gap + change;
        }
        [positive(&inside), positive(&reached)]
    }

    /// Sums over its first intervals, of which there are `last`, at the eccentricity `e` [m].
    #[inline(always)]
    fn add_up(&mut self, e: [f64; 2], last: usize) {
        const THIRD: f64 = 1.0 / 3.0;
        const SIXTH: f64 = 1.0 / 6.0;
        let RotatedSegment { x, y, gaps, .. } = self;
        let mut gap = [0.0; ANGLES];
        for i in 0..ANGLES {
            gap[i] = gaps[0][i] + (e[0] * x[i] + e[1] * y[i]);
        }
        // Of each interval.
        let mut of = [[0.0; SEGMENT]; SUMS];
        for i in 0..SEGMENT {
            let (ux, uy, vx, vy) = (x[i], y[i], x[i + 1], y[i + 1]);
            of[0][i] = THIRD * (ux * ux + ux * vx + vx * vx);
            of[1][i] = THIRD * (ux * uy + vx * vy) + SIXTH * (ux * vy + vx * uy);
            of[2][i] = THIRD * (uy * uy + uy * vy + vy * vy);
        }
        for j in 0..4 {
            let coefficient = if j == 0 { &gap } else { &gaps[j] };
            for i in 0..SEGMENT {
                let to_a = THIRD * coefficient[i] + SIXTH * coefficient[i + 1];
                let to_b = SIXTH * coefficient[i] + THIRD * coefficient[i + 1];
                of[3 + j][i] = to_a * x[i] + to_b * x[i + 1];
                of[7 + j][i] = to_a * y[i] + to_b * y[i + 1];
                of[11 + j][i] += to_a * gap[i] + to_b * gap[i + 1];
                of[12 + j][i] += to_a * gaps[1][i] + to_b * gaps[1][i + 1];
                of[13 + j][i] += to_a * gaps[2][i] + to_b * gaps[2][i + 1];
                of[14 + j][i] += to_a * gaps[3][i] + to_b * gaps[3][i + 1];
            }
        }
        for i in 0..last {
            for k in 0..SUMS {
                self.sums[i + 1][k] = self.sums[i][k] + of[k][i];
            }
        }
    }

    /// Sums of the intervals `which`, bit by bit.
    #[inline(always)]
    pub(super) fn of(&self, mut which: u32) -> [f64; SUMS] {
        let mut all = [0.0; SUMS];
        while which != 0 {
            let from = which.trailing_zeros();
            let to = from + (which >> from).trailing_ones();
            which &= !0 << to;
            let (begin, end) = (&self.sums[from as usize], &self.sums[to as usize]);
            for k in 0..SUMS {
                all[k] += end[k] - begin[k];
            }
        }
        all
    }
}
