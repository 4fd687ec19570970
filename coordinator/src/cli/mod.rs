//! The command line of the binary, one file per command. Results go to standard output, messages and logs to standard
//! error; a command ends with at most one error message and an exit code.

mod accuracy;
mod calibrate;
mod check;
mod command;
mod compare;
mod contact_choices;
mod designs;
mod doctor;
mod draw;
mod error;
mod evaluation_json;
mod explain;
mod external;
mod farm;
mod imported;
mod init;
mod learn;
mod measured;
mod model;
mod monitor;
mod nominal;
mod optimise;
mod output;
mod replace;
mod results;
mod run;
mod scene_options;
mod scenes;
mod shared;
mod shell;
mod signals;
mod simulate;
mod status;
mod stored_study;
mod study_options;
mod test_plan;
mod tradeoff;
mod update;
mod variants;
mod weibull;
mod what_if;

use accuracy::AccuracyArguments;
use command::{CommandArguments, CommandLine};
use common::panics::end_process_on_panic;
use coordinator::presentation::terminal::{messages_to_log, print_message};
use error::{CommandError, Done};
use farm::{CommandEvaluator, WorkerFarm, of_mechanism};
use output::{Destination, answer_with, count, print, to_json};
use scene_options::{DEFAULT_SCENE, SceneArguments, accuracy_name, load_with, scene_name};
use scenes::check_linkage;
use shared::{FarmArguments, Verbosity, positive, probability, seed, share, value, whole};
use std::process::ExitCode;
use stored_study::{OpenedStudy, StoredStudy, failed, known_outcomes, stored_correction, summary_of};
use study_options::RunArguments;
use worker::log;

/// Environment variable that overrides the log levels, in the syntax of `tracing`.
const LOG_VARIABLE: &str = "HINGEWISE_LOG";

/// Reads the command line and runs the command; the exit code of the process.
pub fn main() -> ExitCode {
    end_process_on_panic(
        "This is a defect of the program or of its messaging library, or the system is out of files or memory. Every \
         evaluation recorded so far is saved: continue a study with `coordinator resume DIR`.",
    );
    let arguments = CommandLine::read();
    start_log(arguments.verbosity);
    let done = run_command(arguments);
    // A program of a local worker may be at work for an evaluation that is not needed any more.
    common::external::kill_all();
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if error.exit_code() != 0 {
                let text = match &error {
                    CommandError::Scene(faults) => faults.explained(),
                    error => format!("error: {error}"),
                };
                print_message(text.trim_end());
            }
            ExitCode::from(error.exit_code())
        }
    }
}

fn run_command(arguments: CommandLine) -> Done {
    let CommandLine { verbosity, scene, run: options, command } = arguments;
    let json = verbosity.json;
    let Some(command) = command else {
        return run::run(scene.as_deref().unwrap_or(DEFAULT_SCENE), &options, verbosity);
    };
    if scene.is_some() || options != RunArguments::default() {
        let fault = "coordinator run --workers ...";
        return Err(CommandError::refused("options of a study go after `run`", fault));
    }
    match command {
        CommandArguments::Run { scene, options } => run::run(scene.get(), &options, verbosity),
        CommandArguments::Resume(options) => run::resume(&options, verbosity),
        CommandArguments::Sensitivity { dir } => results::sensitivity(&dir, json),
        CommandArguments::Report(study) => results::report(&study, json),
        CommandArguments::Compare(options) => compare::compare(&options, json),
        CommandArguments::Learn(options) => learn::learn(&options, verbosity),
        CommandArguments::Update(options) => update::update(&options, json),
        CommandArguments::Replace(options) => replace::replace(&options, json),
        CommandArguments::TestPlan(options) => test_plan::test_plan(&options, json),
        CommandArguments::Weibull(options) => weibull::weibull(&options, json),
        CommandArguments::Init(options) => init::init(&options, json),
        CommandArguments::Tradeoff(options) => tradeoff::tradeoff(&options, verbosity),
        CommandArguments::Calibrate(options) => calibrate::calibrate(&options, verbosity),
        CommandArguments::WhatIf(options) => what_if::what_if(&options, verbosity),
        CommandArguments::Designs(options) => designs::designs(&options, verbosity),
        CommandArguments::Optimise(options) => optimise::optimise(&options, verbosity),
        CommandArguments::Moved { .. } => Err(CommandError::refused(
            "extremes, replay, verify",
            "now examples of the sources: cargo run --release -p worker --example extremes, -p coordinator --example verify",
        )),
        CommandArguments::Simulate(options) => simulate::simulate(&options, verbosity),
        CommandArguments::Status(options) => status::status(&options, json),
        CommandArguments::Doctor(options) => doctor::doctor(&options, json),
        CommandArguments::Scenes { show } => scenes::scenes(show.as_deref(), json),
        CommandArguments::Draw(options) => draw::draw(&options, json),
        CommandArguments::Schema { results } => shell::schema(results),
        CommandArguments::Completions { shell } => shell::completions(shell),
        CommandArguments::Man { out } => shell::man(out.as_deref()),
        CommandArguments::Check(options) => check::check(&options, verbosity),
        CommandArguments::Explain { scene, accuracy, quick } => {
            explain::explain(&scene, &accuracy, quick, verbosity)
        }
    }
}

/// Starts the log on standard error.
fn start_log(verbosity: Verbosity) {
    // Zenoh logs the connections and disconnections of workers as errors; the coordinator reports them itself.
    let levels = match (verbosity.quiet, verbosity.verbose) {
        (true, _) => "error,zenoh=off",
        (false, 0) => "warn,zenoh=off",
        (false, 1) => "info,zenoh=warn",
        (false, _) => "debug,zenoh=info,rustls=info",
    };
    if verbosity.log_format == log::Format::Json {
        messages_to_log();
    }
    let with_messages = format!("{levels},coordinator::presentation::terminal=info");
    log::start(&with_messages, LOG_VARIABLE, verbosity.log_format, true);
}
