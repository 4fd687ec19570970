//! Place at which a journal touches its bore: where the gap between both surfaces is closed furthest.
//!
//! The journal with its centre at the eccentricity e closes the gap at the angle theta in the bushing's frame by
//!
//!   g(theta) = e . u(theta) - G(theta),  G(theta) = R(theta) - R_j(theta - alpha) [m],
//!
//! with the unit vector u, its left normal t, the worn bore R and the journal R_j, turned by the angle alpha of its body from the bushing's
//! (`journal.rs`). The journal touches at the largest of them, g' = e . t - G' = 0, where the curvature kappa = e . u + G'' [m] is not below zero:
//!
//!   delta(e) = max g,  d delta/de = u,  d delta/d alpha = -R_j',  d theta = (t . de - R_j'' d alpha) / kappa.
//!
//! Newton's method finds it from the starts of `touch_starts.rs` (of a worn journal from those of `touch_sweep.rs`), kept between angles on
//! both sides of the maximum. delta is a convex function of e. On a groove narrower than the journal two places may close the gap equally
//! far; the one that closes it further is taken, so that delta stays continuous and its direction jumps from one edge to the other.
//!
//! Valid for eccentricities much smaller than the radii, as `free_region.rs` says.
//!
//! # Source
//! Support functions: Schneider, Convex Bodies: The Brunn-Minkowski Theory (2014), section 1.7. Derivatives of a maximum: Danskin (1966), SIAM J. Appl.
//! Math. 14, 641-664. Newton's method with bisection: Dennis, Schnabel (1996), Numerical Methods for Unconstrained Optimization.

use super::journal::{within_a_turn, worn_radius};
use super::local_hertz::{PolarEccentricity, Walls};
use super::touch_starts::Starts;
use super::touch_sweep::Sweep;
use crate::bore::{Bore, Radius};
use crate::lanes::{Real, sincos};
use crate::plane::{fused_dot as dot, left};

/// A step of Newton's method up to which the place is found [rad]: the next one would be of its square, some 1e-12.
const CLOSE: f64 = 1e-6;
/// Most evaluations of one search: two or three are usual, a bisection takes as many as digits.
const MOST: u32 = 40;
/// Largest step of the search [rad].
const LARGEST: f64 = 0.1;
/// How far from the direction of the eccentricity a journal can touch [rad]: a quarter turn, and some more in free flight.
const REACH: f64 = 1.7;
/// Curvature below which a place is taken as flat, as a share of the clearance [1].
const FLAT: f64 = 1e-6;

/// Where a journal touches its bore, or is nearest to it.
#[derive(Debug, Clone, Copy)]
pub struct Touch<R> {
    /// Direction u of the place from the bushing's centre `(2,)` [1].
    pub u: [R; 2],
    /// The surfaces there.
    pub walls: Walls<R>,
}

/// Places from which the search begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Begin<R> {
    /// Angles of one place or two [rad].
    pub places: [R; 2],
    /// One where there are two, else zero.
    pub two: R,
}

/// The two surfaces of a joint all round.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facing<'a, R, B> {
    /// The bore.
    pub bore: &'a B,
    /// Depth of the journal, if that wears.
    pub depth: Option<&'a B>,
    /// Unworn radius R1 of the journal [m].
    pub radius: R,
    /// Angle alpha of the journal's body minus that of the bushing's [rad].
    pub turn: R,
    /// Radial clearance of the unworn joint [m].
    pub clearance: R,
}

impl<R: Real> Walls<R> {
    /// G and its derivatives, with the unworn radius `radius` of the journal [m].
    #[inline(always)]
    pub(super) fn gap(&self, radius: R) -> Radius<R> {
        let Radius { r, d1, d2 } = self.bore;
        match self.journal {
            None => Radius { r: r - radius, d1, d2 },
            Some(journal) => Radius { r: r - journal.r, d1: d1 - journal.d1, d2: d2 - journal.d2 },
        }
    }
}

impl<R: Real, B: Bore<R>> Facing<'_, R, B> {
    /// The surfaces at the angle `theta` in (-2 pi, 2 pi) [rad].
    #[inline(always)]
    pub(super) fn walls(&self, theta: R) -> Walls<R> {
        let bore = self.bore.radius_at(theta);
        let Some(depth) = self.depth else { return Walls { bore, journal: None } };
        let depth = depth.radius_at(within_a_turn(theta - self.turn));
        Walls { bore, journal: Some(worn_radius(self.radius, depth)) }
    }

    /// Where the journal touches at this eccentricity.
    #[inline(always)]
    pub(super) fn touch(&self, e: &PolarEccentricity<R>, starts: &Starts, sweep: &Sweep) -> Touch<R> {
        let begin = if self.depth.is_some() { sweep.begin(self, e) } else { starts.begin(e.psi) };
        let nothing = e.psi.zero();
        let two = nothing.below(begin.two);
        let mut best = self.climb(e, begin.places[0]);
        if R::any(two) {
            let other = self.climb(e, begin.places[1]);
            let further = self.closed(e, &best).below(self.closed(e, &other));
            best = best.or(R::both(two, further), &other);
        }
        best
    }

    /// How far the gap is closed there, delta [m].
    #[inline(always)]
    pub(super) fn closed(&self, e: &PolarEccentricity<R>, at: &Touch<R>) -> R {
        e.size * dot(e.u, at.u) - at.walls.gap(self.radius).r
    }

    /// The maximum of g that is reached by going up from the angle `start` [rad].
    #[inline(always)]
    fn climb(&self, e: &PolarEccentricity<R>, start: R) -> Touch<R> {
        let nothing = start.zero();
        let (largest, close) = (nothing.like(LARGEST), nothing.like(CLOSE));
        let flat = self.clearance * FLAT;
        let e_at = [e.size * e.u[0], e.size * e.u[1]];
        // g rises at `low` and falls at `high`.
        let (mut low, mut high) = (e.psi - REACH, e.psi + REACH);
        let (sin, cos) = sincos(start);
        let (mut theta, mut u) = (start, [cos, sin]);
        let mut count = 0;
        loop {
            let walls = self.walls(theta);
            let gap = walls.gap(self.radius);
            let slope = dot(e_at, left(u)) - gap.d1;
            let kappa = dot(e_at, u) + gap.d2;
            let rises = nothing.below(slope);
            low = R::select(rises, theta, low);
            high = R::select(rises, high, theta);
            let curved = flat.below(kappa);
            let uphill = R::select(rises, largest, -largest);
            let newton = slope / R::select(curved, kappa, nothing.like(1.0));
            let step = R::select(curved, newton, uphill).smaller(largest).larger(-largest);
            let moves = close.below(step.abs());
            count += 1;
            if count == MOST || !R::any(moves) {
                return Touch { u, walls }.moved(R::select(moves, nothing, step));
            }
            let next = theta + step;
            let between = R::both(low.below(next), next.below(high));
            let halving = ((low + high) * 0.5 - theta).smaller(largest).larger(-largest);
            let step = R::select(moves, R::select(between, step, halving), nothing);
            theta += step;
            u = turned(u, step);
        }
    }
}

/// The unit vector `u` turned by an angle of at most [`LARGEST`] [rad], to rounding.
#[inline(always)]
fn turned<R: Real>(u: [R; 2], angle: R) -> [R; 2] {
    let z = angle * angle;
    let (one, t) = (z.like(1.0), left(u));
    let sine = z.like(-1.0 / 6.0).plus_product(z, z.like(1.0 / 120.0).minus_product(z, z.like(1.0 / 5040.0)));
    let cosine = z.like(-0.5).plus_product(z, z.like(1.0 / 24.0).minus_product(z, z.like(1.0 / 720.0)));
    let (sine, cosine) = (angle.plus_product(angle * z, sine), one.plus_product(z, cosine));
    [(u[0] * cosine).plus_product(t[0], sine), (u[1] * cosine).plus_product(t[1], sine)]
}

impl<R: Real> Radius<R> {
    /// That farther on by the small angle `step` [rad].
    #[inline(always)]
    fn moved(self, step: R) -> Self {
        let Radius { r, d1, d2 } = self;
        let r = r.plus_product(step, d1).plus_product(step * step * 0.5, d2);
        Radius { r, d1: d1.plus_product(step, d2), d2 }
    }

    /// `other` where the mask is true.
    #[inline(always)]
    fn or(self, other_is: R::Mask, other: Self) -> Self {
        Radius {
            r: R::select(other_is, other.r, self.r),
            d1: R::select(other_is, other.d1, self.d1),
            d2: R::select(other_is, other.d2, self.d2),
        }
    }
}

impl<R: Real> Touch<R> {
    /// The place farther on by the small angle `step` [rad].
    #[inline(always)]
    fn moved(self, step: R) -> Self {
        let Touch { u, walls } = self;
        let t = left(u);
        let less = step.like(1.0).minus_product(step * step, step.like(0.5));
        let u = [(u[0] * less).plus_product(t[0], step), (u[1] * less).plus_product(t[1], step)];
        let journal = walls.journal.map(|journal| journal.moved(step));
        Touch { u, walls: Walls { bore: walls.bore.moved(step), journal } }
    }

    /// `other` where the mask is true.
    #[inline(always)]
    fn or(&self, other_is: R::Mask, other: &Self) -> Self {
        let journal = match (self.walls.journal, other.walls.journal) {
            (Some(one), Some(other)) => Some(one.or(other_is, other)),
            _ => None,
        };
        Touch {
            u: [R::select(other_is, other.u[0], self.u[0]), R::select(other_is, other.u[1], self.u[1])],
            walls: Walls { bore: self.walls.bore.or(other_is, other.walls.bore), journal },
        }
    }
}
