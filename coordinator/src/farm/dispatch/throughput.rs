//! Evaluations and rate of each worker, for display only; no decision depends on them.

use common::wire::FarmStatus;
use std::collections::BTreeMap;
use std::time::Duration;

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
#[derive(Debug)]
struct Rate {
    first: Option<Duration>,
    /// Second and count of events in that second.
    seconds: [(u64, u32); WINDOW as usize],
}

impl Default for Rate {
    fn default() -> Self {
        Rate { first: None, seconds: [(0, 0); WINDOW as usize] }
    }
}

impl Rate {
    fn count(&mut self, now: Duration) {
        self.first.get_or_insert(now);
        let second = now.as_secs();
        let (counted, count) = &mut self.seconds[(second % WINDOW) as usize];
        if *counted != second {
            (*counted, *count) = (second, 0);
        }
        *count += 1;
    }

    /// Events per second over the window, or since the first event if that is shorter.
    fn per_second(&self, now: Duration) -> f64 {
        let Some(first) = self.first else { return 0.0 };
        let from = (now.as_secs() + 1).saturating_sub(WINDOW);
        let recent = self.seconds.iter().filter(|(second, _)| *second >= from);
        let events: u64 = recent.map(|(_, count)| u64::from(*count)).sum();
        events as f64 / now.saturating_sub(first).as_secs_f64().clamp(1.0, WINDOW as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::wire::WorkerStatus;

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
