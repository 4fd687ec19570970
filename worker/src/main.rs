//! The `worker` command: offers this machine to a coordinator.

mod signals;

use clap::Parser;
use common::accuracy::NamedAccuracy;
use common::scene::{Faults, SceneSource};
use signals::{INTERRUPTED, Signals};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use thiserror::Error;
use tracing_subscriber::EnvFilter;
use worker::log;
use worker::service::{self, Departure, ServiceConfig, ServiceError};
use worker::simulator::simulator;
use worker::umbridge::{self, Model, NAME, Server, UmBridgeError};

const FAILURE: u8 = 1;
const BAD_INPUT: u8 = 2;

/// Longest time that can be asked for [s]: a hundred years.
const LONGEST: u64 = 100 * 366 * 24 * 3600;

/// The scene offered unless another one is named.
const DEFAULT_SCENE: &str = "flapping-wing";

/// Offers this machine to a Hingewise coordinator: claims simulations, runs them, hands the results in. Or offers
/// evaluations of a scene to other programs.
///
/// A worker may join and leave at any time; what it had not finished goes to others.
#[derive(Debug, Parser)]
#[command(name = "worker", version, after_help = EXAMPLES)]
struct Arguments {
    /// Where the coordinator listens, e.g. tcp/192.168.1.20:7447; several, if repeated, share the slots fairly
    #[arg(long, value_name = "ENDPOINT", required_unless_present = "serve_umbridge")]
    connect: Vec<String>,
    /// Offer evaluations of a scene to any client of the UM-Bridge protocol instead, on this port of this machine alone
    #[arg(long, value_name = "PORT|ADDRESS:PORT", conflicts_with_all = ["connect", "config", "name", "give_up_after"])]
    serve_umbridge: Option<String>,
    /// Scene file, or name of a built-in scene, to be offered [default: flapping-wing]
    #[arg(long, value_name = "NAME-or-FILE", requires = "serve_umbridge", conflicts_with = "connect")]
    scene: Option<String>,
    /// Numerical effort of an evaluation to be offered, unless a request says otherwise [default: balanced]
    #[arg(
        long,
        value_name = "draft|balanced|reference|NAME",
        requires = "serve_umbridge",
        conflicts_with = "connect"
    )]
    accuracy: Option<NamedAccuracy>,
    /// Allow --serve-umbridge on an address that other machines can reach
    #[arg(long, requires = "serve_umbridge", conflicts_with = "connect")]
    insecure: bool,
    /// Threads that simulate, each up to three evaluations side by side [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    slots: Option<u16>,
    /// More Zenoh settings, e.g. certificates (JSON5)
    #[arg(long, value_name = "ZENOH.json5")]
    config: Option<PathBuf>,
    /// Name shown by the coordinator [default: host and process]
    #[arg(long)]
    name: Option<String>,
    /// Give up when no coordinator answers for so long; 0: never
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    give_up_after: u64,
    /// Leave when there was nothing to do for so long
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..=LONGEST), conflicts_with = "serve_umbridge")]
    idle_timeout: Option<u64>,
    /// Have left so long after the start: begin nothing that would not end in time, hand back what has not ended
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..=LONGEST), conflicts_with = "serve_umbridge")]
    walltime: Option<u64>,
    /// When stopped (SIGTERM, Ctrl-C), let what runs go on for so long; what has not ended then is handed back
    #[arg(long, value_name = "SECONDS", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=LONGEST), conflicts_with = "serve_umbridge")]
    drain: u64,
    /// Where a campaign has ended, wait for the next one there for as long as it takes
    #[arg(long, conflicts_with_all = ["serve_umbridge", "give_up_after"])]
    stay: bool,
    /// Say more (twice: everything)
    #[arg(short, long, action = clap::ArgAction::Count, conflicts_with = "quiet")]
    verbose: u8,
    /// Say only what is wrong
    #[arg(short, long)]
    quiet: bool,
    /// Log for people, or as lines of JSON for programs that collect logs
    #[arg(long, value_name = "text|json", default_value = "text")]
    log_format: log::Format,
}

const EXAMPLES: &str = "\
Examples:
  worker --connect tcp/192.168.1.20:7447
      all cores of this machine for the coordinator started with
      `coordinator run --workers 0 --listen tcp/192.168.1.20:7447 --insecure`
  worker --connect tcp/127.0.0.1:7447 --slots 4 --give-up-after 0
      on four threads; waits for the coordinator for ever
  worker --connect tls/farm.example:7447 --config worker.json5
      encrypted, with the certificates named in worker.json5
  worker --connect tcp/127.0.0.1:7447 --walltime 3600 --idle-timeout 120 --drain 30
      in a batch job of an hour: leaves in time, or after two idle minutes; 30 s to finish when it is stopped
  worker --connect tcp/127.0.0.1:7447 --connect tcp/127.0.0.1:7448 --stay
      for whatever study runs at either address, half of the slots each while both do
  worker --serve-umbridge 4242 --scene four-bar --accuracy draft
      model `forward` at http://127.0.0.1:4242: random variables in, outputs over life out

Exit codes: 0 the campaign ended or the worker was stopped (SIGTERM), 1 failure, 2 bad input, 130 Ctrl-C.";

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    start_log(arguments.verbose, arguments.quiet, arguments.log_format);
    let done = match &arguments.serve_umbridge {
        Some(given) => offer(given, &arguments),
        None => serve(arguments).map_err(Failed::Service),
    };
    match done {
        Ok(code) => code,
        Err(error) => {
            eprintln!("worker: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// What ended the command.
#[derive(Debug, Error)]
enum Failed {
    #[error(transparent)]
    Service(#[from] ServiceError),
    #[error(transparent)]
    UmBridge(#[from] UmBridgeError),
    #[error(transparent)]
    Scene(#[from] Faults),
}

impl Failed {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Service(ServiceError::Settings { .. }) | Self::Scene(_) => BAD_INPUT,
            Self::UmBridge(UmBridgeError::Refused { .. }) | Self::Service(_) => FAILURE,
            Self::UmBridge(_) => BAD_INPUT,
        }
    }
}

fn slots(arguments: &Arguments) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    arguments.slots.map_or(cores, usize::from)
}

/// Serves until a signal comes.
fn offer(given: &str, arguments: &Arguments) -> Result<ExitCode, Failed> {
    let address = umbridge::address(given, arguments.insecure)?;
    let source = SceneSource::load(arguments.scene.as_deref().unwrap_or(DEFAULT_SCENE))?;
    if source.nominal().simulator.is_some() {
        return Err(UmBridgeError::NoMechanism { origin: source.origin().to_owned() }.into());
    }
    let scene = source.nominal().name.clone();
    let model = Model::new(source, arguments.accuracy.clone().unwrap_or_default());
    let signals = Signals::catch().map_err(no_signals)?;
    let server = Server::start(model, slots(arguments), address)?;
    tracing::info!("model \"{NAME}\", an evaluation of {scene}, at http://{}", server.address());
    let (stop, stopped) = std::sync::mpsc::channel();
    let whoever_waits = move || {
        // It may have left: the process is about to end.
        let _ = stop.send(());
    };
    let interrupted = signals.listen(whoever_waits).map_err(no_signals)?;
    // The sender lives with the thread of the signals, as long as the process.
    let _ = stopped.recv();
    tracing::info!("stopping: answering what was asked");
    server.finish();
    Ok(ended(&interrupted))
}

fn no_signals(error: std::io::Error) -> ServiceError {
    ServiceError::Messaging(format!("signals: {error}"))
}

fn ended(interrupted: &AtomicBool) -> ExitCode {
    if interrupted.load(Ordering::Relaxed) { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS }
}

fn serve(arguments: Arguments) -> Result<ExitCode, ServiceError> {
    let slots = slots(&arguments);
    let wanted = |seconds: u64| (seconds > 0).then(|| Duration::from_secs(seconds));
    let mut config = ServiceConfig {
        connect: arguments.connect,
        zenoh_config: arguments.config,
        give_up_after: wanted(arguments.give_up_after).filter(|_| !arguments.stay),
        drain: Duration::from_secs(arguments.drain),
        idle_timeout: arguments.idle_timeout.and_then(wanted),
        walltime: arguments.walltime.and_then(wanted),
        next_campaign: arguments.stay,
        ..ServiceConfig::new("", slots)
    };
    if let Some(name) = arguments.name {
        config.name = name;
    }
    tracing::info!("{slots} slots for the coordinator at {}", config.connect.join(", "));
    let signals = Signals::catch().map_err(no_signals)?;
    let worker = service::spawn(config, simulator())?;
    let stopper = worker.stopper();
    let stop = move || {
        tracing::info!("stopping: handing in what is finished");
        stopper.stop();
    };
    let interrupted = signals.listen(stop).map_err(no_signals)?;
    let departure = worker.join()?;
    match departure {
        Departure::CampaignEnded => tracing::info!("the coordinator has finished"),
        Departure::Stopped { lost: 0 } => tracing::info!("stopped, everything finished was handed in"),
        Departure::Stopped { lost } => {
            tracing::warn!("stopped; {lost} finished simulations could not be handed in");
        }
        Departure::Idle => tracing::info!("there was nothing to do for too long"),
        Departure::TimeUp { lost: 0 } => tracing::info!("the time is up, everything finished was handed in"),
        Departure::TimeUp { lost } => {
            tracing::warn!("the time is up; {lost} finished simulations could not be handed in");
        }
        Departure::Aborted => tracing::info!("aborted"),
    }
    Ok(ended(&interrupted))
}

fn start_log(verbose: u8, quiet: bool, format: log::Format) {
    // Zenoh warns at every attempt to connect; what matters of it the service says itself.
    let usual = match (quiet, verbose) {
        (true, _) => "error",
        (_, 0) => "info,zenoh=error",
        (_, 1) => "debug,zenoh=warn,rustls=info",
        _ => "trace,zenoh=debug",
    };
    log::start(usual, EnvFilter::DEFAULT_ENV, format, false);
}
