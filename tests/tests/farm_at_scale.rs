//! The scheduler with 200 workers in simulated time; `cargo run --release -p tests --example simulated_farm` prints the
//! table for thousands.

use std::time::Duration;
use tests::simulated_farm::{Plan, simulate};

const PLAN: Plan = Plan {
    workers: 200,
    tasks: 8000,
    initial: 8000,
    batch: 0,
    joining: Duration::ZERO,
    takes: Duration::from_secs(5),
    spread: 1.0,
    latency: Duration::from_micros(300),
    claim_cost: Duration::from_micros(50),
    flush: Duration::from_millis(1),
    deaths: 0,
    stragglers: true,
};

#[test]
fn equal_workers_are_busy_almost_all_the_time() {
    let figures = simulate(PLAN);
    assert!(figures.efficiency_before_tail > 0.99, "{figures:?}");
    assert!(figures.efficiency > 0.95, "{figures:?}");
}

#[test]
fn unequal_workers_finish_together() {
    let figures = simulate(Plan { spread: 16.0, ..PLAN });
    let without = simulate(Plan { spread: 16.0, stragglers: false, ..PLAN });
    assert!(figures.efficiency_before_tail > 0.99, "{figures:?}");
    assert!(figures.efficiency > without.efficiency, "{figures:?}, but {without:?}");
    assert!(figures.repeated < PLAN.workers && without.repeated == 0, "{figures:?}");
}

#[test]
fn crashes_cost_only_the_lost_tasks() {
    let figures = simulate(Plan { deaths: 20, ..PLAN });
    assert!(figures.deaths > 300, "{figures:?}");
    assert!(figures.efficiency > 0.9, "{figures:?}");
}

#[test]
fn workers_that_join_later_are_busy_from_then_on() {
    let figures = simulate(Plan { joining: Duration::from_secs(60), ..PLAN });
    assert!(figures.efficiency > 0.95, "{figures:?}");
}

#[test]
fn a_study_takes_as_long_as_its_batches_however_many_workers_wait() {
    // 45 tasks at once, then 16 in progress: at least 3 s and 80 of 5 s in sixteenths.
    let study = Plan { tasks: 125, initial: 45, batch: 16, ..PLAN };
    let [few, many] = [16, 200].map(|workers| simulate(Plan { workers, ..study }).makespan.as_secs_f64());
    assert!(many < few && many > 25.0 && many < 45.0, "{few} s with 16 workers, {many} s with 200");
}
