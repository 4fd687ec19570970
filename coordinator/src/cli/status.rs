//! `coordinator status`: the progress of a running study.

use super::error::CommandError;
use super::output::{print, to_json};
use super::stored_status::stored_status;
use clap::Args;
use common::wire::{Phase, Status};
use coordinator::farm::dispatch::{ClientError, ClientSession};
use coordinator::presentation::monitor::text::status_text;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use worker::log::refusal;

/// Shown below `coordinator status --help`.
pub const EXAMPLES: &str = "\
Examples:
  coordinator status tcp/127.0.0.1:7447
  coordinator status tcp/127.0.0.1:7447 --watch
  coordinator status hingewise-flapping-wing
  coordinator status tls/coordinator.example:7447 --config worker.json5 --json

The address is that of `coordinator run --listen`. Exit codes: 0 printed, 1 no answer, 2 bad input.";

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time between two requests on a terminal.
const REDRAW: Duration = Duration::from_secs(1);
/// Time between two requests otherwise.
const REPEAT: Duration = Duration::from_secs(10);

/// Arguments of `coordinator status`.
#[derive(Debug, Clone, Args)]
pub struct StatusArguments {
    /// Address of the coordinator, e.g. tcp/127.0.0.1:7447, or the folder of a study, which need not be running
    #[arg(value_name = "ENDPOINT-or-DIR")]
    pub endpoint: String,
    /// Zenoh configuration (JSON5), e.g. for TLS and passwords; that of a worker can be used
    #[arg(long, value_name = "ZENOH.json5")]
    pub config: Option<PathBuf>,
    /// Repeat: every second on a terminal, every 10 s otherwise
    #[arg(long)]
    pub watch: bool,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError::Visit`] if the coordinator does not answer.
pub fn status(arguments: &StatusArguments, as_json: bool) -> Result<(), CommandError> {
    let dir = Path::new(&arguments.endpoint);
    if dir.is_dir() {
        return stored_status(dir, as_json);
    }
    let begun = Instant::now();
    let session = ClientSession::open(&arguments.endpoint, arguments.config.as_deref());
    let session = session.map_err(|error| match explained(error, begun) {
        ClientError::Endpoint { endpoint, reason } => ClientError::Endpoint {
            endpoint,
            reason: format!("there is no such folder, and as an address it is {reason}"),
        },
        other => other,
    })?;
    let mut shown = session.status(PATIENCE)?;
    if !arguments.watch {
        return print(&text(&shown, as_json)?);
    }
    let draws = std::io::stdout().is_terminal() && !as_json;
    loop {
        let text = text(&shown, as_json)?;
        // Cursor home, clear each line to its end, then everything below: the screen does not flicker.
        print(&if draws { format!("\x1b[H{}\x1b[J", text.replace('\n', "\x1b[K\n")) } else { text })?;
        std::thread::sleep(if draws { REDRAW } else { REPEAT });
        match session.status(PATIENCE) {
            Ok(status) => shown = status,
            // The study was ending.
            Err(ClientError::Silent { .. }) if shown.phase == Phase::Ending => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
}

fn text(status: &Status, as_json: bool) -> Result<String, CommandError> {
    if as_json { to_json(status) } else { Ok(status_text(status)) }
}

/// Adds the likely cause to the error of a failed connection.
pub fn explained(error: ClientError, since: Instant) -> ClientError {
    match error {
        ClientError::Unreachable { endpoint, reason } => {
            ClientError::Unreachable { endpoint, reason: refusal::explain(&reason, since) }
        }
        other => other,
    }
}
