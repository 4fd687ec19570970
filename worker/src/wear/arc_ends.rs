//! Ends of a contact arc under `local-hertz`, on a bore tabulated at equal angles.
//!
//! The journal's circle, seen from the bushing's centre at angle phi from the eccentricity's direction u,
//! lies at e cos(phi) + sqrt(R1^2 - e^2 sin^2(phi)) (law of cosines). Its distance beyond the bore is
//!
//! p = R1 - R + e cos(phi) - e^2 sin^2(phi) / (2 R1), e = delta + R(u) - R1 [m],
//!
//! with the journal radius R1, the worn bore R and the penetration delta [m]; the root is expanded to second
//! order: the next term is (e/R1)^4 / 8, below 1e-11 m here. The arc ends at the first table angle where p is
//! no longer positive, on the chord from the table angle before.
//!
//! The search passes over whole intervals between control points where p cannot have a zero: between two
//! angles h apart p lies above its chord less a parabola of height h^2/8 times the largest p'' there (if that
//! is positive), and p'' <= -R'' - e cos(phi) + e^2/R1, with R'' linear within an interval and cos(phi)
//! smallest at its far end. The search starts from the end found before. Both give the end that a walk from
//! angle to angle would find.
//!
//! # Source
//! Arc ends by the law of cosines: Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485,
//! doi 10.3969/j.issn.1004-132X.2026.06.020. The search is derived here.

use crate::bore::Profile;
use std::f64::consts::TAU;

/// Table intervals per control point: 1.25 deg at 36 control points; a linear interpolation there misplaces
/// the ends of a 20 deg arc by 0.2 %.
pub const SUBDIVISION: usize = 8;

/// A bore tabulated for the search.
#[derive(Debug, Clone)]
pub struct ArcEnds {
    /// Journal radius R1 [m].
    journal_radius: f64,
    /// Unit vectors at the table's angles `(n,)` [1].
    direction: Vec<[f64; 2]>,
    /// R1 - R there `(n,)` [m].
    gap: Vec<f64>,
    /// Largest -R'' h^2 / 8 between two control points h apart `(points,)` [m].
    hollow: Vec<f64>,
    /// h^2 / 8 [1].
    eighth: f64,
}

/// Direction of a contact, and the ends of its arc found by the last search.
#[derive(Debug, Clone, Copy)]
pub struct Spot {
    /// Unit vector of the eccentricity `(2,)` [1].
    pub u: [f64; 2],
    /// Its angle in table intervals, in [0, n).
    pub place: f64,
    /// Table angles passed on either side before the arc ended, downwards and upwards.
    passed: [usize; 2],
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
            passed: [0; 2],
        }
    }

    /// Interval between control points that contains the contact, and its fraction there in [0, 1).
    pub(crate) fn within(&self) -> (usize, f64) {
        let interval = self.place as usize / SUBDIVISION;
        (interval, self.place / SUBDIVISION as f64 - interval as f64)
    }
}

/// Journal circle of one contact.
struct Circle {
    /// Eccentricity `(2,)` [m].
    e: [f64; 2],
    /// Penetration delta [m].
    penetration: f64,
    /// 1 / (2 R1) [1/m].
    curvature: f64,
}

/// Part of the arc that certainly lies inside: whole intervals between control points, seen from the contact.
struct Inside {
    /// Distance of its end in table intervals.
    from: f64,
    /// Table angles within it.
    angles: usize,
    /// Distance p of the circle beyond the bore at its end [m].
    depth: f64,
    /// Table angle at the far end of the interval that follows.
    corner: usize,
    /// Height of the parabola below the chord in that interval [m].
    sag: f64,
}

impl ArcEnds {
    /// For a journal of radius `journal_radius` [m] in a bore with `points` control points, not tabulated
    /// yet.
    pub(crate) fn new(journal_radius: f64, points: usize) -> Self {
        let n = SUBDIVISION * points;
        let spacing = TAU / points as f64;
        ArcEnds {
            journal_radius,
            direction: (0..n)
                .map(|k| {
                    let (s, c) = libm::sincos(TAU * k as f64 / n as f64);
                    [c, s]
                })
                .collect(),
            gap: vec![0.0; n],
            hollow: vec![0.0; points],
            eighth: spacing * spacing / 8.0,
        }
    }

    /// Number of table intervals n.
    pub(crate) fn intervals(&self) -> usize {
        self.gap.len()
    }

    /// Tabulates a changed profile.
    pub(crate) fn profile_changed(&mut self, profile: &Profile) {
        profile.tabulate(&mut self.gap);
        self.gap.iter_mut().for_each(|gap| *gap = self.journal_radius - *gap);
        for (hollow, [_, _, c, d]) in self.hollow.iter_mut().zip(profile.cubics()) {
            *hollow = -0.25 * c.min(c + 3.0 * d);
        }
    }

    /// Distances from the direction of the contact at `spot` to the two ends of its arc, downwards and
    /// upwards, at penetration `penetration` [m], where the bore has radius `radius` [m] and slope `slope`
    /// [m/rad]. In table intervals; half a turn where the arc does not end.
    ///
    /// Where a place inside the arc wears until the circle only grazes it, the arc ends there from one
    /// instant to the next, and the part behind it no longer counts; a second patch behind the end joins the
    /// arc again where the gap between them closes. There the end, and with it the wear rate, is not a
    /// continuous function of the profile.
    pub(crate) fn find(&self, spot: &mut Spot, penetration: f64, radius: f64, slope: f64) -> (f64, f64) {
        let e = penetration + radius - self.journal_radius;
        let circle =
            Circle { e: [e * spot.u[0], e * spot.u[1]], penetration, curvature: 0.5 / self.journal_radius };
        let below = spot.place as usize;
        let lead = spot.place - below as f64;
        let [down, up] = &mut spot.passed;
        // Towards smaller angles the first table angle is `below`; the slope changes sign.
        (
            self.end::<false>(&circle, below, lead, slope, down),
            self.end::<true>(&circle, below, 1.0 - lead, -slope, up),
        )
    }

    /// Table angle `m` places after the first one next to the contact.
    #[inline]
    fn angle<const UP: bool>(&self, below: usize, m: usize) -> usize {
        let n = self.gap.len();
        if UP {
            let k = below + 1 + m;
            if k >= n { k - n } else { k }
        } else if below >= m {
            below - m
        } else {
            below + n - m
        }
    }

    /// How far the circle lies beyond the bore at table angle `k`, and e cos(phi) there [m].
    #[inline]
    fn beyond(&self, circle: &Circle, k: usize) -> (f64, f64) {
        let (u, e) = (self.direction[k], circle.e);
        let along = e[0] * u[0] + e[1] * u[1];
        let across = e[0] * u[1] - e[1] * u[0];
        (self.gap[k] + along - across * across * circle.curvature, along)
    }

    /// One end of the arc; `first` is the distance to the first table angle on this side, `slope` that of p
    /// outwards [m/rad]. Leaves the number of table angles passed in `passed`.
    #[inline]
    fn end<const UP: bool>(
        &self,
        circle: &Circle,
        below: usize,
        first: f64,
        slope: f64,
        passed: &mut usize,
    ) -> f64 {
        let n = self.gap.len();
        let inside = self.whole_intervals::<UP>(circle, below, first);
        // From the end found before to the last angle inside, if certainly no angle before that is outside.
        let (mut m, mut p) = (inside.angles, inside.depth);
        let mut guess = (*passed).clamp(inside.angles, inside.corner + 1);
        while guess > inside.angles {
            let q = self.beyond(circle, self.angle::<UP>(below, guess - 1)).0;
            if q > 0.0 {
                let share = (first + (guess - 1) as f64 - inside.from) / SUBDIVISION as f64;
                if positive(inside.depth, q, inside.sag * share * share) {
                    (m, p) = (guess, q);
                }
                break;
            }
            guess -= 1;
        }
        // Angle by angle to the first one outside.
        while m <= n / 2 {
            let next = self.beyond(circle, self.angle::<UP>(below, m)).0;
            if next <= 0.0 {
                *passed = m;
                if m == 0 {
                    return first_end(circle.penetration, slope * TAU / n as f64, first, next);
                }
                return first + (m - 1) as f64 + p / (p - next);
            }
            p = next;
            m += 1;
        }
        *passed = 0;
        n as f64 / 2.0
    }

    /// Passes over the intervals between control points in which p has no zero; arguments as in
    /// [`Self::end`].
    #[inline]
    fn whole_intervals<const UP: bool>(&self, circle: &Circle, below: usize, first: f64) -> Inside {
        let n = self.gap.len();
        let bend = 2.0 * circle.curvature * (circle.e[0] * circle.e[0] + circle.e[1] * circle.e[1]);
        let (mut from, mut angles, mut depth) = (0.0, 0, circle.penetration);
        let mut corner = if UP { SUBDIVISION - 1 - below % SUBDIVISION } else { below % SUBDIVISION };
        let mut interval = below / SUBDIVISION;
        loop {
            let (p, along) = self.beyond(circle, self.angle::<UP>(below, corner));
            let sag = (self.hollow[interval] + self.eighth * (bend - along)).max(0.0);
            if !positive(depth, p, sag) || corner + SUBDIVISION >= n / 2 {
                return Inside { from, angles, depth, corner, sag };
            }
            (from, angles, depth) = (first + corner as f64, corner + 1, p);
            corner += SUBDIVISION;
            interval = match (UP, interval) {
                (true, i) if i + 1 == self.hollow.len() => 0,
                (true, i) => i + 1,
                (false, 0) => self.hollow.len() - 1,
                (false, i) => i - 1,
            };
        }
    }
}

/// Whether a chord from `a` to `b` less a parabola of height `sag` >= 0 between them is positive all along.
#[inline]
fn positive(a: f64, b: f64, sag: f64) -> bool {
    // a (1 - t) + b t - 4 sag t (1 - t): where it is steeper than the parabola, the lower end is the least of
    // it.
    let fall = a - b;
    let slope = fall + 4.0 * sag;
    a.min(b) > 0.0 && (fall.abs() >= 4.0 * sag || slope * slope < 16.0 * sag * a)
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
