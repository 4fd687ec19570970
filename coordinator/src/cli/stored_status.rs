//! `coordinator status DIR`: the state of a study from its campaign file, whether it is running or not.

use super::error::CommandError;
use super::output::{count, print, to_json};
use super::stored_study::END_DOCUMENT;
use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::results::store::{CampaignFile, is_running};
use coordinator::results::summary::Round;
use serde::Serialize;
use std::path::Path;

/// State of a study, as printed with `--json`.
#[derive(Debug, Serialize)]
struct StoredStatus {
    scene: String,
    /// One of `running`, `finished`, `ended` (without a result), `interrupted`.
    state: &'static str,
    /// Reason of an end without a result.
    reason: Option<String>,
    evaluations: usize,
    failed: usize,
    /// Number of times the study was started or continued with other settings.
    legs: usize,
    /// The last round of learning.
    round: Option<Round>,
}

/// Prints the state of the study in a folder.
///
/// # Errors
/// [`CommandError::Store`].
pub fn stored_status(dir: &Path, as_json: bool) -> Result<(), CommandError> {
    let campaign = CampaignFile::look(dir)?;
    let reason: Option<String> = campaign.document(END_DOCUMENT)?;
    let is_finished = campaign.document::<serde_json::Value>(SUMMARY_DOCUMENT)?.is_some();
    let state = match (is_running(dir), is_finished, &reason) {
        (true, ..) => "running",
        (_, true, _) => "finished",
        (_, _, Some(_)) => "ended",
        _ => "interrupted",
    };
    let status = StoredStatus {
        scene: campaign.meta().scene.clone(),
        state,
        reason,
        evaluations: campaign.count()?,
        failed: campaign.failed_count()?,
        legs: campaign.legs()?.len().max(1),
        round: campaign.rounds()?.pop(),
    };
    if as_json { print(&to_json(&status)?) } else { print(&text(&status, dir)) }
}

fn text(status: &StoredStatus, dir: &Path) -> String {
    let dir = dir.display();
    let state = match (status.state, &status.reason) {
        ("ended", Some(reason)) => format!("ended without a result: {reason}"),
        ("interrupted", _) => format!("interrupted; continue it with `coordinator resume {dir}`"),
        (state, _) => state.to_owned(),
    };
    let legs = if status.legs > 1 { format!(", {} legs", status.legs) } else { String::new() };
    let done = count(status.evaluations, "evaluation");
    let round = status.round.as_ref().map_or(String::new(), |round| {
        format!("round {}: R({}) = {:.4}\n", round.round, round.cycles, round.reliability_total)
    });
    format!("{}: {state}\n{done}, {} failed{legs}\n{round}", status.scene, status.failed)
}
