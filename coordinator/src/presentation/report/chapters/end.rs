//! The end of the page: computing effort, failed simulations, and what is needed to repeat the study.

use crate::presentation::report::format::{UNKNOWN, count, percent};
use crate::presentation::report::page::{details, numbered};
use crate::presentation::report::{Page, ReportInput, captioned, tables};
use maud::{Markup, html};

/// Failed evaluations listed one by one.
const FAILURES_LISTED: usize = 50;

/// Quality of the surrogates in cross-validation.
fn surrogates(input: &ReportInput) -> Markup {
    let validated =
        input.summary.surrogates.iter().filter_map(|surrogate| {
            Some((surrogate, surrogate.q2_cross_validated?, surrogate.variance_factor?))
        });
    let rows: Vec<_> = validated.collect();
    html! {
        @if !rows.is_empty() {
            p {
                "Leave-one-out cross-validation of the surrogates: "
                @for (k, (surrogate, q2, factor)) in rows.iter().enumerate() {
                    @if k > 0 { "; " }
                    (surrogate.limit_state) " Q" sup { "2" } " = " (format!("{q2:.4}"))
                    " (" (surrogate.kernel) " kernel, " (surrogate.trend) " trend; predicted variances multiplied by "
                    (format!("{factor:.2}")) ")"
                }
                ". The factor scales the predicted variances to the errors found in cross-validation; every standard error \
                 includes it."
            }
        }
    }
}

/// Work, times, repairs and failed simulations.
pub fn effort(page: &mut Page, input: &ReportInput) {
    let repairs: usize = input.summary.convergence.rounds.iter().map(|round| round.repairs).sum();
    page.begin("Computing effort and failed simulations");
    page.add(html! {
        div.pair {
            div {
                @if input.summary.of_mechanism() {
                    (captioned("work", "Numerical work", tables::diagnostics(input)))
                }
                @if let Some(table) = tables::stated_errors(input) {
                    (captioned("nominal", &format!("Outputs of the nominal {}", input.summary.subject()), table))
                }
            }
            div { (captioned("timing", "Times and workers", tables::timing(input))) }
        }
        p { "Repairs of the surrogates over all rounds: " (count(repairs as u64)) "." }
        (surrogates(input))
        @if input.failures.is_empty() {
            p { "Every evaluation has a result." }
        } @else {
            (failures(input))
        }
    });
}

/// Evaluations without a result.
fn failures(input: &ReportInput) -> Markup {
    let learned = !input.summary.convergence.rounds.is_empty();
    let listed = input.failures.iter().take(FAILURES_LISTED);
    html! {
            p {
                "Evaluations without a result: " (count(input.failures.len() as u64)) ". They are excluded"
                @if input.summary.is_direct() {
                    "; the intervals of R contain both extremes, that all or none of these samples have failed"
                } @else if learned {
                    "; the share of the population that cannot be simulated is estimated at "
                    (percent(input.summary.failures.barred_share))
                    ", and the intervals of R contain both extremes, that all or none of it fails"
                }
                "."
                @if input.failures.len() > FAILURES_LISTED { " The first are listed here, all of them in samples.csv." }
            }
            (details("Failed evaluations", tables::table_of_text(
                &["evaluation", "reason of the failure"],
    listed.map(|(id, reason)| [id.to_string(), reason.clone()]),
            )))
        }
}

/// What is needed to repeat the study.
pub fn repeat(input: &ReportInput) -> Markup {
    let or_unknown = |text: &str| if text.is_empty() { UNKNOWN.to_string() } else { text.to_string() };
    let settings = (!input.meta.settings.is_null())
        .then(|| serde_json::to_string_pretty(&input.meta.settings).unwrap_or_default());
    html! {
        h3 { "Reproducibility" }
        p {
            "Command, version and seed are in " (numbered::refer_table("facts")) ", the scene is listed below and stored next to this \
             page in " code { "scene.toml" } "; the settings include every value that the command left at its default. The same version, scene, settings \
             and seed give bit-identical results for any number of workers."
        }
        @if let Some(settings) = settings { (details("Settings", html! { pre { (settings) } })) }
        (details("Scene", html! { pre { (or_unknown(&input.meta.scene_source)) } }))
    }
}
