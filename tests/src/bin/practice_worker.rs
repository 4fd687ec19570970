//! A worker process whose simulations are a formula, which tests kill.
//!
//! `practice_worker ENDPOINT NAME work|hang`: prints `started ID` at the start of each simulation; with `hang`, no simulation
//! ends.

use std::process::ExitCode;
use std::sync::Arc;
use tests::{ClosureSimulator, practice_result};
use worker::service::{self, ServiceConfig};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [endpoint, name, manner] = &arguments[..] else {
        eprintln!("practice_worker ENDPOINT NAME work|hang");
        return ExitCode::from(2);
    };
    let hang = manner == "hang";
    let simulate = move |sample: &[f64]| {
        println!("started {}", sample[0]);
        if hang {
            loop {
                std::thread::park();
            }
        }
        practice_result(sample)
    };
    let config = ServiceConfig { name: name.clone(), ..ServiceConfig::new(endpoint, 1) };
    match service::run(config, Arc::new(ClosureSimulator(simulate))) {
        Ok(_) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
