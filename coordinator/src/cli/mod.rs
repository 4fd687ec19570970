//! The command line: what the binary does with its arguments. Results go to standard output, all else to standard
//! error; a command ends with one message and an exit code.

mod accuracy;
mod arguments;
mod benchmark;
mod calibrate;
mod compare;
mod distributions;
mod doctor;
mod error;
mod explain;
mod external;
mod extremes;
mod farm;
mod init;
mod model;
mod monitor;
mod names;
mod opened;
mod options;
mod output;
mod replay;
mod results;
mod run;
mod scenes;
mod signals;
mod simulate;
mod status;
mod tradeoff;
mod verify;

use arguments::{Arguments, Command, RunArguments, Talk};
use clap::Parser;
use error::CommandError;
use std::process::ExitCode;
use worker::log;

/// Environment variable that overrides what is logged, in the syntax of `tracing`.
const LOG_VARIABLE: &str = "HINGEWISE_LOG";

/// Parses the arguments and does what they ask.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    start_log(arguments.talk);
    match command(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if error.exit_code() != 0 {
                eprintln!("error: {error}");
            }
            ExitCode::from(error.exit_code())
        }
    }
}

fn command(arguments: Arguments) -> Result<(), CommandError> {
    let json = arguments.talk.json;
    if arguments.command.is_some() && arguments.run != RunArguments::default() {
        return Err(CommandError::MisplacedOptions);
    }
    match arguments.command {
        None => run::run(&arguments.run, arguments.talk),
        Some(Command::Run(study)) => run::run(&study, arguments.talk),
        Some(Command::Resume(study)) => run::resume(&study, arguments.talk),
        Some(Command::Sensitivity(study)) => results::sensitivity(&study.dir, json),
        Some(Command::Report(study)) => results::report(&study.dir, json),
        Some(Command::Compare(studies)) => compare::compare(&studies, json),
        Some(Command::Init(scene)) => init::init(&scene, json),
        Some(Command::Extremes(table)) => extremes::extremes(&table, arguments.talk),
        Some(Command::Tradeoff(measurement)) => tradeoff::tradeoff(&measurement, arguments.talk),
        Some(Command::Benchmark(benchmark)) => benchmark::benchmark(&benchmark, arguments.talk),
        Some(Command::Calibrate(calibration)) => calibrate::calibrate(&calibration, arguments.talk),
        Some(Command::Replay(study)) => replay::replay(&study, json),
        Some(Command::Verify(verification)) => verify::verify(&verification, json),
        Some(Command::Simulate(simulation)) => simulate::simulate(&simulation, arguments.talk),
        Some(Command::Status(look)) => status::status(&look, json),
        Some(Command::Doctor(patient)) => doctor::doctor(&patient, json),
        Some(Command::Scenes { show }) => scenes::scenes(show.as_deref(), json),
        Some(Command::Check { file }) => scenes::check(&file, json),
        Some(Command::Explain { scene, accuracy }) => explain::explain(&scene, &accuracy, arguments.talk),
    }
}

/// Logs go to standard error.
fn start_log(talk: Talk) {
    // Zenoh reports the comings and goings of workers as errors; what matters of them is said here anyway.
    let level = match (talk.quiet, talk.verbose) {
        (true, _) => "error,zenoh=off",
        (false, 0) => "warn,zenoh=off",
        (false, 1) => "info,zenoh=warn",
        (false, _) => "debug,zenoh=info,rustls=info",
    };
    log::start(level, LOG_VARIABLE, talk.log_format, true);
}
