//! The simulation threads. They share one queue of jobs; each runs several side by side if the simulator supports it. Each
//! outcome goes to the claim loop of its coordinator.
//!
//! # Queue of a claim
//! Queue of a worker's waiting jobs. Each slot takes at most its fair share, so that no slot is idle while another one runs
//! several jobs side by side.

use super::fair_share::FairShare;
use super::{ClaimEvent, Job, ServiceConfig, Simulator, guard};
use common::locks::locked;
use common::wire::Task;
use std::collections::VecDeque;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Lowered priority of slots, on the scale of `nice`: a competing thread gets three quarters of the core. With 10 it would
/// get nine tenths, but on a machine with other users the slots would then get almost nothing.
#[cfg(target_os = "linux")]
const LOWERED_PRIORITY: i32 = 5;

/// The slots of a worker. When dropped, waiting jobs are removed; the outcomes of running jobs are discarded.
pub(super) struct Slots {
    /// Jobs that wait for a slot.
    pub(super) queue: Arc<Queue>,
    shares: Arc<Mutex<FairShare>>,
    /// What the slots offer, and what to release when they are not used.
    pub(super) simulator: Arc<dyn Simulator>,
    /// Number of jobs that can run at once.
    pub(super) at_once: usize,
}

impl Slots {
    /// Starts the threads of `config` under the name `worker`; `inboxes` are those of the claim loops, in the order of the
    /// coordinators.
    pub(crate) fn start(
        config: &ServiceConfig,
        worker: &str,
        simulator: Arc<dyn Simulator>,
        inboxes: &[Sender<ClaimEvent>],
    ) -> std::io::Result<Self> {
        let (count, give_way) = (config.slots, config.give_way);
        let slots = Slots {
            queue: Arc::new(Queue::new(count)),
            shares: Arc::new(Mutex::new(FairShare::new(inboxes.iter().cloned()))),
            at_once: count * simulator.side_by_side(),
            simulator: Arc::clone(&simulator),
        };
        for slot in 0..count {
            let (queue, shares) = (Arc::clone(&slots.queue), Arc::clone(&slots.shares));
            let (simulator, inboxes) = (Arc::clone(&simulator), inboxes.to_vec());
            let name = format!("{worker}/{slot}");
            std::thread::Builder::new().name(format!("slot-{slot}")).spawn(move || {
                if give_way {
                    lower_priority();
                }
                work(&queue, &shares, &*simulator, &name, &inboxes);
            })?;
        }
        Ok(slots)
    }

    /// How the coordinators share the slots.
    pub(crate) fn shares(&self) -> MutexGuard<'_, FairShare> {
        locked(&self.shares)
    }

    /// Removes the waiting tasks of a coordinator that are `unwanted`; returns them.
    pub(crate) fn withdraw(&self, coordinator: usize, unwanted: impl Fn(&Task) -> bool) -> Vec<Task> {
        let jobs = self.queue.withdraw(|job| job.coordinator == coordinator && unwanted(&job.task));
        self.shares().ended(coordinator, jobs.len(), Instant::now());
        jobs.into_iter().map(|job| job.task).collect()
    }
}

impl Drop for Slots {
    fn drop(&mut self) {
        self.queue.close();
        self.simulator.stop();
    }
}

fn work(
    queue: &Queue,
    shares: &Mutex<FairShare>,
    simulator: &dyn Simulator,
    name: &str,
    inboxes: &[Sender<ClaimEvent>],
) {
    while let Some(first) = queue.first() {
        guard::evaluate(
            simulator,
            name,
            first,
            &mut |mine| queue.another(mine),
            &mut |coordinator, outcome| {
                queue.ended();
                locked(shares).ended(coordinator, 1, Instant::now());
                // A claim loop that has ended discards outcomes.
                let _ = inboxes[coordinator].send(ClaimEvent::Finished(Box::new(outcome)));
            },
        );
    }
}

/// Lowers the priority of this thread. On other systems than Linux the call would affect the whole process.
fn lower_priority() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::setpriority_process(None, LOWERED_PRIORITY) {
        tracing::debug!("the priority of a slot cannot be lowered: {error}");
    }
}

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
    pub(crate) fn withdraw(&self, unwanted: impl Fn(&Job) -> bool) -> VecDeque<Job> {
        let mut state = locked(&self.state);
        let (out, kept) = std::mem::take(&mut state.waiting).into_iter().partition(unwanted);
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
