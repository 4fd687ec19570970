//! Faults of a farm in short runs; `cargo run --release -p tests --example faults` has the long ones.

use std::time::Duration;
use tests::faults::{self, MOST_UNRECORDED, Report};

const SECOND: Duration = Duration::from_secs(1);

/// Prints the measured values and returns whether the fault left answer and records unchanged.
fn is_undisturbed(report: &Report) -> bool {
    println!("{report}");
    report.is_undisturbed()
}

#[test]
fn workers_are_killed_in_mid_task() {
    let report = faults::killed_workers(3, 40);
    assert!(is_undisturbed(&report), "{report:?}");
    assert_eq!(report.times.len(), 3, "each loss is detected");
    assert!(report.workers.contains(&"steady/0".to_owned()), "{report:?}");
}

#[test]
fn a_worker_is_frozen_for_longer_than_its_lease() {
    let report = faults::frozen_worker(3 * SECOND, 80);
    assert!(is_undisturbed(&report), "{report:?}");
    assert_eq!(report.workers, ["frozen/0", "steady/0"], "both finish evaluations");
}

#[test]
fn the_coordinator_is_killed_and_started_again() {
    let report = faults::killed_coordinator(1, SECOND, 24, SECOND / 5);
    assert!(is_undisturbed(&report), "{report:?}");
    assert_eq!((report.records_lost, report.records_repeated, report.times.len()), (0, 0, 1));
}

#[test]
fn the_disk_is_slow() {
    let report = faults::slow_disk(Duration::from_millis(50), 400);
    assert!(is_undisturbed(&report), "{report:?}");
    assert!(report.unrecorded <= MOST_UNRECORDED, "{report:?}");
}

#[test]
fn the_disk_is_full() {
    if let Some(report) = faults::full_disk(200, Duration::from_millis(5)) {
        assert!(is_undisturbed(&report), "{report:?}");
        assert!(report.error.contains("full") && report.error.contains("campaign.db"), "{report:?}");
    }
}

#[test]
fn the_network_is_cut() {
    if let Some(report) = faults::cut_network(&[3 * SECOND], 60, SECOND / 10) {
        assert!(is_undisturbed(&report), "{report:?}");
    }
}
