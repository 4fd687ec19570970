//! The `worker` command: offers this machine to a coordinator.

use clap::Parser;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use tracing_subscriber::EnvFilter;
use worker::service::{self, Departure, ServiceConfig, ServiceError, Stopper};
use worker::simulator::simulator;

const FAILURE: u8 = 1;
const BAD_INPUT: u8 = 2;
const INTERRUPTED: u8 = 130;

/// Offers this machine to a Hingewise coordinator: claims simulations, runs them, hands the results in.
///
/// A worker may join and leave at any time; what it had not finished goes to others.
#[derive(Debug, Parser)]
#[command(name = "worker", version, after_help = EXAMPLES)]
struct Arguments {
    /// Where the coordinator listens, e.g. tcp/192.168.1.20:7447
    #[arg(long, value_name = "ENDPOINT")]
    connect: String,
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
    /// Say more (twice: everything)
    #[arg(short, long, action = clap::ArgAction::Count, conflicts_with = "quiet")]
    verbose: u8,
    /// Say only what is wrong
    #[arg(short, long)]
    quiet: bool,
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

Exit codes: 0 the campaign ended or the worker was stopped (SIGTERM), 1 failure, 2 bad input, 130 Ctrl-C.";

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    start_log(arguments.verbose, arguments.quiet);
    match serve(arguments) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("worker: {error}");
            ExitCode::from(if matches!(error, ServiceError::Settings { .. }) { BAD_INPUT } else { FAILURE })
        }
    }
}

fn serve(arguments: Arguments) -> Result<ExitCode, ServiceError> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let slots = arguments.slots.map_or(cores, usize::from);
    let mut config = ServiceConfig::new(arguments.connect, slots);
    config.zenoh_config = arguments.config;
    config.give_up_after =
        (arguments.give_up_after > 0).then(|| Duration::from_secs(arguments.give_up_after));
    if let Some(name) = arguments.name {
        config.name = name;
    }
    tracing::info!("{slots} slots for the coordinator at {}", config.connect);
    let worker = service::spawn(config, simulator())?;
    let signals = listen_to_signals(worker.stopper())?;
    let departure = worker.join()?;
    match departure {
        Departure::CampaignEnded => tracing::info!("the coordinator has finished"),
        Departure::Stopped { lost: 0 } => tracing::info!("stopped, everything finished was handed in"),
        Departure::Stopped { lost } => {
            tracing::warn!("stopped; {lost} finished simulations could not be handed in");
        }
        Departure::Aborted => tracing::info!("aborted"),
    }
    let interrupted = signals.load(std::sync::atomic::Ordering::Relaxed);
    Ok(if interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

/// Stops the worker at SIGTERM or Ctrl-C; a second signal ends the process at once. The flag says whether it was
/// Ctrl-C.
fn listen_to_signals(
    stopper: Stopper,
) -> Result<std::sync::Arc<std::sync::atomic::AtomicBool>, ServiceError> {
    use std::sync::atomic::{AtomicBool, Ordering};
    use tokio::signal::unix::{SignalKind, signal};
    let failed = |error: std::io::Error| ServiceError::Messaging(format!("signals: {error}"));
    let interrupted = std::sync::Arc::new(AtomicBool::new(false));
    let flag = std::sync::Arc::clone(&interrupted);
    // Its own small runtime: the service itself needs none, and Zenoh brings its own.
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
    let (mut interrupt, mut terminate) = {
        let _inside = runtime.enter();
        (signal(SignalKind::interrupt()).map_err(failed)?, signal(SignalKind::terminate()).map_err(failed)?)
    };
    let wait = move || {
        runtime.block_on(async move {
            for first in [true, false] {
                tokio::select! {
                    _ = interrupt.recv() => flag.store(true, Ordering::Relaxed),
                    _ = terminate.recv() => {}
                }
                if first {
                    tracing::info!("stopping: handing in what is finished");
                    stopper.stop();
                }
            }
            std::process::exit(i32::from(INTERRUPTED));
        });
    };
    std::thread::Builder::new().name("signals".into()).spawn(wait).map_err(failed)?;
    Ok(interrupted)
}

fn start_log(verbose: u8, quiet: bool) {
    // Zenoh warns at every attempt to connect; what matters of it the service says itself.
    let usual = match (quiet, verbose) {
        (true, _) => "error",
        (_, 0) => "info,zenoh=error",
        (_, 1) => "debug,zenoh=warn",
        _ => "trace,zenoh=debug",
    };
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(usual));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .init();
}
