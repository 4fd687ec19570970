//! What a task costs beside its simulation: an empty simulator, each outcome durable in a campaign file, one worker in a
//! process of its own. `cargo run --release -p tests --example overhead [FOLDER]`; the campaign files lie in the folder,
//! or in the present one. `tests/examples/dask/run.sh` has the same of Dask, which keeps its results in memory.

use coordinator::farm::evaluate::Evaluator;
use std::path::PathBuf;
use std::time::Instant;
use tests::coordinator;
use tests::journaled::Journaled;
use tests::practice_study::evaluation;
use worker::service::{self, ServiceConfig, ServiceError};

const TASKS: u64 = 5000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [word, endpoint, slots] = &arguments[..]
        && word == "worker"
    {
        let config = ServiceConfig::new(endpoint, slots.parse()?);
        service::run(config, std::sync::Arc::new(tests::ClosureSimulator(evaluation)))?;
        return Ok(());
    }
    let folder = PathBuf::from(arguments.first().map_or(".", String::as_str));
    println!("| slots | tasks | microseconds a task | tasks a transaction |\n|---|---|---|---|");
    for slots in [1, 2, 4] {
        let mut coordinator = coordinator();
        let mut worker = std::process::Command::new(std::env::current_exe()?)
            .args(["worker", &coordinator.endpoints()[0], &slots.to_string()])
            .spawn()?;
        let connected =
            coordinator.wait_for_workers(tests::PATIENCE, |workers| workers.iter().any(|w| w.slots > 0));
        if !connected {
            return Err(ServiceError::Messaging("the worker did not connect".into()).into());
        }
        let mut journaled = Journaled::new(TASKS, &folder);
        let started = Instant::now();
        coordinator.run(&mut journaled)?;
        let each = 1e6 * started.elapsed().as_secs_f64() / TASKS as f64;
        coordinator.finish();
        worker.wait()?;
        let (recorded, writes) = journaled.recorded();
        assert_eq!(recorded as u64, TASKS, "every outcome is in the file");
        println!("| {slots} | {TASKS} | {each:.0} | {:.0} |", TASKS as f64 / writes as f64);
    }
    Ok(())
}
