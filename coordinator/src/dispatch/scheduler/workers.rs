//! The workers whose liveliness token is there, and how much of the work each may have.

use common::wire::WorkerId;
use std::collections::BTreeMap;
use std::time::Duration;

/// A worker that is there.
#[derive(Debug, Default)]
pub(super) struct Worker {
    /// Slots it has said to have; 0 until its first claim.
    pub slots: u32,
    /// Number of its last claim.
    pub last_sequence: Option<u64>,
    /// Tasks it has, and since when.
    pub leases: BTreeMap<u64, Duration>,
}

/// Tasks that worker `id` may have at once: of all that are `open` the share that its slots are of all slots, but one for
/// each of its slots in any case. A slot gains by several side by side, as long as none idles elsewhere.
pub(super) fn share(workers: &BTreeMap<WorkerId, Worker>, id: &WorkerId, open: usize) -> usize {
    let slots = |worker: &Worker| worker.slots.max(1) as usize;
    let all: usize = workers.values().map(slots).sum();
    let Some(own) = workers.get(id).map(slots) else { return 0 };
    own.max((open * own).div_ceil(all))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_follow_the_slots_and_keep_every_slot_busy() {
        let id = |name: &str| WorkerId { name: name.into(), epoch: 1 };
        let with = |slots| Worker { slots, ..Worker::default() };
        let workers = BTreeMap::from([(id("a"), with(2)), (id("b"), with(6))]);
        let shares = |open| [share(&workers, &id("a"), open), share(&workers, &id("b"), open)];
        assert_eq!(shares(32), [8, 24]);
        assert_eq!(shares(9), [3, 7]);
        assert_eq!(shares(1), [2, 6]);
        assert_eq!(share(&workers, &id("c"), 8), 0);
        assert_eq!(share(&BTreeMap::from([(id("a"), with(2))]), &id("a"), 8), 8);
    }
}
