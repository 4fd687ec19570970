//! `coordinator status`: asks a running coordinator how its study is getting on.

use super::error::CommandError;
use super::output::{print, to_json};
use clap::Args;
use common::wire::{Phase, Status};
use coordinator::farm::dispatch::{ClientError, ClientSession};
use coordinator::presentation::monitor::text::status_text;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use worker::log::refusal;

/// Shown below `coordinator status --help`.
pub const EXAMPLES: &str = "\
Examples:
  coordinator status tcp/127.0.0.1:7447
  coordinator status tcp/127.0.0.1:7447 --watch
  coordinator status tls/coordinator.example:7447 --config worker.json5 --json

ENDPOINT is what `coordinator run --listen` says. Exit codes: 0 shown, 1 no answer, 2 bad input.";

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time between two looks, on a terminal and elsewhere.
const REDRAW: Duration = Duration::from_secs(1);
const REPEAT: Duration = Duration::from_secs(10);

/// Where to look, and how often.
#[derive(Debug, Clone, Args)]
pub struct StatusArguments {
    /// Where the coordinator listens, e.g. tcp/127.0.0.1:7447
    pub endpoint: String,
    /// Zenoh configuration (JSON5), e.g. for TLS and passwords; that of a worker will do
    #[arg(long, value_name = "ZENOH.json5")]
    pub config: Option<PathBuf>,
    /// Look again and again: drawn anew each second on a terminal, printed every 10 s elsewhere
    #[arg(long)]
    pub watch: bool,
}

/// Runs the command.
pub fn status(arguments: &StatusArguments, as_json: bool) -> Result<(), CommandError> {
    let begun = Instant::now();
    let session = ClientSession::open(&arguments.endpoint, arguments.config.as_deref());
    let session = session.map_err(|error| explained(error, begun))?;
    let mut shown = session.status(PATIENCE)?;
    if !arguments.watch {
        return print(&text(&shown, as_json)?);
    }
    let draws = std::io::stdout().is_terminal() && !as_json;
    loop {
        let text = text(&shown, as_json)?;
        // Home, each line to its end, then whatever was below: nothing flickers.
        print(&if draws { format!("\x1b[H{}\x1b[J", text.replace('\n', "\x1b[K\n")) } else { text })?;
        std::thread::sleep(if draws { REDRAW } else { REPEAT });
        match session.status(PATIENCE) {
            Ok(status) => shown = status,
            // It was about to end.
            Err(ClientError::Silent { .. }) if shown.phase == Phase::Ending => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
}

fn text(status: &Status, as_json: bool) -> Result<String, CommandError> {
    if as_json { to_json(status) } else { Ok(status_text(status)) }
}

/// An error of a visit with the likely cause of a connection that failed.
pub fn explained(error: ClientError, since: Instant) -> ClientError {
    match error {
        ClientError::Unreachable { endpoint, reason } => {
            ClientError::Unreachable { endpoint, reason: refusal::explain(&reason, since) }
        }
        other => other,
    }
}
