//! What each worker has done, and how fast, as people want to see it; no decision depends on it.

use super::scheduler::Census;
use common::wire::{FarmStatus, WorkerStatus};
use std::collections::BTreeMap;
use std::time::Duration;

/// Length of the window over which rates are counted [s].
const WINDOW: u64 = 60;
/// Workers remembered beyond those that are there.
const MOST_REMEMBERED: usize = 1000;

/// Outcomes by worker.
#[derive(Debug, Default)]
pub(super) struct Tally {
    all: Rate,
    workers: BTreeMap<String, (u64, Rate)>,
}

impl Tally {
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

    /// What there is to tell of those who are there.
    pub fn status(&mut self, now: Duration, census: Census) -> FarmStatus {
        if self.workers.len() > MOST_REMEMBERED {
            self.workers.retain(|name, _| census.workers.iter().any(|(there, _, _)| there == name));
        }
        let worker = |(name, slots, leases): (String, u32, usize)| {
            let (done, rate) =
                self.workers.get(&name).map_or((0, 0.0), |(done, rate)| (*done, rate.per_second(now)));
            WorkerStatus { name, slots, under_way: u32::try_from(leases).unwrap_or(u32::MAX), done, rate }
        };
        FarmStatus {
            queued: census.queued as u64,
            under_way: census.open.saturating_sub(census.queued) as u64,
            rate: self.all.per_second(now),
            workers: census.workers.into_iter().map(worker).collect(),
        }
    }
}

/// Events within the last [`WINDOW`], by seconds.
#[derive(Debug)]
struct Rate {
    first: Option<Duration>,
    /// The second of each count, and the count.
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
        let (of, count) = &mut self.seconds[(second % WINDOW) as usize];
        if *of != second {
            (*of, *count) = (second, 0);
        }
        *count += 1;
    }

    /// Events per second over the window, or since the first of them.
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
        let mut tally = Tally::default();
        // Two a second for 100 s, then nothing.
        (0..200).for_each(|k| tally.count(at(500 * k), "host-1/0"));
        let census =
            || Census { queued: 3, open: 5, workers: vec![("host-1".into(), 2, 2), ("new".into(), 1, 0)] };
        let now = tally.status(at(99_900), census());
        assert!((now.rate - 2.0).abs() < 0.05, "{}", now.rate);
        assert_eq!((now.queued, now.under_way, now.workers[0].done), (3, 2, 200));
        assert_eq!((now.workers[1].done, now.workers[1].rate), (0, 0.0));
        assert!((tally.status(at(130_000), census()).rate - 1.0).abs() < 0.05);
        assert_eq!(tally.status(at(170_000), census()).rate, 0.0);
        // A young farm is not measured over a minute that was not.
        let mut young = Tally::default();
        (0..10).for_each(|k| young.count(at(500 * k), "host-1/0"));
        assert!((young.status(at(5000), census()).rate - 2.0).abs() < 0.01);
    }
}
