//! The status for queries: progress of the study, written by the study, and evaluations and rate of each worker, for display only; no decision
//! depends on them.

use common::locks::locked;
use common::wire::{FarmStatus, Phase, ScaleStatus, Status, StudyStatus};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

/// Progress posted by the study: its numbers, whether it is [`Phase::Ending`], and jobs; clones share it.
#[derive(Debug, Clone, Default)]
pub struct StatusBoard(Arc<Mutex<Status>>);

impl StatusBoard {
    /// Changes the posted progress.
    pub fn post(&self, change: impl FnOnce(&mut StudyStatus)) {
        change(&mut locked(&self.0).study);
    }

    /// Posts that all evaluations have ended.
    pub fn post_ending(&self) {
        locked(&self.0).phase = Phase::Ending;
    }

    /// Posts the jobs asked for of a batch system.
    pub fn post_scale(&self, scale: ScaleStatus) {
        locked(&self.0).scale = Some(scale);
    }

    /// The jobs asked for of a batch system, if any were.
    pub fn scale(&self) -> Option<ScaleStatus> {
        locked(&self.0).scale.clone()
    }

    /// The status with the workers of `farm`; `up` is the time since the coordinator started.
    pub fn status(&self, farm: FarmStatus, up: Duration) -> Status {
        let posted = locked(&self.0).clone();
        let phase = match (posted.phase, farm.queued + farm.under_way, farm.slots()) {
            (Phase::Ending, _, _) => Phase::Ending,
            (_, 0, _) => Phase::Learning,
            (_, _, 0) => Phase::Waiting,
            _ => Phase::Simulating,
        };
        let program = env!("CARGO_PKG_VERSION").to_owned();
        Status { program, clock_ms: clock_ms(), up: up.as_secs_f64(), phase, farm, ..posted }
    }
}

/// Time of this machine's clock since 1970-01-01 UTC [ms].
pub fn clock_ms() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

/// Length of the window over which rates are counted [s].
const WINDOW: u64 = 60;
/// Most workers remembered, including disconnected ones.
const MOST_REMEMBERED: usize = 1000;

/// Number and rate of outcomes, of all workers and by worker.
#[derive(Debug, Default)]
pub(super) struct Throughput {
    all: Rate,
    workers: BTreeMap<String, (u64, Rate)>,
}

impl Throughput {
    /// Counts an outcome of `slot`, e.g. `host-4711/0`.
    pub fn count(&mut self, now: Duration, slot: &str) {
        let name = slot.rsplit_once('/').map_or(slot, |(worker, _)| worker);
        self.all.count(now);
        let (done, rate) = self.workers.entry(name.to_owned()).or_default();
        *done += 1;
        rate.count(now);
    }

    /// Adds what was counted to the status of a farm.
    pub fn count_in(&mut self, now: Duration, mut farm: FarmStatus) -> FarmStatus {
        if self.workers.len() > MOST_REMEMBERED {
            self.workers.retain(|name, _| farm.workers.iter().any(|connected| connected.name == *name));
        }
        farm.rate = self.all.per_second(now);
        for worker in &mut farm.workers {
            if let Some((done, rate)) = self.workers.get(&worker.name) {
                (worker.done, worker.rate) = (*done, rate.per_second(now));
            }
        }
        farm
    }
}

/// Events within the last [`WINDOW`] seconds, counted by second.
#[derive(Debug, Default)]
struct Rate {
    first: Option<Duration>,
    /// Count of events by the second in which they were.
    seconds: BTreeMap<u64, u64>,
}

impl Rate {
    fn count(&mut self, now: Duration) {
        self.first.get_or_insert(now);
        *self.seconds.entry(now.as_secs()).or_default() += 1;
        while self.seconds.len() > WINDOW as usize {
            self.seconds.pop_first();
        }
    }

    /// Events per second over the window, or since the first event if that is shorter.
    fn per_second(&self, now: Duration) -> f64 {
        let Some(first) = self.first else { return 0.0 };
        let from = (now.as_secs() + 1).saturating_sub(WINDOW);
        let events: u64 = self.seconds.range(from..).map(|(_, count)| count).sum();
        events as f64 / now.saturating_sub(first).as_secs_f64().clamp(1.0, WINDOW as f64)
    }
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

    #[test]
    fn rates_are_those_of_the_last_minute() {
        let at = Duration::from_millis;
        let mut throughput = Throughput::default();
        // Two a second for 100 s, then nothing.
        (0..200).for_each(|k| throughput.count(at(500 * k), "host-1/0"));
        let named = |name: &str| WorkerStatus { name: name.into(), ..WorkerStatus::default() };
        let snapshot = || FarmStatus {
            workers: vec![named("host-1"), named("new")],
            queued: 3,
            under_way: 2,
            ..FarmStatus::default()
        };
        let now = throughput.count_in(at(99_900), snapshot());
        assert!((now.rate - 2.0).abs() < 0.05, "{}", now.rate);
        assert_eq!((now.queued, now.under_way, now.workers[0].done), (3, 2, 200));
        assert_eq!((now.workers[1].done, now.workers[1].rate), (0, 0.0));
        assert!((throughput.count_in(at(130_000), snapshot()).rate - 1.0).abs() < 0.05);
        assert_eq!(throughput.count_in(at(170_000), snapshot()).rate, 0.0);
        // A farm younger than the window is measured since its first outcome.
        let mut young = Throughput::default();
        (0..10).for_each(|k| young.count(at(500 * k), "host-1/0"));
        assert!((young.count_in(at(5000), snapshot()).rate - 2.0).abs() < 0.01);
    }
}
