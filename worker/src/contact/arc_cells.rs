//! Integrals over the arcs in contact for eccentricities near each other, prepared once for all of them, with another bore in each lane.
//!
//! Eccentricities e [m] are divided into square cells of side s [m] about the points of a lattice. Within a cell every gap
//! changes by s / sqrt 2 at most: intervals of the bore whose gaps are further from zero than that are in contact, or free, all over
//! the cell. Those in contact add up to one quadratic in e - e_0, with the cell's centre e_0; only the few intervals about the ends
//! of an arc have to be looked at for each eccentricity, interval by interval in all lanes at once. The integrals are those of `arc.rs`,
//! but for rounding; they depend on the eccentricity alone, not on the cells met before or on other lanes.
//!
//! The side is [`SIDE`] c a^2 with the clearance c [m] and the angle a between the intervals [rad], or a share of that where
//! too many intervals would have to be looked at: a bore worn to the journal's shape has small gaps along wide arcs, and its
//! journal moves little.
//!
//! # Source
//! Derived here; lists of neighbours that stay valid within a margin: Verlet (1967), Physical Review 159, 98-103.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::arc::Arc;
use super::integrals::{Integrals, UnitIntegrals};
use crate::lanes::Real;
use crate::plane::{fused_dot, length};

/// Side of the widest cells over c a^2 [1].
const SIDE: f64 = 40.0;
/// Factor from one size of cells to the next smaller one [1], and number of sizes.
const SMALLER: f64 = 0.125;
const SIZES: usize = 3;
/// Number of intervals to look at above which cells are made smaller, and the largest number.
const ENOUGH: usize = 16;
const MOST: usize = 64;

/// An interval about the end of an arc; in lanes where there is none it touches nothing.
#[derive(Debug, Clone, Copy)]
struct EndInterval<R> {
    /// Unit vectors at both ends of the interval `(2,)` each [1].
    u: [R; 2],
    v: [R; 2],
    /// Gaps there at the centre of the cell [m].
    a: R,
    b: R,
}

impl<R: Real> EndInterval<R> {
    /// No interval in any lane.
    #[inline(always)]
    fn none(like: R) -> Self {
        let (zero, free) = (like.zero(), like.like(-1.0));
        EndInterval { u: [zero; 2], v: [zero; 2], a: free, b: free }
    }

    /// Replaces the interval of a lane.
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, [a, b]: [f64; 2], [u, v]: [[f64; 2]; 2]) {
        self.a.set_lane(lane, a);
        self.b.set_lane(lane, b);
        for k in 0..2 {
            self.u[k].set_lane(lane, u[k]);
            self.v[k].set_lane(lane, v[k]);
        }
    }
}

/// The bores and the cells met last, one per lane, each within the one before.
#[derive(Debug, Clone)]
pub struct ArcCells<R> {
    /// Eccentricity up to which the journal does not touch the bore [m], and side of the largest cells [m] and one over it.
    reach: R,
    side: R,
    per_side: R,
    /// Centres e_0 of the cells of each size `(SIZES, 2)` [m]; infinite if there is no such cell.
    centres: [[R; 2]; SIZES],
    /// Centre of the smallest cell `(2,)` [m], its size, and the largest of these numbers.
    centre: [R; 2],
    size: R,
    smallest: usize,
    /// Sums of the intervals in contact all over the smallest cell, at its centre and for intervals of length one.
    whole: Integrals<R>,
    /// The other intervals that may touch, and the largest number of them in a lane.
    ends: Vec<EndInterval<R>>,
    used: usize,
    /// Number of these intervals in each lane; `None` if even the smallest cell has too many.
    counts: Vec<Option<usize>>,
    /// True if a lane has too many.
    overfull: bool,
}

impl<R: Real> ArcCells<R> {
    /// Cells of the bore `arc` in every lane; `like` sets the number of lanes.
    pub(super) fn new(arc: &Arc, like: R) -> Self {
        let zero = like.zero();
        let mut cells = ArcCells {
            reach: zero,
            side: zero,
            per_side: zero,
            centres: [[zero; 2]; SIZES],
            centre: [zero; 2],
            size: zero,
            smallest: 0,
            whole: UnitIntegrals::none(zero).sums,
            ends: vec![EndInterval::none(like); MOST],
            used: 0,
            counts: vec![Some(0); R::LANES],
            overfull: false,
        };
        (0..R::LANES).for_each(|lane| cells.set(lane, arc));
        cells
    }

    /// True if a lane has too many intervals to look at.
    #[cfg(test)]
    pub(super) fn is_overfull(&self) -> bool {
        self.overfull
    }

    /// Forgets the cells of a lane, whose bore is `arc` from now on.
    pub(super) fn set(&mut self, lane: usize, arc: &Arc) {
        self.reach.set_lane(lane, arc.reach());
        self.side.set_lane(lane, SIDE * arc.scale());
        self.per_side.set_lane(lane, 1.0 / (SIDE * arc.scale()));
        for centre in &mut self.centres {
            centre.iter_mut().for_each(|x| x.set_lane(lane, f64::INFINITY));
        }
        self.centre.iter_mut().for_each(|x| x.set_lane(lane, 0.0));
        self.size.set_lane(lane, 0.0);
        let nothing = Integrals::default();
        self.set_whole(lane, &nothing);
        self.set_count(lane, Some(0));
    }

    /// Integrals over the arcs of the bores `arcs` `(lanes,)` in contact at the eccentricity `e` [m], for intervals of length one; the
    /// bores are those of [`Self::set`]. Zeros for the second derivative unless `SECOND`.
    #[inline(always)]
    pub(super) fn integrate<const SECOND: bool>(&mut self, arcs: &[Arc], e: [R; 2]) -> UnitIntegrals<R> {
        let zero = e[0].zero();
        let touches = self.reach.below(length(e));
        if !R::any(touches) {
            return UnitIntegrals::none(zero);
        }
        self.find(arcs, e, touches);
        let x = [e[0] - self.centre[0], e[1] - self.centre[1]];
        let mut ends = UnitIntegrals::none(zero);
        for k in 0..self.used {
            add_end::<R, SECOND>(&mut ends, &self.ends[k], x);
        }
        let Integrals { v, p, d } = self.whole;
        let moved = [fused_dot([d[0], d[1]], x), fused_dot([d[1], d[2]], x)];
        let UnitIntegrals { sums: of_ends, extent } = ends;
        let only = |value: R| R::select(touches, value, zero);
        let mut sums = Integrals {
            v: only(of_ends.v + v + fused_dot([p[0] * 2.0 + moved[0], p[1] * 2.0 + moved[1]], x)),
            p: [only(p[0] + moved[0] + of_ends.p[0]), only(p[1] + moved[1] + of_ends.p[1])],
            d: [zero; 3],
        };
        if SECOND {
            for k in 0..3 {
                sums.d[k] = only(d[k] + of_ends.d[k]);
            }
        }
        let mut all = UnitIntegrals { sums, extent: only(d[0] + d[2] + extent) };
        if self.overfull {
            for lane in 0..R::LANES {
                let at = [e[0].lane(lane), e[1].lane(lane)];
                if self.counts[lane].is_none() && self.reach.lane(lane) < length(at) {
                    all.set_lane(lane, arcs[lane].integrate_units(at));
                }
            }
        }
        all
    }

    /// Prepares in each lane that `touches` the largest cell about `e` [m] with few enough intervals to look at. Whether the cell of one
    /// size will do depends on the cell alone, hence so does the cell found.
    #[inline(always)]
    fn find(&mut self, arcs: &[Arc], e: [R; 2], touches: R::Mask) {
        let (mut side, mut per_side) = (self.side, self.per_side);
        let mut stale = 0;
        for size in 0..=self.smallest {
            let at = [(e[0] * per_side).round() * side, (e[1] * per_side).round() * side];
            let off = (at[0] - self.centres[size][0]).abs() + (at[1] - self.centres[size][1]).abs();
            let used = off.like(size as f64 - 0.5).below(self.size);
            stale |= R::bits(R::both(R::both(touches, used), off.zero().below(off)));
            side = side * SMALLER;
            per_side = per_side * (1.0 / SMALLER);
        }
        while stale != 0 {
            let lane = stale.trailing_zeros() as usize;
            stale &= stale - 1;
            self.find_lane(lane, &arcs[lane], [e[0].lane(lane), e[1].lane(lane)]);
        }
    }

    /// Prepares the cells about `e` [m] that a lane has left, from the largest of these on.
    #[inline(always)]
    fn find_lane(&mut self, lane: usize, arc: &Arc, e: [f64; 2]) {
        let (mut side, mut per_side) = (self.side.lane(lane), self.per_side.lane(lane));
        for size in 0..SIZES {
            let centre = [Real::round(e[0] * per_side) * side, Real::round(e[1] * per_side) * side];
            let of_size = self.centres[size];
            if centre != [of_size[0].lane(lane), of_size[1].lane(lane)] {
                for smaller in size..SIZES {
                    for k in 0..2 {
                        self.centres[smaller][k].set_lane(lane, f64::INFINITY);
                    }
                }
                for k in 0..2 {
                    self.centres[size][k].set_lane(lane, centre[k]);
                    self.centre[k].set_lane(lane, centre[k]);
                }
                self.size.set_lane(lane, size as f64);
                self.fill(lane, arc, centre, side);
                if self.counts[lane].is_some_and(|count| count <= ENOUGH) {
                    break;
                }
            }
            side *= SMALLER;
            per_side *= 1.0 / SMALLER;
        }
        self.smallest = 0;
        for lane in 0..R::LANES {
            self.smallest = self.smallest.max(self.size.lane(lane) as usize);
        }
    }

    /// Prepares the cell of a lane, of side `side` [m] about `centre` [m].
    #[inline(always)]
    fn fill(&mut self, lane: usize, arc: &Arc, centre: [f64; 2], side: f64) {
        // Half the diagonal, and a little for rounding and for unit vectors that are slightly longer than one.
        let margin = 0.72 * side;
        let mut whole = Integrals::default();
        let ends = &mut self.ends;
        let mut found = 0;
        arc.visit_near(centre, margin, &mut whole, |gaps, directions| {
            if found < MOST {
                ends[found].set_lane(lane, gaps, directions);
            }
            found += 1;
        });
        self.set_whole(lane, &whole);
        self.set_count(lane, (found <= MOST).then_some(found));
    }

    #[inline(always)]
    fn set_whole(&mut self, lane: usize, whole: &Integrals) {
        self.whole.v.set_lane(lane, whole.v);
        for k in 0..2 {
            self.whole.p[k].set_lane(lane, whole.p[k]);
        }
        for k in 0..3 {
            self.whole.d[k].set_lane(lane, whole.d[k]);
        }
    }

    /// Sets the number of intervals of a lane, and empties those beyond.
    #[inline(always)]
    fn set_count(&mut self, lane: usize, count: Option<usize>) {
        let written = if count.is_some() { self.used } else { MOST };
        for k in count.unwrap_or(0)..written {
            self.ends[k].set_lane(lane, [-1.0; 2], [[0.0; 2]; 2]);
        }
        self.counts[lane] = count;
        (self.used, self.overfull) = (0, false);
        for lane in 0..R::LANES {
            self.used = self.used.max(self.counts[lane].unwrap_or(0));
            self.overfull |= self.counts[lane].is_none();
        }
    }
}

/// Adds this interval at the eccentricity `x` from the centre of the cell [m], without second derivatives unless `SECOND`.
///
/// Of an interval with the larger gap h and the smaller one l the share f = h / (h - l), at most one, is in contact; the formulas are
/// those of `integrals.rs`, without branches and with fused operations.
#[inline(always)]
fn add_end<R: Real, const SECOND: bool>(to: &mut UnitIntegrals<R>, end: &EndInterval<R>, x: [R; 2]) {
    let ([ux, uy], [vx, vy]) = (end.u, end.v);
    let (zero, sixth_part) = (ux.zero(), ux.like(1.0 / 6.0));
    let a = end.a.plus_product(x[0], ux).plus_product(x[1], uy);
    let b = end.b.plus_product(x[0], vx).plus_product(x[1], vy);
    let falls = b.below(a);
    let (high, low) = (R::select(falls, a, b).larger(zero), R::select(falls, b, a));
    let (over, under) = (low.larger(zero), low.smaller(zero));
    let f = high / (high - under + f64::MIN_POSITIVE);
    let f2 = f * f;
    // Half and a sixth of the parts h f and h f^2.
    let (half, sixth) = (high * f * 0.5, high * f2 * sixth_part);
    let near = (half - sixth).plus_product(over, sixth_part);
    let far = sixth.plus_product(over, sixth_part * 2.0);
    let (wa, wb) = (R::select(falls, near, far), R::select(falls, far, near));
    let sums = &mut to.sums;
    sums.v = sums.v.plus_product(wa, a).plus_product(wb, b);
    sums.p[0] = sums.p[0].plus_product(wa, ux).plus_product(wb, vx);
    sums.p[1] = sums.p[1].plus_product(wa, uy).plus_product(wb, vy);
    to.extent += f;
    if SECOND {
        let f3 = f2 * f * (1.0 / 3.0);
        let (near, mixed, far) = (f - f2 + f3, f2 * 0.5 - f3, f3);
        let (aa, bb) = (R::select(falls, near, far), R::select(falls, far, near));
        let (ax, bx) = ((aa * ux).plus_product(mixed, vx), (mixed * ux).plus_product(bb, vx));
        let (ay, by) = ((aa * uy).plus_product(mixed, vy), (mixed * uy).plus_product(bb, vy));
        sums.d[0] = sums.d[0].plus_product(ax, ux).plus_product(bx, vx);
        sums.d[1] = sums.d[1].plus_product(ay, ux).plus_product(by, vx);
        sums.d[2] = sums.d[2].plus_product(ay, uy).plus_product(by, vy);
    }
}
