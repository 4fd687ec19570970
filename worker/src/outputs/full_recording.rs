//! Forces of all joints over a cycle: their peaks and free flight, and if the cycle is displayed their histories, the motion of all
//! bodies and the energy.

use super::ForceTrack;
use super::displayed_motion::{DisplayedMotion, PowerState};
use crate::contact::{GuideReaction, JointForce};
use crate::integrate::Linearised;
use crate::mechanism::Island;

/// Recording of all joints of one island over a cycle.
#[derive(Debug, Clone, Default)]
pub struct FullRecording {
    /// One track per joint: those with clearance, the guides, then the ideal ones.
    pub forces: Vec<ForceTrack>,
    /// Time of the last state [s].
    last: Option<f64>,
    /// Everything else, if the cycle is displayed.
    pub displayed: Option<DisplayedMotion>,
}

impl FullRecording {
    /// An empty recording for the joints of an island, of a cycle that is displayed at the times `shown` [s] or not at all.
    pub(crate) fn new(island: &Island, shown: Option<Vec<f64>>) -> Self {
        let joints = island.all_joints().count();
        FullRecording {
            forces: vec![ForceTrack::default(); joints],
            last: None,
            displayed: shown.map(DisplayedMotion::new),
        }
    }

    /// Adds an accepted state at time `t` [s], at which the island was last linearised.
    pub(crate) fn push(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        let half = self.last.replace(t).map_or(0.0, |last| 0.5 * (t - last));
        let joint = |j: &JointForce| (libm::hypot(j.force[0], j.force[1]), j.normal > 0.0);
        let guide = |guide: &GuideReaction| (guide.force(), guide.deepest() > 0.0);
        let forces = || {
            let contacts = at.joints.iter().map(joint).chain(at.guides.iter().map(guide));
            contacts.chain(island.ideal_forces(at).map(|force| (force, true)))
        };
        for (track, (force, touches)) in self.forces.iter_mut().zip(forces()) {
            track.push(force, touches, half);
        }
        if let Some(motion) = &mut self.displayed {
            motion.push(t, [q, v], forces().map(|(force, _)| force), power_state(island, t, v, at));
        }
    }

    /// Closes the recording at the end of the cycle.
    pub(crate) fn finish(&mut self) {
        self.displayed.iter_mut().for_each(DisplayedMotion::finish);
    }
}

/// Energies and powers of an island at the state it was last linearised at.
fn power_state(island: &Island, t: f64, v: &[f64], at: &Linearised) -> PowerState {
    let loads = island.load_power(t, v);
    let drives: f64 =
        at.prescribed.iter().zip(island.prescribed_speeds()).map(|(f, omega)| -f[2] * omega).sum();
    let mut now = PowerState {
        stored: loads.stored,
        input: drives + island.driving_power(at) + loads.driving,
        lost: loads.lost,
        unphysical: 0.0,
    };
    now.lost += at.friction.iter().map(|[force, speed]| force * speed).sum::<f64>();
    for (k, force) in at.joints.iter().enumerate() {
        let joint = &island.joints[k];
        let energy = joint.contact.energy(joint.surfaces(), &island.joint_motion(k), force);
        now.stored += energy.stored;
        now.lost += energy.friction + energy.damping + energy.film;
        now.unphysical += energy.unphysical;
    }
    for guide in &at.guides {
        now.stored += guide.stored;
        now.lost += guide.lost;
    }
    now
}
