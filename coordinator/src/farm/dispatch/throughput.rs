//! Evaluations and rate of each worker, for display only; no decision depends on them.

use super::scheduler::FarmSnapshot;
use common::wire::{FarmStatus, WorkerStatus};
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
        let (done, rate) = match self.workers.get_mut(name) {
            Some(known) => known,
            None => self.workers.entry(name.to_owned()).or_default(),
        };
        *done += 1;
        rate.count(now);
    }

    /// Status of the workers in `snapshot`.
    pub fn status(&mut self, now: Duration, snapshot: FarmSnapshot) -> FarmStatus {
        if self.workers.len() > MOST_REMEMBERED {
            self.workers.retain(|name, _| snapshot.workers.iter().any(|(connected, _, _)| connected == name));
        }
        let worker = |(name, slots, leases): (String, u32, usize)| {
            let (done, rate) =
                self.workers.get(&name).map_or((0, 0.0), |(done, rate)| (*done, rate.per_second(now)));
            WorkerStatus { name, slots, under_way: u32::try_from(leases).unwrap_or(u32::MAX), done, rate }
        };
        FarmStatus {
            queued: snapshot.queued as u64,
            under_way: snapshot.open.saturating_sub(snapshot.queued) as u64,
            rate: self.all.per_second(now),
            workers: snapshot.workers.into_iter().map(worker).collect(),
        }
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
        let recent =
            self.seconds.iter().filter(|(second, _)| *second >= from).map(|(_, count)| u64::from(*count));
        let events: u64 = recent.sum();
        events as f64 / now.saturating_sub(first).as_secs_f64().clamp(1.0, WINDOW as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_those_of_the_last_minute() {
        let at = Duration::from_millis;
        let mut throughput = Throughput::default();
        // Two a second for 100 s, then nothing.
        (0..200).for_each(|k| throughput.count(at(500 * k), "host-1/0"));
        let snapshot = || FarmSnapshot {
            queued: 3,
            open: 5,
            workers: vec![("host-1".into(), 2, 2), ("new".into(), 1, 0)],
        };
        let now = throughput.status(at(99_900), snapshot());
        assert!((now.rate - 2.0).abs() < 0.05, "{}", now.rate);
        assert_eq!((now.queued, now.under_way, now.workers[0].done), (3, 2, 200));
        assert_eq!((now.workers[1].done, now.workers[1].rate), (0, 0.0));
        assert!((throughput.status(at(130_000), snapshot()).rate - 1.0).abs() < 0.05);
        assert_eq!(throughput.status(at(170_000), snapshot()).rate, 0.0);
        // A farm younger than the window is measured since its first outcome.
        let mut young = Throughput::default();
        (0..10).for_each(|k| young.count(at(500 * k), "host-1/0"));
        assert!((young.status(at(5000), snapshot()).rate - 2.0).abs() < 0.01);
    }
}
