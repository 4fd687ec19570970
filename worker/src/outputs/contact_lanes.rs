//! Contact histories of the islands in the lanes of a vector, one per lane: what [`Recorder`] does for one island.

use super::Recorder;
use super::recorder::LastContacts;
use crate::integrate::Linearised;
use crate::lanes::{InLane, Lanewise, Real};
use crate::wear::{ContactInstant, ContactSample, Interval, WearHistory};

/// All joints with clearance of one island per lane.
#[derive(Debug, Clone)]
pub struct ContactLanes<R> {
    /// Of each joint the interval of its history that has not ended yet, and its contact at the last state.
    joints: Vec<(Interval<R>, ContactInstant<R>)>,
    /// Time of the last state and half of the step before it [s].
    time: R,
    half: R,
    /// One half in lanes that record, zero in others [1].
    weight: R,
}

impl<R: Real> ContactLanes<R> {
    /// Lanes without recordings, for islands with `joints` joints with clearance; `like` sets the number of lanes.
    pub(crate) fn new(like: R, joints: usize) -> Self {
        let interval = Interval::new(f64::INFINITY, false).in_lanes(like);
        let joint = (interval, ContactInstant::default().in_lanes(like));
        ContactLanes {
            joints: vec![joint; joints],
            time: like.zero(),
            half: like.zero(),
            weight: like.zero(),
        }
    }

    /// Continues the histories of `recorder` in a lane, from its last state or else from the first one, at time `start` [s].
    pub(crate) fn load(&mut self, lane: usize, recorder: &Recorder, start: f64) {
        let histories = recorder.histories.iter().filter_map(WearHistory::bore);
        for ((to, _), from) in self.joints.iter_mut().zip(histories) {
            from.interval.write_lane::<R>(lane, to);
        }
        let (mut time, mut half) = (start, 0.0);
        if let Some(last) = &recorder.last {
            (time, half) = (last.time, last.half);
            for ((_, to), from) in self.joints.iter_mut().zip(&last.contacts) {
                from.write_lane::<R>(lane, to);
            }
        }
        self.time.set_lane(lane, time);
        self.half.set_lane(lane, half);
        self.weight.set_lane(lane, 0.5);
    }

    /// Adds the contacts of the states linearised as `at`, at the times `t` [s]; `ended` receives joint, lane and averages of every
    /// interval that ends with the states before them. A state that was added before adds nothing.
    #[inline(always)]
    pub(crate) fn record(
        &mut self,
        t: R,
        at: &Linearised<R>,
        ended: &mut dyn FnMut(usize, usize, ContactSample),
    ) {
        // Trapezoidal rule: a state stands for half of the step before it and half of the one after it.
        let half = (t - self.time) * self.weight;
        let stepped = half.zero().below(half);
        let duration = R::select(stepped, self.half + half, half.zero());
        for j in 0..self.joints.len() {
            let (interval, last) = &mut self.joints[j];
            let now = ContactInstant::new(at.e[j], &at.joints[j]).turned(at.turns[j]);
            let mut ended = |lane: usize, sample: ContactSample| ended(j, lane, sample);
            interval.push(duration, last, &mut ended);
            *last = now;
        }
        (self.time, self.half) = (t, R::select(stepped, half, self.half));
    }

    /// Returns the histories of a lane to its recorder.
    pub(crate) fn unload(&mut self, lane: usize, recorder: &mut Recorder) {
        let histories = recorder.histories.iter_mut().filter_map(WearHistory::bore_mut);
        for ((from, _), to) in self.joints.iter().zip(histories) {
            to.interval = from.in_lane(lane);
        }
        recorder.last = Some(LastContacts {
            time: self.time.lane(lane),
            half: self.half.lane(lane),
            contacts: self.joints.iter().map(|(_, last)| last.in_lane(lane)).collect(),
            // Islands with guides that wear are never in lanes.
            sliders: vec![],
        });
        self.weight.set_lane(lane, 0.0);
    }
}
