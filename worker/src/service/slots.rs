//! The threads that simulate. They share one queue of jobs; each outcome goes to the inbox of the claims.

use super::Simulator;
use super::claims::Inbox;
use super::guard;
use common::wire::{Task, WorkOrder};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

/// One task with the order it came in.
struct Job {
    order: Arc<WorkOrder>,
    task: Task,
}

/// The slots of a worker. When dropped, what waits is forgotten; what runs comes to its end unheard.
pub(super) struct Slots {
    jobs: Sender<Job>,
    closed: Arc<AtomicBool>,
}

impl Slots {
    /// Starts `count` threads.
    pub fn start(
        count: usize,
        worker: &str,
        simulator: Arc<dyn Simulator>,
        inbox: &Sender<Inbox>,
    ) -> std::io::Result<Self> {
        let (jobs, queue) = channel();
        let queue = Arc::new(Mutex::new(queue));
        let closed = Arc::new(AtomicBool::new(false));
        for slot in 0..count {
            let (queue, closed) = (Arc::clone(&queue), Arc::clone(&closed));
            let (simulator, inbox) = (Arc::clone(&simulator), inbox.clone());
            let name = format!("{worker}/{slot}");
            std::thread::Builder::new()
                .name(format!("slot-{slot}"))
                .spawn(move || work(&queue, &closed, &*simulator, &name, &inbox))?;
        }
        Ok(Self { jobs, closed })
    }

    /// Queues a task.
    pub fn start_task(&self, order: &Arc<WorkOrder>, task: Task) {
        // The threads end only after this value is gone, so somebody receives it.
        let _ = self.jobs.send(Job { order: Arc::clone(order), task });
    }
}

impl Drop for Slots {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Release);
    }
}

fn work(
    queue: &Mutex<Receiver<Job>>,
    closed: &AtomicBool,
    simulator: &dyn Simulator,
    name: &str,
    inbox: &Sender<Inbox>,
) {
    loop {
        // Whoever has the lock waits for the next job, the others for the lock.
        let job = queue.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(Job { order, task }) = job else { return };
        if closed.load(Ordering::Acquire) {
            return;
        }
        let outcome = guard::evaluate(simulator, &order, task, name);
        if inbox.send(Inbox::Finished(Box::new(outcome))).is_err() {
            return;
        }
    }
}
