//! Watches one island over a cycle: contact history for the wear, what the scene's outputs ask for, and everything
//! for those who want to see it.

use super::{BodyTrack, MomentTrack, PointTrack, Shown, Wanted};
use crate::contact::JointForce;
use crate::integrate::{Dynamics, Linearised, Watch};
use crate::mechanism::{End, Frame, Island};
use crate::wear::ContactHistory;
use common::scene::{Attachment, Scene};

/// Records a cycle of one island.
#[derive(Debug, Clone)]
pub struct Recorder {
    /// One history per joint with clearance.
    pub histories: Vec<ContactHistory>,
    /// Everything, if it is to be shown.
    pub shown: Option<Shown>,
    /// Bodies whose motion is asked for: slot, moment of inertia, track.
    bodies: Vec<(usize, f64, BodyTrack)>,
    /// Points whose path is asked for.
    points: Vec<(Attachment, End, PointTrack)>,
    /// Driven bodies whose torque is asked for, by index into the bodies the island touches.
    moments: Vec<(usize, MomentTrack)>,
    /// Largest force so far of each joint, those with clearance first, if asked for [N].
    peaks: Option<Vec<f64>>,
    last: Option<(f64, Vec<JointForce>, Vec<[f64; 2]>)>,
}

impl Recorder {
    /// For an island and what is wanted of it; the contact history is cut into `samples` stretches per cycle.
    pub fn new(island: &Island, scene: &Scene, wanted: &Wanted, samples: usize) -> Self {
        let slots = |bodies: &[usize]| -> Vec<usize> {
            (0..island.bodies.len()).filter(|&s| bodies.contains(&island.bodies[s])).collect()
        };
        let point = |place: &Attachment| {
            let frame = island.bodies.iter().position(|&b| b == place.body)?;
            Some((*place, End { frame, arm: scene.arm(place) }, PointTrack::default()))
        };
        let touched = (0..island.touched.len()).filter(|&k| wanted.driven.contains(&island.touched[k]));
        let joints = island.joints.len() + island.constraints().len();
        Recorder {
            histories: vec![ContactHistory::new(scene.life.period, samples); island.joints.len()],
            shown: None,
            bodies: slots(&wanted.bodies)
                .into_iter()
                .map(|s| (s, island.mass()[3 * s + 2], BodyTrack::default()))
                .collect(),
            points: wanted.points.iter().filter_map(point).collect(),
            moments: touched.map(|k| (k, MomentTrack::default())).collect(),
            peaks: wanted.peaks.then(|| vec![0.0; joints]),
            last: None,
        }
    }

    /// Track of a body of the scene, if it is in this island and asked for.
    pub fn body(&self, island: &Island, body: usize) -> Option<&BodyTrack> {
        self.bodies.iter().find(|(slot, ..)| island.bodies[*slot] == body).map(|(.., track)| track)
    }

    /// Path of a point, if it is on this island and asked for.
    pub fn point(&self, at: &Attachment) -> Option<&PointTrack> {
        self.points.iter().find(|(place, ..)| place == at).map(|(.., track)| track)
    }

    /// Moment of this island on a driven body of the scene, if it touches that and it is asked for.
    pub fn moment(&self, island: &Island, body: usize) -> Option<&MomentTrack> {
        self.moments.iter().find(|(k, _)| island.touched[*k] == body).map(|(_, track)| track)
    }

    /// Largest force of a joint of the scene over the cycle, if it is in this island and asked for [N].
    pub fn peak(&self, island: &Island, joint: usize) -> Option<f64> {
        let contacts = island.joints.iter().map(|j| j.scene_joint);
        let all = contacts.chain(island.constraints().iter().map(|c| c.scene_joint));
        let peaks = self.peaks.as_ref()?;
        all.zip(peaks).find(|(scene_joint, _)| *scene_joint == joint).map(|(_, peak)| *peak)
    }

    /// Starts a new cycle.
    pub fn clear(&mut self) {
        self.histories.iter_mut().for_each(ContactHistory::clear);
        self.bodies.iter_mut().for_each(|(.., track)| track.clear());
        self.points.iter_mut().for_each(|(.., track)| track.clear());
        self.moments.iter_mut().for_each(|(_, track)| track.clear());
        if let Some(peaks) = &mut self.peaks {
            peaks.fill(0.0);
        }
        self.last = None;
    }

    /// Ends the cycle.
    pub fn finish(&mut self) {
        self.histories.iter_mut().for_each(ContactHistory::close_stretch);
    }
}

impl Watch<Island> for Recorder {
    fn state(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        // The second half of a cycle begins where the first ended: that instant is seen twice.
        if self.last.as_ref().is_some_and(|(time, ..)| *time == t) {
            return;
        }
        for (slot, inertia, track) in &mut self.bodies {
            let k = 3 * *slot + 2;
            track.push(t, q[k], v[k], at.f[k] / *inertia);
        }
        for (_, End { frame, arm }, track) in &mut self.points {
            let k = 3 * *frame..3 * *frame + 3;
            let frame = Frame::free(&q[k.clone()], &v[k]);
            track.push(t, frame.point(*arm), frame.velocity(*arm));
        }
        for (touched, track) in &mut self.moments {
            track.push(t, at.prescribed[*touched][2]);
        }
        if let Some(peaks) = &mut self.peaks {
            let contacts = at.joints.iter().map(|j| libm::hypot(j.force[0], j.force[1]));
            for (peak, force) in peaks.iter_mut().zip(contacts.chain(island.ideal_forces(at))) {
                *peak = peak.max(force);
            }
        }
        if let Some(shown) = &mut self.shown {
            shown.push(island, t, q, v, at);
        }
        if let Some((time, joints, e)) = &mut self.last {
            // Trapezoidal rule: each end of the step stands for half of it.
            let half = 0.5 * (t - *time);
            for (j, history) in self.histories.iter_mut().enumerate() {
                history.push(half, e[j], &joints[j]);
                history.push(half, at.e[j], &at.joints[j]);
            }
            *time = t;
            joints.copy_from_slice(&at.joints);
            e.copy_from_slice(&at.e);
        } else {
            self.last = Some((t, at.joints.clone(), at.e.clone()));
        }
    }
}
