//! Stretches of a tabulated bore: sums over their intervals, and whether they touch as a whole.
//!
//! Over an interval with g > 0 at both ends the integral of g^2 of `arc.rs` is quadratic in the eccentricity e, so that
//! sums of its coefficients over the first intervals of a stretch give the integrals over any number of its intervals
//! at once. Eccentricities are counted from the one at which the journal touches both ends of the stretch: the
//! coefficients are then as small as the bore is uneven, and little is lost in rounding.
//!
//! # Source
//! Derived here.

use crate::plane::{cross, dot};
use std::f64::consts::TAU;

/// Intervals of a stretch, over which sums are kept and which is judged as a whole; few enough for a bore to be nearly an
/// arc about one point there.
pub(super) const STRETCH: usize = 16;

/// What is known of a stretch as a whole.
#[derive(Clone, Copy, PartialEq)]
pub enum Touch {
    /// No interval is in contact.
    Free,
    /// Each interval has to be looked at.
    Partly,
    /// Every interval is in contact from end to end.
    Whole,
}

/// Intervals next to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Eccentricity at which the journal touches the bore at both ends of the stretch `(2,)` [m]: eccentricities are
    /// counted from there, so that the coefficients are as small as the bore is uneven.
    centre: [f64; 2],
    /// Unit vectors at its ends, and the cosine of half the angle between them [1].
    ends: [[f64; 2]; 2],
    half: f64,
    /// Least and largest gap, with the other sign, of its angles at that eccentricity [m].
    uneven: [f64; 2],
    /// Sums over its first 0 to [`STRETCH`] intervals.
    pub sums: [Quadratic; STRETCH + 1],
}

impl Stretch {
    /// The intervals from `first` to before `end` of a bore with these tabulated radii [m] and unit vectors.
    fn new(first: usize, end: usize, journal_radius: f64, radius: &[f64], direction: &[[f64; 2]]) -> Self {
        let n = radius.len();
        let play = |k: usize| radius[k] - journal_radius;
        let after = |k: usize| if k + 1 == n { 0 } else { k + 1 };
        let (u, v) = (direction[first], direction[after(end - 1)]);
        let (a, b, det) = (play(first), play(after(end - 1)), cross(u, v));
        let centre = [(a * v[1] - b * u[1]) / det, (b * u[0] - a * v[0]) / det];
        let uneven = |k: usize| play(k) - dot(centre, direction[k]);
        let mut sums = [Quadratic::default(); STRETCH + 1];
        let (mut least, mut most) = (uneven(first), uneven(first));
        for (i, k) in (first..end).enumerate() {
            let next = after(k);
            let (here, there) = (uneven(k), uneven(next));
            (least, most) = (least.min(there), most.max(there));
            sums[i + 1] = sums[i].plus(&Quadratic::of_interval(direction[k], direction[next], here, there));
        }
        let half = 0.5 * (end - first) as f64 * TAU / n as f64;
        Stretch { centre, ends: [u, v], half: libm::cos(half), uneven: [least, most], sums }
    }

    /// The eccentricity `e`, counted from the stretch's own [m].
    #[inline(always)]
    pub(super) fn relative_to_centre(&self, e: [f64; 2]) -> [f64; 2] {
        [e[0] - self.centre[0], e[1] - self.centre[1]]
    }

    /// Whether the stretch touches at the eccentricity `e` [m]. A wave e.u between the values a and b at the ends is at least
    /// the smaller of two positive ones, and at most the larger over the cosine of half the angle between them.
    #[inline(always)]
    pub(super) fn touch(&self, e: [f64; 2]) -> Touch {
        let e = self.relative_to_centre(e);
        let (a, b) = (dot(e, self.ends[0]), dot(e, self.ends[1]));
        let [least, most] = self.uneven;
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        if high.max(high / self.half) <= least {
            Touch::Free
        } else if low > 0.0 && low > most {
            Touch::Whole
        } else {
            Touch::Partly
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

/// The stretches of a bore with these tabulated radii [m] and unit vectors, into `stretches`.
pub(super) fn tabulate(
    stretches: &mut Vec<Stretch>,
    journal_radius: f64,
    radius: &[f64],
    direction: &[[f64; 2]],
) {
    let n = radius.len();
    stretches.clear();
    let firsts = (0..n).step_by(STRETCH);
    stretches.extend(
        firsts.map(|first| Stretch::new(first, n.min(first + STRETCH), journal_radius, radius, direction)),
    );
}
