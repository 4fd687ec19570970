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
//!
//! # Driving torque
//! The torque that a driven body needs, from the moments that joints and loads exert on it.
//!
//! With the moments M_k of the islands on the body and the moment M_e of the loads on it alone, a body of mass m [kg], inertia I
//! [kg m^2] about its centre of mass, and centre of mass c [m] from its axis needs the torque [N m]
//!
//!   T = (I + m |c|^2) alpha - m (c x g) - M_e - sum M_k,
//!
//! alpha [rad/s^2] being its angular acceleration and g [m/s^2] the gravity. The output is the largest |T| over the cycle.
//!
//! Source:
//! Balance of angular momentum about a fixed axis: Goldstein, Poole, Safko, Classical Mechanics (2002), chapter 5.

use super::{MomentTrack, RecordedCycle, SoughtBacklash, sample_times};
use crate::contact::FreeRegion;
use crate::mechanism::{ExternalLoads, Influence, Prescribed, WearingGuide, WearingJoint};
use common::scene::Motion;

/// The outputs `backlash` [rad] and `position-backlash` [m].
pub(super) fn backlash(sought: &SoughtBacklash, cycle: &RecordedCycle) -> f64 {
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

/// The output `driving-torque` [N m] of a driven body of the scene.
pub(super) fn driving_torque(body: usize, cycle: &RecordedCycle) -> f64 {
    let scene = cycle.scene;
    let driven = &scene.bodies[body];
    let Some(motion) = Prescribed::from_body(driven) else { return 0.0 };
    let outer = ExternalLoads::new(scene, body);
    let inertia = match &driven.motion {
        Motion::Driven { inertia, .. } => *inertia,
        _ => None,
    };
    let own = |t: f64| {
        let inertial = inertia.map_or(0.0, |driven| {
            let [x, y] = driven.centre_of_mass;
            let inertial = (driven.inertia + driven.mass * (x * x + y * y)) * motion.jet(t)[2];
            if [x, y] == [0.0; 2] || scene.gravity == [0.0; 2] {
                return inertial;
            }
            let centre = motion.frame(t).turn([x, y]);
            let weight = driven.mass * (centre[0] * scene.gravity[1] - centre[1] * scene.gravity[0]);
            inertial - weight
        });
        inertial - outer.moment(t)
    };
    largest_torque(&cycle.moments(body), &sample_times(scene), own)
}

/// max over t of |own(t) - sum of the moments|, where `own` [N m] is the torque that the body needs without them. Evaluated at the
/// times of all moments and at `times` [s].
fn largest_torque(moments: &[&MomentTrack], times: &[f64], own: impl Fn(f64) -> f64) -> f64 {
    let known = moments.iter().flat_map(|m| &m.time);
    // A recording may begin after the start of the cycle.
    let start = moments.iter().filter_map(|m| m.time.first()).fold(f64::NEG_INFINITY, |a, &t| a.max(t));
    known.chain(times).filter(|&&t| t >= start).fold(0.0, |largest: f64, &t| {
        let moment: f64 = moments.iter().map(|m| m.moment_at(t)).sum();
        largest.max((own(t) - moment).abs())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_two_islands_add_up_at_the_times_of_both() {
        let track = |times: &[f64], f: fn(f64) -> f64| MomentTrack {
            time: times.to_vec(),
            values: [times.iter().map(|&t| f(t)).collect()],
        };
        let (a, b) = (track(&[0.0, 0.5, 1.0], |t| 2.0 * t), track(&[0.0, 0.3, 1.0], |t| 1.0 - t));
        // -(2 t + 1 - t) + 0.5 has its largest size at t = 1: 1.5.
        assert!((largest_torque(&[&a, &b], &[], |_| 0.5) - 1.5).abs() < 1e-15);
        assert_eq!(largest_torque(&[], &[0.0, 2.0], |t| -t), 2.0);
    }
}
