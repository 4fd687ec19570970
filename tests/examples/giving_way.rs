//! Slowdown of learning by local workers on every core: a computation alone, with slots of lower priority (as with
//! `--workers auto`), and with slots of normal priority.
//! `cargo run --release -p tests --example giving_way`.

use coordinator::farm::evaluate::Evaluator;
use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use tests::{ClosureSimulator, PATIENCE, coordinator_at, practice_result, requests};
use worker::service::{self, ServiceConfig};

/// A computation of about one second; its wall time.
fn compute() -> Duration {
    let started = Instant::now();
    let mut x = 0.5_f64;
    for _ in 0..300_000_000_u64 {
        x = black_box(3.7 * x * (1.0 - x));
    }
    started.elapsed()
}

/// Wall time of the computation with simulations on every core, and the number of simulations that ended meanwhile.
fn compute_with_simulations(give_way: bool) -> (Duration, usize) {
    let stopped = Arc::default();
    let mut coordinator = coordinator_at(None, Arc::clone(&stopped));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let config = ServiceConfig { give_way, ..ServiceConfig::new(&coordinator.endpoints[0], cores) };
    let simulate = |sample: &[f64]| {
        let started = Instant::now();
        while started.elapsed() < Duration::from_millis(20) {
            black_box(sample);
        }
        practice_result(sample)
    };
    let worker =
        service::spawn(config, Arc::new(ClosureSimulator(simulate))).expect("a loopback endpoint opens");
    assert!(coordinator.connected.wait_for(PATIENCE, |here| here.iter().any(|worker| worker.slots > 0)));
    let (mut ended, mut took) = (0, Duration::ZERO);
    std::thread::scope(|scope| {
        let computation = scope.spawn(|| {
            let took = compute();
            stopped.store(true, Ordering::Relaxed);
            took
        });
        // It ends with the computation.
        let _ = coordinator.evaluate(&requests(0..1_000_000), &mut |_| {
            ended += 1;
            Ok(())
        });
        took = computation.join().expect("the computation does not panic");
    });
    worker.stopper.abort();
    (took, ended)
}

fn main() {
    println!("| simulations | computation [s] | slowdown | simulations ended meanwhile |\n|---|---|---|---|");
    let alone = compute();
    println!("| none | {:.2} | 1.00 | 0 |", alone.as_secs_f64());
    for (name, give_way) in [("slots of lower priority", true), ("slots of normal priority", false)] {
        let (took, ended) = compute_with_simulations(give_way);
        let times = took.as_secs_f64() / alone.as_secs_f64();
        println!("| {name} | {:.2} | {times:.2} | {ended} |", took.as_secs_f64());
    }
}
