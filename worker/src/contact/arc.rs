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
//! Intervals with g > 0 at both ends are added segment by segment (`segment.rs`), and segments wholly in contact next to each
//! other at once.
//!
//! # Source
//! Derived here, for the Winkler foundation of `foundation.rs` (Winkler 1867; Johnson 1985).

use super::integrals::{Integrals, RotatedIntegrals, UnitIntegrals, weights};
use super::segment::{GROUP, Segment, Segments};
use crate::bore::{Profile, Radius};
use crate::extremum::smallest;
use crate::lanes::Real;
use crate::plane::{dot, length};
use std::f64::consts::TAU;

/// Tabulated bore of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Arc {
    /// Journal radius R1 [m].
    journal_radius: f64,
    /// Eccentricity up to which the journal does not touch the bore [m].
    pub(super) reach: f64,
    /// Spacing s of the angles [rad].
    pub(super) spacing: f64,
    /// c s^2, with the clearance c [m].
    pub(super) scale: f64,
    /// R - R'' s^2 / 12 at equal angles `(intervals,)` [m].
    radius: Vec<f64>,
    /// (1 + s^2 / 12) times the unit vectors at those angles `(intervals, 2)` [1].
    direction: Vec<[f64; 2]>,
    /// Segments of [`super::segment::SEGMENT`] intervals.
    pub(super) segments: Segments,
}

/// A tabulated bore with a journal in it that is round or worn, or one pair per lane.
pub trait Arcs<R: Real> {
    /// Whether the journal wears, so that its angle alpha [rad] in the bore matters.
    const JOURNAL: bool;
    /// Integrals over the arc in contact at the eccentricity `e` [m] with the journal turned by `alpha` [rad]; the second derivatives only if
    /// `SECOND`.
    fn integrate<const SECOND: bool>(&self, e: [R; 2], alpha: R) -> RotatedIntegrals<R>;
}

/// One pair per lane, also in free flight.
pub trait FreeArcs<R: Real>: Arcs<R> {
    /// Penetration of a lane in free flight at the eccentricity `e` [m] with the journal turned by `alpha` [rad], not above zero [m].
    fn free_penetration(&self, lane: usize, e: [f64; 2], alpha: f64) -> f64;
    /// Direction in which the journal of a lane is nearest to the bore at the eccentricity `e` [m], which is not zero `(2,)` [1], and the
    /// derivative of the gap to alpha there [m/rad]; zeros for an idle lane, which has no bore.
    fn nearest(&self, lane: usize, e: [f64; 2], alpha: f64) -> ([f64; 2], f64);
    /// Radius of the worn journal at the angle `chi` in its own body, within half a turn of zero [rad]; that of a round one is the joint's.
    fn journal(&self, chi: R) -> Radius<R> {
        Radius { r: chi.zero(), d1: chi.zero(), d2: chi.zero() }
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
        let mut segments = Segments::default();
        segments.tabulate(journal_radius, &radius, &direction);
        let scale = clearance * spacing * spacing;
        Arc { journal_radius, reach: clearance / lift, spacing, scale, radius, direction, segments }
    }

    /// A bore that no journal reaches.
    pub(crate) fn out_of_reach() -> Self {
        Arc {
            journal_radius: 0.0,
            reach: f64::MAX,
            spacing: 1.0,
            scale: 1.0,
            radius: vec![],
            direction: vec![],
            segments: Segments::default(),
        }
    }

    /// Number of intervals around the bore.
    pub(crate) fn intervals(&self) -> usize {
        self.radius.len()
    }

    /// Tabulates a changed profile.
    #[inline(always)]
    pub(crate) fn profile_changed(&mut self, profile: &Profile) {
        profile.tabulate_chords(&mut self.radius);
        self.reach = (smallest(self.radius.iter().copied()) - self.journal_radius) / self.direction[0][0];
        self.segments.tabulate(self.journal_radius, &self.radius, &self.direction);
    }

    /// Gap function in the direction of the eccentricity itself, |e| + R1 - R [m].
    #[inline(always)]
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
        peak(n, |k| dot(e, self.direction[k % n]) - self.radius[k % n]).1
    }

    /// Gap function g at table angle `k` [m].
    #[inline(always)]
    pub(super) fn gap(&self, e: [f64; 2], k: usize) -> f64 {
        dot(e, self.direction[k]) - (self.radius[k] - self.journal_radius)
    }

    /// Integrals over the arc in contact at the eccentricity `e` [m]. Intervals wholly in contact come from the sums
    /// of their segment; at the two ends of an arc only the part with g > 0 counts.
    #[inline(always)]
    pub(crate) fn integrate(&self, e: [f64; 2]) -> Integrals {
        self.integrate_units(e).scaled(self.spacing)
    }

    /// Sums over the arc in contact at the eccentricity `e` [m], before they are multiplied by the spacing of the angles.
    #[inline(always)]
    pub(super) fn integrate_units(&self, e: [f64; 2]) -> UnitIntegrals {
        let mut sum = Integrals::default();
        if length(e) <= self.reach {
            return UnitIntegrals::none(0.0);
        }
        let segments = &self.segments;
        // Segments wholly in contact under way: the first, and the one after the last.
        let (mut first, mut end) = (0, 0);
        for g in 0..segments.groups.len() {
            let [mut rest, whole_segments] = segments.groups[g].touched(e, segments.widening, 0.0);
            while rest != 0 {
                let i = rest.trailing_zeros();
                rest &= rest - 1;
                let s = g * GROUP + i as usize;
                if (whole_segments >> i) & 1 == 0 {
                    add_partly(&mut sum, e, &segments.each[s]);
                } else if s == end {
                    end += 1;
                } else {
                    self.add_segments(&mut sum, e, first, end);
                    (first, end) = (s, s + 1);
                }
            }
        }
        self.add_segments(&mut sum, e, first, end);
        UnitIntegrals { sums: sum, extent: sum.d[0] + sum.d[2] }
    }

    /// Adds to `whole`, for intervals of length one, the intervals in contact from end to end at all eccentricities within `margin` of
    /// `e` [m]; `other` receives the gaps at `e` [m] and the unit vectors at both ends of every other interval that touches at one of them.
    #[inline(always)]
    pub(super) fn visit_near(
        &self,
        e: [f64; 2],
        margin: f64,
        whole: &mut Integrals,
        mut other: impl FnMut([f64; 2], [[f64; 2]; 2]),
    ) {
        for g in 0..self.segments.groups.len() {
            let [mut rest, whole_segments] =
                self.segments.groups[g].touched(e, self.segments.widening, margin);
            while rest != 0 {
                let i = rest.trailing_zeros();
                rest &= rest - 1;
                let segment = &self.segments.each[g * GROUP + i as usize];
                if (whole_segments >> i) & 1 == 1 {
                    whole.add_whole(segment.relative_to_centre(e), segment.sums[segment.intervals]);
                    continue;
                }
                let inside = segment.positive(e, margin);
                let reached = segment.positive(e, -margin);
                let both = inside & (inside >> 1) & segment.all();
                add_runs(whole, e, segment, both);
                let mut ends = (reached | (reached >> 1)) & segment.all() & !both;
                while ends != 0 {
                    let k = ends.trailing_zeros() as usize;
                    ends &= ends - 1;
                    let ((u, from), (v, to)) = (segment.angle(k), segment.angle(k + 1));
                    other([dot(e, u) - from, dot(e, v) - to], [u, v]);
                }
            }
        }
    }

    /// Adds the integrals of the segments from `first` to before `end`, which are wholly in contact. Of several at once the
    /// coefficients are for eccentricities counted from zero: they touch deeply enough for rounding not to count.
    #[inline(always)]
    fn add_segments(&self, sum: &mut Integrals, e: [f64; 2], first: usize, end: usize) {
        if end == first + 1 {
            let segment = &self.segments.each[first];
            sum.add_whole(segment.relative_to_centre(e), segment.sums[segment.intervals]);
        } else if end > first {
            sum.add_whole(e, self.segments.across[end].minus(&self.segments.across[first]));
        }
    }

    /// Penetration in free flight, not above zero [m].
    pub(crate) fn free_penetration(&self, e: [f64; 2]) -> f64 {
        let radius = length(e);
        if radius <= self.reach { radius - self.reach } else { self.gap_along(e).min(0.0) }
    }

    /// Unit vector `(2,)` [1] and R - R1 [m] at table angle `k`, of which the one after the last is the first.
    #[inline(always)]
    pub(crate) fn angle(&self, k: usize) -> ([f64; 2], f64) {
        let k = if k == self.radius.len() { 0 } else { k };
        (self.direction[k], self.radius[k] - self.journal_radius)
    }
}

/// Where the function `gap` of the number of `n` equal angles, up to twice as many, is largest: the number of the angle, the direction of the peak of the
/// parabola through it and its neighbours `(2,)` [1], and how far that is from the angle [intervals].
pub(super) fn peak(n: usize, gap: impl Fn(usize) -> f64) -> (usize, [f64; 2], f64) {
    let nearest = (0..n).fold(0, |best, k| if gap(k) > gap(best) { k } else { best });
    let (before, at, after) = (gap(nearest + n - 1), gap(nearest), gap(nearest + 1));
    let bend = before - 2.0 * at + after;
    let offset = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
    let (s, c) = libm::sincos(TAU * (nearest as f64 + offset) / n as f64);
    (nearest, [c, s], offset)
}

/// Adds the integrals of a segment of which each interval has to be looked at.
#[inline(always)]
fn add_partly(sum: &mut Integrals, e: [f64; 2], segment: &Segment) {
    let positive = segment.positive(e, 0.0);
    add_runs(sum, e, segment, positive & (positive >> 1) & segment.all());
    let mut ends = (positive ^ (positive >> 1)) & segment.all();
    while ends != 0 {
        let i = ends.trailing_zeros() as usize;
        ends &= ends - 1;
        let ((u, from), (v, to)) = (segment.angle(i), segment.angle(i + 1));
        let (a, b) = (dot(e, u) - from, dot(e, v) - to);
        sum.add([a, b], weights(a, b), u, v);
    }
}

/// Adds the integrals of the intervals `whole` of a segment, bit by bit, which are in contact from end to end.
#[inline(always)]
fn add_runs(sum: &mut Integrals, e: [f64; 2], segment: &Segment, mut whole: u32) {
    while whole != 0 {
        let from = whole.trailing_zeros();
        let to = from + (whole >> from).trailing_ones();
        whole &= !0 << to;
        let of = segment.sums[to as usize].minus(&segment.sums[from as usize]);
        sum.add_whole(segment.relative_to_centre(e), of);
    }
}

impl Arcs<f64> for Arc {
    const JOURNAL: bool = false;

    #[inline(always)]
    fn integrate<const SECOND: bool>(&self, e: [f64; 2], _alpha: f64) -> RotatedIntegrals {
        RotatedIntegrals::round(Arc::integrate(self, e))
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
                sum.add([a, b], weights(a, b), arc.direction[k], arc.direction[next]);
            }
        }
        UnitIntegrals { sums: sum, extent: sum.d[0] + sum.d[2] }.scaled(TAU / n as f64)
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
                    }
                    for i in 0..3 {
                        error = error.max(off(found.d[i], exact.d[i], exact.d[0] + exact.d[2]));
                    }
                    assert!(error < 1e-6, "{k} deg, {penetration} m: {found:?} {exact:?}");
                    worst = worst.max(error);
                }
            }
        }
        println!("sums within {worst:e}");
    }
}
