//! Who has what, for people who look.

use super::Scheduler;

/// The workers and the queue at one moment.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FarmSnapshot {
    /// Tasks that nobody works on.
    pub queued: usize,
    /// Tasks submitted that have not ended.
    pub open: usize,
    /// Of each worker that is there: name, slots (0 until its first claim), tasks it has.
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
                .map(|(id, worker)| (id.name.clone(), worker.slots, worker.leased()))
                .collect(),
        }
    }
}
