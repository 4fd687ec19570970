//! Ends of a contact arc under `local-hertz`, on a bore tabulated at equal angles.
//!
//! The journal's circle, seen from the bushing's centre at angle phi from the eccentricity's direction u,
//! lies at e cos(phi) + sqrt(R1^2 - e^2 sin^2(phi)) (law of cosines). Its distance beyond the bore is
//!
//! p = R1 - R + e cos(phi) - e^2 sin^2(phi) / (2 R1), e = delta + R(u) - R1 [m],
//!
//! with the journal radius R1, the worn bore R and the penetration delta [m]; the root is expanded to second
//! order: the next term is (e/R1)^4 / 8, below 1e-11 m here. The arc ends at the first table angle where p is
//! no longer positive, on the chord from the table angle before. (A parabola through three angles is ten times as exact, but under it narrow
//! scars at many control points wear in thousands of sub-steps.)
//!
//! The search tries eight table angles at a time: the end is the one that a walk from angle to angle finds. Towards
//! smaller angles it is the same search on the mirrored bore.
//!
//! # Source
//! Arc ends by the law of cosines: Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485,
//! doi 10.3969/j.issn.1004-132X.2026.06.020. The expansion is derived here.

use crate::bore::Profile;
use std::f64::consts::TAU;

/// Table intervals per control point: 1.25 deg at 36 control points, which misplaces the ends of an arc by 0.2 % of its width at most.
pub const SUBDIVISION: usize = 8;

/// Table angles tried at once: what the compiler makes vectors of.
const AT_ONCE: usize = 8;

/// A bore tabulated for the search, over two turns: half a turn from any angle of the first is one piece.
#[derive(Debug, Clone)]
pub struct ArcEnds {
    /// Journal radius R1 [m].
    journal_radius: f64,
    /// Cosines and sines of the table's angles `(2 n,)` each [1].
    cos: Vec<f64>,
    sin: Vec<f64>,
    /// R1 - R there `(2 n,)` [m].
    gap: Vec<f64>,
    /// R1 - R of the mirrored bore, at the negative angles `(2 n,)` [m].
    mirrored_gap: Vec<f64>,
}

/// Direction of a contact.
#[derive(Debug, Clone, Copy)]
pub struct Spot {
    /// Unit vector of the eccentricity `(2,)` [1].
    pub u: [f64; 2],
    /// Its angle in table intervals, in [0, n).
    pub place: f64,
}

impl Spot {
    /// Contact in the direction of `e` `(2,)` [m], on a table of `n` intervals.
    pub(crate) fn new(e: [f64; 2], n: usize) -> Self {
        let length = libm::hypot(e[0], e[1]);
        let turn = libm::atan2(e[1], e[0]) / TAU;
        let place = n as f64 * if turn < 0.0 { turn + 1.0 } else { turn };
        Spot {
            u: if length > 0.0 { [e[0] / length, e[1] / length] } else { [1.0, 0.0] },
            // A turn just below zero is rounded to a whole one.
            place: if place < n as f64 { place } else { 0.0 },
        }
    }

    /// Interval between control points that contains the contact, and its fraction there in [0, 1).
    pub(crate) fn within(&self) -> (usize, f64) {
        let interval = self.place as usize / SUBDIVISION;
        (interval, self.place / SUBDIVISION as f64 - interval as f64)
    }
}

/// Both ends of a few contact arcs, downwards and upwards, each between two neighbouring table angles: number by number, for the
/// vectors of the processor.
#[derive(Debug, Clone, Copy)]
pub struct Brackets<const N: usize> {
    /// p > 0 at the nearer angle, and p <= 0 at the farther one [m].
    p: [[f64; N]; 2],
    /// Distance of the nearer angle from the contact's direction, and from there to the farther one [table intervals].
    near: [f64; N],
    step: [f64; N],
    /// R1 - R at both angles [m].
    gap: [[f64; N]; 2],
}

impl<const N: usize> Brackets<N> {
    /// Room for `N` ends.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        let zero = [0.0; N];
        Brackets { p: [[1.0; N], [-1.0; N]], near: zero, step: zero, gap: [zero; 2] }
    }

    /// Sets end `k` between table angles.
    #[inline(always)]
    fn between(&mut self, k: usize, p: [f64; 2], near: f64, gap: [f64; 2]) {
        (self.p[0][k], self.p[1][k]) = (p[0], p[1]);
        (self.near[k], self.step[k]) = (near, 1.0);
        (self.gap[0][k], self.gap[1][k]) = (gap[0], gap[1]);
    }

    /// Sets end `k` at this distance from the contact [table intervals], where R1 - R is `gap` [m].
    #[inline(always)]
    fn at(&mut self, k: usize, distance: f64, gap: f64) {
        self.between(k, [1.0, -1.0], distance, [gap; 2]);
        self.step[k] = 0.0;
    }

    /// Distance of each end from its contact [table intervals], and R1 - R there [m]: where the chord of p is zero.
    #[inline(always)]
    pub(crate) fn solve(&self) -> [[f64; N]; 2] {
        let (mut distance, mut gap) = ([0.0; N], [0.0; N]);
        for k in 0..N {
            let s = self.p[0][k] / (self.p[0][k] - self.p[1][k]);
            distance[k] = self.near[k] + self.step[k] * s;
            gap[k] = self.gap[0][k] + s * (self.gap[1][k] - self.gap[0][k]);
        }
        [distance, gap]
    }
}

/// One contact: penetration delta and R1 - R in its direction [m].
struct Contact {
    penetration: f64,
    gap: f64,
}

/// Journal circle of one contact, and one side of the bore.
#[derive(Clone, Copy)]
struct Side<'a> {
    /// R1 - R from the first table angle of this side on [m].
    gap: &'a [f64],
    /// Cosines and sines of these angles [1].
    cos: &'a [f64],
    sin: &'a [f64],
    /// Eccentricity `(2,)` [m].
    e: [f64; 2],
    /// 1 / (2 R1) [1/m].
    curvature: f64,
}

impl Side<'_> {
    /// How far the circle lies beyond the bore at the `m`-th angle [m].
    #[inline(always)]
    fn beyond(&self, m: usize) -> f64 {
        let along = self.e[0] * self.cos[m] + self.e[1] * self.sin[m];
        let across = self.e[0] * self.sin[m] - self.e[1] * self.cos[m];
        self.gap[m] + along - across * across * self.curvature
    }

    /// The first angle at which the circle is not beyond the bore, if it is among the first `most`.
    #[inline(always)]
    fn first_outside(&self, most: usize) -> Option<usize> {
        for first in (0..most).step_by(AT_ONCE) {
            let group = Side {
                gap: &self.gap[first..first + AT_ONCE],
                cos: &self.cos[first..first + AT_ONCE],
                sin: &self.sin[first..first + AT_ONCE],
                ..*self
            };
            // Loops, not closures, and every comparison made: vectors of this processor.
            let (mut p, mut inside) = ([0.0; AT_ONCE], true);
            for (k, p) in p.iter_mut().enumerate() {
                *p = group.beyond(k);
            }
            for p in p {
                inside &= p > 0.0;
            }
            if inside {
                continue;
            }
            if let Some(k) = p.iter().position(|p| *p <= 0.0) {
                return (first + k < most).then_some(first + k);
            }
        }
        None
    }
}

impl ArcEnds {
    /// For a journal of radius `journal_radius` [m] in a bore with `points` control points, not tabulated
    /// yet.
    pub(crate) fn new(journal_radius: f64, points: usize) -> Self {
        let n = SUBDIVISION * points;
        let (sin, cos) = (0..2 * n).map(|k| libm::sincos(TAU * (k % n) as f64 / n as f64)).unzip();
        ArcEnds { journal_radius, cos, sin, gap: vec![0.0; 2 * n], mirrored_gap: vec![0.0; 2 * n] }
    }

    /// Journal radius R1 [m].
    #[inline(always)]
    pub(crate) fn journal_radius(&self) -> f64 {
        self.journal_radius
    }

    /// Number of table intervals n.
    pub(crate) fn intervals(&self) -> usize {
        self.gap.len() / 2
    }

    /// Tabulates a changed profile.
    pub(crate) fn profile_changed(&mut self, profile: &Profile) {
        let n = self.intervals();
        let (gap, mirrored) = (&mut self.gap, &mut self.mirrored_gap);
        profile.tabulate(&mut gap[..n]);
        gap[..n].iter_mut().for_each(|gap| *gap = self.journal_radius - *gap);
        gap.copy_within(..n, n);
        // The angle zero is its own mirror image.
        mirrored
            .iter_mut()
            .zip(gap[..n + 1].iter().rev().chain(gap[..n].iter().rev()))
            .for_each(|(to, from)| *to = *from);
    }

    /// Brackets the two ends of the arc of the contact at `spot`, downwards as end 2 `k` and upwards as end 2 `k` + 1, at penetration
    /// `penetration` [m], where the bore has radius `radius` [m] and slope `slope` [m/rad].
    ///
    /// Where a place inside the arc wears until the circle only grazes it, the arc ends there from one
    /// instant to the next, and the part behind it no longer counts; a second patch behind the end joins the
    /// arc again where the gap between them closes. There the end, and with it the wear rate, is not a
    /// continuous function of the profile.
    #[inline(always)]
    pub(crate) fn bracket<const N: usize>(
        &self,
        spot: &Spot,
        penetration: f64,
        radius: f64,
        slope: f64,
        k: usize,
        ends: &mut Brackets<N>,
    ) {
        let n = self.intervals();
        let size = penetration + radius - self.journal_radius;
        let e = [size * spot.u[0], size * spot.u[1]];
        let below = spot.place as usize;
        let lead = spot.place - below as f64;
        // In the mirrored bore the first table angle is that of `below`, and slopes change sign.
        let down = self.side(&self.mirrored_gap, n - below, [e[0], -e[1]]);
        let up = self.side(&self.gap, below + 1, e);
        let slope = slope * TAU / n as f64;
        let contact = Contact { penetration, gap: self.journal_radius - radius };
        bracket_end(&down, n, lead, &contact, slope, 2 * k, ends);
        bracket_end(&up, n, 1.0 - lead, &contact, -slope, 2 * k + 1, ends);
    }

    /// The side of the bore with these gaps that begins at the table angle `first`, for the eccentricity `e` [m].
    #[inline(always)]
    fn side<'a>(&'a self, gap: &'a [f64], first: usize, e: [f64; 2]) -> Side<'a> {
        let curvature = 0.5 / self.journal_radius;
        Side { gap: &gap[first..], cos: &self.cos[first..], sin: &self.sin[first..], e, curvature }
    }
}

/// One end of the arc on a table of `n` intervals, half a turn away where it does not end; `first` is the distance to the first table
/// angle on this side, `slope` that of p outwards [m per interval].
#[inline(always)]
fn bracket_end<const N: usize>(
    side: &Side,
    n: usize,
    first: f64,
    contact: &Contact,
    slope: f64,
    k: usize,
    ends: &mut Brackets<N>,
) {
    match side.first_outside(n / 2 + 1) {
        None => ends.at(k, n as f64 / 2.0, side.gap[n / 2]),
        Some(0) => {
            let distance = first_end(contact.penetration, slope, first, side.beyond(0));
            let share = if first > 0.0 { distance / first } else { 1.0 };
            ends.at(k, distance, contact.gap + share * (side.gap[0] - contact.gap));
        }
        Some(m) => {
            let p = [side.beyond(m - 1), side.beyond(m)];
            ends.between(k, p, first + (m - 1) as f64, [side.gap[m - 1], side.gap[m]]);
        }
    }
}

/// End of the arc within the first table interval: positive root of delta + slope x + q x^2, where q makes
/// the parabola pass through (first, p), p <= 0 < delta; lengths in any one unit, `slope` per that unit.
fn first_end(delta: f64, slope: f64, first: f64, p: f64) -> f64 {
    if delta <= 0.0 || first <= 0.0 {
        return first.max(f64::MIN_POSITIVE);
    }
    let q = (p - delta - slope * first) / (first * first);
    let root = (slope * slope - 4.0 * q * delta).max(0.0).sqrt();
    // q x^2 + slope x + delta = 0, the root that stays finite as q -> 0.
    let x = if slope >= 0.0 { (slope + root) / (-2.0 * q) } else { 2.0 * delta / (root - slope) };
    if x.is_finite() && x > 0.0 { x.min(first) } else { first }
}
