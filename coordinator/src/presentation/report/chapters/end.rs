//! The end of the page: combinations that fail and most probable failures; what identifies the study and the chapter by which it is signed;
//! in the appendix computing effort, failed simulations, and what is needed to repeat the study.

use crate::presentation::report::figures::parallel_coordinates;
use crate::presentation::report::format::{
    UNKNOWN, capital, count, fixed, joined, number_of_cycles, percent, seven_digits, three_digits, unit_scale,
};
use crate::presentation::report::page::{beside, details, mark, refer_table};
use crate::presentation::report::{
    Page, ReportInput, captioned, drawing, table, table_of_text, tables, words,
};
use crate::results::summary_rows::{CoordinateRow, FailurePointRow};
use maud::{Markup, Render, html};

/// Adds the chapter of combinations that fail and of most probable failures.
pub fn failing(page: &mut Page, input: &ReportInput) {
    page.begin("Simulations and failure points");
    let combinations = page.draw(parallel_coordinates(input), "one");
    page.add(beside(&combinations, failure_points(input)));
}

/// Variables with a row in the table of the most probable failures.
const VARIABLES_LISTED: usize = 12;

/// The most probable failures of all limit states: one pair of columns each, one row for each of the variables farthest from their medians.
fn failure_points(input: &ReportInput) -> Markup {
    let points = &input.summary.failure_points;
    if points.is_empty() {
        let failed = input.summary.reliability.iter().any(|row| row.reliability.get("total") < Some(&1.0));
        return html! {
            p.none {
                @if failed { "The study stored no most probable failures." }
                @else { "No failure was found, so that there is no most probable one." }
            }
        };
    }
    let of_point =
        |point: &FailurePointRow| [format!("{}: value", point.limit_state), "standard deviations".to_owned()];
    let head: Vec<String> =
        ["variable", "unit"].map(str::to_owned).into_iter().chain(points.iter().flat_map(of_point)).collect();
    let distance = |name: &str| {
        let rows = points.iter().flat_map(|point| &point.variables).filter(|row| row.variable == name);
        rows.map(|row| row.normal.abs()).fold(0.0, f64::max)
    };
    let mut variables: Vec<_> = input.scene.variables.iter().collect();
    variables.sort_by(|a, b| distance(&b.name).total_cmp(&distance(&a.name)));
    let all = variables.len();
    let rows = variables.into_iter().take(VARIABLES_LISTED).map(|variable| {
        let scale = unit_scale(&variable.unit);
        let cells = points.iter().flat_map(move |point| {
            let own = point.variables.iter().find(|row| row.variable == variable.name);
            let cell = |text: &dyn Fn(&CoordinateRow) -> String| own.map_or(UNKNOWN.to_owned(), text);
            [cell(&|row| seven_digits(row.value / scale)), cell(&|row| fixed(row.normal, 2))]
        });
        [variable.name.clone(), variable.unit.clone()].into_iter().chain(cells)
    });
    let rest = if all > VARIABLES_LISTED {
        format!(" The {VARIABLES_LISTED} of {all} variables farthest from their medians; all: summary.json.")
    } else {
        String::new()
    };
    let title = format!(
        "Most probable failure per limit state: of all failed points of the population the one nearest to the medians in the space of \
         independent standard normals. {}{rest}",
        joined(points.iter().map(|point| failure_point(input, point)), " ")
    );
    captioned("failure-points", &title, table(&head, rows))
}

fn failure_point(input: &ReportInput, point: &FailurePointRow) -> String {
    let by = format!("by {}, when ", number_of_cycles(point.cycles));
    let by = if input.summary.is_static() { "" } else { &by };
    let failed = if point.failed < 1e-4 { three_digits(point.failed) } else { percent(point.failed) };
    format!(
        "{}: {by}{failed} of the population {}, at a distance of {} standard deviations.",
        capital(&point.limit_state),
        if by.is_empty() { "fails" } else { "have failed" },
        fixed(point.distance, 2)
    )
}

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
                    (surrogate.limit_state) @if surrogate.logarithms { ", by its logarithm:" } " Q" sup { "2" } " = " (format!("{q2:.4}"))
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
                @if input.has_lives() {
                    (captioned("work", "Numerical work", tables::diagnostics(input)))
                }
                @if let Some(table) = tables::stated_errors(input) {
                    (captioned("nominal", &format!("Outputs of the nominal {}", input.subject()), table))
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
    let listed = input.failures.iter().take(FAILURES_LISTED);
    let rows = listed.map(|(id, reason)| [id.to_string(), reason.clone()]);
    html! {
        p {
            "Evaluations without a result: " (count(input.failures.len() as u64)) "."
            @if input.failures.len() > FAILURES_LISTED { " The first are listed here, all of them in samples.csv." }
        }
        (details("Failed evaluations", table_of_text(&["evaluation", "reason of the failure"], rows)))
    }
}

fn or_unknown(text: &str) -> &str {
    if text.is_empty() { UNKNOWN } else { text }
}

/// What is needed to repeat the study.
pub fn repeat(input: &ReportInput) -> Markup {
    let settings = (!input.meta.settings.is_null())
        .then(|| serde_json::to_string_pretty(&input.meta.settings).unwrap_or_default());
    html! {
        h3 { "Reproducibility" }
        p {
            "Command and version are in " (refer_table("facts")) ", the seed in " (refer_table("settings")) ", the scene is listed below and stored next to this \
             page in " code { "scene.toml" } "; the settings include every value that the command left at its default. The same version, scene, settings \
             and seed give bit-identical results for any number of workers."
        }
        @if let Some(settings) = settings { (details("Settings", html! { pre { (settings) } })) }
        (details("Scene", html! { pre { (or_unknown(&input.meta.scene_source)) } }))
    }
}

/// Adds the chapter.
pub fn identification(page: &mut Page, input: &ReportInput) {
    page.begin("Identification and signatures");
    page.add(html! { (facts(input)) (files(input)) (elements(input)) (signatures(input)) });
}

/// What identifies the study.
fn facts(input: &ReportInput) -> Markup {
    let summary = &input.summary;
    let stated = |key: &'static str| Some((key, input.written.name(&format!("report.{key}"))?.render()));
    let rows = ["project", "revision"].into_iter().filter_map(stated).chain([
        ("begun", html! { (or_unknown(&moment(&summary.created))) }),
        ("command", html! { code { (or_unknown(&input.meta.command)) } }),
        ("version", html! { "Hingewise " (or_unknown(&summary.version)) "; simulations: " (or_unknown(&input.meta.version)) }),
        (
            "scene",
            html! { (summary.scene) ", SHA-256 of " code { "scene.toml" } " " code { (or_unknown(&summary.scene_sha256)) } },
        ),
        ("method", html! { (summary.method) ", accuracy " (words::accuracy(summary)) }),
    ]);
    let rows = rows.map(|(name, value)| [name.render(), value]);
    captioned("facts", "The study", table_of_text(&["item", "value"], rows))
}

/// A time of the campaign file, e.g. `2026-11-23T23:18:38.139Z`, to the second.
pub fn moment(time: &str) -> String {
    match time.split_once('T') {
        Some((day, clock)) => format!("{day} {} UTC", clock.split(['.', 'Z']).next().unwrap_or_default()),
        None => time.to_owned(),
    }
}

/// The files that the scene took values from, with their hashes; nothing for a scene that stands alone.
fn files(input: &ReportInput) -> Markup {
    let files = input.written.files();
    let row = |(file, keys): (&str, Vec<&str>)| [file.to_owned(), keys.join(", ")];
    html! {
        @if !files.is_empty() {
            (captioned("files", "Files that the scene read", table_of_text(&["file", "values of"], files.into_iter().map(row))))
        }
    }
}

/// Where the report answers each element that IEEE 1413 requires of a reliability prediction.
///
/// # Source
/// IEEE Std 1413-2010, Framework for reliability prediction of hardware.
fn elements(input: &ReportInput) -> Markup {
    let see = refer_table;
    let is_mechanism = input.scene.simulator.is_none();
    let rows = [
        (
            "identification of the item",
            html! { (see("facts")) @if is_mechanism { ", " (mark("see-figure", drawing::NAME)) ", " (see("bodies")) " and after" } },
        ),
        (
            "intended use of the prediction",
            html! { @if let Some(note) = input.written.name("report.note") { (note) } @else { "not stated: " code { "[report] note" } " in the scene" } },
        ),
        (
            "operating conditions and life",
            html! { (see("limits")) " and below" @if !input.scene.conditions.is_empty() { ", " (see("conditions")) } },
        ),
        ("assumptions", html! { "assumptions and limits of the model" }),
        (
            "sources of data",
            html! { @if input.written.files().is_empty() { "values of the scene, whose comments name their sources" } @else { (see("files")) } },
        ),
        ("methodology", html! { (see("facts")) ", " (see("settings")) }),
        (
            "inputs",
            html! { (see("variables")) ", " (see("limits")) @if is_mechanism { ", " (see("joints")) } ", scene in the appendix" },
        ),
        (
            "uncertainty of the results",
            html! {
                @if input.summary.is_static() { (see("reliability")) } @else { (see("lives")) ", " (see("reliability")) }
                ", " (mark("see-figure", "parts-of-interval"))
            },
        ),
        ("limitations", html! { "cautions at the head; assumptions and limits of the model" }),
        ("repeatability", html! { "reproducibility, in the appendix" }),
    ];
    let table =
        table_of_text(&["element", "answered in"], rows.map(|(element, answer)| [element.render(), answer]));
    captioned("elements", "Elements of a reliability prediction by IEEE 1413", table)
}

/// Lines for those who sign; names that were not stated are left blank.
fn signatures(input: &ReportInput) -> Markup {
    let row = |key: &str| {
        let name = input.written.name(&format!("report.{key}")).unwrap_or_default();
        [key, name, "", ""].map(str::to_owned)
    };
    html! { div.signatures { (captioned("signatures", "Signatures", table(&["", "name", "date", "signature"], ["author", "checked", "approved"].map(row)))) } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::{page, render};
    use crate::results::verified::VerificationRow;
    use crate::tests::test_study;
    use common::random::RandomVariable;

    #[test]
    fn times_are_stated_to_the_second() {
        assert_eq!(moment("2026-11-23T23:18:38.139Z"), "2026-11-23 23:18:38 UTC");
    }

    #[test]
    fn what_direct_simulation_has_shown_is_stated_with_its_time() {
        let mut input = test_study::report_input();
        let row = VerificationRow {
            made: "2026-11-23T23:18:38Z".into(),
            evaluations: input.summary.evaluations.total,
            compared: "surrogates with others".into(),
            found: "Q2 at least 0.9".into(),
        };
        input.verified = vec![row.clone(), VerificationRow { evaluations: 7, ..row }];
        let html = render(&input, true).html(None);
        let said = "<p>Verified 2026-11-23 23:18:38 UTC: surrogates with others: Q2 at least 0.9.";
        assert!(html.contains(&format!("{said}</p>")));
        assert!(html.contains(&format!("{said} The study had 7 simulations then.</p>")));
    }

    #[test]
    fn what_the_scene_or_the_command_states_is_at_the_head_and_in_the_signature_block() {
        let mut input = test_study::report_input();
        input.written = crate::presentation::report::written::WrittenScene::new(include_str!(
            "../../../../../common/tests/scenes/everything.toml"
        ));
        let text = render(&input, true).html(None);
        let (head, rest) = text.split_once("<nav").unwrap();
        assert!(head.contains("Project of every word, revision B, by A. Author"), "{head}");
        assert!(head.contains("A note to the reader."));
        let (body, appendix) = rest.split_once("<details class=\"appendix\">").unwrap();
        for said in ["<td>author</td><td>A. Author</td>", "<td>C. Checker</td>", "<td>D. Approver</td>"] {
            assert!(body.contains(said) && !appendix.contains(said), "{said}");
        }
        input.sign(&[("report.author", "E. Editor"), ("scene.title", "Another title")]);
        let text = render(&input, true).html(None);
        assert!(text.contains("<td>E. Editor</td>") && text.contains("<h1>Another title</h1>"));
        assert!(!text.contains("A. Author"));
    }

    /// Every answer that is a reference leads to a table or a figure of the page.
    #[test]
    fn every_element_of_a_prediction_is_answered_where_the_list_says() {
        let input = test_study::report_input();
        let listed = page::resolve(&elements(&input).0, false);
        let text = render(&input, true).html(None);
        let (_, list) = text.split_once("id=\"table-elements\"").unwrap();
        let list = list.split("</table>").next().unwrap();
        assert_eq!(list.matches("<tr>").count(), listed.matches("<tr>").count());
        assert!(list.matches("<a href=\"#").count() >= 12, "{list}");
        for name in ["facts", "bodies", "limits", "settings", "variables", "joints", "lives", "reliability"] {
            assert!(list.contains(&format!("<a href=\"#table-{name}\">")), "{name}: {list}");
        }
    }
    #[test]
    fn the_table_has_values_in_units_and_distances() {
        let mut input = test_study::report_input();
        let text = |input: &ReportInput| failure_points(input).0.replace('\u{a0}', " ");
        input.summary.failure_points.clear();
        assert!(text(&input).contains("stored no most probable failures"));
        let row = |variable: &RandomVariable| CoordinateRow {
            variable: variable.name.clone(),
            value: if variable.name == "rod_length" { 0.040_055_4 } else { variable.distribution.mean() },
            normal: if variable.name == "rod_length" { 1.0 } else { 0.0 },
        };
        input.summary.failure_points.push(FailurePointRow {
            limit_state: "wear".into(),
            cycles: 63_000,
            failed: 0.0123,
            distance: 2.345,
            variables: input.scene.variables.iter().map(row).collect(),
        });
        let found = text(&input);
        for said in [
            "<td>rod_length</td><td>mm</td>",
            ">40.0554</td>",
            "Wear: by 63 000 cycles, when 1.2 % of the population have failed",
            "distance of 2.35 standard",
        ] {
            assert!(found.contains(said), "{said}: {found}");
        }
        for at in &mut input.summary.reliability {
            at.reliability.insert("total".into(), 1.0);
        }
        input.summary.failure_points.clear();
        assert!(text(&input).contains("No failure was found"));
    }
}
