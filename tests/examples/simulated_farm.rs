//! The scheduler with up to 10 000 workers, in simulated time: prints a table.
//! `cargo run --release -p tests --example simulated_farm`, about a minute.

use std::time::Duration;
use tests::simulated_farm::{Figures, Plan, simulate};

fn main() {
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
            tasks_each: 40,
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
            workers * plan.tasks_each,
            1e6 * per_event.as_secs_f64()
        );
    }
}
