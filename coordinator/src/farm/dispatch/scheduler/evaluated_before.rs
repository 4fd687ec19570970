//! Samples that are evaluated once more: a worker that has evaluated one before gets it only where no other worker is connected.

use super::workers::{Worker, Workforce};
use common::wire::WorkerId;

/// True if a worker is not among the slots `not_by` that evaluated a sample before, or no other worker is connected that is not.
pub(super) fn may_evaluate(not_by: &[String], id: &WorkerId, workers: &Workforce) -> bool {
    // Slots of a worker are named `host-4711/0`.
    let has_evaluated = |id: &WorkerId| {
        let rest =
            |slot: &String| slot.strip_prefix(&id.name).map(|rest| rest.is_empty() || rest.starts_with('/'));
        not_by.iter().any(|slot| rest(slot) == Some(true))
    };
    let is_other = |(other, worker): (&WorkerId, &Worker)| worker.usable_slots() > 0 && !has_evaluated(other);
    !has_evaluated(id) || !workers.iter().any(is_other)
}
