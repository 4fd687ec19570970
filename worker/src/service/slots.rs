//! The simulation threads. They share one queue of jobs; each runs several side by side if the simulator supports it. Each
//! outcome goes to the claim loop of its coordinator.

use super::claim_event::ClaimEvent;
use super::fair_share::FairShare;
use super::queue::Queue;
use super::{Job, ServiceConfig, Simulator, guard};
use common::wire::Task;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::Instant;

/// Lowered priority of slots, on the scale of `nice`: a competing thread gets three quarters of the core. With 10 it would
/// get nine tenths, but on a machine with other users the slots would then get almost nothing.
#[cfg(target_os = "linux")]
const LOWERED_PRIORITY: i32 = 5;

/// The slots of a worker. When dropped, waiting jobs are removed; the outcomes of running jobs are discarded.
pub(super) struct Slots {
    queue: Arc<Queue>,
    shares: Arc<FairShare>,
    simulator: Arc<dyn Simulator>,
    at_once: usize,
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
            shares: Arc::new(FairShare::new(inboxes.iter().cloned())),
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

    /// Number of jobs that can run at once.
    pub(crate) fn at_once(&self) -> usize {
        self.at_once
    }

    /// What the slots offer, and what to release when they are not used.
    pub(crate) fn simulator(&self) -> &dyn Simulator {
        &*self.simulator
    }

    /// How the coordinators share the slots.
    pub(crate) fn shares(&self) -> &FairShare {
        &self.shares
    }

    /// Appends a job to the queue.
    pub(crate) fn start_job(&self, job: Job) {
        self.queue.push(job);
    }

    /// Removes the waiting tasks of a coordinator that are `unwanted`; returns them.
    pub(crate) fn withdraw(&self, coordinator: usize, unwanted: impl Fn(&Task) -> bool) -> Vec<Task> {
        let jobs = self.queue.withdraw(|job| job.coordinator == coordinator && unwanted(&job.task));
        self.shares.ended(coordinator, jobs.len(), Instant::now());
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
    shares: &FairShare,
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
                shares.ended(coordinator, 1, Instant::now());
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
