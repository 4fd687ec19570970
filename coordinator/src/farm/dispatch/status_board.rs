//! Progress of the study, written by the study and read by status queries.

use common::wire::{FarmStatus, Phase, ScaleStatus, Status, StudyStatus};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

/// Progress posted by the study; clones share it.
#[derive(Debug, Clone, Default)]
pub struct StatusBoard(Arc<Mutex<Posted>>);

#[derive(Debug, Default)]
struct Posted {
    study: StudyStatus,
    ending: bool,
    scale: Option<ScaleStatus>,
}

impl StatusBoard {
    fn posted(&self) -> MutexGuard<'_, Posted> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the posted progress.
    pub fn post(&self, change: impl FnOnce(&mut StudyStatus)) {
        change(&mut self.posted().study);
    }

    /// Posts that all evaluations have ended.
    pub fn post_ending(&self) {
        self.posted().ending = true;
    }

    /// Posts the jobs asked for of a batch system.
    pub fn post_scale(&self, scale: ScaleStatus) {
        self.posted().scale = Some(scale);
    }

    /// The jobs asked for of a batch system, if any were.
    pub fn scale(&self) -> Option<ScaleStatus> {
        self.posted().scale.clone()
    }

    /// The status with the workers of `farm`; `up` is the time since the coordinator started.
    pub fn status(&self, farm: FarmStatus, up: Duration) -> Status {
        let posted = self.posted();
        let phase = match (posted.ending, farm.queued + farm.under_way, farm.slots()) {
            (true, _, _) => Phase::Ending,
            (_, 0, _) => Phase::Learning,
            (_, _, 0) => Phase::Waiting,
            _ => Phase::Simulating,
        };
        Status {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            clock_ms: clock_ms(),
            up: up.as_secs_f64(),
            phase,
            study: posted.study.clone(),
            farm,
            scale: posted.scale.clone(),
        }
    }
}

/// Time of this machine's clock since 1970-01-01 UTC [ms].
pub fn clock_ms() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::wire::WorkerStatus;

    #[test]
    fn the_phase_follows_from_queue_workers_and_study() {
        let board = StatusBoard::default();
        let phase = |queued, under_way, slots| {
            let worker = WorkerStatus { slots, ..WorkerStatus::default() };
            let farm = FarmStatus { queued, under_way, workers: vec![worker], ..FarmStatus::default() };
            board.status(farm, Duration::ZERO).phase
        };
        assert_eq!(phase(3, 0, 0), Phase::Waiting);
        assert_eq!(phase(3, 1, 2), Phase::Simulating);
        assert_eq!(phase(0, 0, 2), Phase::Learning);
        board.post(|study| study.done = 7);
        board.post_ending();
        assert_eq!(phase(3, 1, 2), Phase::Ending);
        assert_eq!(board.status(FarmStatus::default(), Duration::ZERO).study.done, 7);
    }
}
