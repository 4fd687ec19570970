//! Coordinator and worker of a practice study as processes, which tests kill, stop and disconnect.
//!
//! `practice_study coordinator FOLDER ENDPOINT SAMPLES [CONFIG]`: starts or resumes the study in the folder; prints `listening`,
//! `there NAME SECONDS` for each worker that connects, and `answer JSON` at the end.
//!
//! `practice_study worker ENDPOINT NAME MILLISECONDS [CONFIG]`: a worker with one slot whose simulations take this time;
//! prints `started MARK` at the start of each.
//!
//! `CONFIG`: a file with Zenoh settings, e.g. certificates.

use coordinator::farm::dispatch::{Listen, ZenohEvaluator};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tests::ClosureSimulator;
use tests::practice_study::{PracticeStudy, evaluation, mark};
use worker::service::{self, ServiceConfig};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["coordinator", folder, endpoint, samples, ref config @ ..] if config.len() < 2 => {
            coordinate(Path::new(folder), endpoint, samples, config.first().map(PathBuf::from))
        }
        ["worker", endpoint, name, milliseconds, ref config @ ..] if config.len() < 2 => {
            work(endpoint, name, milliseconds, config.first().map(PathBuf::from))
        }
        _ => Err("practice_study coordinator FOLDER ENDPOINT SAMPLES [CONFIG] \
                  | worker ENDPOINT NAME MILLISECONDS [CONFIG]"
            .into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn coordinate(
    folder: &Path,
    endpoint: &str,
    samples: &str,
    config: Option<PathBuf>,
) -> Result<(), Box<dyn Error>> {
    let study = PracticeStudy::monte_carlo(samples.parse()?);
    let (mut journal, resumed) = study.journal(folder)?;
    // In a separate network namespace, the coordinator must accept connections from outside.
    let listen = Listen { endpoint: Some(endpoint.into()), config, insecure: true };
    let mut evaluator = ZenohEvaluator::open(study.campaign(resumed), &listen, Arc::default())?;
    println!("listening");
    let (started, connected) = (Instant::now(), evaluator.connected.clone());
    std::thread::spawn(move || {
        let mut known: Vec<String> = Vec::new();
        loop {
            let here = |workers: &[coordinator::farm::dispatch::ConnectedWorker]| -> Vec<String> {
                workers.iter().map(|worker| worker.name.clone()).collect()
            };
            connected.wait_for(Duration::MAX, |workers| here(workers) != known);
            let now = here(&connected.workers());
            for name in now.iter().filter(|name| !known.contains(name)) {
                println!("there {name} {:.3}", started.elapsed().as_secs_f64());
            }
            known = now;
        }
    });
    let (answer, _) = study.run(&mut evaluator, &mut journal)?;
    evaluator.finish();
    println!("answer {answer}");
    Ok(())
}

fn work(
    endpoint: &str,
    name: &str,
    milliseconds: &str,
    zenoh_config: Option<PathBuf>,
) -> Result<(), Box<dyn Error>> {
    let takes = Duration::from_millis(milliseconds.parse()?);
    let simulate = move |sample: &[f64]| {
        println!("started {}", mark(sample));
        std::thread::sleep(takes);
        evaluation(sample)
    };
    let config = ServiceConfig {
        name: name.into(),
        give_up_after: None,
        zenoh_config,
        ..ServiceConfig::new(endpoint, 1)
    };
    service::run(config, Arc::new(ClosureSimulator(simulate)))?;
    Ok(())
}
