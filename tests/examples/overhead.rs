//! What a task costs beside its simulation: an empty simulator, recorded in memory, one worker in a process of
//! its own. `cargo run --release -p tests --example overhead`.

use coordinator::evaluate::Evaluator;
use std::time::Instant;
use tests::{coordinator, practice_result, requests};
use worker::service::{self, ServiceConfig, ServiceError};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if let Some(endpoint) = std::env::args().nth(1) {
        let setting = |n: usize| std::env::args().nth(n).and_then(|text| text.parse().ok()).unwrap_or(0);
        let config = ServiceConfig { prefetch: setting(3), ..ServiceConfig::new(endpoint, setting(2)) };
        service::run(config, std::sync::Arc::new(tests::Practice(practice_result)))?;
        return Ok(());
    }
    println!("slots prefetch  microseconds a task");
    for (slots, prefetch) in [(1, 0), (2, 0), (4, 0), (1, 3), (8, 8)] {
        println!("{slots:5} {prefetch:8}  {:.0}", measure(slots, prefetch)?);
    }
    Ok(())
}

/// Microseconds a task.
fn measure(slots: usize, prefetch: usize) -> Result<f64, Box<dyn std::error::Error>> {
    const TASKS: u64 = 5000;
    let mut coordinator = coordinator();
    let mut worker = std::process::Command::new(std::env::current_exe()?)
        .args([&coordinator.endpoints()[0], &slots.to_string(), &prefetch.to_string()])
        .spawn()?;
    let connected =
        coordinator.wait_for_workers(tests::PATIENCE, |workers| workers.iter().any(|w| w.slots > 0));
    if !connected {
        return Err(ServiceError::Messaging("the worker did not connect".into()).into());
    }
    let started = Instant::now();
    coordinator.evaluate(&requests(0..TASKS), &mut |_| Ok(()))?;
    let each = started.elapsed().as_secs_f64() / TASKS as f64;
    coordinator.finish();
    worker.wait()?;
    Ok(1e6 * each)
}
