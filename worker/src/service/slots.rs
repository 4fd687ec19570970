//! The threads that simulate. They share one queue of jobs, each takes several side by side if its simulator gains by
//! it; each outcome goes to the claims of the coordinator that wants it.

use super::claim_event::ClaimEvent;
use super::fair_share::FairShare;
use super::queue::Queue;
use super::{Job, Simulator, guard};
use common::wire::Task;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::Instant;

/// Priority of threads that give way, on the scale of `nice`: another one that wants the same core has three quarters of
/// it. With 10 it would have nine tenths, but on a machine that others use too nothing would be left.
#[cfg(target_os = "linux")]
const GIVING_WAY: i32 = 5;

/// The slots of a worker. When dropped, what waits is forgotten; what runs comes to its end unheard.
pub(super) struct Slots {
    queue: Arc<Queue>,
    shares: Arc<FairShare>,
    at_once: usize,
}

impl Slots {
    /// Starts `count` threads for coordinators whose claims have these inboxes; `give_way` to the other threads of this
    /// process or not.
    pub fn start(
        count: usize,
        give_way: bool,
        worker: &str,
        simulator: Arc<dyn Simulator>,
        inboxes: &[Sender<ClaimEvent>],
    ) -> std::io::Result<Self> {
        let slots = Slots {
            queue: Arc::new(Queue::new(count)),
            shares: Arc::new(FairShare::new(inboxes.iter().cloned())),
            at_once: count * simulator.side_by_side(),
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

    /// Tasks that can be under way at once.
    pub fn at_once(&self) -> usize {
        self.at_once
    }

    /// Which coordinator may have how many of them.
    pub fn shares(&self) -> &FairShare {
        &self.shares
    }

    /// Queues a job.
    pub fn start_job(&self, job: Job) {
        self.queue.push(job);
    }

    /// Drops what waits of the coordinator at `place` and is unwanted.
    pub fn withdraw(&self, place: usize, unwanted: impl Fn(&Task) -> bool) -> Vec<Task> {
        let jobs = self.queue.withdraw(|job| job.place == place && unwanted(&job.task));
        self.shares.ended(place, jobs.len(), Instant::now());
        jobs.into_iter().map(|job| job.task).collect()
    }
}

impl Drop for Slots {
    fn drop(&mut self) {
        self.queue.close();
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
        guard::evaluate(simulator, name, first, &mut |mine| queue.another(mine), &mut |place, outcome| {
            queue.ended();
            shares.ended(place, 1, Instant::now());
            // Claims that have ended do not listen any more.
            let _ = inboxes[place].send(ClaimEvent::Finished(Box::new(outcome)));
        });
    }
}

/// Lowers the priority of this thread; elsewhere than on Linux it would be that of the process.
fn lower_priority() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::setpriority_process(None, GIVING_WAY) {
        tracing::debug!("a slot keeps its priority: {error}");
    }
}
