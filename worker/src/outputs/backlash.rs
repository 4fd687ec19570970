//! Backlash: how far a body can be turned, or a point of it moved, while the drives are held.
//!
//! The lost motion of the output between a small load in one and in the other direction, in the limit of a load of nothing: the mechanism
//! takes every position in which all journals are within their worn bores. To first order in the clearances the coordinate y moves by the sum of
//! lambda_k . e_k over the joints (`mechanism/influence.rs`), and each eccentricity e_k takes any value in its convex free region
//! (`contact/free_region.rs`), so that
//!
//!   backlash = sum over k of |lambda_k| (H_k(a_k) + H_k(a_k + pi)) + play of the guides,
//!
//! with the angle a_k [rad] of lambda_k in the frame of the bushing and the farthest way H_k [m] of the journal there: 2 c |lambda_k| for each
//! unworn joint of clearance c. A lever of length r on one such hinge has 2 c / r. It is that of the drives held at one angle, or the largest
//! over the cycle. The elastic deflection under a load, which the contact law adds, and friction are not part of it.
//!
//! # Source
//! Displacement by clearances from virtual work: Innocenti (2002), J. Mech. Design 124, 52-57. Derived here for worn bores.

use super::RecordedCycle;
use crate::contact::FreeRegion;
use crate::mechanism::{Influence, WearingGuide, WearingJoint};
use common::scene::OutputKind;

/// The outputs `backlash` [rad] and `position-backlash` [m].
pub(super) fn backlash(sought: &OutputKind, cycle: &RecordedCycle) -> f64 {
    let joints: Vec<&WearingJoint> = cycle.islands.iter().flat_map(|(island, _)| &island.joints).collect();
    let guides: Vec<&WearingGuide> = cycle.islands.iter().flat_map(|(island, _)| &island.guides).collect();
    let mut regions: Vec<Option<FreeRegion>> = joints.iter().map(|joint| round_journal(joint)).collect();
    let mut in_pose = |influence: &Influence| {
        let play = influence.joints.iter().map(|(scene_joint, lambda, turn)| {
            let Some(k) = joints.iter().position(|joint| joint.scene_joint == *scene_joint) else {
                return 0.0;
            };
            // A worn journal leaves another region at every angle.
            regions[k].get_or_insert_with(|| free_region(joints[k], *turn));
            let region = &mut regions[k];
            let width = region.as_ref().map_or(0.0, |region| region.width(*lambda));
            if joints[k].journal.is_some() {
                *region = None;
            }
            width
        });
        let of_worn_guides = influence.worn_guides.iter().map(|(scene_joint, lambda, s)| {
            let guide = guides.iter().find(|guide| guide.flat.scene_joint == *scene_joint);
            guide.and_then(|guide| guide.play(*lambda, *s)).unwrap_or(0.0)
        });
        play.sum::<f64>() + influence.guides + of_worn_guides.sum::<f64>()
    };
    cycle.ideal.influences(sought).iter().map(&mut in_pose).fold(0.0, f64::max)
}

/// The free region of a joint whose journal stays round, else `None`.
fn round_journal(joint: &WearingJoint) -> Option<FreeRegion<'_>> {
    joint.journal.is_none().then(|| free_region(joint, 0.0))
}

/// The free region of a joint with its journal turned by `turn` [rad] in the bushing.
fn free_region(joint: &WearingJoint, turn: f64) -> FreeRegion<'_> {
    FreeRegion::new(joint.surfaces(), joint.contact.surface().journal_radius, turn)
}
