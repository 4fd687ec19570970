//! Throughput compared with the ideal: 1 to 256 workers in this process, whose simulations sleep for 50 ms, each
//! outcome durable in a campaign file. `cargo run --release -p tests --example throughput [FOLDER]`.

use coordinator::farm::evaluate::Evaluator;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tests::journaled::Journaled;
use tests::practice_study::evaluation;
use tests::{PATIENCE, coordinator, worker};

const TAKES: Duration = Duration::from_millis(50);
/// Tasks per worker.
const EACH: usize = 100;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    println!("| workers | tasks | tasks per second | of the ideal |\n|---|---|---|---|");
    for workers in [1, 2, 8, 64, 256] {
        let mut coordinator = coordinator();
        let handles: Vec<_> = (0..workers)
            .map(|k| {
                worker(&coordinator, &format!("w{k}"), 1, |sample| {
                    std::thread::sleep(TAKES);
                    evaluation(sample)
                })
            })
            .collect();
        let ready = |here: &[coordinator::farm::dispatch::ConnectedWorker]| {
            here.iter().filter(|worker| worker.slots > 0).count() == workers
        };
        assert!(coordinator.connected.wait_for(PATIENCE, ready), "the workers connect");
        let tasks = EACH * workers;
        let mut journaled = Journaled::new(tasks as u64, &folder);
        let started = Instant::now();
        coordinator.run(&mut journaled)?;
        let took = started.elapsed().as_secs_f64();
        coordinator.finish();
        for handle in handles {
            handle.join()?;
        }
        assert_eq!(journaled.recorded().0, tasks, "every outcome is in the file");
        let ideal = workers as f64 / TAKES.as_secs_f64();
        let rate = tasks as f64 / took;
        println!("| {workers} | {tasks} | {rate:.0} | {:.1} % |", 100.0 * rate / ideal);
    }
    Ok(())
}
