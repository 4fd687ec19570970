//! Recording of one island over a cycle: contact histories for the wear, what the outputs request, and everything if the
//! cycle is displayed.

use super::peaks::{Largest, Peaks, push_largest};
use super::{BodyTrack, FullRecording, MomentTrack, MotionRows, PointTrack, RecordingRequest};
use crate::contact::GuideReaction;
use crate::integrate::{Dynamics, Linearised, StateObserver};
use crate::lanes::Real;
use crate::mechanism::{End, Frame, Island};
use crate::wear::{ContactInstant, RailInstant, WearHistory};
use common::scene::{Attachment, Scene};

/// Start of a cycle, as a share of it [1], in which a transient may hide what the rest of the cycle shows.
const START: f64 = 0.25;

/// Contacts of the last state, which is added to the histories when the length of the step after it is known.
#[derive(Debug, Clone)]
pub(super) struct LastContacts {
    /// Time of the state [s].
    pub time: f64,
    /// Half of the step before it [s].
    pub half: f64,
    /// Contact of each joint `(joints,)`, and of each guide that wears.
    pub contacts: Vec<ContactInstant>,
    pub sliders: Vec<RailInstant>,
}

/// Contacts of one state.
#[derive(Debug, Clone)]
pub struct TracedState {
    /// Time of the state [s].
    pub time: f64,
    /// Contact of each joint `(joints,)`.
    pub contacts: Vec<ContactInstant>,
    /// Reaction of each guide `(guides,)`.
    pub guides: Vec<GuideReaction>,
}

/// Records a cycle of one island.
#[derive(Debug, Clone)]
pub struct Recorder {
    /// Contact history of each pair of surfaces, as [`Island::pairs`] has them `(pairs,)`.
    pub histories: Vec<WearHistory>,
    /// Forces of all joints, and everything if the cycle is displayed.
    pub full: Option<FullRecording>,
    /// Every state, if the contacts are returned.
    pub traced: Option<Vec<TracedState>>,
    /// Requested bodies: index into the bodies of the island, moment of inertia [kg m^2], motion.
    bodies: Vec<(usize, f64, BodyTrack)>,
    /// Requested points with their place on the island, and their paths.
    points: Vec<(Attachment, End, PointTrack)>,
    /// Requested driven bodies: index into the prescribed bodies that the island touches, moment on them.
    moments: Vec<(usize, MomentTrack)>,
    /// Largest accelerations and impacts so far.
    pub(super) peaks: Peaks,
    /// Largest force so far of each joint, those with clearance first, if requested [N].
    peak_forces: Option<Vec<Largest>>,
    /// End of the start of a cycle [s].
    start_end: f64,
    /// Contacts of the last state.
    pub(super) last: Option<LastContacts>,
    /// Time of the state whose motion was recorded last [s]; in lanes a state whose contacts are may turn out to have no force.
    recorded: Option<f64>,
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
        let joints = island.all_joints().count();
        Recorder {
            histories: island.pairs().map(|pair| pair.empty_history(scene.life.period, samples)).collect(),
            full: None,
            traced: None,
            bodies: slots(&requested.bodies)
                .into_iter()
                .map(|s| (s, island.mass()[3 * s + 2], BodyTrack::default()))
                .collect(),
            points: requested.points.iter().filter_map(point).collect(),
            moments: touched.map(|k| (k, MomentTrack::default())).collect(),
            peaks: Peaks::new(island, scene, requested),
            peak_forces: requested.peak_forces.then(|| vec![[0.0; 2]; joints]),
            start_end: START * scene.life.period,
            last: None,
            recorded: None,
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
        let all = island.all_joints();
        let peaks = self.peak_forces.as_ref()?;
        all.zip(peaks).find(|(scene_joint, _)| *scene_joint == joint).map(|(_, peak)| peak[0])
    }

    /// Removes the recording, for a new cycle.
    pub(crate) fn clear(&mut self) {
        self.histories.iter_mut().for_each(WearHistory::clear);
        self.traced.iter_mut().for_each(Vec::clear);
        self.bodies.iter_mut().for_each(|(.., track)| track.clear());
        self.points.iter_mut().for_each(|(.., track)| track.clear());
        self.moments.iter_mut().for_each(|(_, track)| track.clear());
        if let Some(peaks) = &mut self.peak_forces {
            peaks.fill([0.0; 2]);
        }
        self.peaks.clear();
        (self.last, self.recorded) = (None, None);
    }

    /// The recording of the motion without the start of the cycle.
    pub(crate) fn without_start(&self) -> Self {
        let mut rest = self.clone();
        rest.bodies.iter_mut().for_each(|(.., track)| track.drop_until(self.start_end));
        rest.points.iter_mut().for_each(|(.., track)| track.drop_until(self.start_end));
        rest.moments.iter_mut().for_each(|(_, track)| track.drop_until(self.start_end));
        rest.peak_forces.iter_mut().flatten().for_each(|peak| peak[0] = peak[1]);
        rest.peaks.drop_start();
        rest
    }

    /// Closes the recording at the end of the cycle.
    pub(crate) fn finish(&mut self) {
        if let Some(mut last) = self.last.take() {
            let half = std::mem::take(&mut last.half);
            self.push_contacts(half, &last);
            self.last = Some(last);
        }
        self.histories.iter_mut().for_each(WearHistory::close_interval);
        self.full.iter_mut().for_each(FullRecording::finish);
    }

    /// True if the motion of a state at this time [s] was the last one recorded: the second half of a cycle begins at the end of the first,
    /// and that instant is observed twice.
    pub(crate) fn has_recorded(&self, t: f64) -> bool {
        self.recorded == Some(t)
    }

    /// True if [`Self::record_motion`] reads the forces of the joints and those on prescribed bodies.
    pub(crate) fn needs_joint_forces(&self) -> bool {
        self.full.is_some()
            || self.traced.is_some()
            || self.peak_forces.is_some()
            || !self.moments.is_empty()
            || self.peaks.needs_joint_forces()
    }

    /// Records everything of a state but the contacts.
    pub(crate) fn record_motion(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        self.recorded = Some(t);
        let later = t > self.start_end;
        if let Some(traced) = &mut self.traced {
            traced.push(TracedState { time: t, contacts: contacts(at).collect(), guides: at.guides.clone() });
        }
        for (slot, inertia, track) in &mut self.bodies {
            let k = 3 * *slot + 2;
            track.push(t, [q[k], v[k], at.f[k] / *inertia]);
        }
        for (_, End { frame, arm }, track) in &mut self.points {
            let k = 3 * *frame..3 * *frame + 3;
            let frame = Frame::free(&q[k.clone()], &v[k]);
            let ([x, y], [vx, vy]) = (frame.point(*arm), frame.velocity(*arm));
            track.push(t, [x, y, vx, vy]);
        }
        for (touched, track) in &mut self.moments {
            track.push(t, [at.prescribed[*touched][2]]);
        }
        if let Some(peaks) = &mut self.peak_forces {
            let contacts = at.joints.iter().map(|j| libm::hypot(j.force[0], j.force[1]));
            let contacts = contacts.chain(at.guides.iter().map(GuideReaction::force));
            for (peak, force) in peaks.iter_mut().zip(contacts.chain(island.ideal_forces(at))) {
                push_largest(peak, force.abs(), later);
            }
        }
        self.peaks.push(island, (t, q, v), later, at);
        if let Some(full) = &mut self.full {
            full.push(island, t, q, v, at);
        }
    }

    /// Records everything of the new states of a lane but the contacts, as [`Self::record_motion`] does for one state that needs no forces of
    /// joints; a state that was recorded before adds nothing. `space` holds one state (q, v, linearisation).
    pub(crate) fn record_rows<R: Real>(
        &mut self,
        island: &Island,
        (rows, lane): (&MotionRows<R>, usize),
        space: (&mut [f64], &mut [f64], &mut Linearised),
    ) {
        let recorded = self.recorded;
        if self.points.is_empty() && !self.peaks.any() {
            for (slot, inertia, track) in &mut self.bodies {
                rows.each_new(lane, |row, t| {
                    let [angle, omega, moment] = rows.coordinate(lane, row, 3 * *slot + 2);
                    if recorded != Some(t) {
                        track.push(t, [angle, omega, moment / *inertia]);
                    }
                });
            }
            rows.each_new(lane, |_, t| self.recorded = Some(t));
            return;
        }
        let (q, v, at) = space;
        rows.each_new(lane, |row, t| {
            for (k, (q, v)) in q.iter_mut().zip(v.iter_mut()).enumerate() {
                [*q, *v, at.f[k]] = rows.coordinate(lane, row, k);
            }
            if recorded != Some(t) {
                self.record_motion(island, t, q, v, at);
            }
        });
    }

    /// Adds the contacts of a state to the histories.
    pub(super) fn record_contacts(&mut self, island: &Island, t: f64, at: &Linearised) {
        let contacts = contacts(at);
        let worn = island.guides.iter().zip(&at.guides).filter(|(guide, _)| guide.wears());
        let sliders = worn.map(|(_, now)| RailInstant::new(now));
        let Some(mut last) = self.last.take() else {
            let (contacts, sliders) = (contacts.collect(), sliders.collect());
            self.last = Some(LastContacts { time: t, half: 0.0, contacts, sliders });
            return;
        };
        // Trapezoidal rule: a state stands for half of the step before it and half of the one after it.
        let half = 0.5 * (t - last.time);
        self.push_contacts(last.half + half, &last);
        last.contacts.iter_mut().zip(contacts).for_each(|(last, now)| *last = now);
        last.sliders.iter_mut().zip(sliders).for_each(|(last, now)| *last = now);
        (last.time, last.half) = (t, half);
        self.last = Some(last);
    }

    /// Adds the contacts of a state with weight `duration` [s] to the histories.
    fn push_contacts(&mut self, duration: f64, of: &LastContacts) {
        let (bores, rails) = self.histories.split_at_mut(of.contacts.len());
        let bores = bores.iter_mut().filter_map(WearHistory::bore_mut);
        bores.zip(&of.contacts).for_each(|(history, contact)| history.push(duration, contact));
        let rails = rails.iter_mut().filter_map(WearHistory::rail_mut);
        rails.zip(&of.sliders).for_each(|(history, slider)| history.push(duration, slider));
    }
}

/// Contacts of the joints with clearance in a state.
fn contacts(at: &Linearised) -> impl Iterator<Item = ContactInstant> + '_ {
    let turned = at.e.iter().zip(&at.joints).zip(&at.turns);
    turned.map(|((e, joint), turn)| ContactInstant::new(*e, joint).turned(*turn))
}

impl StateObserver<Island> for Recorder {
    fn observe(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        if !self.has_recorded(t) {
            self.record_motion(island, t, q, v, at);
        }
        if self.last.as_ref().is_none_or(|last| last.time != t) {
            self.record_contacts(island, t, at);
        }
    }
}
