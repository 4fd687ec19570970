//! Integrals over the arcs in contact with turned journals for states near each other, prepared once for all of them, with another
//! bore and journal in each lane.
//!
//! A cell (`cells.rs`) holds eccentricities about e_0 [m] and angles of the journal for which its table of depths (`journal_table.rs`) stays in one
//! interval, or in a part of it. Intervals in contact all over the cell add up to a polynomial (`rotated_segment.rs`); only the few
//! intervals about the ends of an arc are looked at for each state, interval by interval in all lanes at once. The integrals are those
//! of `rotated_arc.rs`, but for rounding; they depend on the state alone, not on the cells met before or on other lanes.
//!
//! # Source
//! Derived here.

use super::arc::Arc;
use super::cells::{CellContents, Cells, MOST, SIDE, change_of_gaps};
use super::integrals::{Integrals, RotatedIntegrals, UnitIntegrals};
use super::journal_table::JournalTable;
use super::rotated_arc::RotatedArc;
use super::rotated_segment::{RotatedEnd, RotatedSegment, Whole};
use super::segment::SEGMENT;
use crate::lanes::{Lanewise, Real};
use std::f64::consts::TAU;

/// Number of intervals to look at above which cells are made smaller: more than with a round journal, since cells are left more often and
/// take longer to prepare.
const ENOUGH: usize = 40;
/// Factor from one size of cells to the next smaller one [1], one over an odd number: cells of angles of the journal then lie within those
/// of the size before, none in two intervals of its table. Factors of 1/9 with three sizes take the same time.
const SMALLER: f64 = 1.0 / 3.0;
const SIZES: usize = 5;

/// Bores with worn journals and the cells met last, one per lane.
#[derive(Debug, Clone)]
pub struct RotatedCells<R> {
    pub(super) cells: Cells<R, 3>,
    contents: RotatedContents<R>,
    /// Spacing s of the tables [rad].
    spacing: R,
    /// Derivative of the place in the journal's table to alpha, minus the number of its intervals in a radian [1/rad].
    slope: R,
}

/// What is prepared for the cells of bores with worn journals.
#[derive(Debug, Clone)]
struct RotatedContents<R> {
    whole: Whole<R>,
    /// The other intervals that may touch.
    ends: Vec<RotatedEnd<R>>,
    /// Segments of each lane with the journal as it was turned when they were met last `(lanes, segments)`.
    segments: Vec<Vec<RotatedSegment>>,
}

impl<R: Real> RotatedCells<R> {
    /// Cells of the bore `arc` in every lane; `like` sets the number of lanes.
    pub(super) fn new(arc: &Arc, like: R) -> Self {
        let zero = like.zero();
        let contents = RotatedContents {
            whole: Whole { d: [zero; 3], p: [[zero; 4]; 2], c: [zero; 7] },
            ends: vec![RotatedEnd::none(like); MOST],
            segments: vec![vec![]; R::LANES],
        };
        let mut all = RotatedCells {
            cells: Cells::new((ENOUGH, SIZES), [SMALLER; 3], like),
            contents,
            spacing: zero,
            slope: zero,
        };
        (0..R::LANES).for_each(|lane| all.set(lane, arc));
        all
    }

    /// Forgets the cells of a lane, whose bore is `arc` from now on and whose journal is another one.
    pub(super) fn set(&mut self, lane: usize, arc: &Arc) {
        Whole::default().write_lane::<R>(lane, &mut self.contents.whole);
        self.contents.segments[lane].clear();
        self.contents.segments[lane].resize(arc.segments.each.len(), RotatedSegment::NONE);
        self.spacing.set_lane(lane, arc.spacing);
        self.slope.set_lane(lane, -(arc.intervals() as f64) / TAU);
        let side = SIDE * arc.scale;
        let of_arc = (arc.reach, [side, side, 1.0]);
        self.cells.set(lane, of_arc, &mut self.contents);
    }

    /// Integrals over the arcs of these bores and journals `(lanes,)` in contact at the eccentricity `e` [m] with the journals turned by `alpha`
    /// [rad]; the bores are those of [`Self::set`]. Zeros for the second derivatives unless `SECOND`.
    #[inline(always)]
    pub(super) fn integrate<const SECOND: bool>(
        &mut self,
        pairs: &[(Arc, JournalTable)],
        e: [R; 2],
        alpha: R,
    ) -> RotatedIntegrals<R> {
        let zero = alpha.zero();
        let touches = self.cells.touches(e);
        if !R::any(touches) {
            return RotatedIntegrals::none(zero);
        }
        // Intervals of the journal's table, counted on over full turns, are the largest cells about whole numbers of this coordinate.
        let place = alpha * self.slope - 0.5;
        self.cells.find([e[0], e[1], place], touches, pairs, &mut self.contents);
        let centre = self.cells.centre;
        let x = [e[0] - centre[0], e[1] - centre[1]];
        let f = place - centre[2].round() + 0.5;
        let mut sums = self.contents.whole.at::<SECOND>(x, f);
        for k in 0..self.cells.used {
            sums.add_end::<SECOND>(&self.contents.ends[k], x, f);
        }
        let (to_alpha, slope) = (self.slope * self.spacing, self.slope);
        let only = |value: R| R::select(touches, value, zero);
        let UnitIntegrals { sums: Integrals { v, p, d }, extent } = sums.to_e;
        let to_e = UnitIntegrals {
            sums: Integrals {
                v: only(v),
                p: [only(p[0]), only(p[1])],
                d: [only(d[0]), only(d[1]), only(d[2])],
            },
            extent: only(extent),
        };
        let mut all = RotatedIntegrals {
            to_e: to_e.scaled(self.spacing),
            t: only(sums.t * to_alpha),
            et: [only(sums.et[0] * to_alpha), only(sums.et[1] * to_alpha)],
            tt: only(sums.tt * to_alpha * slope),
        };
        if self.cells.overfull {
            for lane in 0..R::LANES {
                let at = [e[0].lane(lane), e[1].lane(lane)];
                if self.cells.is_lane_overfull(lane, at) {
                    let (arc, journal) = &pairs[lane];
                    let one = RotatedArc { arc, journal }.integrals::<true>(at, alpha.lane(lane));
                    one.write_lane::<R>(lane, &mut all);
                }
            }
        }
        all
    }
}

impl<R: Real> CellContents<R, 3> for RotatedContents<R> {
    type Table = (Arc, JournalTable);

    #[inline(always)]
    fn fill(
        &mut self,
        (arc, journal): &Self::Table,
        lane: usize,
        [x, y, place]: [f64; 3],
        half: [f64; 3],
    ) -> usize {
        let (centre, margin) = ([x, y], change_of_gaps(half[0]));
        let turned = RotatedArc { arc, journal };
        let base = Real::round(place);
        let (f, turned_by) = (place - base + 0.5, half[2] * 1.000_001);
        let at = journal.in_interval(base);
        let mut whole = Whole::default();
        let mut found = 0;
        for g in 0..arc.segments.groups.len() {
            let mut any = turned.touching(centre, at, g, margin);
            while any != 0 {
                let (s, of_bore) = turned.next_segment(g, &mut any);
                let segment = &mut self.segments[lane][s];
                if segment.base != base {
                    segment.base = base;
                    segment.prepare(of_bore, journal, at, s * SEGMENT);
                }
                let [inside, reached] = segment.bounds(centre, margin, (f, turned_by));
                let both = inside & (inside >> 1) & of_bore.all();
                if both != 0 {
                    whole.add_moved(&segment.of(both), of_bore.relative_to_centre(centre));
                }
                let mut ends = (reached | (reached >> 1)) & of_bore.all() & !both;
                while ends != 0 {
                    let k = ends.trailing_zeros() as usize;
                    ends &= ends - 1;
                    if found < MOST {
                        self.ends[found].set_lane(lane, segment, k, centre);
                    }
                    found += 1;
                }
            }
        }
        whole.write_lane::<R>(lane, &mut self.whole);
        found
    }

    #[inline(always)]
    fn leave_free(&mut self, lane: usize, k: usize) {
        self.ends[k].set_lane(lane, &RotatedSegment::NONE, 0, [0.0; 2]);
    }
}
