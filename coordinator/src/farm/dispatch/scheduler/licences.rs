//! Licences: a bound on the evaluations that run at once, on all workers together.
//!
//! A lease takes a licence. The licence of a lease that ends without an outcome is held back for as long as its program may
//! still run: a lost worker may be cut off rather than dead, and a program outlives a worker that was killed.

use common::wire::WorkerId;
use std::collections::BTreeMap;
use std::time::Duration;

/// Time in which the programs of a worker that leaves have ended.
const LEAVING: Duration = Duration::from_secs(1);

/// Bound on the evaluations at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LicenceSettings {
    /// Number of licences.
    pub count: u32,
    /// Longest time of one evaluation.
    pub timeout: Duration,
}

/// Licences held back, with the time until when.
#[derive(Debug, Default)]
pub(super) struct HeldLicences(BTreeMap<WorkerId, Vec<Duration>>);

impl HeldLicences {
    /// Holds licences of a lost worker back for twice the longest evaluation so far, at most for the time limit of an
    /// evaluation; for the latter before the first evaluation has ended. `longest_wall` is in seconds.
    pub fn hold_lost(
        &mut self,
        worker: &WorkerId,
        count: usize,
        now: Duration,
        settings: &LicenceSettings,
        longest_wall: Option<f64>,
    ) {
        let usual = longest_wall.and_then(|wall| Duration::try_from_secs_f64(2.0 * wall).ok());
        self.hold(worker, count, now + usual.map_or(settings.timeout, |usual| usual.min(settings.timeout)));
    }

    /// Holds licences of a worker that leaves back until its programs have ended.
    pub fn hold_leaving(&mut self, worker: &WorkerId, count: usize, now: Duration) {
        self.hold(worker, count, now + LEAVING);
    }

    fn hold(&mut self, worker: &WorkerId, count: usize, until: Duration) {
        if count > 0 {
            self.0.entry(worker.clone()).or_default().extend(std::iter::repeat_n(until, count));
        }
    }

    /// Holds nothing back for a connected worker: its claims list what it runs.
    pub fn forget(&mut self, worker: &WorkerId) {
        self.0.remove(worker);
    }

    /// Releases the licences whose time is over; true if there were any.
    pub fn release(&mut self, now: Duration) -> bool {
        let before = self.count();
        self.0.retain(|_, held| {
            held.retain(|until| *until > now);
            !held.is_empty()
        });
        self.count() < before
    }

    /// Number of licences held back.
    pub fn count(&self) -> usize {
        self.0.values().map(Vec::len).sum()
    }
}
