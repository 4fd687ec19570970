//! What tests of several modules share.

#[path = "../../../common/tests/scene/rows.rs"]
mod rows;
pub mod test_study;

/// Published problems with reference failure probabilities, those of the example.
#[allow(dead_code)] // The example reads more of a problem than the tests do.
#[path = "../../examples/published_problems/problems.rs"]
pub mod models;

use crate::results::journal::InMemoryJournal;
use crate::study::{Observed, StoredOutcome};
use common::scene::Faults;

/// The rows of a section of `cases.txt`.
pub fn rows<const N: usize>(section: &str) -> Vec<[&'static str; N]> {
    rows::rows(include_str!("cases.txt"), section)
}

/// The outcomes of a study, as they are stored.
pub fn stored(journal: &InMemoryJournal) -> Vec<StoredOutcome> {
    let outcomes = journal.outcomes().values();
    let stored = outcomes.map(|(sample, finished)| StoredOutcome {
        sample: sample.clone(),
        outcome: finished.outcome.clone().map(Observed::from_evaluation),
    });
    stored.collect()
}

/// The faults of a file, one a line, with line and column.
pub fn located(Faults(faults): Faults) -> String {
    let said = faults.iter().map(|fault| {
        format!("line {}, column {}: {}", fault.location.as_ref().unwrap().line, fault.key, fault.kind)
    });
    said.collect::<Vec<_>>().join("\n")
}
