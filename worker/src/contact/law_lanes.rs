//! One contact law, with the constants and the bore of another joint in each lane.
//!
//! # Source
//! The laws: see [`LocalHertz`] and [`Foundation`].
//!
//! # Journal lanes
//! Tabulated bores with a worn journal in each, one pair per lane.
//!
//! Arcs in contact are summed in cells (`rotated_cells.rs`), free flight lane by lane.
//!
//! Source:
//! The law: see `foundation.rs`.

use super::arc::{Arcs, FreeArcs};
use super::arc_cells::ArcCells;
use super::integrals::RotatedIntegrals;
use super::journal_table::{JournalTable, within_a_turn, worn_radius};
use super::rotated_arc::RotatedArc;
use super::rotated_cells::RotatedCells;
use super::{
    Arc, Contact, ForceSlopes, Foundation, JointForce, JointMotion, Journal, LocalHertz, PolarEccentricity,
    Surface, Surfaces, Walls,
};
use crate::bore::{Bores, Radius};
use crate::lanes::{Lanewise, Real};
use std::cell::RefCell;

/// A contact law in lanes.
#[derive(Debug, Clone)]
pub enum LawLanes<R> {
    /// Hertz's force along the eccentricity, with one bore per lane, and the depths of one journal if that wears.
    LocalHertz(LocalHertz<R>, Bores, Option<Bores>),
    /// Elastic foundation along the bore, with one bore per lane.
    Foundation(Foundation<R, ArcLanes<R>>),
    /// Elastic foundation along the bore, with one bore and one worn journal per lane.
    FoundationWithJournal(Foundation<R, JournalLanes<R>>),
}

/// Tabulated bores, one per lane `(lanes,)`, with the cells of eccentricities met last.
#[derive(Debug, Clone)]
pub struct ArcLanes<R> {
    arcs: Vec<Arc>,
    cells: RefCell<ArcCells<R>>,
    /// Length of the intervals [rad].
    spacing: R,
}

impl<R: Real> ArcLanes<R> {
    /// Tabulated bores that are all copies of `arc`, without any cell; `like` sets the number of lanes.
    fn new(arc: &Arc, like: R) -> Self {
        ArcLanes {
            arcs: vec![arc.clone(); R::LANES],
            cells: RefCell::new(ArcCells::new(arc, like)),
            spacing: like.like(arc.spacing),
        }
    }

    /// Replaces the bore of a lane.
    fn set(&mut self, lane: usize, arc: Arc) {
        self.spacing.set_lane(lane, arc.spacing);
        self.cells.get_mut().set(lane, &arc);
        self.arcs[lane] = arc;
    }
}

impl<R: Real> LawLanes<R> {
    /// The law of a joint and its surfaces in every lane; `like` sets the number of lanes.
    pub fn new(contact: &Contact, surfaces: Surfaces, like: R) -> Self {
        let surface = contact.surface().in_lanes(like);
        let Surfaces { bore, journal } = surfaces;
        match contact {
            Contact::LocalHertz(_) => {
                let journals = journal.map(|journal| Bores::new(&journal.worn, R::LANES));
                LawLanes::LocalHertz(LocalHertz { surface }, Bores::new(bore, R::LANES), journals)
            }
            Contact::Foundation(law) => {
                let modulus = law.modulus.in_lanes(like);
                match journal.and_then(|journal| Some((journal, journal.table.as_ref()?))) {
                    None => {
                        let arc = ArcLanes::new(&law.arc, like);
                        LawLanes::Foundation(Foundation { surface, modulus, arc })
                    }
                    Some((journal, table)) => {
                        let arc = JournalLanes::new((&law.arc, table), journal, surface.journal_radius);
                        LawLanes::FoundationWithJournal(Foundation { surface, modulus, arc })
                    }
                }
            }
        }
    }

    /// Constants of the joints.
    #[inline(always)]
    fn surface_mut(&mut self) -> &mut Surface<R> {
        match self {
            LawLanes::LocalHertz(law, ..) => &mut law.surface,
            LawLanes::Foundation(law) => &mut law.surface,
            LawLanes::FoundationWithJournal(law) => &mut law.surface,
        }
    }

    /// True for an elastic foundation.
    #[inline(always)]
    pub(crate) fn is_foundation(&self) -> bool {
        !matches!(self, LawLanes::LocalHertz(..))
    }

    /// Replaces the damping factor [s/m] in every lane.
    pub(crate) fn set_damping(&mut self, damping: R) {
        self.surface_mut().damping = damping;
    }

    /// Constants of the joints.
    #[inline(always)]
    pub(crate) fn surface(&self) -> &Surface<R> {
        match self {
            LawLanes::LocalHertz(law, ..) => &law.surface,
            LawLanes::Foundation(law) => &law.surface,
            LawLanes::FoundationWithJournal(law) => &law.surface,
        }
    }

    /// Lets the damping factors of laws with memory follow the speeds of approach, in lanes where the `penetration` [m] at this place and
    /// motion is not above zero; no effect for constant D.
    #[inline(always)]
    pub(crate) fn follow_approach(
        &mut self,
        (place, walls): (&PolarEccentricity<R>, &Walls<R>),
        motion: &JointMotion<R>,
        penetration: R,
    ) {
        if self.surface().restitution.is_none() {
            return;
        }
        let approach = self.approach((place, walls), motion, penetration);
        self.surface_mut().follow_approach(approach, penetration);
    }

    /// Rate of the penetration, delta_dot, in lanes where the `penetration` [m] is not above zero [m/s]; the speed in the middle of the bore.
    #[inline(always)]
    pub(super) fn approach(
        &self,
        (place, walls): (&PolarEccentricity<R>, &Walls<R>),
        motion: &JointMotion<R>,
        penetration: R,
    ) -> R {
        match self {
            LawLanes::LocalHertz(law, ..) => law.approach(place, walls, motion),
            LawLanes::Foundation(law) => law.approach(motion, penetration),
            LawLanes::FoundationWithJournal(law) => law.approach(motion, penetration),
        }
    }

    /// Replaces a lane by a joint with the same law and its surfaces, of which the same wear.
    pub(crate) fn set(&mut self, lane: usize, contact: &Contact, surfaces: Surfaces) {
        contact.surface().write_lane::<R>(lane, self.surface_mut());
        match (self, contact) {
            (LawLanes::LocalHertz(_, bores, journals), _) => {
                bores.set(lane, surfaces.bore);
                if let Some((journals, journal)) = journals.as_mut().zip(surfaces.journal) {
                    journals.set(lane, &journal.worn);
                }
            }
            (LawLanes::Foundation(to), Contact::Foundation(from)) => {
                from.modulus.write_lane::<R>(lane, &mut to.modulus);
                to.arc.set(lane, from.arc.clone());
            }
            (LawLanes::FoundationWithJournal(to), Contact::Foundation(from)) => {
                from.modulus.write_lane::<R>(lane, &mut to.modulus);
                if let Some(journal) = surfaces.journal {
                    to.arc.set(lane, &from.arc, journal, from.surface.journal_radius);
                }
            }
            (LawLanes::Foundation(_) | LawLanes::FoundationWithJournal(_), Contact::LocalHertz(_)) => {}
        }
    }

    /// Leaves a lane idle: its bore takes no time until [`Self::set`] replaces it.
    pub(crate) fn leave_idle(&mut self, lane: usize) {
        match self {
            LawLanes::LocalHertz(..) => {}
            LawLanes::Foundation(law) => law.arc.set(lane, Arc::out_of_reach()),
            LawLanes::FoundationWithJournal(law) => law.arc.leave_idle(lane),
        }
    }

    /// Surfaces at the place of a contact, with the journal turned by `turn` [rad]; zeros under [`Foundation`], whose arcs look them up
    /// themselves.
    #[inline(always)]
    pub fn walls(&self, place: &PolarEccentricity<R>, turn: R) -> Walls<R> {
        let LawLanes::LocalHertz(law, bores, journals) = self else {
            let nothing = place.psi.zero();
            return Walls { bore: Radius { r: nothing, d1: nothing, d2: nothing }, journal: None };
        };
        let bore = bores.radius_at(place.psi);
        let Some(journals) = journals else { return Walls { bore, journal: None } };
        let depth = journals.radius_at(within_a_turn(place.psi - turn));
        Walls { bore, journal: Some(worn_radius(law.surface.journal_radius, depth)) }
    }

    /// Force on the journal at this place of the contact and these surfaces; with `JACOBIAN` its exact derivative, else no slopes.
    #[inline(always)]
    pub fn force<const JACOBIAN: bool>(
        &self,
        (place, walls): (&PolarEccentricity<R>, &Walls<R>),
        motion: &JointMotion<R>,
    ) -> (JointForce<R>, ForceSlopes<R>) {
        match self {
            LawLanes::LocalHertz(law, _, None) => law.force::<JACOBIAN, false>(place, walls, motion),
            LawLanes::LocalHertz(law, ..) => law.force::<JACOBIAN, true>(place, walls, motion),
            LawLanes::Foundation(law) => law.force::<JACOBIAN>(motion),
            LawLanes::FoundationWithJournal(law) => law.force::<JACOBIAN>(motion),
        }
    }
}

impl<R: Real> Arcs<R> for ArcLanes<R> {
    const JOURNAL: bool = false;

    #[inline(always)]
    fn integrate<const SECOND: bool>(&self, e: [R; 2], _alpha: R) -> RotatedIntegrals<R> {
        let sums = self.cells.borrow_mut().integrate::<SECOND>(&self.arcs, e);
        RotatedIntegrals::round(sums.scaled(self.spacing))
    }
}

impl<R: Real> FreeArcs<R> for ArcLanes<R> {
    fn free_penetration(&self, lane: usize, e: [f64; 2], _alpha: f64) -> f64 {
        self.arcs[lane].free_penetration(e)
    }

    fn nearest(&self, lane: usize, e: [f64; 2], _alpha: f64) -> ([f64; 2], f64) {
        let arc = &self.arcs[lane];
        (if arc.intervals() == 0 { [0.0; 2] } else { arc.nearest(e) }, 0.0)
    }
}

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
}

impl<R: Real> FreeArcs<R> for JournalLanes<R> {
    fn free_penetration(&self, lane: usize, e: [f64; 2], alpha: f64) -> f64 {
        let (arc, journal) = &self.pairs[lane];
        RotatedArc { arc, journal }.free_penetration(e, alpha)
    }

    fn nearest(&self, lane: usize, e: [f64; 2], alpha: f64) -> ([f64; 2], f64) {
        let (arc, journal) = &self.pairs[lane];
        if arc.intervals() == 0 { ([0.0; 2], 0.0) } else { RotatedArc { arc, journal }.nearest(e, alpha) }
    }

    #[inline(always)]
    fn journal(&self, chi: R) -> Radius<R> {
        worn_radius(self.radius, self.depths.radius_at(chi))
    }
}
