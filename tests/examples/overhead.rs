//! Cost of a task without its simulation: an empty simulator, each outcome durable in a campaign file, one worker in a
//! separate process. `cargo run --release -p tests --example overhead [FOLDER]`; the campaign files are in the folder, by
//! default the current one. `tests/examples/peers/run.sh` measures it beside Dask and HyperQueue, which keep nothing.

use coordinator::farm::evaluate::Evaluator;
use std::path::PathBuf;
use std::time::Instant;
use tests::coordinator;
use tests::journaled::Journaled;
use tests::practice_study::evaluation;
use worker::service::{self, ServiceConfig};

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
    println!("| slots | tasks | microseconds per task | tasks per transaction |\n|---|---|---|---|");
    for slots in [1, 2, 4] {
        let mut coordinator = coordinator();
        let mut worker = std::process::Command::new(std::env::current_exe()?)
            .args(["worker", &coordinator.endpoints[0], &slots.to_string()])
            .spawn()?;
        let connected =
            coordinator.connected.wait_for(tests::PATIENCE, |workers| workers.iter().any(|w| w.slots > 0));
        if !connected {
            return Err("the worker did not connect".into());
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
