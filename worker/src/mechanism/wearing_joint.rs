//! A joint with clearance of an island, with its contact law and its surfaces as worn so far.
//!
//! # Wearing pair
//! Two surfaces of a joint that wear each other: bushing and journal, or guide and slider.

use super::frame::End;
use super::joint::Touching;
use crate::bore::Profile;
use crate::contact::{Contact, JointMotion, Journal, LawLanes, PolarEccentricity, Surfaces, Walls};
use crate::wear::{BoreWearRate, ContactHistory, FinerBore, StepTolerance, WearHistory, WearRate};
use common::scene::{Clearance, WearDistribution, WearModel};

/// A joint with clearance and its surfaces.
#[derive(Debug, Clone)]
pub struct WearingJoint {
    /// Index into the scene's joints.
    pub scene_joint: usize,
    /// Contact law of the joint.
    pub contact: Contact,
    /// The law on the surfaces as worn so far, whose forces are those of a joint in lanes to the last bit.
    law: LawLanes<f64>,
    /// Profile of the bore, worn so far.
    pub profile: Profile,
    /// The journal, worn so far; `None` if it does not wear.
    pub journal: Option<Journal>,
    /// Wear coefficient K_H of bushing and journal, zero for a surface that does not wear `(2,)` [1/Pa].
    pub wear_coefficients: [f64; 2],
    /// How the wear of a contact arc is distributed over the control points.
    pub distribution: WearDistribution,
    /// Width L of the bushing [m].
    pub width: f64,
    /// Ends of the joint: journal, bushing.
    pub ends: [End; 2],
}

impl WearingJoint {
    /// Joint number `scene_joint` of a checked scene with this wear model, unworn.
    pub(super) fn new(
        scene_joint: usize,
        (clearance, wear): (&Clearance, &WearModel),
        ends: [End; 2],
    ) -> Self {
        let contact = Contact::new(clearance);
        let wear_coefficients = clearance.wear_coefficients();
        let points = clearance.control_points.number();
        let profile = Profile::round(clearance.bushing_radius, points).with_spline(wear.spline);
        let journal = (wear_coefficients[1] > 0.0).then(|| contact.new_journal(points));
        WearingJoint {
            scene_joint,
            law: LawLanes::new(&contact, Surfaces { bore: &profile, journal: journal.as_ref() }, 0.0),
            contact,
            profile,
            journal,
            wear_coefficients,
            distribution: wear.distribution,
            width: clearance.width,
            ends,
        }
    }

    /// The two surfaces as worn so far.
    #[inline(always)]
    pub(crate) fn surfaces(&self) -> Surfaces<'_> {
        Surfaces { bore: &self.profile, journal: self.journal.as_ref() }
    }

    /// Called after each accepted step with the joint's place and motion and its penetration [m] there: a law with memory takes the speed
    /// of approach in free flight.
    pub(super) fn follow_approach(
        &mut self,
        at: (&PolarEccentricity<f64>, &Walls<f64>),
        motion: &JointMotion,
        penetration: f64,
    ) {
        self.law.follow_approach(at, motion, penetration);
        self.contact.set_damping(self.law.surface().damping);
    }

    /// Penetration by the law on the surfaces as worn so far, at the eccentricity `e` in the bushing's frame `(2,)` [m] and the angle `turn` of
    /// the journal's body from the bushing's [rad]; negative in free flight [m].
    pub(crate) fn penetration(&self, e: [f64; 2], turn: f64) -> f64 {
        let place = PolarEccentricity::new(e);
        let walls = self.law.walls(&place, turn);
        let motion = JointMotion { e, w: [0.0; 2], omega_journal: 0.0, omega_bushing: 0.0, turn };
        self.law.force::<false>((&place, &walls), &motion).0.penetration
    }

    /// Wear rate of the joint with a bore like `profile`.
    fn rate_on(&self, profile: &Profile) -> WearRate {
        let WearingJoint { wear_coefficients, width, contact, distribution, .. } = self;
        let rate = BoreWearRate::new(*wear_coefficients, *width, contact, profile);
        WearRate::Bore(Box::new(rate.distributed(*distribution)))
    }

    /// Replaces the damping factor [s/m], as fixed at the last impact.
    pub(crate) fn set_damping(&mut self, damping: f64) {
        self.contact.set_damping(damping);
        self.law.set_damping(damping);
    }
}

impl WearingPair for WearingJoint {
    fn scene_joint(&self) -> usize {
        self.scene_joint
    }

    fn wear_coefficients(&self) -> [f64; 2] {
        self.wear_coefficients
    }

    fn first_depths(&self) -> usize {
        self.profile.points()
    }

    fn depths(&self) -> usize {
        self.profile.points() * if self.journal.is_some() { 2 } else { 1 }
    }

    fn set_depth(&mut self, depth: &[f64]) {
        let (bore, of_journal) = depth.split_at(self.profile.points());
        self.profile.set_depth(bore);
        self.contact.profile_changed(&self.profile);
        if let Some(journal) = &mut self.journal {
            journal.set_depth(of_journal);
        }
        let WearingJoint { contact, profile, journal, law, .. } = self;
        law.set(0, contact, Surfaces { bore: profile, journal: journal.as_ref() });
    }

    fn refine(&mut self, times: u32) -> bool {
        let points = self.profile.points() << times;
        self.contact = self.contact.with_points(points);
        self.profile = self.profile.unworn(points);
        self.journal = self.journal.is_some().then(|| self.contact.new_journal(points));
        self.law = LawLanes::new(&self.contact, self.surfaces(), 0.0);
        true
    }

    fn empty_history(&self, period: f64, samples: usize) -> WearHistory {
        WearHistory::Bore(ContactHistory::new(period, samples, self.journal.is_some()))
    }

    fn wear_rate(&self) -> WearRate {
        self.rate_on(&self.profile)
    }

    fn finer_copy(&self, tolerance: StepTolerance) -> FinerBore<WearRate> {
        let finer = self.profile.unworn(2 * self.profile.points());
        FinerBore::new(self.rate_on(&finer), 2 * self.depths(), tolerance)
    }
}

impl Touching<f64> for WearingJoint {
    fn parts(&self) -> ([End; 2], &LawLanes<f64>) {
        (self.ends, &self.law)
    }
}

/// A pair of surfaces with their wear depths: those of the first surface, then those of the second if it wears.
pub(crate) trait WearingPair {
    /// Index into the scene's joints.
    fn scene_joint(&self) -> usize;

    /// Wear coefficients K_H, zero for a surface that does not wear `(2,)` [1/Pa].
    fn wear_coefficients(&self) -> [f64; 2];

    /// Number of depths of the first surface.
    fn first_depths(&self) -> usize;

    /// Number of all depths.
    fn depths(&self) -> usize;

    /// Replaces the wear depths by `depth` `(depths,)` [m].
    fn set_depth(&mut self, depth: &[f64]);

    /// Halves the distance between control points this many `times`, if its forces can be computed on that number; the surfaces are unworn
    /// then. True if they can.
    fn refine(&mut self, times: u32) -> bool;

    /// An empty history of its contacts, which cuts a cycle of `period` [s] into about `samples` intervals.
    fn empty_history(&self, period: f64, samples: usize) -> WearHistory;

    /// Wear rate of the surfaces, as worn so far.
    fn wear_rate(&self) -> WearRate;

    /// Unworn copy with twice as many control points, whose wear steps follow from the `rule` of those of this pair.
    fn finer_copy(&self, tolerance: StepTolerance) -> FinerBore<WearRate>;

    /// True if one of the surfaces wears.
    fn wears(&self) -> bool {
        self.wear_coefficients().iter().any(|coefficient| *coefficient > 0.0)
    }
}
