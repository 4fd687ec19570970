//! The chapter by which a report is signed: what identifies the study, where it answers each element of a reliability prediction, and the
//! signatures.

use crate::presentation::report::format::{UNKNOWN, count};
use crate::presentation::report::page::numbered;
use crate::presentation::report::{Page, ReportInput, captioned, drawing, table, table_of_text, words};
use maud::{Markup, Render, html};

/// Adds the chapter.
pub fn chapter(page: &mut Page, input: &ReportInput) {
    page.begin("Identification and signatures");
    page.add(html! { (facts(input)) (files(input)) (elements(input)) (signatures(input)) });
}

/// What identifies the study.
fn facts(input: &ReportInput) -> Markup {
    let summary = &input.summary;
    let or_unknown = |text: &str| if text.is_empty() { UNKNOWN.to_string() } else { text.to_string() };
    let workers: Vec<&str> = summary.workers.iter().map(|worker| worker.name.as_str()).collect();
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
        ("seed", html! { (summary.seed) }),
        ("population", html! { (count(summary.population as u64)) }),
        ("workers", html! { (or_unknown(&workers.join(", "))) }),
    ]);
    captioned(
        "facts",
        "The study",
        table_of_text(&["item", "value"], rows.map(|(name, value)| [name.render(), value])),
    )
}

/// A time of the campaign file, e.g. `2026-11-23T23:18:38.139Z`, to the second.
fn moment(time: &str) -> String {
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
    let see = numbered::refer_table;
    let is_mechanism = input.scene.simulator.is_none();
    let rows = [
        (
            "identification of the item",
            html! {
                (see("facts")) @if is_mechanism { ", " (numbered::mark("see-figure", drawing::NAME)) ", " (see("bodies")) " and after" }
            },
        ),
        (
            "intended use of the prediction",
            html! {
                @if let Some(note) = input.written.name("report.note") { (note) } @else { "not stated: " code { "[report] note" } " in the scene" }
            },
        ),
        (
            "operating conditions and life",
            html! {
                (see("limits")) " and below" @if !input.scene.conditions.is_empty() { ", " (see("conditions")) }
            },
        ),
        ("assumptions", html! { "assumptions and limits of the model" }),
        (
            "sources of data",
            html! {
                @if input.written.files().is_empty() { "values of the scene, whose comments name their sources" } @else { (see("files")) }
            },
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
                ", " (numbered::mark("see-figure", "parts-of-interval"))
            },
        ),
        ("limitations", html! { "cautions at the head; assumptions and limits of the model" }),
        ("repeatability", html! { "reproducibility, in the appendix" }),
    ];
    let rows = rows.map(|(element, answer)| [element.render(), answer]);
    captioned(
        "elements",
        "Elements of a reliability prediction by IEEE 1413",
        table_of_text(&["element", "answered in"], rows),
    )
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
    use crate::presentation::report::{FigureFiles, page, render};
    use crate::tests::test_study;

    #[test]
    fn times_are_stated_to_the_second() {
        assert_eq!(moment("2026-11-23T23:18:38.139Z"), "2026-11-23 23:18:38 UTC");
    }

    #[test]
    fn what_the_scene_or_the_command_states_is_at_the_head_and_in_the_signature_block() {
        let mut input = test_study::report_input();
        input.written = crate::presentation::report::written::WrittenScene::new(include_str!(
            "../../../../../common/tests/scenes/everything.toml"
        ));
        let text = render(&input, FigureFiles::NextToPage).html(None);
        let (head, rest) = text.split_once("<nav").unwrap();
        assert!(head.contains("Project of every word, revision B, by A. Author"), "{head}");
        assert!(head.contains("A note to the reader."));
        let (body, appendix) = rest.split_once("<details class=\"appendix\">").unwrap();
        for said in ["<td>author</td><td>A. Author</td>", "<td>C. Checker</td>", "<td>D. Approver</td>"] {
            assert!(body.contains(said) && !appendix.contains(said), "{said}");
        }
        input.sign(&[("report.author", "E. Editor"), ("scene.title", "Another title")]);
        let text = render(&input, FigureFiles::NextToPage).html(None);
        assert!(text.contains("<td>E. Editor</td>") && text.contains("<h1>Another title</h1>"));
        assert!(!text.contains("A. Author"));
    }

    /// Every answer that is a reference leads to a table or a figure of the page.
    #[test]
    fn every_element_of_a_prediction_is_answered_where_the_list_says() {
        let input = test_study::report_input();
        let listed = page::numbered::resolve(&elements(&input).0, page::FigureFiles::Absent);
        let text = render(&input, FigureFiles::NextToPage).html(None);
        let (_, list) = text.split_once("id=\"table-elements\"").unwrap();
        let list = list.split("</table>").next().unwrap();
        assert_eq!(list.matches("<tr>").count(), listed.matches("<tr>").count());
        assert!(list.matches("<a href=\"#").count() >= 12, "{list}");
        for name in ["facts", "bodies", "limits", "settings", "variables", "joints", "lives", "reliability"] {
            assert!(list.contains(&format!("<a href=\"#table-{name}\">")), "{name}: {list}");
        }
    }
}
