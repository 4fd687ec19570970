//! A segment of a bore with a worn journal in one interval of its table: gaps and sums as functions of the fraction f of that interval.
//!
//! Every gap is linear in the eccentricity and cubic in f. Over intervals in contact from end to end the integral of its square is a
//! polynomial, whose coefficients summed over the first intervals of the segment give those of any number of its intervals.
//!
//! # Source
//! Derived here, as `segment.rs` for a round journal.
//!
//! # Rotated sums
//! Integrals over an arc in contact with a turned journal within a cell of states: a polynomial, and single intervals about its ends.
//!
//! With x = e - e_0 the eccentricity from the cell's centre [m] and f the fraction of the journal's interval, between 0 and 1, every gap is
//! linear in x and cubic in f. Intervals in contact all over the cell add up to
//!
//!   2 V / s = x.D x + 2 x.P(f) + C(f),
//!
//! with the spacing s [rad] of the table, P of third and C of sixth degree.
//!
//! Source:
//! Derived here.

use super::integrals::{Integrals, UnitIntegrals, weights_in_lanes};
use super::journal_table::{JournalTable, Rotated};
use super::rotated_arc::ANGLES;
use super::segment::{SEGMENT, Segment, positive};
use crate::lanes::{Real, lanewise};
use crate::plane::fused_dot;

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

/// An interval about the end of an arc; in lanes where there is none it touches nothing.
#[derive(Debug, Clone, Copy)]
pub struct RotatedEnd<R> {
    /// Unit vectors at both ends of the interval `(2,)` each [1].
    u: [R; 2],
    v: [R; 2],
    /// Coefficients of the gaps there in f, at the centre of the cell `(4,)` each [m].
    a: [R; 4],
    b: [R; 4],
}

impl<R: Real> RotatedEnd<R> {
    /// No interval in any lane.
    pub(super) fn none(like: R) -> Self {
        let zero = like.zero();
        let free = [like.like(-1.0), zero, zero, zero];
        RotatedEnd { u: [zero; 2], v: [zero; 2], a: free, b: free }
    }

    /// Replaces the interval of a lane by interval `i` of a segment, with the cell's centre `e` [m].
    #[inline(always)]
    pub(super) fn set_lane(&mut self, lane: usize, segment: &RotatedSegment, i: usize, e: [f64; 2]) {
        let RotatedSegment { x, y, gaps, .. } = segment;
        self.a[0].set_lane(lane, gaps[0][i] + (e[0] * x[i] + e[1] * y[i]));
        self.b[0].set_lane(lane, gaps[0][i + 1] + (e[0] * x[i + 1] + e[1] * y[i + 1]));
        for k in 1..4 {
            self.a[k].set_lane(lane, gaps[k][i]);
            self.b[k].set_lane(lane, gaps[k][i + 1]);
        }
        self.u[0].set_lane(lane, x[i]);
        self.u[1].set_lane(lane, y[i]);
        self.v[0].set_lane(lane, x[i + 1]);
        self.v[1].set_lane(lane, y[i + 1]);
    }
}

/// Sums of intervals of length one in contact all over a cell.
#[derive(Debug, Clone, Copy, Default)]
pub struct Whole<R = f64> {
    /// D, entries xx, xy, yy [1].
    pub d: [R; 3],
    /// Coefficients of both components of P `(2, 4)` [m].
    pub p: [[R; 4]; 2],
    /// Coefficients of C `(7,)` [m^2].
    pub c: [R; 7],
}

lanewise!(Whole { d, p, c });

impl Whole {
    /// Adds these sums of a segment at the eccentricity `x`, counted from its own [m].
    #[inline(always)]
    pub(super) fn add_moved(&mut self, of: &[f64; SUMS], x: [f64; 2]) {
        let moved = [of[0] * x[0] + of[1] * x[1], of[1] * x[0] + of[2] * x[1]];
        for k in 0..3 {
            self.d[k] += of[k];
        }
        for j in 0..4 {
            self.p[0][j] += of[3 + j];
            self.p[1][j] += of[7 + j];
            self.c[j] += 2.0 * (x[0] * of[3 + j] + x[1] * of[7 + j]);
        }
        self.p[0][0] += moved[0];
        self.p[1][0] += moved[1];
        self.c[0] += x[0] * moved[0] + x[1] * moved[1];
        for k in 0..7 {
            self.c[k] += of[11 + k];
        }
    }
}

/// Sums over intervals of length one; the derivatives to alpha are those to f.
pub struct RotatedSums<R> {
    /// V and its derivatives to e.
    pub to_e: UnitIntegrals<R>,
    /// dV/df, d2V/(de df) `(2,)` and d2V/df2.
    pub t: R,
    pub et: [R; 2],
    pub tt: R,
}

impl<R: Real> Whole<R> {
    /// Sums at the eccentricity `x` from the centre of the cell [m] and the fraction `f`; zeros for second derivatives unless `SECOND`.
    #[inline(always)]
    pub(super) fn at<const SECOND: bool>(&self, x: [R; 2], f: R) -> RotatedSums<R> {
        let zero = f.zero();
        let Whole { d, p: [px, py], c } = self;
        let (p, slope) = ([cubic(px, f), cubic(py, f)], [cubic_slope(px, f), cubic_slope(py, f)]);
        let moved = [fused_dot([d[0], d[1]], x), fused_dot([d[1], d[2]], x)];
        let mut value = c[6];
        for k in (0..6).rev() {
            value = c[k].plus_product(value, f);
        }
        let mut growth = c[6] * 6.0;
        for k in (1..6).rev() {
            growth = (c[k] * k as f64).plus_product(growth, f);
        }
        let to_e = UnitIntegrals {
            sums: Integrals {
                v: value + fused_dot([p[0] * 2.0 + moved[0], p[1] * 2.0 + moved[1]], x),
                p: [p[0] + moved[0], p[1] + moved[1]],
                d: if SECOND { *d } else { [zero; 3] },
            },
            extent: d[0] + d[2],
        };
        let t = (growth * 0.5) + fused_dot(slope, x);
        if !SECOND {
            return RotatedSums { to_e, t, et: [zero; 2], tt: zero };
        }
        let mut bend = c[6] * 15.0;
        for k in (2..6).rev() {
            bend = (c[k] * (0.5 * (k * (k - 1)) as f64)).plus_product(bend, f);
        }
        let tt = bend + fused_dot([cubic_bend(px, f), cubic_bend(py, f)], x);
        RotatedSums { to_e, t, et: slope, tt }
    }
}

/// Value at `f` of the cubic with these coefficients.
#[inline(always)]
fn cubic<R: Real>(of: &[R; 4], f: R) -> R {
    of[0].plus_product(of[1].plus_product(of[2].plus_product(of[3], f), f), f)
}

/// Derivative of that cubic to `f`.
#[inline(always)]
fn cubic_slope<R: Real>(of: &[R; 4], f: R) -> R {
    of[1].plus_product((of[2] * 2.0).plus_product(of[3] * 3.0, f), f)
}

/// Second derivative of that cubic to `f`.
#[inline(always)]
fn cubic_bend<R: Real>(of: &[R; 4], f: R) -> R {
    (of[2] * 2.0).plus_product(of[3] * 6.0, f)
}

impl<R: Real> RotatedSums<R> {
    /// Adds this interval at the eccentricity `x` from the centre of the cell [m] and the fraction `f`, without second derivatives unless
    /// `SECOND`.
    #[inline(always)]
    pub(super) fn add_end<const SECOND: bool>(&mut self, end: &RotatedEnd<R>, x: [R; 2], f: R) {
        let ([ux, uy], [vx, vy]) = (end.u, end.v);
        let a = cubic(&end.a, f).plus_product(x[0], ux).plus_product(x[1], uy);
        let b = cubic(&end.b, f).plus_product(x[0], vx).plus_product(x[1], vy);
        let (da, db) = (cubic_slope(&end.a, f), cubic_slope(&end.b, f));
        let weights = weights_in_lanes::<R, SECOND>(a, b);
        self.to_e.add_end::<SECOND>([end.u, end.v], [a, b], weights);
        let ([wa, wb], [aa, mixed, bb], _) = weights;
        self.t = self.t.plus_product(wa, da).plus_product(wb, db);
        if SECOND {
            let (af, bf) = ((aa * da).plus_product(mixed, db), (mixed * da).plus_product(bb, db));
            self.et[0] = self.et[0].plus_product(af, ux).plus_product(bf, vx);
            self.et[1] = self.et[1].plus_product(af, uy).plus_product(bf, vy);
            let bends = (wa * cubic_bend(&end.a, f)).plus_product(wb, cubic_bend(&end.b, f));
            self.tt = (self.tt + bends).plus_product(af, da).plus_product(bf, db);
        }
    }
}
