//! Integrals over an arc in contact with a turned journal within a cell of states: a polynomial, and single intervals about its ends.
//!
//! With x = e - e_0 the eccentricity from the cell's centre [m] and f the fraction of the journal's interval, between 0 and 1, every gap is
//! linear in x and cubic in f. Intervals in contact all over the cell add up to
//!
//!   2 V / s = x.D x + 2 x.P(f) + C(f),
//!
//! with the spacing s [rad] of the table, P of third and C of sixth degree.
//!
//! # Source
//! Derived here.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::integrals::{Integrals, UnitIntegrals, weights_in_lanes};
use super::rotated_segment::{RotatedSegment, SUMS};
use crate::lanes::{Real, lanewise};
use crate::plane::fused_dot;

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
