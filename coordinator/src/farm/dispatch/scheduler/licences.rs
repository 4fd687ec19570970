//! Licences: a bound on the evaluations that run at once, on all workers together.
//!
//! A lease takes a licence. A worker without contact ends its evaluations after [`LICENCE_CONTACT`], and those of a worker
//! that is killed end with it; until then the licence of a lease that ends without an outcome is held back.

use common::wire::{LICENCE_CONTACT, WorkerId};
use std::collections::BTreeMap;
use std::time::Duration;

/// Time for which a licence is held back after the last contact: longer than [`LICENCE_CONTACT`] by the time in which a
/// worker notices that it is over and ends its programs.
pub const LICENCE_HOLD: Duration = LICENCE_CONTACT.saturating_add(Duration::from_secs(2));
/// Time in which the programs of a worker that leaves have ended.
pub(super) const LEAVING: Duration = Duration::from_secs(1);

/// Licences held back, with the time until when.
#[derive(Debug, Default)]
pub(super) struct HeldLicences(BTreeMap<WorkerId, Vec<Duration>>);

impl HeldLicences {
    /// Holds licences of a worker back until then: [`LICENCE_HOLD`] after the last contact of one that has no leases for what it runs,
    /// [`LEAVING`] of one that leaves.
    pub fn hold(&mut self, worker: &WorkerId, count: usize, until: Duration) {
        if count > 0 {
            self.0.entry(worker.clone()).or_default().extend(std::iter::repeat_n(until, count));
        }
    }

    /// Extends the time of a worker that has contact and no leases.
    pub fn extend(&mut self, worker: &WorkerId, now: Duration) {
        if let Some(held) = self.0.get_mut(worker) {
            held.fill(now + LICENCE_HOLD);
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
