//! What one more slot of a worker costs in memory at `reference`. On Linux alone: nowhere else is the peak of the resident set in a file.
#![cfg(target_os = "linux")]

mod peak;
mod slot_memory;

use common::accuracy::Accuracy;

/// With a life short enough: what is held of a life does not grow with it but for some numbers per block.
#[test]
fn one_more_slot_takes_less_than_20_mb() {
    let each = slot_memory::of_one_more_slot(Accuracy::reference(), 1000, 2);
    assert!(each < 20.0, "{each} MB");
}
