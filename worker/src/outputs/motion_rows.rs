//! States of the islands in the lanes of a vector, kept over a few rounds: what the recorders need of them is read lane by lane in one go.
//!
//! # Contact lanes
//! Contact histories of the islands in the lanes of a vector, one per lane: what [`Recorder`] does for one island.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use super::Recorder;
use super::recorder::LastContacts;
use crate::integrate::{LaneStepper, Linearised};
use crate::lanes::{InLane, Lanewise, Real};
use crate::wear::{ContactInstant, ContactSample, Interval, WearHistory};

/// Rounds that are kept at a time: few enough to stay in the processor's nearest memory.
const ROUNDS: usize = 16;

/// States of all lanes over the last rounds.
#[derive(Debug, Clone)]
pub struct MotionRows<R> {
    /// Number of coordinates.
    n: usize,
    /// One in lanes that are recorded, else zero.
    recorded: R,
    /// Number of rounds that are kept.
    kept: usize,
    /// Time of the states of each round [s], and one in recorded lanes whose state is new, else zero `(ROUNDS, 2)`.
    rounds: Vec<[R; 2]>,
    /// Position, velocity and generalised force of every coordinate in each round `(ROUNDS, n, 3)` [SI].
    states: Vec<[R; 3]>,
}

impl<R: Real> MotionRows<R> {
    /// No states, of islands with `n` coordinates; `like` sets the number of lanes.
    pub(crate) fn new(like: R, n: usize) -> Self {
        MotionRows {
            n,
            recorded: like.zero(),
            kept: 0,
            rounds: vec![[like.zero(); 2]; ROUNDS],
            states: vec![[like.zero(); 3]; ROUNDS * n],
        }
    }

    /// Records a lane from the next round on, or no longer.
    pub(crate) fn set_recorded(&mut self, lane: usize, recorded: bool) {
        self.recorded.set_lane(lane, f64::from(u8::from(recorded)));
    }

    /// True if there is no room for another round: the rows are to be read and cleared.
    #[inline(always)]
    pub(crate) fn is_full(&self) -> bool {
        self.kept == ROUNDS
    }

    /// Adds the states of a round, if there is room.
    #[inline(always)]
    pub(crate) fn push(&mut self, stepper: &LaneStepper<R>) {
        if self.is_full() || !R::any(self.recorded.zero().below(self.recorded)) {
            return;
        }
        self.rounds[self.kept] = [stepper.progress.time, stepper.fresh * self.recorded];
        let states = &mut self.states[self.kept * self.n..][..self.n];
        for i in 0..states.len() {
            states[i] = [stepper.q[i], stepper.v[i], stepper.at.f[i]];
        }
        self.kept += 1;
    }

    /// Removes all rows.
    pub(crate) fn clear(&mut self) {
        self.kept = 0;
    }

    /// Removes the rows of one lane, which have been read.
    pub(crate) fn clear_lane(&mut self, lane: usize) {
        self.rounds[..self.kept].iter_mut().for_each(|[_, new]| new.set_lane(lane, 0.0));
    }

    /// Removes the last row of one lane, whose state was not accepted.
    pub(crate) fn remove_last(&mut self, lane: usize) {
        if let Some([_, new]) = self.rounds[..self.kept].last_mut() {
            new.set_lane(lane, 0.0);
        }
    }

    /// Calls `state` with the number and the time [s] of every row of lane `lane` whose state is new, in order of time.
    #[inline]
    pub(crate) fn each_new(&self, lane: usize, mut state: impl FnMut(usize, f64)) {
        for (row, [time, new]) in self.rounds[..self.kept].iter().enumerate() {
            if new.lane(lane) == 1.0 {
                state(row, time.lane(lane));
            }
        }
    }

    /// Position, velocity and generalised force of coordinate `k` of a lane in row `row` [SI].
    #[inline]
    pub(crate) fn coordinate(&self, lane: usize, row: usize, k: usize) -> [f64; 3] {
        let of = &self.states[row * self.n + k];
        [of[0].lane(lane), of[1].lane(lane), of[2].lane(lane)]
    }
}

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
