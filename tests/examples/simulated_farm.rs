//! The scheduler with up to 10 000 workers, in simulated time: prints a table, and one of kinds of studies; with the argument `studies`
//! that one alone.
//! `cargo run --release -p tests --example simulated_farm`, about a minute.

use std::time::Duration;
use tests::simulated_farm::{Figures, Plan, simulate};

fn main() {
    if std::env::args().nth(1).is_none_or(|word| word != "studies") {
        farms();
    }
    studies();
}

/// The default study of the drive, direct simulation, and a program that takes minutes; one task of 500 crashes its worker where several
/// thousand workers do, workers join within the time given, and differ fourfold in speed.
fn studies() {
    println!(
        "\n| tasks | at the start, then in progress | task [s] | workers | join within [s] | crashes | takes [s] | busy | done twice |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (tasks, initial, batch, seconds) in
        [(250, 45, 16, 1.0), (100_000, 100_000, 0, 1.0), (100_000, 100_000, 0, 180.0)]
    {
        for (workers, joining) in [(16, 0.0), (1000, 0.0), (10_000, 0.0), (10_000, 60.0)] {
            let plan = Plan {
                workers,
                tasks,
                initial,
                batch,
                joining: Duration::from_secs_f64(joining),
                takes: Duration::from_secs_f64(seconds),
                spread: 4.0,
                latency: Duration::from_micros(300),
                claim_cost: Duration::from_micros(50),
                flush: Duration::from_millis(1),
                deaths: if joining > 0.0 { 500 } else { 0 },
                stragglers: true,
            };
            let Figures { makespan, efficiency, repeated, deaths, .. } = simulate(plan);
            let takes = makespan.as_secs_f64();
            println!(
                "| {tasks} | {initial}, {batch} | {seconds} | {workers} | {joining} | {deaths} | {takes:.1} | {:.1} % | {repeated} |",
                100.0 * efficiency
            );
        }
    }
}

fn farms() {
    println!(
        "| workers | task [s] | fastest / slowest | second worker for stragglers | crashes | busy before the tail | busy overall | done twice | scheduler per event |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (workers, seconds, spread, stragglers, deaths) in [
        (2, 0.3, 1.0, true, 0),
        (16, 0.3, 1.0, true, 0),
        (64, 5.0, 1.0, true, 0),
        (1000, 5.0, 1.0, true, 0),
        (1000, 5.0, 16.0, true, 0),
        (1000, 5.0, 16.0, false, 0),
        (1000, 5.0, 16.0, true, 50),
        (10_000, 5.0, 1.0, true, 0),
        (10_000, 20.0, 16.0, true, 0),
        (10_000, 20.0, 16.0, false, 0),
        (10_000, 20.0, 16.0, true, 50),
    ] {
        let plan = Plan {
            workers,
            tasks: 40 * workers,
            initial: 40 * workers,
            batch: 0,
            joining: Duration::ZERO,
            takes: Duration::from_secs_f64(seconds),
            spread,
            latency: Duration::from_micros(300),
            claim_cost: Duration::from_micros(50),
            flush: Duration::from_millis(1),
            deaths,
            stragglers,
        };
        let Figures { efficiency, efficiency_before_tail, repeated, deaths, per_event, .. } = simulate(plan);
        println!(
            "| {workers} | {seconds} | {spread} | {} | {deaths} | {:.1} % | {:.1} % | {repeated} of {} | {:.1} us |",
            if stragglers { "yes" } else { "no" },
            100.0 * efficiency_before_tail,
            100.0 * efficiency,
            plan.tasks,
            1e6 * per_event.as_secs_f64()
        );
    }
}
