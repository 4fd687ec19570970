//! States of the islands in the lanes of a vector, kept over a few rounds: what the recorders need of them is read lane by lane in one go.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use crate::integrate::LaneStepper;
use crate::lanes::Real;

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
