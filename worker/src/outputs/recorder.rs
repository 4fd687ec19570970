//! Recording of one island over a cycle: contact histories for the wear, what the outputs request, and everything if the
//! cycle is displayed.

use super::impact_count::ImpactCount;
use super::moment_track::MomentTrack;
use super::peaks::Peaks;
use super::{BodyTrack, FullRecording, PointTrack, RecordingRequest};
use crate::integrate::{Dynamics, Linearised, StateObserver};
use crate::mechanism::{End, Frame, Island};
use crate::wear::{ContactHistory, ContactInstant};
use common::scene::{Attachment, Scene};

/// Records a cycle of one island.
#[derive(Debug, Clone)]
pub struct Recorder {
    /// Contact history of each joint with clearance `(joints,)`.
    pub histories: Vec<ContactHistory>,
    /// Forces of all joints, and everything if the cycle is displayed.
    pub full: Option<FullRecording>,
    /// Requested bodies: index into the bodies of the island, moment of inertia [kg m^2], motion.
    bodies: Vec<(usize, f64, BodyTrack)>,
    /// Requested points with their place on the island, and their paths.
    points: Vec<(Attachment, End, PointTrack)>,
    /// Requested driven bodies: index into the prescribed bodies that the island touches, moment on them.
    moments: Vec<(usize, MomentTrack)>,
    /// Largest accelerations and impacts so far.
    peaks: Peaks,
    /// Largest force so far of each joint, those with clearance first, if requested [N].
    peak_forces: Option<Vec<f64>>,
    /// Time [s] and contacts of the last state `(joints,)`.
    pub(super) last: Option<(f64, Vec<ContactInstant>)>,
}

impl Recorder {
    /// A recorder of what is `requested` of an island; contact histories are cut into `samples` intervals per cycle.
    pub(crate) fn new(island: &Island, scene: &Scene, requested: &RecordingRequest, samples: usize) -> Self {
        let slots = |bodies: &[usize]| -> Vec<usize> {
            (0..island.bodies.len()).filter(|&s| bodies.contains(&island.bodies[s])).collect()
        };
        let point = |place: &Attachment| {
            let frame = island.bodies.iter().position(|&b| b == place.body)?;
            Some((*place, End { frame, arm: scene.arm(place) }, PointTrack::default()))
        };
        let touched = (0..island.touched.len()).filter(|&k| requested.driven.contains(&island.touched[k]));
        let joints = island.joints.len() + island.constraints().len();
        Recorder {
            histories: island
                .joints
                .iter()
                .map(|joint| ContactHistory::new(scene.life.period, samples, joint.journal.is_some()))
                .collect(),
            full: None,
            bodies: slots(&requested.bodies)
                .into_iter()
                .map(|s| (s, island.mass()[3 * s + 2], BodyTrack::default()))
                .collect(),
            points: requested.points.iter().filter_map(point).collect(),
            moments: touched.map(|k| (k, MomentTrack::default())).collect(),
            peaks: Peaks::new(island, scene, requested),
            peak_forces: requested.peak_forces.then(|| vec![0.0; joints]),
            last: None,
        }
    }

    /// Motion of a body of the scene, if it is in this island and requested.
    pub(crate) fn body(&self, island: &Island, body: usize) -> Option<&BodyTrack> {
        self.bodies.iter().find(|(slot, ..)| island.bodies[*slot] == body).map(|(.., track)| track)
    }

    /// Path of a point, if it is on this island and requested.
    pub(crate) fn point(&self, at: &Attachment) -> Option<&PointTrack> {
        self.points.iter().find(|(place, ..)| place == at).map(|(.., track)| track)
    }

    /// Moment of this island on a driven body of the scene, if the island touches that body and it is requested.
    pub(crate) fn moment(&self, island: &Island, body: usize) -> Option<&MomentTrack> {
        self.moments.iter().find(|(k, _)| island.touched[*k] == body).map(|(_, track)| track)
    }

    /// Largest force of a joint of the scene over the cycle, if it is in this island and requested [N].
    pub(crate) fn peak_force(&self, island: &Island, joint: usize) -> Option<f64> {
        let contacts = island.joints.iter().map(|j| j.scene_joint);
        let all = contacts.chain(island.constraints().iter().map(|c| c.scene_joint));
        let peaks = self.peak_forces.as_ref()?;
        all.zip(peaks).find(|(scene_joint, _)| *scene_joint == joint).map(|(_, peak)| *peak)
    }

    /// Largest acceleration of a point over the cycle, if it is on this island and requested [m/s^2].
    pub(crate) fn peak_acceleration(&self, at: &Attachment) -> Option<f64> {
        self.peaks.acceleration(at)
    }

    /// Largest angular acceleration of a body of the scene over the cycle, if it is in this island and requested [rad/s^2].
    pub(crate) fn peak_angular_acceleration(&self, body: usize) -> Option<f64> {
        self.peaks.angular_acceleration(body)
    }

    /// Impacts of a joint of the scene over the cycle, if it is in this island and they are requested.
    pub(crate) fn impacts(&self, island: &Island, joint: usize) -> Option<ImpactCount> {
        self.peaks.impacts(island, joint)
    }

    /// Removes the recording, for a new cycle.
    pub(crate) fn clear(&mut self) {
        self.histories.iter_mut().for_each(ContactHistory::clear);
        self.bodies.iter_mut().for_each(|(.., track)| track.clear());
        self.points.iter_mut().for_each(|(.., track)| track.clear());
        self.moments.iter_mut().for_each(|(_, track)| track.clear());
        if let Some(peaks) = &mut self.peak_forces {
            peaks.fill(0.0);
        }
        self.peaks.clear();
        self.last = None;
    }

    /// Closes the recording at the end of the cycle.
    pub(crate) fn finish(&mut self) {
        self.histories.iter_mut().for_each(ContactHistory::close_stretch);
    }
}

impl Recorder {
    /// True if a state at this time [s] was the last one recorded: the second half of a cycle begins at the end of the first, and that
    /// instant is observed twice.
    pub(crate) fn has_recorded(&self, t: f64) -> bool {
        self.last.as_ref().is_some_and(|(time, _)| *time == t)
    }

    /// True if [`Self::record_motion`] reads the forces of the joints and those on prescribed bodies.
    pub(crate) fn needs_joint_forces(&self) -> bool {
        self.full.is_some()
            || self.peak_forces.is_some()
            || !self.moments.is_empty()
            || self.peaks.needs_joint_forces()
    }

    /// Records everything of a state but the contacts.
    pub(crate) fn record_motion(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
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
        if let Some(peaks) = &mut self.peak_forces {
            let contacts = at.joints.iter().map(|j| libm::hypot(j.force[0], j.force[1]));
            for (peak, force) in peaks.iter_mut().zip(contacts.chain(island.ideal_forces(at))) {
                *peak = peak.max(force);
            }
        }
        self.peaks.push(island, t, q, v, at);
        if let Some(full) = &mut self.full {
            full.push(island, t, q, v, at);
        }
    }

    /// Adds the contacts of a state to the histories.
    fn record_contacts(&mut self, t: f64, at: &Linearised) {
        let turned = at.e.iter().zip(&at.joints).zip(&at.turns);
        let now = turned.map(|((e, joint), turn)| ContactInstant::new(*e, joint).turned(*turn));
        let Some((time, before)) = &mut self.last else {
            self.last = Some((t, now.collect()));
            return;
        };
        // Trapezoidal rule: each end of the step stands for half of it.
        let half = 0.5 * (t - *time);
        for ((history, before), now) in self.histories.iter_mut().zip(before).zip(now) {
            history.push(half, before);
            history.push(half, &now);
            *before = now;
        }
        *time = t;
    }
}

impl StateObserver<Island> for Recorder {
    fn observe(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        if !self.has_recorded(t) {
            self.record_motion(island, t, q, v, at);
            self.record_contacts(t, at);
        }
    }
}
