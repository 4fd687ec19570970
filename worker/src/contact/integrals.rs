//! Integrals of the gap function over an arc in contact, and what one interval adds to them.
//!
//! With the gap function g [m], positive in contact, linear between the ends of an interval, V = integral of g^2 / 2 over g > 0 [m^2
//! rad] is a cubic function of the gaps at the two ends; its first and second derivatives follow from it exactly.
//!
//! # Source
//! Derived here, for the Winkler foundation of `foundation.rs` (Winkler 1867; Johnson 1985).

use super::segment::Quadratic;
use crate::lanes::{Real, lanewise};
use crate::plane::dot;

/// Integrals over the arc in contact.
#[derive(Debug, Clone, Copy, Default)]
pub struct Integrals<R = f64> {
    /// V, integral of g^2 / 2 [m^2 rad].
    pub v: R,
    /// Its gradient to e: integral of g u `(2,)` [m rad].
    pub p: [R; 2],
    /// Its second derivative to e, entries xx, xy, yy [rad].
    pub d: [R; 3],
}

lanewise!(Integrals { v, p, d });

/// Sums over intervals before they are multiplied by the spacing of the angles; V counts twice.
#[derive(Debug, Clone, Copy)]
pub struct UnitIntegrals<R = f64> {
    /// V and its derivatives.
    pub sums: Integrals<R>,
    /// Number of intervals in contact, those in part by that part [1].
    pub extent: R,
}

lanewise!(UnitIntegrals { sums, extent });

impl<R: Real> UnitIntegrals<R> {
    /// Nothing in contact.
    #[inline(always)]
    pub(super) fn none(nothing: R) -> Self {
        UnitIntegrals { sums: Integrals { v: nothing, p: [nothing; 2], d: [nothing; 3] }, extent: nothing }
    }

    /// The integrals for intervals of length `spacing` [rad].
    #[inline(always)]
    pub(super) fn scaled(self, spacing: R) -> Integrals<R> {
        let UnitIntegrals { sums: Integrals { v, p, d }, extent } = self;
        let zero = v.zero();
        let touches = zero.below(extent);
        // Of contacts below a tenth of a picometre rounding leaves less than this bound (Cauchy and Schwarz).
        let least = dot(p, p) / R::select(touches, extent, zero.like(1.0));
        let v = R::select(R::both(touches, v.below(least)), least, v);
        // In lanes, closures are not compiled for the instruction set of the code around them.
        let p = [p[0] * spacing, p[1] * spacing];
        Integrals { v: v * spacing * 0.5, p, d: [d[0] * spacing, d[1] * spacing, d[2] * spacing] }
    }
}

/// Integrals over the arc in contact with a turned journal.
#[derive(Debug, Clone, Copy)]
pub struct RotatedIntegrals<R = f64> {
    /// V and its derivatives to e.
    pub to_e: Integrals<R>,
    /// dV/dalpha: minus the integral of g dh/dalpha [m^2].
    pub t: R,
    /// d2V/(de dalpha) `(2,)` [m].
    pub et: [R; 2],
    /// Second derivative of V to alpha [m^2/rad].
    pub tt: R,
}

lanewise!(RotatedIntegrals { to_e, t, et, tt });

impl<R: Real> RotatedIntegrals<R> {
    /// Zero integrals: no interval in contact.
    #[inline(always)]
    pub(super) fn none(nothing: R) -> Self {
        Self::round(Integrals { v: nothing, p: [nothing; 2], d: [nothing; 3] })
    }

    /// Those of a round journal, which do not depend on alpha.
    #[inline(always)]
    pub(super) fn round(to_e: Integrals<R>) -> Self {
        let nothing = to_e.v.zero();
        RotatedIntegrals { to_e, t: nothing, et: [nothing; 2], tt: nothing }
    }
}

/// Weights of the two ends of one interval with gaps `a` and `b` [m] of which at least one is positive: first derivatives to the gaps [m],
/// and second derivatives aa, ab, bb [1] of its potential, the integral of g^2 / 2 over the part with g > 0, for an interval of length one.
#[inline(always)]
pub(super) fn weights(a: f64, b: f64) -> ([f64; 2], [f64; 3]) {
    if a > 0.0 && b > 0.0 {
        let third = 1.0 / 3.0;
        ([a * third + b / 6.0, a / 6.0 + b * third], [third, 1.0 / 6.0, third])
    } else if a > 0.0 {
        let f = a / (a - b);
        (
            [a * f * (0.5 - f / 6.0), a * f * f / 6.0],
            [f - f * f + f * f * f / 3.0, f * f * (0.5 - f / 3.0), f * f * f / 3.0],
        )
    } else {
        let f = b / (b - a);
        (
            [b * f * f / 6.0, b * f * (0.5 - f / 6.0)],
            [f * f * f / 3.0, f * f * (0.5 - f / 3.0), f - f * f + f * f * f / 3.0],
        )
    }
}

/// First derivatives of the potential of an interval to the gaps `a` and `b` [m] at its ends, as those of [`weights`], its second
/// derivatives aa, ab, bb if `SECOND`, else zeros, and the share of it in contact [1]. Without branches, also where nothing is in contact.
///
/// Of an interval with the larger gap h and the smaller one l the share f = h / (h - l), at most one, is in contact.
#[inline(always)]
pub(super) fn weights_in_lanes<R: Real, const SECOND: bool>(a: R, b: R) -> ([R; 2], [R; 3], R) {
    let (zero, sixth_part) = (a.zero(), a.like(1.0 / 6.0));
    let falls = b.below(a);
    let (high, low) = (R::select(falls, a, b).larger(zero), R::select(falls, b, a));
    let (over, under) = (low.larger(zero), low.smaller(zero));
    let f = high / (high - under + f64::MIN_POSITIVE);
    let f2 = f * f;
    // Half and a sixth of the parts h f and h f^2.
    let (half, sixth) = (high * f * 0.5, high * f2 * sixth_part);
    let near = (half - sixth).plus_product(over, sixth_part);
    let far = sixth.plus_product(over, sixth_part * 2.0);
    let first = [R::select(falls, near, far), R::select(falls, far, near)];
    if !SECOND {
        return (first, [zero; 3], f);
    }
    let f3 = f2 * f * (1.0 / 3.0);
    let (near, mixed, far) = (f - f2 + f3, f2 * 0.5 - f3, f3);
    (first, [R::select(falls, near, far), mixed, R::select(falls, far, near)], f)
}

impl<R: Real> UnitIntegrals<R> {
    /// Adds an interval with the unit vectors `u`, `v` and the gaps `gaps` [m] at its ends and these weights and share in contact; its
    /// second derivative only if `SECOND`.
    #[inline(always)]
    pub(super) fn add_end<const SECOND: bool>(
        &mut self,
        [u, v]: [[R; 2]; 2],
        [a, b]: [R; 2],
        ([wa, wb], [aa, mixed, bb], share): ([R; 2], [R; 3], R),
    ) {
        let ([ux, uy], [vx, vy]) = (u, v);
        let sums = &mut self.sums;
        sums.v = sums.v.plus_product(wa, a).plus_product(wb, b);
        sums.p[0] = sums.p[0].plus_product(wa, ux).plus_product(wb, vx);
        sums.p[1] = sums.p[1].plus_product(wa, uy).plus_product(wb, vy);
        self.extent += share;
        if SECOND {
            let (ax, bx) = ((aa * ux).plus_product(mixed, vx), (mixed * ux).plus_product(bb, vx));
            let (ay, by) = ((aa * uy).plus_product(mixed, vy), (mixed * uy).plus_product(bb, vy));
            sums.d[0] = sums.d[0].plus_product(ax, ux).plus_product(bx, vx);
            sums.d[1] = sums.d[1].plus_product(ay, ux).plus_product(by, vx);
            sums.d[2] = sums.d[2].plus_product(ay, uy).plus_product(by, vy);
        }
    }
}

impl Integrals {
    /// Adds twice the potential, its gradient and its second derivative of one interval of length one with
    /// unit vectors `u`, `v` and gaps `gaps` [m] at its ends.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        gaps: [f64; 2],
        (first, second): ([f64; 2], [f64; 3]),
        u: [f64; 2],
        v: [f64; 2],
    ) {
        let ([a, b], [wa, wb], [aa, ab, bb]) = (gaps, first, second);
        self.v += wa * a + wb * b;
        for i in 0..2 {
            self.p[i] += wa * u[i] + wb * v[i];
        }
        self.d[0] += aa * u[0] * u[0] + 2.0 * ab * u[0] * v[0] + bb * v[0] * v[0];
        self.d[1] += aa * u[0] * u[1] + ab * (u[0] * v[1] + v[0] * u[1]) + bb * v[0] * v[1];
        self.d[2] += aa * u[1] * u[1] + 2.0 * ab * u[1] * v[1] + bb * v[1] * v[1];
    }

    /// Adds the same of intervals of length one that are wholly in contact, with the coefficients `of` at the
    /// eccentricity `e` [m]: e D e - 2 h e + c, D e - h, D.
    #[inline(always)]
    pub(super) fn add_whole(&mut self, e: [f64; 2], of: Quadratic) {
        let ([xx, xy, yy], [hx, hy]) = (of.d, of.h);
        let p = [xx * e[0] + xy * e[1] - hx, xy * e[0] + yy * e[1] - hy];
        self.v += e[0] * (p[0] - hx) + e[1] * (p[1] - hy) + of.c;
        self.p[0] += p[0];
        self.p[1] += p[1];
        self.d[0] += xx;
        self.d[1] += xy;
        self.d[2] += yy;
    }
}
