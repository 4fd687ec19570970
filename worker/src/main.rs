//! The `worker` command: runs simulations of a coordinator on this machine.

mod signals;

use clap::{CommandFactory, Parser};
use clap_complete::Shell;
use common::accuracy::NamedAccuracy;
use common::panics::end_process_on_panic;
use common::scene::{Faults, SceneSource};
use signals::{INTERRUPTED, Signals};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use thiserror::Error;
use tracing_subscriber::EnvFilter;
use worker::log;
use worker::own_simulators::{self, OfferError, OwnSimulators};
use worker::serve_cycle;
use worker::service::{self, Departure, ServiceConfig, ServiceError, Simulator};
use worker::simulator::simulator;
use worker::umbridge::{self, Model, NAME, Server, UmBridgeError};

const FAILURE: u8 = 1;
const BAD_INPUT: u8 = 2;

/// Largest time accepted by an option [s]: a hundred years.
const LONGEST: u64 = 100 * 366 * 24 * 3600;

/// Default scene of `--serve-umbridge`.
const DEFAULT_SCENE: &str = "flapping-wing";

/// Runs simulations of a Hingewise coordinator on this machine, offers programs of this machine to it, or serves evaluations of a scene to UM-Bridge clients.
///
/// A worker may join and leave at any time; the coordinator gives its unfinished tasks to other workers.
#[derive(Debug, Parser)]
#[command(name = "worker", version, after_help = EXAMPLES)]
struct Arguments {
    /// Endpoint of the coordinator, e.g. tcp/192.168.1.20:7447; may be repeated: the coordinators share the slots fairly
    #[arg(long, value_name = "ENDPOINT", required_unless_present_any = ["serve_umbridge", "serve_cycle", "completions", "man"])]
    connect: Vec<String>,
    /// Serve evaluations of a scene by the UM-Bridge protocol instead; a port alone accepts only clients on this machine
    #[arg(long, value_name = "PORT|ADDRESS:PORT", conflicts_with_all = ["connect", "config", "name", "give_up_after"])]
    serve_umbridge: Option<String>,
    /// Serve cycles of a scene on standard input and output instead, as a program of a scene with gives = "cycle"
    #[arg(long, value_name = "NAME-or-FILE", conflicts_with_all = ["connect", "config", "name", "give_up_after", "serve_umbridge", "simulator", "slots", "idle_timeout", "walltime", "drain", "stay"])]
    serve_cycle: Option<String>,
    /// Scene file or name of a built-in scene to serve [default: flapping-wing]
    #[arg(long, value_name = "NAME-or-FILE", requires = "serve_umbridge", conflicts_with = "connect")]
    scene: Option<String>,
    /// Accuracy of served evaluations, unless a request sets it [default: balanced]
    #[arg(
        long,
        value_name = "draft|balanced|reference|NAME",
        requires = "serve_umbridge",
        conflicts_with = "connect"
    )]
    accuracy: Option<NamedAccuracy>,
    /// Allow --serve-umbridge on an address that other machines can reach, without authentication
    #[arg(long, requires = "serve_umbridge", conflicts_with = "connect")]
    insecure: bool,
    /// Offer the simulator that this scene file names, instead of simulating mechanisms; a folder means all scene files in it; may be repeated
    #[arg(long, value_name = "FILE|FOLDER", conflicts_with = "serve_umbridge")]
    simulator: Vec<PathBuf>,
    /// Simulation threads, each with several evaluations side by side [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    slots: Option<u16>,
    /// File with further Zenoh settings, e.g. certificates (JSON5)
    #[arg(long, value_name = "ZENOH.json5")]
    config: Option<PathBuf>,
    /// Name of this worker at the coordinator [default: host and process number]
    #[arg(long)]
    name: Option<String>,
    /// Give up after this time without an answer of a coordinator; 0: never
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    give_up_after: u64,
    /// Leave after this time without tasks
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..=LONGEST), conflicts_with = "serve_umbridge")]
    idle_timeout: Option<u64>,
    /// Maximum run time: start no task that cannot finish within it, return unfinished tasks
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..=LONGEST), conflicts_with = "serve_umbridge")]
    walltime: Option<u64>,
    /// After SIGTERM or Ctrl-C, let running tasks continue for this time, then return unfinished tasks
    #[arg(long, value_name = "SECONDS", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=LONGEST), conflicts_with = "serve_umbridge")]
    drain: u64,
    /// Wait for the next campaign at the same endpoint when a campaign has ended, without a time limit
    #[arg(long, conflicts_with_all = ["serve_umbridge", "give_up_after"])]
    stay: bool,
    /// Log more details (twice: everything)
    #[arg(short, long, action = clap::ArgAction::Count, conflicts_with = "quiet")]
    verbose: u8,
    /// Log errors only
    #[arg(short, long)]
    quiet: bool,
    /// Format of the log: plain text, or one JSON object per line
    #[arg(long, value_name = "text|json", default_value = "text")]
    log_format: log::Format,
    /// Print the completions for a shell, and end
    #[arg(long, value_name = "SHELL", exclusive = true)]
    completions: Option<Shell>,
    /// Print the manual page, and end
    #[arg(long, exclusive = true)]
    man: bool,
}

const EXAMPLES: &str = "\
Examples:
  worker --connect tcp/192.168.1.20:7447
      all cores of this machine, for a coordinator started with
      `coordinator run --workers 0 --listen tcp/192.168.1.20:7447 --insecure`
  worker --connect tcp/127.0.0.1:7447 --slots 4 --give-up-after 0
      four threads; waits for the coordinator without a time limit
  worker --connect tls/farm.example:7447 --config worker.json5
      encrypted connection with the certificates named in worker.json5
  worker --connect tcp/127.0.0.1:7447 --walltime 3600 --idle-timeout 120 --drain 30
      in a batch job of one hour: leaves in time, or after two minutes without tasks;
      30 s to finish when stopped
  worker --connect tcp/127.0.0.1:7447 --connect tcp/127.0.0.1:7448 --stay
      for studies at either address; while both run, each gets half of the slots
  worker --connect tcp/192.168.1.20:7447 --simulator beam.toml --slots 2
      two processes of the program that beam.toml names here, for studies of the same scene; the
      coordinator sends samples, never a command; it may bound the processes on all workers (licences)
  worker --serve-cycle four-bar
      cycles of the four-bar on worn bores for a wear loop, lines of JSON in and out
  worker --serve-umbridge 4242 --scene four-bar --accuracy draft
      model `forward` at http://127.0.0.1:4242: random variables in, outputs over life out

Exit codes: 0 the campaign ended or the worker was stopped (SIGTERM), 1 failure, 2 bad input, 130 Ctrl-C.";

fn main() -> ExitCode {
    end_process_on_panic(
        "This is a defect of the program or of its messaging library, or the system is out of files or memory. The \
         coordinator gives the unfinished evaluations to other workers.",
    );
    let arguments = Arguments::parse();
    let printed = match arguments.completions {
        Some(shell) => Some(print_completions(Arguments::command(), shell)),
        None => arguments.man.then(|| print_manual(Arguments::command())),
    };
    if let Some(printed) = printed {
        return match printed {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("worker: standard output: {error}");
                ExitCode::from(FAILURE)
            }
        };
    }
    let log_format = arguments.log_format;
    start_log(arguments.verbose, arguments.quiet, log_format);
    let done = match (&arguments.serve_umbridge, &arguments.serve_cycle) {
        (Some(given), _) => serve_umbridge(given, &arguments),
        (None, Some(scene)) => serve_cycle(scene),
        (None, None) => work(arguments),
    };
    // A program may be at work for an evaluation that is not needed any more.
    common::external::kill_all();
    match done {
        Ok(code) => code,
        Err(error) => {
            match log_format {
                log::Format::Text => eprintln!("worker: {error}"),
                log::Format::Json => tracing::error!("{error}"),
            }
            ExitCode::from(error.exit_code())
        }
    }
}

/// Errors that end the command.
#[derive(Debug, Error)]
enum CommandError {
    #[error(transparent)]
    Service(#[from] ServiceError),
    #[error(transparent)]
    UmBridge(#[from] UmBridgeError),
    #[error(transparent)]
    Scene(#[from] Faults),
    #[error(transparent)]
    Offer(#[from] OfferError),
    #[error("signals cannot be caught: {0}")]
    Signals(std::io::Error),
    #[error("cycles cannot be served: {0}")]
    Cycle(std::io::Error),
}

impl CommandError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Service(ServiceError::Settings { .. }) => BAD_INPUT,
            Self::UmBridge(UmBridgeError::Refused { .. }) | Self::Service(_) => FAILURE,
            Self::Signals(_) | Self::Cycle(_) => FAILURE,
            Self::UmBridge(_) | Self::Scene(_) | Self::Offer(_) => BAD_INPUT,
        }
    }
}

fn slots(arguments: &Arguments) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    arguments.slots.map_or(cores, usize::from)
}

/// Serves evaluations by the UM-Bridge protocol until a signal arrives.
fn serve_umbridge(given: &str, arguments: &Arguments) -> Result<ExitCode, CommandError> {
    let address = umbridge::address(given, arguments.insecure)?;
    let source = SceneSource::load(arguments.scene.as_deref().unwrap_or(DEFAULT_SCENE))?;
    if source.nominal().simulator.is_some() {
        return Err(UmBridgeError::NoMechanism(source.origin().to_owned()).into());
    }
    let scene = source.nominal().name.clone();
    let model = Model::new(source, arguments.accuracy.clone().unwrap_or_default());
    let signals = Signals::catch().map_err(CommandError::Signals)?;
    let server = Server::start(model, slots(arguments), address)?;
    tracing::info!("serving evaluations of {scene} as model \"{NAME}\" at http://{}", server.address());
    let (stop, stopped) = std::sync::mpsc::channel();
    let notify = move || {
        // The receiver is gone when the process is about to exit.
        let _ = stop.send(());
    };
    let interrupted = signals.listen(notify).map_err(CommandError::Signals)?;
    // The sender belongs to the signal thread, which runs as long as the process.
    let _ = stopped.recv();
    tracing::info!("stopping: answering the open requests");
    server.finish();
    Ok(exit_code(&interrupted))
}

/// Serves cycles of a scene until the input ends.
fn serve_cycle(scene: &str) -> Result<ExitCode, CommandError> {
    let source = SceneSource::load(scene)?;
    if source.nominal().simulator.is_some() {
        return Err(UmBridgeError::NoMechanism(source.origin().to_owned()).into());
    }
    serve_cycle::serve(&source, std::io::stdin().lock(), std::io::stdout().lock())
        .map_err(CommandError::Cycle)?;
    Ok(ExitCode::SUCCESS)
}

/// The simulation of mechanisms, or the simulators of scene files.
fn offered(files: &[PathBuf]) -> Result<Arc<dyn Simulator>, OfferError> {
    if files.is_empty() {
        return Ok(simulator());
    }
    let own = OwnSimulators::open(&own_simulators::load(files)?)?;
    for id in own.ids() {
        tracing::info!("offering simulator {id}");
    }
    Ok(Arc::new(own))
}

fn exit_code(interrupted: &AtomicBool) -> ExitCode {
    if interrupted.load(Ordering::Relaxed) { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS }
}

/// Evaluates tasks of the coordinators until they end or a signal arrives.
fn work(arguments: Arguments) -> Result<ExitCode, CommandError> {
    let slots = slots(&arguments);
    let simulator = offered(&arguments.simulator)?;
    let limit = |seconds: u64| (seconds > 0).then(|| Duration::from_secs(seconds));
    let mut config = ServiceConfig {
        connect: arguments.connect,
        zenoh_config: arguments.config,
        give_up_after: limit(arguments.give_up_after).filter(|_| !arguments.stay),
        drain: Duration::from_secs(arguments.drain),
        idle_timeout: arguments.idle_timeout.and_then(limit),
        walltime: arguments.walltime.and_then(limit),
        next_campaign: arguments.stay,
        ..ServiceConfig::new("", slots)
    };
    if let Some(name) = arguments.name {
        config.name = name;
    }
    tracing::info!("{slots} slots for the coordinator at {}", config.connect.join(", "));
    let signals = Signals::catch().map_err(CommandError::Signals)?;
    let worker = service::spawn(config, simulator)?;
    let stopper = worker.stopper.clone();
    let stop = move || {
        tracing::info!("stopping: returning finished outcomes");
        stopper.stop();
    };
    let interrupted = signals.listen(stop).map_err(CommandError::Signals)?;
    let left = |why: &str, lost: usize| match lost {
        0 => tracing::info!("{why}; all finished outcomes were returned"),
        _ => tracing::warn!("{why}; {lost} finished outcomes could not be returned"),
    };
    match worker.join()? {
        Departure::CampaignEnded => tracing::info!("the coordinator has finished"),
        Departure::Stopped { lost } => left("stopped", lost),
        Departure::Idle => tracing::info!("left after --idle-timeout without tasks"),
        Departure::TimeUp { lost } => left("--walltime is over", lost),
        Departure::Aborted => tracing::info!("aborted"),
    }
    Ok(exit_code(&interrupted))
}

fn start_log(verbose: u8, quiet: bool, format: log::Format) {
    // Zenoh warns at every failed attempt to connect; the service logs these failures itself.
    let levels = match (quiet, verbose) {
        (true, _) => "error",
        (_, 0) => "info,zenoh=error",
        (_, 1) => "debug,zenoh=warn,rustls=info",
        _ => "trace,zenoh=debug",
    };
    log::start(levels, EnvFilter::DEFAULT_ENV, format, false);
}

/// Name of the program, as shells know it.
const PROGRAM: &str = "worker";

/// Prints the completions of a command line for a shell.
///
/// # Errors
/// The error of standard output.
fn print_completions(mut command: clap::Command, shell: Shell) -> std::io::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, PROGRAM, &mut script);
    std::io::stdout().write_all(&script)
}

/// Prints the manual page of a command line.
///
/// # Errors
/// The error of standard output.
fn print_manual(command: clap::Command) -> std::io::Result<()> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    std::io::stdout().write_all(&page)
}
