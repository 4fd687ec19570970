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
//! # Source
//! Derived here, for the Winkler foundation of `foundation.rs` (Winkler 1867; Johnson 1985).

use crate::bore::Profile;
use crate::extremum::smallest;
use crate::plane::{cross, dot, length};
use std::f64::consts::TAU;

/// Intervals per block: a block without contact is skipped at once, since most of the arc that could touch
/// does not.
const BLOCK: usize = 4;

/// Tabulated bore of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Arc {
    /// Journal radius R1 [m].
    journal_radius: f64,
    /// Smallest tabulated radius of each block `(intervals / BLOCK,)` [m].
    block_radius: Vec<f64>,
    /// Sine of half the angle of a block [1].
    sine: f64,
    /// Eccentricity up to which the journal does not touch the bore [m].
    reach: f64,
    /// R - R'' s^2 / 12 at equal angles `(intervals,)` [m].
    radius: Vec<f64>,
    /// (1 + s^2 / 12) times the unit vectors at those angles `(intervals, 2)` [1].
    direction: Vec<[f64; 2]>,
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
        let n = intervals.div_ceil(control_points * BLOCK) * control_points * BLOCK;
        let spacing = TAU / n as f64;
        let lift = 1.0 + spacing * spacing / 12.0;
        Arc {
            journal_radius,
            block_radius: vec![journal_radius + clearance; n / BLOCK],
            sine: libm::sin(0.5 * BLOCK as f64 * spacing),
            reach: clearance / lift,
            radius: vec![journal_radius + clearance; n],
            direction: (0..n)
                .map(|k| {
                    let (s, c) = libm::sincos(k as f64 * spacing);
                    [lift * c, lift * s]
                })
                .collect(),
        }
    }

    /// Number of intervals around the bore.
    pub(crate) fn intervals(&self) -> usize {
        self.radius.len()
    }

    /// Tabulates a changed profile.
    pub(crate) fn profile_changed(&mut self, profile: &Profile) {
        profile.tabulate_chords(&mut self.radius);
        let n = self.radius.len();
        for (b, least) in self.block_radius.iter_mut().enumerate() {
            *least = smallest((b * BLOCK..=(b + 1) * BLOCK).map(|k| self.radius[k % n]));
        }
        self.reach =
            (smallest(self.block_radius.iter().copied()) - self.journal_radius) / self.direction[0][0];
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

    /// Whether the block of intervals that begins at table angle `k` is certainly without contact.
    ///
    /// Within the block e.u is at most e.u_m + |e x u_m| sin(half the block), u_m the unit vector of its
    /// middle, if e.u_m is not negative. Where it is negative, only a bore narrower than its journal could
    /// touch.
    #[inline(always)]
    fn block_is_free(&self, e: [f64; 2], k: usize) -> bool {
        let u = self.direction[k + BLOCK / 2];
        let along = dot(e, u);
        let reach = along + cross(e, u).abs() * self.sine;
        along >= 0.0 && reach + self.journal_radius <= self.block_radius[k / BLOCK]
    }

    /// Integrals over the arc in contact at the eccentricity `e` [m]. `weigh` receives each interval in
    /// contact with the parts of the integral of g that belong to its two ends [m rad].
    ///
    /// Only the part of an interval with g > 0 counts: its potential is the integral of g^2 / 2, the weights
    /// are the derivatives of that potential to the gaps at its ends.
    #[inline]
    pub(crate) fn integrate(&self, e: [f64; 2], mut weigh: impl FnMut(usize, f64, f64)) -> Integrals {
        let mut sum = Integrals::default();
        let n = self.radius.len();
        let spacing = TAU / n as f64;
        let r = length(e);
        if r <= self.reach {
            return sum;
        }
        let half = libm::acos((self.reach / r).max(-1.0));
        let centre = libm::atan2(e[1], e[0]);
        let first = ((centre - half) / spacing).floor() as i64;
        let last = ((centre + half) / spacing).ceil() as i64;
        let last = last.min(first + n as i64);
        let mut k = first.rem_euclid(n as i64) as usize;
        let mut a = self.gap(e, k);
        let mut left = last - first;
        while left > 0 {
            if k.is_multiple_of(BLOCK) && left >= BLOCK as i64 && self.block_is_free(e, k) {
                left -= BLOCK as i64;
                k = if k + BLOCK == n { 0 } else { k + BLOCK };
                if left > 0 {
                    a = self.gap(e, k);
                }
                continue;
            }
            left -= 1;
            let next = if k + 1 == n { 0 } else { k + 1 };
            let b = self.gap(e, next);
            if a > 0.0 || b > 0.0 {
                let weights = Weights::new(a, b);
                sum.add([a, b], &weights, self.direction[k], self.direction[next]);
                weigh(k, weights.first[0] * spacing, weights.first[1] * spacing);
            }
            a = b;
            k = next;
        }
        sum.scaled(spacing)
    }
}
