//! Workers and queue at one moment, for status queries.

use super::Scheduler;

/// The workers and the queue at one moment.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FarmSnapshot {
    /// Tasks not leased to any worker.
    pub queued: usize,
    /// Tasks submitted and not ended.
    pub open: usize,
    /// Name, slots (0 until the first claim, and for a worker that gets no tasks) and leased tasks of each connected worker.
    pub workers: Vec<(String, u32, usize)>,
}

impl Scheduler {
    /// The workers and the queue now.
    pub fn snapshot(&self) -> FarmSnapshot {
        FarmSnapshot {
            queued: self.tasks.waiting(),
            open: self.tasks.open(),
            workers: self
                .workers
                .iter()
                .map(|(id, worker)| (id.name.clone(), worker.usable_slots(), worker.leased()))
                .collect(),
        }
    }
}
