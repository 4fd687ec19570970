//! Watches one island over a cycle: bodies whose speed is asked for, contact history for the wear, forces for
//! those who want to see them.

use super::{BodyTrack, ForceTrack};
use crate::contact::JointForce;
use crate::integrate::{Linearised, Watch};
use crate::mechanism::Island;
use crate::wear::ContactHistory;

/// Records a cycle of one island.
#[derive(Debug, Clone)]
pub struct Recorder {
    /// One track per tracked body.
    pub tracks: Vec<BodyTrack>,
    /// One history per joint with clearance.
    pub histories: Vec<ContactHistory>,
    /// One track per joint with clearance, if forces are wanted.
    pub forces: Option<Vec<ForceTrack>>,
    slots: Vec<usize>,
    inertia: Vec<f64>,
    last: Option<(f64, Vec<JointForce>, Vec<[f64; 2]>)>,
}

impl Recorder {
    /// For an island, tracking the bodies in these slots; the contact history is cut into `samples` stretches
    /// per cycle of `period` [s].
    pub fn new(island: &Island, slots: Vec<usize>, period: f64, samples: usize) -> Self {
        use crate::integrate::Dynamics;
        Recorder {
            tracks: vec![BodyTrack::default(); slots.len()],
            histories: vec![ContactHistory::new(period, samples); island.joints.len()],
            forces: None,
            inertia: slots.iter().map(|s| island.mass()[3 * s + 2]).collect(),
            slots,
            last: None,
        }
    }

    /// Track of a body of the scene, if it is in this island and tracked.
    pub fn track_of(&self, island: &Island, body: usize) -> Option<&BodyTrack> {
        let index = self.slots.iter().position(|&s| island.bodies[s] == body)?;
        Some(&self.tracks[index])
    }

    /// Starts a new cycle.
    pub fn clear(&mut self) {
        self.tracks.iter_mut().for_each(BodyTrack::clear);
        self.histories.iter_mut().for_each(ContactHistory::clear);
        if let Some(forces) = &mut self.forces {
            forces.iter_mut().for_each(|f| *f = ForceTrack::default());
        }
        self.last = None;
    }

    /// Ends the cycle.
    pub fn finish(&mut self) {
        self.histories.iter_mut().for_each(ContactHistory::close_stretch);
    }
}

impl Watch<Island> for Recorder {
    fn state(&mut self, _island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        // The second half of a cycle begins where the first ended: that instant is seen twice.
        if self.last.as_ref().is_some_and(|(time, ..)| *time == t) {
            return;
        }
        for ((track, slot), inertia) in self.tracks.iter_mut().zip(&self.slots).zip(&self.inertia) {
            let k = 3 * slot + 2;
            track.push(t, q[k], v[k], at.f[k] / inertia);
        }
        if let Some((time, joints, e)) = &mut self.last {
            // Trapezoidal rule: each end of the step stands for half of it.
            let half = 0.5 * (t - *time);
            for (j, history) in self.histories.iter_mut().enumerate() {
                history.push(half, e[j], &joints[j]);
                history.push(half, at.e[j], &at.joints[j]);
                if let Some(forces) = &mut self.forces {
                    for joint in [&joints[j], &at.joints[j]] {
                        forces[j].free += if joint.normal > 0.0 { 0.0 } else { half };
                    }
                }
            }
            *time = t;
            joints.copy_from_slice(&at.joints);
            e.copy_from_slice(&at.e);
        } else {
            self.last = Some((t, at.joints.clone(), at.e.clone()));
        }
        if let Some(forces) = &mut self.forces {
            for (track, joint) in forces.iter_mut().zip(&at.joints) {
                track.time.push(t);
                track.force.push(libm::hypot(joint.force[0], joint.force[1]));
            }
        }
    }
}
