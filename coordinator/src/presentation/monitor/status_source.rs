//! Provides the status of a running study to its views.

use crate::farm::dispatch::{StatusBoard, StatusHandle};
use common::wire::{FarmStatus, Status, StudyStatus, WorkerStatus};
use std::time::{Duration, Instant};

/// Longest wait for the status of the farm.
const STATUS_TIMEOUT: Duration = Duration::from_secs(2);

/// Provider of the status of a running study.
#[derive(Debug, Clone)]
pub enum StatusSource {
    /// The dispatcher of a farm.
    Farm(StatusHandle),
    /// A study whose simulator runs on slots of this process.
    Alone {
        /// Board of the study.
        board: StatusBoard,
        /// Number of slots.
        slots: u32,
        /// Start of the study.
        since: Instant,
    },
}

impl StatusSource {
    /// The status now; `None` if the farm has ended or does not answer.
    pub fn status(&self) -> Option<Status> {
        match self {
            StatusSource::Farm(dispatcher) => dispatcher.status(STATUS_TIMEOUT),
            StatusSource::Alone { board, slots, since } => {
                let up = since.elapsed();
                let mut status = board.status(FarmStatus::default(), up);
                let StudyStatus { done, recalled, planned, .. } = status.study;
                let under_way = planned.saturating_sub(done);
                let rate = done.saturating_sub(recalled) as f64 / up.as_secs_f64().max(1.0);
                let worker = WorkerStatus {
                    name: "this-process".to_owned(),
                    slots: *slots,
                    under_way: u32::try_from(under_way).unwrap_or(u32::MAX).min(*slots),
                    done: done.saturating_sub(recalled),
                    rate,
                };
                let running = u64::from(worker.under_way);
                let queued = under_way - running;
                status =
                    board.status(FarmStatus { queued, under_way: running, rate, workers: vec![worker] }, up);
                Some(status)
            }
        }
    }
}
