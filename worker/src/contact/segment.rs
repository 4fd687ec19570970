//! Segments of a tabulated bore: sums over their intervals, and whether they touch as a whole.
//!
//! Over an interval with g > 0 at both ends the integral of g^2 of `arc.rs` is quadratic in the eccentricity e, so that
//! sums of its coefficients over the first intervals of a segment give the integrals over any number of its intervals
//! at once. Eccentricities are counted from the one at which the journal touches both ends of the segment: the
//! coefficients are then as small as the bore is uneven, and little is lost in rounding.
//!
//! Whether segments touch is decided for a group of them at once, in loops that become vector instructions.
//!
//! # Source
//! Derived here.

use crate::plane::{cross, dot};
use std::f64::consts::TAU;

/// Intervals of a segment, over which sums are kept and which is judged as a whole; few enough for a bore to be nearly an
/// arc about one point there.
pub(super) const SEGMENT: usize = 16;
/// Segments of a group, as many numbers as the widest vectors hold.
pub(super) const GROUP: usize = 8;

/// What decides whether the segments of a group touch; segments beyond the end of the bore never do.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentGroup {
    /// First and last angle of the segments.
    ends: [Angles<GROUP>; 2],
    /// Least and largest gap, with the other sign, of the angles of each segment at the eccentricity at which the journal touches both
    /// its ends `(GROUP,)` [m].
    least: [f64; GROUP],
    most: [f64; GROUP],
}

impl SegmentGroup {
    /// A group without segments.
    const EMPTY: Self = SegmentGroup {
        ends: [Angles { x: [0.0; GROUP], y: [0.0; GROUP], radial_gap: [0.0; GROUP] }; 2],
        least: [f64::INFINITY; GROUP],
        most: [f64::INFINITY; GROUP],
    };

    /// Segments that touch at the eccentricity `e` [m], or at any within `margin` of it [m]. A wave e.u between the gaps a and b at the ends is at least the smaller of two
    /// positive ones, and at most the larger times `widening`, one over the cosine of half the angle between the ends. Returns the segments
    /// that may be in contact, and of these the ones whose intervals are all in contact; bit i stands for segment i of the group.
    #[inline(always)]
    pub(super) fn touched(&self, e: [f64; 2], widening: f64, margin: f64) -> [u32; 2] {
        let (a, b) = (self.ends[0].gaps(e), self.ends[1].gaps(e));
        let (mut above, mut within) = ([0.0; GROUP], [0.0; GROUP]);
        for i in 0..GROUP {
            let (low, high) = if a[i] < b[i] { (a[i], b[i]) } else { (b[i], a[i]) };
            let widest = if high > 0.0 { high * widening } else { high };
            let most = if self.most[i] > 0.0 { self.most[i] } else { 0.0 };
            above[i] = widest - self.least[i] + margin;
            within[i] = low - most - margin;
        }
        [positive(&above), positive(&within)]
    }

    /// Segments that may touch at the eccentricity `e` [m] a journal that is worn by at least `worn` `(GROUP,)` [m] along each.
    #[inline(always)]
    pub(super) fn touched_beyond(&self, e: [f64; 2], widening: f64, worn: &[f64; GROUP]) -> u32 {
        let (a, b) = (self.ends[0].gaps(e), self.ends[1].gaps(e));
        let mut above = [0.0; GROUP];
        for i in 0..GROUP {
            let high = if a[i] < b[i] { b[i] } else { a[i] };
            let widest = if high > 0.0 { high * widening } else { high };
            above[i] = widest - self.least[i] - worn[i];
        }
        positive(&above)
    }
}

/// Angles of a tabulated bore.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angles<const N: usize> {
    /// Unit vectors at the angles `(N,)` each [1].
    pub x: [f64; N],
    pub y: [f64; N],
    /// R - R1 there `(N,)` [m].
    pub radial_gap: [f64; N],
}

impl<const N: usize> Angles<N> {
    /// Gap function g at the eccentricity `e` [m] `(N,)` [m].
    #[inline(always)]
    pub(super) fn gaps(&self, e: [f64; 2]) -> [f64; N] {
        let mut gap = [0.0; N];
        for i in 0..N {
            gap[i] = e[0] * self.x[i] + e[1] * self.y[i] - self.radial_gap[i];
        }
        gap
    }
}

/// Bits of the numbers above zero, at most 32 of them: the first number is the lowest bit. In terms of sign bits, which become vector
/// instructions where comparisons become branches.
#[inline(always)]
pub(super) fn positive<const N: usize>(x: &[f64; N]) -> u32 {
    let mut found = 0;
    for i in 0..N {
        found |= ((0.0 - x[i]).to_bits() >> 63) << i;
    }
    found as u32
}

/// Intervals next to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Number of its intervals, at most [`SEGMENT`].
    pub intervals: usize,
    /// Angles at which its intervals begin; beyond its end the bore is out of reach.
    pub begin: Angles<SEGMENT>,
    /// Angle at which the last one ends.
    pub end: Angles<1>,
    /// Eccentricity at which the journal touches the bore at both ends of the segment `(2,)` [m]: eccentricities are
    /// counted from there, so that the coefficients are as small as the bore is uneven.
    centre: [f64; 2],
    /// Sums over its first 0 to [`SEGMENT`] intervals.
    pub sums: [Quadratic; SEGMENT + 1],
}

impl Segment {
    /// The intervals from `first` to before `end` of a bore with these tabulated radii [m] and unit vectors, with the least and the
    /// largest gap of its angles, with the other sign, at the eccentricity from which others are counted [m].
    #[inline(always)]
    fn new(
        first: usize,
        end: usize,
        journal_radius: f64,
        radius: &[f64],
        direction: &[[f64; 2]],
    ) -> (Self, [f64; 2]) {
        let n = radius.len();
        let at = |k: usize| if k == n { 0 } else { k };
        let radial_gap = |k: usize| radius[at(k)] - journal_radius;
        let (u, v) = (direction[first], direction[at(end)]);
        let (a, b, det) = (radial_gap(first), radial_gap(end), cross(u, v));
        let centre = [(a * v[1] - b * u[1]) / det, (b * u[0] - a * v[0]) / det];
        let mut begin = Angles { x: [0.0; SEGMENT], y: [0.0; SEGMENT], radial_gap: [f64::INFINITY; SEGMENT] };
        for (i, k) in (first..end).enumerate() {
            ([begin.x[i], begin.y[i]], begin.radial_gap[i]) = (direction[k], radial_gap(k));
        }
        let mut segment = Segment {
            intervals: end - first,
            begin,
            end: Angles { x: [v[0]], y: [v[1]], radial_gap: [b] },
            centre,
            sums: [Quadratic::default(); SEGMENT + 1],
        };
        let uneven = |k: usize| radial_gap(k) - dot(centre, direction[at(k)]);
        let (mut least, mut most) = (uneven(first), uneven(first));
        for (i, k) in (first..end).enumerate() {
            let (here, there) = (uneven(k), uneven(k + 1));
            (least, most) = (least.min(there), most.max(there));
            let interval = Quadratic::of_interval(direction[k], direction[at(k + 1)], here, there);
            segment.sums[i + 1] = segment.sums[i].plus(&interval);
        }
        (segment, [least, most])
    }

    /// The eccentricity `e`, counted from the segment's own [m].
    #[inline(always)]
    pub(super) fn relative_to_centre(&self, e: [f64; 2]) -> [f64; 2] {
        [e[0] - self.centre[0], e[1] - self.centre[1]]
    }

    /// Bits of the angles with a gap above `least` at the eccentricity `e` [m]: bit i stands for the angle at which interval i begins,
    /// the next one for that at which the last interval ends.
    #[inline(always)]
    pub(super) fn positive(&self, e: [f64; 2], least: f64) -> u32 {
        let mut above = self.begin.gaps(e);
        for i in 0..SEGMENT {
            above[i] -= least;
        }
        positive(&above) | (u32::from(self.end.gaps(e)[0] > least) << self.intervals)
    }

    /// Bits of all its intervals.
    #[inline(always)]
    pub(super) fn all(&self) -> u32 {
        (1 << self.intervals) - 1
    }

    /// Unit vector `(2,)` [1] and R - R1 [m] at the angle at which interval `i` begins, or the last one ends.
    #[inline(always)]
    pub(super) fn angle(&self, i: usize) -> ([f64; 2], f64) {
        if i < self.intervals {
            ([self.begin.x[i], self.begin.y[i]], self.begin.radial_gap[i])
        } else {
            ([self.end.x[0], self.end.y[0]], self.end.radial_gap[0])
        }
    }

    /// Coefficients of all its intervals for eccentricities counted from zero.
    #[inline(always)]
    fn counted_from_zero(&self) -> Quadratic {
        let Quadratic { d, h, c } = self.sums[self.intervals];
        let moved = [dot([d[0], d[1]], self.centre), dot([d[1], d[2]], self.centre)];
        Quadratic {
            d,
            h: [h[0] + moved[0], h[1] + moved[1]],
            c: c + dot([2.0 * h[0] + moved[0], 2.0 * h[1] + moved[1]], self.centre),
        }
    }
}

/// Coefficients of twice the potential e D e - 2 h e + c of intervals wholly in contact, for a spacing of one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Quadratic {
    /// D, entries xx, xy, yy [1].
    pub d: [f64; 3],
    /// The vector h `(2,)` [m].
    pub h: [f64; 2],
    /// The constant c [m^2].
    pub c: f64,
}

impl Quadratic {
    /// Those of one interval with the unit vectors `u`, `v` at its ends and there the gaps -`a` and -`b` [m] at the
    /// eccentricity from which others are counted.
    #[inline(always)]
    fn of_interval(u: [f64; 2], v: [f64; 2], a: f64, b: f64) -> Self {
        let entry =
            |i: usize, j: usize| (u[i] * u[j] + v[i] * v[j]) / 3.0 + (u[i] * v[j] + v[i] * u[j]) / 6.0;
        let mixed = |i: usize| u[i] * (a / 3.0 + b / 6.0) + v[i] * (a / 6.0 + b / 3.0);
        Quadratic {
            d: [entry(0, 0), entry(0, 1), entry(1, 1)],
            h: [mixed(0), mixed(1)],
            c: (a * a + a * b + b * b) / 3.0,
        }
    }

    #[inline(always)]
    fn plus(&self, other: &Self) -> Self {
        let ([xx, xy, yy], [hx, hy]) = (other.d, other.h);
        Quadratic {
            d: [self.d[0] + xx, self.d[1] + xy, self.d[2] + yy],
            h: [self.h[0] + hx, self.h[1] + hy],
            c: self.c + other.c,
        }
    }

    #[inline(always)]
    pub(super) fn minus(&self, other: &Self) -> Self {
        let ([xx, xy, yy], [hx, hy]) = (other.d, other.h);
        Quadratic {
            d: [self.d[0] - xx, self.d[1] - xy, self.d[2] - yy],
            h: [self.h[0] - hx, self.h[1] - hy],
            c: self.c - other.c,
        }
    }
}

/// All segments of a tabulated bore.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Segments {
    /// The segments in order.
    pub each: Vec<Segment>,
    /// Groups of [`GROUP`] segments, which decide whether these touch.
    pub groups: Vec<SegmentGroup>,
    /// One over the cosine of half the angle that the ends of a segment enclose [1].
    pub widening: f64,
    /// Sums over the first 0 to all segments, for eccentricities counted from zero.
    pub across: Vec<Quadratic>,
}

impl Segments {
    /// Tabulates a bore with these radii [m] and unit vectors.
    #[inline(always)]
    pub(super) fn tabulate(&mut self, journal_radius: f64, radius: &[f64], direction: &[[f64; 2]]) {
        let n = radius.len();
        self.widening = 1.0 / libm::cos(0.5 * SEGMENT as f64 * TAU / n as f64);
        self.each.clear();
        self.across.clear();
        self.across.push(Quadratic::default());
        self.groups.clear();
        self.groups.resize(n.div_ceil(SEGMENT * GROUP), SegmentGroup::EMPTY);
        for (s, first) in (0..n).step_by(SEGMENT).enumerate() {
            let end = n.min(first + SEGMENT);
            let (segment, [least, most]) = Segment::new(first, end, journal_radius, radius, direction);
            let (group, i) = (&mut self.groups[s / GROUP], s % GROUP);
            for (ends, angle) in group.ends.iter_mut().zip([0, segment.intervals]) {
                ([ends.x[i], ends.y[i]], ends.radial_gap[i]) = segment.angle(angle);
            }
            (group.least[i], group.most[i]) = (least, most);
            self.across.push(self.across[s].plus(&segment.counted_from_zero()));
            self.each.push(segment);
        }
    }
}
