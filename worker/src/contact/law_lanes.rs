//! One contact law, with the constants and the bore of another joint in each lane.
//!
//! # Source
//! The laws: see [`LocalHertz`] and [`Foundation`].

use super::arc::{Arc, Arcs};
use super::arc_cell::ArcCell;
use super::foundation::Foundation;
use super::integrals::Integrals;
use super::joint_force::{ForceSlopes, JointForce, JointMotion};
use super::local_hertz::{LocalHertz, PolarEccentricity};
use super::{Contact, Surface};
use crate::bore::{Bore, Bores, Profile, Radius};
use crate::lanes::{Lanewise, Real};
use std::cell::RefCell;

/// A contact law in lanes.
#[derive(Debug, Clone)]
pub enum LawLanes<R> {
    /// Hertz's force along the eccentricity, with one bore per lane.
    LocalHertz(LocalHertz<R>, Bores),
    /// Elastic foundation along the bore, with one bore per lane.
    Foundation(Foundation<R, ArcLanes>),
}

/// Tabulated bores, one per lane `(lanes,)`, with the cell of eccentricities met last. What an arc of contact needs differs too much
/// from lane to lane for operations of all lanes at once: they are summed lane by lane, each in loops over its own bore.
#[derive(Debug, Clone)]
pub struct ArcLanes(Vec<(Arc, RefCell<ArcCell>)>);

impl<R: Real> LawLanes<R> {
    /// The law of a joint and its bore in every lane; `like` sets the number of lanes.
    pub(crate) fn new(contact: &Contact, profile: &Profile, like: R) -> Self {
        let surface = contact.surface().in_lanes(like);
        match contact {
            Contact::LocalHertz(_) => {
                LawLanes::LocalHertz(LocalHertz { surface }, Bores::new(profile, R::LANES))
            }
            Contact::Foundation(law) => LawLanes::Foundation(Foundation {
                surface,
                modulus: law.modulus.in_lanes(like),
                arc: ArcLanes(vec![(law.arc.clone(), RefCell::new(ArcCell::NONE)); R::LANES]),
            }),
        }
    }

    /// Constants of the joints.
    #[inline(always)]
    fn surface_mut(&mut self) -> &mut Surface<R> {
        match self {
            LawLanes::LocalHertz(law, _) => &mut law.surface,
            LawLanes::Foundation(law) => &mut law.surface,
        }
    }

    /// Constants of the joints.
    #[inline(always)]
    pub(crate) fn surface(&self) -> &Surface<R> {
        match self {
            LawLanes::LocalHertz(law, _) => &law.surface,
            LawLanes::Foundation(law) => &law.surface,
        }
    }

    /// Lets the damping factors of laws with memory follow the speeds of approach, in lanes where the `penetration` [m] at this place and
    /// motion is not above zero; no effect for constant D.
    #[inline(always)]
    pub(crate) fn follow_approach(
        &mut self,
        (place, wall): (&PolarEccentricity<R>, &Radius<R>),
        motion: &JointMotion<R>,
        penetration: R,
    ) {
        if self.surface().restitution.is_none() {
            return;
        }
        let approach = match self {
            LawLanes::LocalHertz(law, _) => law.approach(place, wall, motion),
            LawLanes::Foundation(law) => law.approach(motion, penetration),
        };
        self.surface_mut().follow_approach(approach, penetration);
    }

    /// Replaces a lane by a joint with the same law and its bore.
    pub(crate) fn set(&mut self, lane: usize, contact: &Contact, profile: &Profile) {
        contact.surface().write_lane::<R>(lane, self.surface_mut());
        match (self, contact) {
            (LawLanes::LocalHertz(_, bores), _) => bores.set(lane, profile),
            (LawLanes::Foundation(to), Contact::Foundation(from)) => {
                from.modulus.write_lane::<R>(lane, &mut to.modulus);
                to.arc.0[lane] = (from.arc.clone(), RefCell::new(ArcCell::NONE));
            }
            (LawLanes::Foundation(_), Contact::LocalHertz(_)) => {}
        }
    }

    /// Leaves a lane idle: its bore takes no time until [`Self::set`] replaces it.
    pub(crate) fn leave_idle(&mut self, lane: usize) {
        if let LawLanes::Foundation(law) = self {
            law.arc.0[lane] = (Arc::out_of_reach(), RefCell::new(ArcCell::NONE));
        }
    }

    /// Bore at the place of a contact; zeros under [`Foundation`], whose arcs look it up themselves.
    #[inline(always)]
    pub(crate) fn wall(&self, place: &PolarEccentricity<R>) -> Radius<R> {
        match self {
            LawLanes::LocalHertz(_, bores) => bores.radius_at(place.psi),
            LawLanes::Foundation(_) => {
                let nothing = place.psi.zero();
                Radius { r: nothing, d1: nothing, d2: nothing }
            }
        }
    }

    /// Force on the journal at this place of the contact and this bore; with `JACOBIAN` its exact derivative, else no slopes.
    #[inline(always)]
    pub(crate) fn force<const JACOBIAN: bool>(
        &self,
        (place, wall): (&PolarEccentricity<R>, &Radius<R>),
        motion: &JointMotion<R>,
    ) -> (JointForce<R>, ForceSlopes<R>) {
        match self {
            LawLanes::LocalHertz(law, _) => law.force::<JACOBIAN>(place, wall, motion),
            LawLanes::Foundation(law) => law.force::<JACOBIAN>(motion),
        }
    }
}

impl<R: Real> Arcs<R> for ArcLanes {
    #[inline(always)]
    fn integrate(&self, e: [R; 2]) -> Integrals<R> {
        let nothing = e[0].zero();
        let mut all = Integrals { v: nothing, p: [nothing; 2], d: [nothing; 3] };
        for lane in 0..R::LANES {
            let (arc, cell) = &self.0[lane];
            let one = cell.borrow_mut().integrate(arc, [e[0].lane(lane), e[1].lane(lane)]);
            all.v.set_lane(lane, one.v);
            for k in 0..2 {
                all.p[k].set_lane(lane, one.p[k]);
            }
            for k in 0..3 {
                all.d[k].set_lane(lane, one.d[k]);
            }
        }
        all
    }

    #[inline(always)]
    fn nearest_free(&self, e: [R; 2], penetration: R) -> [R; 2] {
        let mut out = [e[0].zero(); 2];
        for lane in 0..R::LANES {
            let one = self.0[lane].0.nearest_free([e[0].lane(lane), e[1].lane(lane)], penetration.lane(lane));
            out[0].set_lane(lane, one[0]);
            out[1].set_lane(lane, one[1]);
        }
        out
    }

    #[inline(always)]
    fn free_penetration(&self, e: [R; 2], touches: R) -> R {
        let mut out = e[0].zero();
        for lane in 0..R::LANES {
            if touches.lane(lane) <= 0.0 {
                out.set_lane(lane, self.0[lane].0.free_penetration([e[0].lane(lane), e[1].lane(lane)]));
            }
        }
        out
    }
}
