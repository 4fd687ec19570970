//! The end of the page: the work done, runs without a result, and everything needed to repeat the study.

use super::details;
use crate::presentation::report::format::{UNKNOWN, count, escape, percent};
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::tables;
use crate::results::summary::SurrogateRow;
use std::fmt::Write;

/// Failed evaluations listed one by one.
const FAILURES_LISTED: usize = 50;

/// Work and failures, then everything needed to repeat the study.
pub fn end(input: &ReportInput) -> String {
    numerics(input) + &repeat(input)
}

/// What the surrogates are worth where they were not fitted.
fn surrogates(input: &ReportInput) -> String {
    let of = |row: &SurrogateRow| {
        let (q2, factor) = (row.q2_cross_validated?, row.variance_factor?);
        Some(format!(
            "for {} with Q<sup>2</sup> = {q2:.4} ({} kernel, {} trend; predicted variances multiplied by {factor:.2})",
            escape(&row.limit_state),
            row.kernel,
            row.trend
        ))
    };
    let rows: Vec<String> = input.summary.surrogates.iter().filter_map(of).collect();
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "<p>The surrogates predict simulations that were left out of their fits {}. The factor makes the predicted variances \
         those of the errors seen, and is part of every standard error.</p>\n",
        rows.join("; ")
    )
}

/// Work, times, repairs and failed runs.
fn numerics(input: &ReportInput) -> String {
    let repairs: usize = input.summary.convergence.rounds.iter().map(|round| round.repairs).sum();
    let mut html = String::from("<h2>Work and failed runs</h2>\n<div class=\"pair\"><div>");
    if input.summary.of_mechanism() {
        html += &tables::diagnostics(input);
    }
    html += &tables::stated_errors(input);
    html += "</div><div>";
    html += &tables::timing(input);
    html += "</div></div>\n";
    let _ = writeln!(html, "<p>Repairs of the surrogates over all rounds: {}.</p>", count(repairs as u64));
    html += &surrogates(input);
    if input.failures.is_empty() {
        html += "<p>Every evaluation has a result.</p>\n";
    } else {
        let failed = input.failures.len() as u64;
        let _ = writeln!(
            html,
            "<p>Evaluations without a result: {}. They are left out of the design{}.{}</p>",
            count(failed),
            if input.summary.convergence.rounds.is_empty() {
                String::new()
            } else {
                format!(
                    "; simulations are estimated to fail in {} of the population",
                    percent(input.summary.failures.barred_share)
                )
            },
            if failed > FAILURES_LISTED as u64 {
                " The first are listed here, all in samples.csv."
            } else {
                ""
            }
        );
        let table = tables::table_of_text(
            &["evaluation".into(), "what the simulation reported".into()],
            input
                .failures
                .iter()
                .take(FAILURES_LISTED)
                .map(|run| vec![run.id.to_string(), escape(&run.failure)]),
        );
        html += &details("Failed evaluations", &table);
    }
    html
}

/// Everything needed to repeat the study.
fn repeat(input: &ReportInput) -> String {
    let summary = &input.summary;
    let or_unknown = |text: &str| if text.is_empty() { UNKNOWN.to_string() } else { escape(text) };
    let mut html = String::from("<h2>To repeat it</h2>\n");
    html += &tables::table_of_text(
        &["what".into(), "value".into()],
        [
            ("command", format!("<code>{}</code>", or_unknown(&input.command))),
            ("version", format!("Hingewise {}", or_unknown(&summary.version))),
            ("seed", summary.seed.to_string()),
            ("population", count(summary.population as u64)),
        ]
        .into_iter()
        .map(|(name, value)| vec![name.to_string(), value]),
    );
    html += "<p>The scene as it was studied is below, and beside this page in <code>scene.toml</code>; the settings hold what \
             the command left to the scene or the program. The same version, scene, settings and seed give the same answer, \
             bit for bit, whatever the workers.</p>\n";
    if !input.settings.is_null() {
        let settings = serde_json::to_string_pretty(&input.settings).unwrap_or_default();
        html += &details("Settings", &format!("<pre>{}</pre>\n", escape(&settings)));
    }
    html + &details("Scene", &format!("<pre>{}</pre>\n", or_unknown(&input.scene_source)))
}
