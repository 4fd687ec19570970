//! Tabulated bores with a worn journal in each, one pair per lane.
//!
//! Arcs in contact are summed in cells (`rotated_cells.rs`), free flight lane by lane.
//!
//! # Source
//! The law: see `foundation.rs`.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::arc::{Arc, Arcs};
use super::integrals::RotatedIntegrals;
use super::journal_table::{Journal, JournalTable, worn_radius};
use super::rotated_arc::RotatedArc;
use super::rotated_cells::RotatedCells;
use crate::bore::{Bore, Bores, Radius};
use crate::lanes::Real;
use std::cell::RefCell;

/// Bores with a worn journal in each, one pair per lane.
#[derive(Debug, Clone)]
pub struct JournalLanes<R> {
    /// Tabulated bore and journal of each lane `(lanes,)`, with the cells of states met last.
    pairs: Vec<(Arc, JournalTable)>,
    cells: RefCell<RotatedCells<R>>,
    /// Unworn radius of the journals [m], and their depths.
    radius: R,
    depths: Bores,
}

impl<R: Real> JournalLanes<R> {
    /// This tabulated bore and journal in every lane; `journal` has the unworn radius `radius` [m].
    pub(super) fn new((arc, table): (&Arc, &JournalTable), journal: &Journal, radius: R) -> Self {
        JournalLanes {
            cells: RefCell::new(RotatedCells::new(arc, radius)),
            pairs: vec![(arc.clone(), table.clone()); R::LANES],
            radius,
            depths: Bores::new(&journal.worn, R::LANES),
        }
    }

    /// Replaces a lane by this bore and this journal of unworn radius `radius` [m].
    pub(super) fn set(&mut self, lane: usize, arc: &Arc, journal: &Journal, radius: f64) {
        let (to_arc, to_table) = &mut self.pairs[lane];
        to_arc.clone_from(arc);
        if let Some(table) = &journal.table {
            to_table.clone_from(table);
        }
        self.cells.get_mut().set(lane, arc);
        self.radius.set_lane(lane, radius);
        self.depths.set(lane, &journal.worn);
    }

    /// Leaves a lane idle: its bore takes no time until [`Self::set`] replaces it.
    pub(super) fn leave_idle(&mut self, lane: usize) {
        let arc = Arc::out_of_reach();
        self.cells.get_mut().set(lane, &arc);
        self.pairs[lane].0 = arc;
    }
}

impl<R: Real> Arcs<R> for JournalLanes<R> {
    const JOURNAL: bool = true;

    #[inline(always)]
    fn integrate<const SECOND: bool>(&self, e: [R; 2], alpha: R) -> RotatedIntegrals<R> {
        self.cells.borrow_mut().integrate::<SECOND>(&self.pairs, e, alpha)
    }

    #[inline(always)]
    fn free_penetration(&self, e: [R; 2], alpha: R, touches: R) -> R {
        let mut out = alpha.zero();
        for lane in 0..R::LANES {
            if touches.lane(lane) <= 0.0 {
                let (arc, journal) = &self.pairs[lane];
                let at = [e[0].lane(lane), e[1].lane(lane)];
                out.set_lane(lane, RotatedArc { arc, journal }.free_penetration(at, alpha.lane(lane)));
            }
        }
        out
    }

    #[inline(always)]
    fn nearest_free(&self, e: [R; 2], alpha: R, penetration: R) -> ([R; 2], R) {
        let nothing = alpha.zero();
        let (mut direction, mut to_alpha) = ([nothing; 2], nothing);
        for lane in 0..R::LANES {
            let (arc, journal) = &self.pairs[lane];
            // An idle lane has no bore.
            if penetration.lane(lane) > 0.0 || arc.intervals() == 0 {
                continue;
            }
            let at = [e[0].lane(lane), e[1].lane(lane)];
            let (one, slope) = RotatedArc { arc, journal }.nearest(at, alpha.lane(lane));
            direction[0].set_lane(lane, one[0]);
            direction[1].set_lane(lane, one[1]);
            to_alpha.set_lane(lane, slope);
        }
        (direction, to_alpha)
    }

    #[inline(always)]
    fn journal(&self, chi: R) -> Radius<R> {
        worn_radius(self.radius, self.depths.radius_at(chi))
    }
}
