//! What can befall a farm, in short; `cargo run --release -p tests --example faults` does it in full.

use std::time::Duration;
use tests::faults;

#[test]
fn workers_are_killed_in_mid_task() {
    println!("{}", faults::killed_workers(3, 40));
}

#[test]
fn a_worker_is_frozen_for_longer_than_its_lease() {
    println!("{}", faults::frozen_worker(Duration::from_secs(3), 80));
}

#[test]
fn the_coordinator_is_killed_and_started_again() {
    let second = Duration::from_secs(1);
    println!("{}", faults::killed_coordinator(1, second, 24, second / 5));
}

#[test]
fn the_disk_is_slow() {
    println!("{}", faults::slow_disk(Duration::from_millis(50), 400));
}

#[test]
fn the_disk_is_full() {
    if let Some(found) = faults::full_disk(200, Duration::from_millis(5)) {
        println!("{found}");
    }
}

#[test]
fn the_network_is_cut() {
    let found = faults::cut_network(&[Duration::from_secs(3)], 60, Duration::from_millis(100));
    if let Some(found) = found {
        println!("{found}");
    }
}
