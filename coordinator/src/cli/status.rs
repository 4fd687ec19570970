//! `coordinator status`: the progress of a running study.

use super::stored_study::END_DOCUMENT;
use super::{Done, count, print, to_json};
use clap::Args;
use common::wire::{Phase, Status};
use coordinator::farm::dispatch::{ClientError, ClientSession};
use coordinator::presentation::monitor::status_text;
use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::results::store::{CampaignFile, is_running};
use serde_json::json;
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
/// [`super::CommandError::Client`] if the coordinator does not answer.
pub fn status(arguments: &StatusArguments, as_json: bool) -> Done {
    let dir = Path::new(&arguments.endpoint);
    if dir.is_dir() {
        return stored_status(dir, as_json);
    }
    let begun = Instant::now();
    let session = ClientSession::open(&arguments.endpoint, arguments.config.as_deref());
    let session = session.map_err(|error| match explained(error, begun) {
        ClientError::Endpoint(endpoint, reason) => ClientError::Endpoint(
            endpoint,
            format!("there is no such folder, and as an address it is {reason}"),
        ),
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
            Err(ClientError::Silent(..)) if shown.phase == Phase::Ending => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
}

fn text(status: &Status, as_json: bool) -> Done<String> {
    if as_json { to_json(status) } else { Ok(status_text(status)) }
}

/// Adds the likely cause to the error of a failed connection.
pub fn explained(error: ClientError, since: Instant) -> ClientError {
    match error {
        ClientError::Unreachable(endpoint, reason) => {
            ClientError::Unreachable(endpoint, refusal::explain(&reason, since))
        }
        other => other,
    }
}

/// Prints the state of the study in a folder.
///
/// # Errors
/// [`super::CommandError::Store`].
fn stored_status(dir: &Path, as_json: bool) -> Done {
    let campaign = CampaignFile::look(dir)?;
    let reason: Option<String> = campaign.document(END_DOCUMENT)?;
    let is_finished = campaign.document::<serde_json::Value>(SUMMARY_DOCUMENT)?.is_some();
    let state = match (is_running(dir), is_finished, &reason) {
        (true, ..) => "running",
        (_, true, _) => "finished",
        (_, _, Some(_)) => "ended",
        _ => "interrupted",
    };
    let scene = &campaign.meta.scene;
    let (evaluations, failed) = (campaign.count()?, campaign.failed_count()?);
    // Times that the study was started or continued with other settings, and the last round of learning.
    let (legs, round) = (campaign.leg_versions()?.len().max(1), campaign.rounds()?.pop());
    if as_json {
        return print(&to_json(
            &json!({ "scene": scene, "state": state, "reason": reason, "evaluations": evaluations,
                                       "failed": failed, "legs": legs, "round": round }),
        )?);
    }
    let dir = dir.display();
    let state = match (state, &reason) {
        ("ended", Some(reason)) => format!("ended without a result: {reason}"),
        ("interrupted", _) => format!("interrupted; continue it with `coordinator resume {dir}`"),
        (state, _) => state.to_owned(),
    };
    let legs = if legs > 1 { format!(", {legs} legs") } else { String::new() };
    let done = count(evaluations, "evaluation");
    let round = round.map_or(String::new(), |round| {
        format!("round {}: R({}) = {:.4}\n", round.round, round.cycles, round.reliability_total)
    });
    print(&format!("{scene}: {state}\n{done}, {failed} failed{legs}\n{round}"))
}
