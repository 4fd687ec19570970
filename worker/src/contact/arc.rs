//! Integrals of the gap function over the arc in contact, on a bore tabulated at equal angles.
//!
//! g(psi) = e.u(psi) + R1 - R(psi) [m], positive in contact: eccentricity e [m], unit vector u at angle psi,
//! journal radius R1 and worn bore R [m]. The integrals come from V = integral of g^2 / 2 over g > 0 [m^2
//! rad], with g piecewise linear between the angles: force and stiffness are the exact derivatives of V,
//! whatever the spacing s [rad]. The values at the angles are g - g'' s^2 / 12 with g'' = -e.u - R'', which
//! gives the chords the mean of the arcs they replace. The remaining error comes from the two ends of the
//! arc: the force of an arc whose half angle spans m intervals is within 0.025 / m^3 (chords through g itself
//! fall short by 0.25 / m^2).
//!
//! Intervals with g > 0 at both ends are added stretch by stretch (`stretch.rs`).
//!
//! # Source
//! Derived here, for the Winkler foundation of `foundation.rs` (Winkler 1867; Johnson 1985).

use super::stretch::{Quadratic, STRETCH, Stretch, Touch, tabulate};
use crate::bore::Profile;
use crate::extremum::smallest;
use crate::plane::{dot, length};
use std::f64::consts::TAU;

/// Tabulated bore of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Arc {
    /// Journal radius R1 [m].
    journal_radius: f64,
    /// Eccentricity up to which the journal does not touch the bore [m].
    reach: f64,
    /// R - R'' s^2 / 12 at equal angles `(intervals,)` [m].
    radius: Vec<f64>,
    /// (1 + s^2 / 12) times the unit vectors at those angles `(intervals, 2)` [1].
    direction: Vec<[f64; 2]>,
    /// Stretches of [`STRETCH`] intervals.
    stretches: Vec<Stretch>,
}

/// Integrals over the arc in contact.
#[derive(Debug, Clone, Copy, Default)]
pub struct Integrals {
    /// V, integral of g^2 / 2 [m^2 rad].
    pub v: f64,
    /// Its gradient to e: integral of g u `(2,)` [m rad].
    pub p: [f64; 2],
    /// Its second derivative to e `(2, 2)`, symmetric [rad].
    pub d: [[f64; 2]; 2],
}

/// Weights of the two ends a, b of one interval: derivatives of its potential, the integral of g^2 / 2 over
/// the part with g > 0, for an interval of length one.
struct Weights {
    /// First derivatives to the gaps at a and b [m].
    first: [f64; 2],
    /// Second derivatives aa, ab, bb [1].
    second: [f64; 3],
}

impl Weights {
    /// Weights for gaps `a` and `b` [m] of which at least one is positive.
    #[inline(always)]
    fn new(a: f64, b: f64) -> Self {
        if a > 0.0 && b > 0.0 {
            let third = 1.0 / 3.0;
            Weights { first: [a * third + b / 6.0, a / 6.0 + b * third], second: [third, 1.0 / 6.0, third] }
        } else if a > 0.0 {
            let f = a / (a - b);
            Weights {
                first: [a * f * (0.5 - f / 6.0), a * f * f / 6.0],
                second: [f - f * f + f * f * f / 3.0, f * f * (0.5 - f / 3.0), f * f * f / 3.0],
            }
        } else {
            let f = b / (b - a);
            Weights {
                first: [b * f * f / 6.0, b * f * (0.5 - f / 6.0)],
                second: [f * f * f / 3.0, f * f * (0.5 - f / 3.0), f - f * f + f * f * f / 3.0],
            }
        }
    }
}

impl Integrals {
    /// Adds twice the potential, its gradient and its second derivative of one interval of length one with
    /// unit vectors `u`, `v` and gaps `gaps` [m] at its ends.
    #[inline(always)]
    fn add(&mut self, gaps: [f64; 2], weights: &Weights, u: [f64; 2], v: [f64; 2]) {
        let ([a, b], [wa, wb], [aa, ab, bb]) = (gaps, weights.first, weights.second);
        self.v += wa * a + wb * b;
        for i in 0..2 {
            self.p[i] += wa * u[i] + wb * v[i];
            for j in 0..2 {
                self.d[i][j] += aa * u[i] * u[j] + ab * (u[i] * v[j] + v[i] * u[j]) + bb * v[i] * v[j];
            }
        }
    }

    /// Adds the same of intervals of length one that are wholly in contact, with the coefficients `of` at the
    /// eccentricity `e` [m]: e D e - 2 h e + c, D e - h, D.
    #[inline(always)]
    fn add_whole(&mut self, (e, of): ([f64; 2], Quadratic)) {
        let ([xx, xy, yy], [hx, hy]) = (of.d, of.h);
        let p = [xx * e[0] + xy * e[1] - hx, xy * e[0] + yy * e[1] - hy];
        self.v += e[0] * (p[0] - hx) + e[1] * (p[1] - hy) + of.c;
        self.p[0] += p[0];
        self.p[1] += p[1];
        self.d[0][0] += xx;
        self.d[0][1] += xy;
        self.d[1][0] += xy;
        self.d[1][1] += yy;
    }

    /// The integrals for intervals of length `spacing` [rad].
    #[inline(always)]
    fn scaled(mut self, spacing: f64) -> Self {
        self.v *= 0.5 * spacing;
        for i in 0..2 {
            self.p[i] *= spacing;
            for j in 0..2 {
                self.d[i][j] *= spacing;
            }
        }
        self
    }
}

impl Arc {
    /// A round bore tabulated at `intervals` intervals or more, a multiple of the control points.
    pub(crate) fn new(journal_radius: f64, clearance: f64, control_points: usize, intervals: usize) -> Self {
        let n = intervals.div_ceil(control_points * 4) * control_points * 4;
        let spacing = TAU / n as f64;
        let lift = 1.0 + spacing * spacing / 12.0;
        let radius = vec![journal_radius + clearance; n];
        let unit_vector = |k: usize| {
            let (s, c) = libm::sincos(k as f64 * spacing);
            [lift * c, lift * s]
        };
        let direction: Vec<[f64; 2]> = (0..n).map(unit_vector).collect();
        let mut stretches = Vec::new();
        tabulate(&mut stretches, journal_radius, &radius, &direction);
        Arc { journal_radius, reach: clearance / lift, radius, direction, stretches }
    }

    /// Number of intervals around the bore.
    pub(crate) fn intervals(&self) -> usize {
        self.radius.len()
    }

    /// Tabulates a changed profile.
    pub(crate) fn profile_changed(&mut self, profile: &Profile) {
        profile.tabulate_chords(&mut self.radius);
        self.reach = (smallest(self.radius.iter().copied()) - self.journal_radius) / self.direction[0][0];
        tabulate(&mut self.stretches, self.journal_radius, &self.radius, &self.direction);
    }

    /// Eccentricity up to which the journal does not touch the bore in any direction [m].
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Gap function in the direction of the eccentricity itself, |e| + R1 - R [m].
    pub(crate) fn gap_along(&self, e: [f64; 2]) -> f64 {
        let n = self.radius.len();
        let x = libm::atan2(e[1], e[0]).rem_euclid(TAU) / TAU * n as f64;
        let k = x as usize;
        let (a, b) = (self.radius[k % n], self.radius[(k + 1) % n]);
        let radius = a + (x - k as f64) * (b - a);
        libm::hypot(e[0], e[1]) + self.journal_radius - radius
    }

    /// Direction in which the gap function is largest, that is of first contact `(2,)` [1].
    pub(crate) fn nearest(&self, e: [f64; 2]) -> [f64; 2] {
        let n = self.radius.len();
        let gap = |k: usize| dot(e, self.direction[k % n]) - self.radius[k % n];
        let nearest = (0..n).fold(0, |best, k| if gap(k) > gap(best) { k } else { best });
        // The peak of the parabola through three neighbours.
        let (before, at, after) = (gap(nearest + n - 1), gap(nearest), gap(nearest + 1));
        let bend = before - 2.0 * at + after;
        let offset = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
        let (s, c) = libm::sincos(TAU * (nearest as f64 + offset) / n as f64);
        [c, s]
    }

    /// Gap function g at table angle `k` [m].
    #[inline(always)]
    fn gap(&self, e: [f64; 2], k: usize) -> f64 {
        dot(e, self.direction[k]) + self.journal_radius - self.radius[k]
    }

    /// Intervals that could touch at the eccentricity `e` [m]: the first, and their number; `None` if none could.
    #[inline]
    fn window(&self, e: [f64; 2]) -> Option<(usize, usize)> {
        let n = self.radius.len();
        let spacing = TAU / n as f64;
        let r = length(e);
        if r <= self.reach {
            return None;
        }
        let half = libm::acos((self.reach / r).max(-1.0));
        let centre = libm::atan2(e[1], e[0]);
        let first = ((centre - half) / spacing).floor() as i64;
        let last = ((centre + half) / spacing).ceil() as i64;
        Some((first.rem_euclid(n as i64) as usize, (last - first).min(n as i64) as usize))
    }

    /// Coefficients of the intervals from `from` to before `to`, which is in the same stretch or ends it, and the
    /// eccentricity that they refer to when it is `e` [m].
    #[inline(always)]
    fn whole(&self, e: [f64; 2], from: usize, to: usize) -> ([f64; 2], Quadratic) {
        let stretch = &self.stretches[from / STRETCH];
        let (before, after) = (&stretch.sums[from % STRETCH], &stretch.sums[to - from / STRETCH * STRETCH]);
        (stretch.relative_to_centre(e), after.minus(before))
    }

    /// Integrals over the arc in contact at the eccentricity `e` [m]. Intervals wholly in contact come from the sums
    /// of their stretch; at the two ends of an arc only the part with g > 0 counts.
    #[inline]
    pub(crate) fn integrate(&self, e: [f64; 2]) -> Integrals {
        let mut sum = Integrals::default();
        let n = self.radius.len();
        self.visit(e, |first, end, touch| {
            if touch == Touch::Whole {
                sum.add_whole(self.whole(e, first, end));
                return;
            }
            let mut a = self.gap(e, first);
            // First of the intervals under way that are wholly in contact.
            let mut whole_from = None;
            for k in first..end {
                let next = if k + 1 == n { 0 } else { k + 1 };
                let b = self.gap(e, next);
                if a > 0.0 && b > 0.0 {
                    whole_from.get_or_insert(k);
                } else {
                    if let Some(from) = whole_from.take() {
                        sum.add_whole(self.whole(e, from, k));
                    }
                    if a > 0.0 || b > 0.0 {
                        sum.add([a, b], &Weights::new(a, b), self.direction[k], self.direction[next]);
                    }
                }
                a = b;
            }
            if let Some(from) = whole_from {
                sum.add_whole(self.whole(e, from, end));
            }
        });
        // Of contacts below a tenth of a picometre rounding leaves less than this bound (Cauchy and Schwarz).
        let extent = sum.d[0][0] + sum.d[1][1];
        if extent > 0.0 {
            sum.v = sum.v.max(dot(sum.p, sum.p) / extent);
        }
        sum.scaled(TAU / n as f64)
    }

    /// Calls `at` with the first interval and the one after the last of every stretch that may be in contact at the
    /// eccentricity `e` [m].
    #[inline(always)]
    fn visit(&self, e: [f64; 2], mut at: impl FnMut(usize, usize, Touch)) {
        let Some((first, count)) = self.window(e) else { return };
        let n = self.radius.len();
        let stretches = self.stretches.len();
        let (mut s, last) = (first / STRETCH, first + count);
        // First interval of stretch `s`; counted on beyond `n` where the window goes on at interval 0.
        let mut begin = s * STRETCH;
        for _ in 0..stretches {
            if begin >= last {
                break;
            }
            let (from, end) = (s * STRETCH, n.min((s + 1) * STRETCH));
            let touch = self.stretches[s].touch(e);
            if touch != Touch::Free {
                at(from, end, touch);
            }
            begin += end - from;
            s = if s + 1 == stretches { 0 } else { s + 1 };
        }
    }

    /// Calls `weigh` with each interval in contact at the eccentricity `e` [m] and the parts of the integral of g that
    /// belong to its two ends [m rad].
    pub(crate) fn weigh(&self, e: [f64; 2], mut weigh: impl FnMut(usize, f64, f64)) {
        let n = self.radius.len();
        let spacing = TAU / n as f64;
        self.visit(e, |first, end, _| {
            for k in first..end {
                let (a, b) = (self.gap(e, k), self.gap(e, if k + 1 == n { 0 } else { k + 1 }));
                if a > 0.0 || b > 0.0 {
                    let [first, second] = Weights::new(a, b).first;
                    weigh(k, first * spacing, second * spacing);
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integrals, interval by interval.
    fn one_by_one(arc: &Arc, e: [f64; 2]) -> Integrals {
        let mut sum = Integrals::default();
        let n = arc.intervals();
        for k in 0..n {
            let next = (k + 1) % n;
            let (a, b) = (arc.gap(e, k), arc.gap(e, next));
            if a > 0.0 || b > 0.0 {
                sum.add([a, b], &Weights::new(a, b), arc.direction[k], arc.direction[next]);
            }
        }
        sum.scaled(TAU / n as f64)
    }

    #[test]
    fn sums_over_whole_intervals_are_those_of_single_ones() {
        let (journal_radius, clearance, points) = (1.5e-3, 23.5e-6, 36);
        let mut profile = Profile::round(journal_radius + clearance, points);
        let mut arc = Arc::new(journal_radius, clearance, points, 720);
        let mut worst: f64 = 0.0;
        // A round bore, a worn one, and one whose control points alternate, which touches in many places.
        for (smooth, rough) in [(0.0, 0.0), (30e-6, 0.0), (20e-6, 1e-6)] {
            let depth: Vec<f64> = (0..points)
                .map(|i| {
                    let angle = TAU * i as f64 / points as f64;
                    let scar = ((1.0 + angle.cos()) / 2.0_f64).powi(3);
                    smooth * scar + if i % 2 == 0 { rough } else { 0.0 }
                })
                .collect();
            profile.set_depth(&depth);
            arc.profile_changed(&profile);
            for k in 0..360 {
                let angle = f64::from(k).to_radians();
                let u = [angle.cos(), angle.sin()];
                // Free flight, light contact and heavy contact in this direction.
                let at = clearance - arc.gap_along([clearance * u[0], clearance * u[1]]);
                for penetration in [-1e-7, 1e-8, 1e-7, 1e-6, 1e-5] {
                    let e = [(at + penetration) * u[0], (at + penetration) * u[1]];
                    let (found, exact) = (arc.integrate(e), one_by_one(&arc, e));
                    let size = length(exact.p);
                    let off = |a: f64, b: f64, size: f64| {
                        if size > 0.0 { (a - b).abs() / size } else { (a - b).abs() }
                    };
                    let mut error = off(found.v, exact.v, exact.v);
                    for i in 0..2 {
                        error = error.max(off(found.p[i], exact.p[i], size));
                        for j in 0..2 {
                            error =
                                error.max(off(found.d[i][j], exact.d[i][j], exact.d[0][0] + exact.d[1][1]));
                        }
                    }
                    assert!(error < 1e-6, "{k} deg, {penetration} m: {found:?} {exact:?}");
                    worst = worst.max(error);
                }
            }
        }
        println!("sums within {worst:e}");
    }
}
