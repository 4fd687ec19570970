//! Integrals over the arcs in contact for eccentricities near each other, prepared once for all of them, with another bore in each lane.
//!
//! Of the intervals of a bore, those in contact all over a cell of eccentricities (`cells.rs`) add up to one quadratic in e - e_0 [m], with the
//! cell's centre e_0; only the few intervals about the ends of an arc are looked at for each eccentricity, interval by interval in
//! all lanes at once. The integrals are those of `arc.rs`, but for rounding.
//!
//! # Source
//! Derived here.

use super::arc::Arc;
use super::cells::{CellContents, Cells, MOST, SIDE, change_of_gaps};
use super::integrals::{Integrals, UnitIntegrals, weights_in_lanes};
use crate::lanes::{Lanewise, Real};
use crate::plane::fused_dot;

/// Number of intervals to look at above which cells are made smaller.
const ENOUGH: usize = 16;
/// Factor from one size of cells to the next smaller one [1], and number of sizes.
const SMALLER: f64 = 0.125;
const SIZES: usize = 3;

/// An interval about the end of an arc: unit vectors at both ends of it `(2, 2)` [1], and the gaps there at the centre of the cell [m]; in lanes where there is
/// none it touches nothing.
type EndInterval<R> = ([[R; 2]; 2], [R; 2]);

/// Replaces the interval of a lane.
#[inline(always)]
fn set_lane<R: Real>(end: &mut EndInterval<R>, lane: usize, gaps: [f64; 2], directions: [[f64; 2]; 2]) {
    for k in 0..2 {
        end.1[k].set_lane(lane, gaps[k]);
        for side in 0..2 {
            end.0[side][k].set_lane(lane, directions[side][k]);
        }
    }
}

/// The bores and the cells met last, one per lane.
#[derive(Debug, Clone)]
pub struct ArcCells<R> {
    pub(super) cells: Cells<R, 2>,
    contents: ArcContents<R>,
}

/// What is prepared for the cells of bores: sums of the intervals in contact all over the cell, at its centre and for intervals of length one, and the
/// other intervals that may touch.
type ArcContents<R> = (Integrals<R>, Vec<EndInterval<R>>);

impl<R: Real> ArcCells<R> {
    /// Cells of the bore `arc` in every lane; `like` sets the number of lanes.
    pub(super) fn new(arc: &Arc, like: R) -> Self {
        let (zero, free) = (like.zero(), like.like(-1.0));
        let contents = (UnitIntegrals::none(zero).sums, vec![([[zero; 2]; 2], [free; 2]); MOST]);
        let mut all = ArcCells { cells: Cells::new((ENOUGH, SIZES), [SMALLER; 2], like), contents };
        (0..R::LANES).for_each(|lane| all.set(lane, arc));
        all
    }

    /// Forgets the cells of a lane, whose bore is `arc` from now on.
    pub(super) fn set(&mut self, lane: usize, arc: &Arc) {
        Integrals::default().write_lane::<R>(lane, &mut self.contents.0);
        let of_arc = (arc.reach, [SIDE * arc.scale; 2]);
        self.cells.set(lane, of_arc, &mut self.contents);
    }

    /// Integrals over the arcs of the bores `arcs` `(lanes,)` in contact at the eccentricity `e` [m], for intervals of length one; the
    /// bores are those of [`Self::set`]. Zeros for the second derivative unless `SECOND`.
    #[inline(always)]
    pub(super) fn integrate<const SECOND: bool>(&mut self, arcs: &[Arc], e: [R; 2]) -> UnitIntegrals<R> {
        let zero = e[0].zero();
        let touches = self.cells.touches(e);
        if !R::any(touches) {
            return UnitIntegrals::none(zero);
        }
        self.cells.find(e, touches, arcs, &mut self.contents);
        let centre = self.cells.centre;
        let x = [e[0] - centre[0], e[1] - centre[1]];
        let mut ends = UnitIntegrals::none(zero);
        for k in 0..self.cells.used {
            add_end::<R, SECOND>(&mut ends, &self.contents.1[k], x);
        }
        let Integrals { v, p, d } = self.contents.0;
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
        if self.cells.overfull {
            for lane in 0..R::LANES {
                let at = [e[0].lane(lane), e[1].lane(lane)];
                if self.cells.is_lane_overfull(lane, at) {
                    arcs[lane].integrate_units(at).write_lane::<R>(lane, &mut all);
                }
            }
        }
        all
    }
}

impl<R: Real> CellContents<R, 2> for ArcContents<R> {
    type Table = Arc;

    #[inline(always)]
    fn fill(&mut self, arc: &Arc, lane: usize, centre: [f64; 2], half: [f64; 2]) -> usize {
        let margin = change_of_gaps(half[0]);
        let mut whole = Integrals::default();
        let (sums, ends) = self;
        let mut found = 0;
        arc.visit_near(centre, margin, &mut whole, |gaps, directions| {
            if found < MOST {
                set_lane(&mut ends[found], lane, gaps, directions);
            }
            found += 1;
        });
        whole.write_lane::<R>(lane, sums);
        found
    }

    #[inline(always)]
    fn leave_free(&mut self, lane: usize, k: usize) {
        set_lane(&mut self.1[k], lane, [-1.0; 2], [[0.0; 2]; 2]);
    }
}

/// Adds this interval at the eccentricity `x` from the centre of the cell [m], without second derivatives unless `SECOND`.
#[inline(always)]
fn add_end<R: Real, const SECOND: bool>(to: &mut UnitIntegrals<R>, end: &EndInterval<R>, x: [R; 2]) {
    let (directions @ [[ux, uy], [vx, vy]], [a, b]) = *end;
    let a = a.plus_product(x[0], ux).plus_product(x[1], uy);
    let b = b.plus_product(x[0], vx).plus_product(x[1], vy);
    to.add_end::<SECOND>(directions, [a, b], weights_in_lanes::<R, SECOND>(a, b));
}
