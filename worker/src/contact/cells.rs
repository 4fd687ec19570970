//! Cells of eccentricities near each other, for which the arcs in contact are prepared once, with another bore in each lane.
//!
//! Eccentricities e [m] are divided into square cells of side s [m] about the points of a lattice. Within a cell every gap
//! changes by s / sqrt 2 at most: intervals of the bore whose gaps are further from zero than that are in contact, or free, all over
//! the cell. Only the few intervals about the ends of an arc have to be looked at for each eccentricity. The cell found depends on the
//! eccentricity and the bore alone, not on the cells met before or on other lanes.
//!
//! The side is [`SIDE`] c a^2 with the clearance c [m] and the angle a between the intervals [rad], or a share of that where
//! too many intervals would have to be looked at: a bore worn to the journal's shape has small gaps along wide arcs, and its
//! journal moves little.
//!
//! # Source
//! Derived here; lists of neighbours that stay valid within a margin: Verlet (1967), Physical Review 159, 98-103.

use crate::lanes::Real;
use crate::plane::length;

/// Side of the widest cells over c a^2 [1].
pub(super) const SIDE: f64 = 40.0;
/// Largest number of sizes of cells.
const SIZES: usize = 5;
/// Largest number of intervals to look at.
pub(super) const MOST: usize = 64;

/// What is prepared for a cell.
pub(super) trait CellContents<R, const D: usize> {
    /// The bore of a lane, from which the contents are prepared.
    type Table;
    /// Prepares in a lane from its `table` what holds in the cell about `centre` `(D,)`, whose coordinates reach up to `half` `(D,)` to either side; returns the
    /// number of intervals to look at, of which the first [`MOST`] are kept.
    fn fill(&mut self, table: &Self::Table, lane: usize, centre: [f64; D], half: [f64; D]) -> usize;
    /// Leaves the kept interval `k` of a lane out of contact.
    fn leave_free(&mut self, lane: usize, k: usize);
}

/// The cells met last, one per lane, each within the one before; of `D` coordinates the first two are the eccentricity.
#[derive(Debug, Clone)]
pub struct Cells<R, const D: usize> {
    /// Eccentricity up to which the journal does not touch the bore [m].
    reach: R,
    /// Sides of the largest cells, and one over them `(D,)`.
    side: [R; D],
    per_side: [R; D],
    /// Factors from one size of cells to the next smaller one, and one over them `(D,)` [1].
    smaller: [f64; D],
    per_smaller: [f64; D],
    /// Number of intervals to look at above which cells are made smaller, and number of sizes.
    enough: usize,
    sizes: usize,
    /// Centres of the cells of each size `(SIZES, D)`; infinite if there is no such cell.
    centres: [[R; D]; SIZES],
    /// Centre of the smallest cell `(D,)`, its size, and the largest of these numbers.
    pub(super) centre: [R; D],
    size: R,
    smallest: usize,
    /// Number of intervals to look at in each lane, `None` if even the smallest cell has too many; the largest number.
    counts: Vec<Option<usize>>,
    pub(super) used: usize,
    /// True if a lane has too many.
    pub(super) overfull: bool,
}

impl<R: Real, const D: usize> Cells<R, D> {
    /// No cell in any lane, and no bore yet; cells with more than `enough` intervals to look at are made smaller by the factors
    /// `smaller` `(D,)`, down to the last of `sizes`. `like` sets the number of lanes.
    pub(super) fn new((enough, sizes): (usize, usize), smaller: [f64; D], like: R) -> Self {
        let zero = like.zero();
        Cells {
            reach: like.like(f64::MAX),
            side: [like.like(1.0); D],
            per_side: [like.like(1.0); D],
            smaller,
            per_smaller: smaller.map(|factor| 1.0 / factor),
            enough,
            sizes,
            centres: [[like.like(f64::INFINITY); D]; SIZES],
            centre: [zero; D],
            size: zero,
            smallest: 0,
            counts: vec![Some(0); R::LANES],
            used: 0,
            overfull: false,
        }
    }

    /// Forgets the cells of a lane with these `contents`: its journal does not touch the bore up to the eccentricity `reach` [m], its largest cells have
    /// these sides `(D,)`.
    pub(super) fn set(
        &mut self,
        lane: usize,
        (reach, side): (f64, [f64; D]),
        contents: &mut impl CellContents<R, D>,
    ) {
        self.reach.set_lane(lane, reach);
        for d in 0..D {
            self.side[d].set_lane(lane, side[d]);
            self.per_side[d].set_lane(lane, 1.0 / side[d]);
            self.centre[d].set_lane(lane, 0.0);
            for size in 0..SIZES {
                self.centres[size][d].set_lane(lane, f64::INFINITY);
            }
        }
        self.size.set_lane(lane, 0.0);
        self.set_count(lane, 0, contents);
    }

    /// Lanes in which the journal may touch at the eccentricity `e` [m].
    #[inline(always)]
    pub(super) fn touches(&self, e: [R; 2]) -> R::Mask {
        self.reach.below(length(e))
    }

    /// True if this lane has, and may touch at the eccentricity `e` [m].
    #[inline(always)]
    pub(super) fn is_lane_overfull(&self, lane: usize, e: [f64; 2]) -> bool {
        self.counts[lane].is_none() && self.reach.lane(lane) < length(e)
    }

    /// Prepares in each lane that `touches` the largest cell about `at` `(D,)` with few enough intervals to look at. Whether the cell of one
    /// size will do depends on the cell alone, hence so does the cell found.
    #[inline(always)]
    pub(super) fn find<C: CellContents<R, D>>(
        &mut self,
        at: [R; D],
        touches: R::Mask,
        tables: &[C::Table],
        contents: &mut C,
    ) {
        let (mut side, mut per_side) = (self.side, self.per_side);
        let mut stale = 0;
        for size in 0..=self.smallest {
            let mut off = at[0].zero();
            for d in 0..D {
                off += ((at[d] * per_side[d]).round() * side[d] - self.centres[size][d]).abs();
                side[d] = side[d] * self.smaller[d];
                per_side[d] = per_side[d] * self.per_smaller[d];
            }
            let used = off.like(size as f64 - 0.5).below(self.size);
            stale |= R::bits(R::both(R::both(touches, used), off.zero().below(off)));
        }
        while stale != 0 {
            let lane = stale.trailing_zeros() as usize;
            stale &= stale - 1;
            let mut of_lane = [0.0; D];
            for d in 0..D {
                of_lane[d] = at[d].lane(lane);
            }
            self.find_lane(lane, of_lane, &tables[lane], contents);
        }
    }

    /// Prepares the cells about `at` `(D,)` that a lane has left, from the largest of these on.
    #[inline(always)]
    fn find_lane<C: CellContents<R, D>>(
        &mut self,
        lane: usize,
        at: [f64; D],
        table: &C::Table,
        contents: &mut C,
    ) {
        let (mut side, mut per_side) = ([0.0; D], [0.0; D]);
        for d in 0..D {
            (side[d], per_side[d]) = (self.side[d].lane(lane), self.per_side[d].lane(lane));
        }
        for size in 0..self.sizes {
            let (mut centre, mut half, mut left) = ([0.0; D], [0.0; D], false);
            for d in 0..D {
                centre[d] = Real::round(at[d] * per_side[d]) * side[d];
                half[d] = 0.5 * side[d];
                left |= centre[d] != self.centres[size][d].lane(lane);
            }
            if left {
                for d in 0..D {
                    for smaller in size + 1..SIZES {
                        self.centres[smaller][d].set_lane(lane, f64::INFINITY);
                    }
                    self.centres[size][d].set_lane(lane, centre[d]);
                    self.centre[d].set_lane(lane, centre[d]);
                }
                self.size.set_lane(lane, size as f64);
                let found = contents.fill(table, lane, centre, half);
                self.set_count(lane, found, contents);
                if found <= self.enough {
                    break;
                }
            }
            for d in 0..D {
                side[d] *= self.smaller[d];
                per_side[d] *= self.per_smaller[d];
            }
        }
        self.smallest = 0;
        for lane in 0..R::LANES {
            self.smallest = self.smallest.max(self.size.lane(lane) as usize);
        }
    }

    /// Sets the number of intervals `found` in a lane, and leaves those beyond out of contact.
    #[inline(always)]
    fn set_count(&mut self, lane: usize, found: usize, contents: &mut impl CellContents<R, D>) {
        let count = (found <= MOST).then_some(found);
        let written = if count.is_some() { self.used } else { MOST };
        for k in count.unwrap_or(0)..written {
            contents.leave_free(lane, k);
        }
        self.counts[lane] = count;
        (self.used, self.overfull) = (0, false);
        for lane in 0..R::LANES {
            self.used = self.used.max(self.counts[lane].unwrap_or(0));
            self.overfull |= self.counts[lane].is_none();
        }
    }
}

/// Bound of the change of a gap within a cell of eccentricities of half this side [m]: half its diagonal, and a little for rounding and
/// for unit vectors that are slightly longer than one.
#[inline(always)]
pub(super) fn change_of_gaps(half_side: f64) -> f64 {
    1.44 * half_side
}
