//! The threads that simulate. They share one queue of jobs, each takes several side by side if its simulator gains by
//! it; each outcome goes to the inbox of the claims.

use super::claims::Inbox;
use super::queue::Queue;
use super::{Job, Simulator, guard};
use std::sync::Arc;
use std::sync::mpsc::Sender;

/// The slots of a worker. When dropped, what waits is forgotten; what runs comes to its end unheard.
pub(super) struct Slots {
    queue: Arc<Queue>,
    at_once: usize,
}

impl Slots {
    /// Starts `count` threads.
    pub fn start(
        count: usize,
        worker: &str,
        simulator: Arc<dyn Simulator>,
        inbox: &Sender<Inbox>,
    ) -> std::io::Result<Self> {
        let slots = Slots { queue: Arc::new(Queue::new(count)), at_once: count * simulator.side_by_side() };
        for slot in 0..count {
            let (queue, simulator, inbox) = (Arc::clone(&slots.queue), Arc::clone(&simulator), inbox.clone());
            let name = format!("{worker}/{slot}");
            std::thread::Builder::new()
                .name(format!("slot-{slot}"))
                .spawn(move || work(&queue, &*simulator, &name, &inbox))?;
        }
        Ok(slots)
    }

    /// Tasks that can be under way at once.
    pub fn at_once(&self) -> usize {
        self.at_once
    }

    /// Queues a job.
    pub fn start_job(&self, job: Job) {
        self.queue.push(job);
    }
}

impl Drop for Slots {
    fn drop(&mut self) {
        self.queue.close();
    }
}

fn work(queue: &Queue, simulator: &dyn Simulator, name: &str, inbox: &Sender<Inbox>) {
    while let Some(first) = queue.first() {
        guard::evaluate(simulator, name, first, &mut |mine| queue.another(mine), &mut |outcome| {
            queue.ended();
            // Nobody listens any more once the queue is closed.
            let _ = inbox.send(Inbox::Finished(Box::new(outcome)));
        });
    }
}
