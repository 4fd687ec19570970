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
//! On a bore with roughness, or two worn surfaces, p may be positive again behind an end: the contact has further patches, found
//! in the same way. Their lengths, and with them the wear rate, are continuous functions of the profile: a patch
//! that appears has no length yet, and one that joins the arc leaves nothing out. (Were only the arc around the direction u counted,
//! as in the source, its length would jump where a place inside wears until the circle only grazes it.)
//! Patches are looked for up to the angle where e cos(phi) no longer exceeds the least gap of the surfaces.
//!
//! In front of a worn journal (`contact/journal_table.rs`) p falls by its depth h(psi - alpha), with the angle alpha of its body
//! from the bushing's: by the cubic through four neighbours of a table of that depth, turned by a fraction of its spacing.
//!
//! The search notes in the bits of a word at which of 64 table angles the circle lies beyond the bore, as many at a time as a vector holds: ends
//! and starts are where neighbouring bits differ, those that a walk from angle to angle finds. Towards smaller angles it is the same
//! search on the mirrored bore.
//!
//! # Source
//! Arc ends by the law of cosines: Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485,
//! doi 10.3969/j.issn.1004-132X.2026.06.020. The expansion is derived here.

use super::crossing::{Crossing, OnJournal};
use crate::bore::Profile;
use crate::lanes::Real;
use std::f64::consts::TAU;

/// Fewest table intervals of a turn: 1.25 deg each; a linear interpolation there misplaces the ends of a 20 deg arc by 0.2 %.
const INTERVALS: usize = 288;

/// Number of shares for which the angles to be searched are tabulated.
const SHARES: usize = 512;

/// Table angles tried before any end is looked for among them: as many as a word has bits.
pub(super) const WORD: usize = 64;

/// How far a circle lies beyond a bore at the table angles of a word [m].
pub type Overlaps = [f64; WORD];

/// Table intervals per control point of a profile with `points` of them.
pub(super) fn subdivision(points: usize) -> usize {
    INTERVALS.div_ceil(points)
}

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
    /// Largest R1 - R of the table [m].
    largest_gap: f64,
    /// Table angles on one side to be searched, by the share of the eccentricity that the least gap takes `(SHARES,)`; see
    /// [`Self::reach`].
    reach: Vec<u16>,
    /// Depth of the journal at the table's angles in its own body, from the angle before zero on, and that of the mirrored one
    /// `(2 n + 3,)` each [m]; empty if it does not wear.
    depth: [Vec<f64>; 2],
}

/// Direction of a contact.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContactDirection {
    /// Unit vector of the eccentricity `(2,)` [1].
    pub u: [f64; 2],
    /// Its angle in table intervals, in [0, n).
    pub place: f64,
    /// Number of the table angle below.
    below: u32,
}

impl ContactDirection {
    /// Contact in the direction of `e` `(2,)` [m], on a table of `n` intervals.
    pub(crate) fn new(e: [f64; 2], n: usize) -> Self {
        let length = libm::hypot(e[0], e[1]);
        let turn = libm::atan2(e[1], e[0]) / TAU;
        let place = n as f64 * if turn < 0.0 { turn + 1.0 } else { turn };
        // A turn just below zero is rounded to a whole one.
        let place = if place < n as f64 { place } else { 0.0 };
        ContactDirection {
            u: if length > 0.0 { [e[0] / length, e[1] / length] } else { [1.0, 0.0] },
            place,
            below: place as u32,
        }
    }

    /// Distance from the table angle below, in table intervals.
    #[inline(always)]
    fn offset(&self) -> f64 {
        self.place - f64::from(self.below)
    }

    /// Interval between `points` control points that contains the contact; `per_point` is one over the table intervals of a point.
    pub(crate) fn interval(&self, points: usize, per_point: f64) -> u32 {
        ((self.place * per_point) as u32).min(points as u32 - 1)
    }
}

/// A journal pressed into a bore.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContactState {
    /// Direction of the eccentricity.
    pub spot: ContactDirection,
    /// Penetration delta there [m].
    pub penetration: f64,
    /// Radius of the bore there [m], and its slope [m/rad]; of a worn journal those of the gap of both surfaces.
    pub radius: f64,
    pub slope: f64,
    /// Place of the contact on a worn journal, in table intervals.
    pub on_journal: Option<f64>,
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
    /// Where these angles are on the journal, if that wears.
    journal: Option<OnJournal<'a>>,
    /// Distance from the direction of the contact to the first of them, in table intervals.
    offset: f64,
    /// Penetration in that direction [m], and the slope of p outwards there [m per interval].
    penetration: f64,
    slope: f64,
}

impl Side<'_> {
    /// How far the circle lies beyond the bore at the angles from the `m`-th on [m]; `like` sets their number.
    #[inline(always)]
    fn beyond<R: Real>(&self, m: usize, like: R) -> R {
        let [x, y] = [like.like(self.e[0]), like.like(self.e[1])];
        let (cos, sin, gap) =
            (like.load(&self.cos[m..]), like.load(&self.sin[m..]), like.load(&self.gap[m..]));
        let gap = match &self.journal {
            None => gap,
            Some(journal) => gap - journal.depth(m, like),
        };
        let across = (x * sin).minus_product(y, cos);
        gap.plus_product(x, cos)
            .plus_product(y, sin)
            .minus_product(across * across, like.like(self.curvature))
    }

    /// How far the circle lies beyond the bore at the `count` angles from the `first`-th on, into `beyond` [m]; the bits of the numbers
    /// of those where it does. `like` sets the number of angles tried at once.
    #[inline(always)]
    fn inside<R: Real>(&self, first: usize, count: usize, like: R, beyond: &mut Overlaps) -> u64 {
        let mut inside = 0;
        for k in (0..count).step_by(R::LANES) {
            let p = self.beyond(first + k, like);
            p.store(&mut beyond[k..]);
            inside |= R::bits(like.zero().below(p)) << k;
        }
        inside & (u64::MAX >> (WORD - count))
    }

    /// Where the arc ends on this side, if that is the only change among the first `reach` table angles, at most [`WORD`].
    #[inline(always)]
    fn only_end<R: Real>(&self, reach: usize, like: R, beyond: &mut Overlaps) -> Option<Crossing> {
        let bits = self.inside(0, reach, like, beyond);
        let end = bits.trailing_ones() as usize;
        if end >= reach || bits >> end != 0 {
            return None;
        }
        let before = if end == 0 { self.penetration } else { beyond[end - 1] };
        Some(Crossing { at: end, before, next: beyond[end] })
    }

    /// Distance to a crossing on this side, in table intervals.
    #[inline(always)]
    fn distance(&self, to: &Crossing) -> f64 {
        to.distance(self.penetration, self.slope, self.offset)
    }

    /// Distance to the end of the arc on this side of a table of `n` intervals. Calls `patch` with start and end of those behind it, among
    /// the first `reach` table angles.
    #[inline(always)]
    fn end<R: Real>(
        &self,
        n: usize,
        reach: usize,
        like: R,
        beyond: &mut Overlaps,
        patch: &mut impl FnMut(f64, f64),
    ) -> f64 {
        let half = n / 2 + 1;
        let reach = reach.min(half);
        // A patch may end before it starts: half a turn away, and by rounding where it only grazes an angle.
        let mut patch = |from: f64, to: f64| patch(from, to.max(from));
        // Number of the angle to go on from, p at the one before, and whether that is inside a patch.
        let (mut at, mut last, mut inside) = (0, self.penetration, true);
        // End of the arc, and start of the patch at hand.
        let (mut arc, mut start) = (n as f64 / 2.0, None);
        while at < if inside { half } else { reach } {
            let count = (if at < reach { reach } else { half } - at).min(WORD);
            let bits = self.inside(at, count, like, beyond);
            let mut changes = (bits ^ (bits << 1 | u64::from(inside))) & (u64::MAX >> (WORD - count));
            while changes != 0 {
                let k = changes.trailing_zeros() as usize;
                changes &= changes - 1;
                let (m, next) = (at + k, beyond[k]);
                let p = if k == 0 { last } else { beyond[k - 1] };
                let zero = self.distance(&Crossing { at: m, before: p, next });
                match (inside, start) {
                    (true, None) => arc = zero,
                    (true, Some(from)) => patch(from, zero),
                    (false, _) => start = Some(zero),
                }
                inside = !inside;
            }
            (at, last) = (at + count, beyond[count - 1]);
        }
        if let (true, Some(from)) = (inside, start) {
            patch(from, n as f64 / 2.0);
        }
        arc
    }
}

impl ArcEnds {
    /// For a journal of radius `journal_radius` [m], which `wears` or not, in a bore with `points` control points, not tabulated
    /// yet.
    pub(crate) fn new(journal_radius: f64, points: usize, wears: bool) -> Self {
        let n = subdivision(points) * points;
        let (sin, cos) = (0..2 * n).map(|k| libm::sincos(TAU * (k % n) as f64 / n as f64)).unzip();
        let depth = || vec![0.0; if wears { 2 * n + 3 } else { 0 }];
        ArcEnds {
            journal_radius,
            cos,
            sin,
            gap: vec![0.0; 2 * n],
            mirrored_gap: vec![0.0; 2 * n],
            largest_gap: 0.0,
            reach: (0..SHARES)
                .map(|k| 2 + (libm::acos(k as f64 / SHARES as f64) * (n as f64 / TAU)) as u16)
                .collect(),
            depth: [depth(), depth()],
        }
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
        self.largest_gap = gap[..n].iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        // The angle zero is its own mirror image.
        mirrored
            .iter_mut()
            .zip(gap[..n + 1].iter().rev().chain(gap[..n].iter().rev()))
            .for_each(|(to, from)| *to = *from);
    }

    /// Tabulates a changed depth of the journal, the radius of the profile `worn`.
    pub(crate) fn journal_changed(&mut self, worn: &Profile) {
        let n = self.intervals();
        let [depth, mirrored] = &mut self.depth;
        worn.tabulate(&mut depth[1..=n]);
        depth[0] = depth[n];
        for k in n + 1..depth.len() {
            depth[k] = depth[k - n];
        }
        // The mirrored surface at the place k - 1 is the other one at 1 - k.
        for (k, to) in mirrored.iter_mut().enumerate() {
            *to = depth[1 + (3 * n + 1 - k) % n];
        }
    }

    /// Where the arc of the `contact` ends, downwards and upwards, on the sides where nothing else can be in contact. `like` sets the number of
    /// angles tried at once; `beyond` is overwritten.
    #[inline(always)]
    pub(crate) fn only_ends<R: Real>(
        &self,
        contact: &ContactState,
        like: R,
        beyond: &mut Overlaps,
    ) -> [Option<Crossing>; 2] {
        let ([down, up], reach) = self.sides(contact);
        if reach > WORD {
            return [None; 2];
        }
        [down.only_end(reach, like, beyond), up.only_end(reach, like, beyond)]
    }

    /// Distances from the direction of the `contact` to the two ends of its arc, downwards and upwards, in table intervals; half a turn
    /// where the arc does not end. `only` are those of [`Self::only_ends`].
    ///
    /// Calls `patch` with the start and the end of every further patch, in table intervals from the direction of the contact, negative
    /// below it. `like` sets the number of angles tried at once; `beyond` is overwritten.
    #[inline(always)]
    pub(crate) fn find<R: Real>(
        &self,
        contact: &ContactState,
        only: &[Option<Crossing>; 2],
        like: R,
        beyond: &mut Overlaps,
        mut patch: impl FnMut(f64, f64),
    ) -> (f64, f64) {
        if let [Some(down), Some(up)] = only {
            let (offset, slope, penetration) =
                (contact.spot.offset(), self.slope(contact), contact.penetration);
            return (
                down.distance(penetration, slope, offset),
                up.distance(penetration, -slope, 1.0 - offset),
            );
        }
        let n = self.intervals();
        let ([down, up], reach) = self.sides(contact);
        let mut further = |from: f64, to: f64| patch(-to, -from);
        let before = match &only[0] {
            Some(end) => down.distance(end),
            None => down.end(n, reach, like, beyond, &mut further),
        };
        let after = match &only[1] {
            Some(end) => up.distance(end),
            None => up.end(n, reach, like, beyond, &mut patch),
        };
        (before, after)
    }

    /// Slope of the gap where the `contact` is [m per interval].
    #[inline(always)]
    fn slope(&self, contact: &ContactState) -> f64 {
        contact.slope * TAU / self.intervals() as f64
    }

    /// Both sides of a `contact`, and the number of table angles to be searched on each.
    #[inline(always)]
    fn sides(&self, contact: &ContactState) -> ([Side<'_>; 2], usize) {
        let ContactState { spot, penetration, radius, on_journal, .. } = *contact;
        let n = self.intervals();
        let size = penetration + radius - self.journal_radius;
        let e = [size * spot.u[0], size * spot.u[1]];
        let (below, offset, slope) = (spot.below as usize, spot.offset(), self.slope(contact));
        // In the mirrored bore the first table angle is that of `below`, and slopes change sign.
        let mut down = self.side(&self.mirrored_gap, n - below, [e[0], -e[1]], [offset, penetration, slope]);
        let mut up = self.side(&self.gap, below + 1, e, [1.0 - offset, penetration, -slope]);
        if let Some(place) = on_journal {
            down.journal = Some(OnJournal::new(&self.depth[1], offset - place, n));
            up.journal = Some(OnJournal::new(&self.depth[0], place + 1.0 - offset, n));
        }
        ([down, up], self.reach(size))
    }

    /// Number of table angles on one side beyond which p is negative for an eccentricity of `size` [m]: with the largest gap g, p <= g + e
    /// cos(phi), so beyond the angle whose cosine is -g / e.
    #[inline(always)]
    fn reach(&self, size: f64) -> usize {
        let share = -self.largest_gap / size;
        let tabulated = self.reach.get((share * SHARES as f64) as usize).copied();
        // Where the least gap is none, or that is not a number, half a turn; where it is larger than the eccentricity, nothing.
        if share >= 0.0 { usize::from(tabulated.unwrap_or(1)) } else { self.intervals() / 2 }
    }

    /// The side of the bore with these gaps that begins at the table angle `first`, for the eccentricity `e` [m]; `near` are the distance to
    /// that angle, the penetration and the slope of p where the contact is.
    #[inline(always)]
    fn side<'a>(&'a self, gap: &'a [f64], first: usize, e: [f64; 2], near: [f64; 3]) -> Side<'a> {
        let curvature = 0.5 / self.journal_radius;
        let (gap, cos, sin) = (&gap[first..], &self.cos[first..], &self.sin[first..]);
        let [offset, penetration, slope] = near;
        Side { gap, cos, sin, e, curvature, journal: None, offset, penetration, slope }
    }
}
