//! Queue of a worker's waiting jobs. Each slot takes at most its fair share, so that no slot is idle while another one runs
//! several jobs side by side.

use super::Job;
use common::locks::locked;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};

/// Waiting jobs, and the number of running ones.
pub(super) struct Queue {
    slots: usize,
    state: Mutex<QueueState>,
    changed: Condvar,
}

#[derive(Default)]
struct QueueState {
    waiting: VecDeque<Job>,
    running: usize,
    closed: bool,
}

impl Queue {
    /// An empty queue for `slots` slots.
    pub(crate) fn new(slots: usize) -> Self {
        Queue { slots, state: Mutex::default(), changed: Condvar::new() }
    }

    /// Appends a job.
    pub(crate) fn push(&self, job: Job) {
        locked(&self.state).waiting.push_back(job);
        self.changed.notify_one();
    }

    /// Removes and returns the waiting jobs that are `unwanted`.
    pub(crate) fn withdraw(&self, unwanted: impl Fn(&Job) -> bool) -> Vec<Job> {
        let mut state = locked(&self.state);
        let all = std::mem::take(&mut state.waiting).into_iter();
        let (out, kept): (Vec<Job>, VecDeque<Job>) =
            all.fold(Default::default(), |(mut out, mut kept), job| {
                if unwanted(&job) {
                    out.push(job)
                } else {
                    kept.push_back(job)
                }
                (out, kept)
            });
        state.waiting = kept;
        out
    }

    /// Removes all waiting jobs; no slot gets a job afterwards.
    pub(crate) fn close(&self) {
        let mut state = locked(&self.state);
        state.closed = true;
        state.waiting.clear();
        self.changed.notify_all();
    }

    /// Waits for a job for an idle slot; `None` once the queue is closed.
    pub(crate) fn first(&self) -> Option<Job> {
        let idle = |state: &mut QueueState| !state.closed && state.waiting.is_empty();
        let mut state =
            self.changed.wait_while(locked(&self.state), idle).unwrap_or_else(PoisonError::into_inner);
        state.take()
    }

    /// Another job for a slot already running `mine`, unless that exceeds its fair share.
    pub(crate) fn another(&self, mine: usize) -> Option<Job> {
        let mut state = locked(&self.state);
        let share = (state.running + state.waiting.len()).div_ceil(self.slots);
        if mine < share { state.take() } else { None }
    }

    /// Counts the end of a job.
    pub(crate) fn ended(&self) {
        let mut state = locked(&self.state);
        state.running = state.running.saturating_sub(1);
    }
}

impl QueueState {
    fn take(&mut self) -> Option<Job> {
        let job = self.waiting.pop_front()?;
        self.running += 1;
        Some(job)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::practice_tests::job;

    #[test]
    fn a_slot_takes_its_share_and_leaves_the_others_theirs() {
        let queue = Queue::new(2);
        (0..5).for_each(|k| queue.push(job(f64::from(k))));
        assert_eq!(queue.first().expect("waits").sample(), [0.0]);
        assert_eq!(queue.another(1).expect("of five, three are its share").sample(), [1.0]);
        assert_eq!(queue.another(2).expect("the third").sample(), [2.0]);
        assert!(queue.another(3).is_none());
        assert_eq!(queue.first().expect("the other slot").sample(), [3.0]);
        assert_eq!(queue.another(1).expect("its second").sample(), [4.0]);
        assert!(queue.another(2).is_none());
        // The share also bounds jobs that arrive later.
        (0..2).for_each(|_| queue.ended());
        queue.push(job(5.0));
        assert!(queue.another(2).is_none());
        assert_eq!(queue.another(1).expect("four in all, two each").sample(), [5.0]);
    }

    #[test]
    fn a_withdrawn_job_is_not_taken() {
        let queue = Queue::new(1);
        (0..3).for_each(|k| queue.push(job(f64::from(k))));
        let out = queue.withdraw(|job| job.sample() == [1.0]);
        assert_eq!(out.iter().map(|job| job.sample()[0]).collect::<Vec<_>>(), [1.0]);
        assert_eq!(queue.first().expect("waits").sample(), [0.0]);
        assert_eq!(queue.another(0).expect("waits").sample(), [2.0]);
    }

    #[test]
    fn a_closed_queue_returns_no_job() {
        let queue = Queue::new(1);
        queue.push(job(0.0));
        queue.close();
        assert!(queue.first().is_none());
        assert!(queue.another(0).is_none());
    }
}
