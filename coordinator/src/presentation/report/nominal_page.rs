//! The page of one mechanism without a study: what it is, its outputs over life against the limits, its motion, bores and cycles. The page of
//! `simulate --report`, and the beginning of the live page.

use super::figures;
use super::format::{UNKNOWN, count, joined, whole, with_unit};
use super::{Figure, Page, ReportInput, captioned};
use super::{chapters, studied, tables};
use crate::presentation::nominal_life::{NominalLife, nominal_lives};
use maud::{Markup, html};

/// The page before the first results of a study, with the reason why there are none; `drawing` is that of the mechanism as long as there is
/// no evaluation.
pub fn before_results(input: &ReportInput, drawing: Option<&Figure>, reason: &str) -> Page {
    let mut page = Page::new(&input.scene.title, chapters::header(input));
    page.add(html! { p.none { (reason) } });
    begin(&mut page, input, drawing);
    page
}

/// The page of one simulation; `facts` are pairs of a name and what it stands for, and `source` is the text of the scene.
pub fn page(input: &ReportInput, facts: &[(&str, String)], source: &str) -> Page {
    let scene = &input.scene;
    let header = html! {
        header {
            p.brand { "Hingewise" }
            h1 { (scene.title) }
            p.meta { "Simulation of one mechanism, scene " code { (scene.name) } }
        }
    };
    let mut page = Page::new(&scene.title, header);
    let rows = facts.iter().map(|(name, value)| [*name, value]);
    page.add(captioned("facts", "The simulation", tables::table_of_text(&["item", "value"], rows)));
    begin(&mut page, input, None);
    let scripts = if scene.simulator.is_none() {
        chapters::motion(&mut page, input)
    } else {
        html! {}
    };
    chapters::wear_and_cycles(&mut page, input);
    page.begin("What was simulated");
    page.add(studied::mechanism(scene, source));
    page.begin_appendix();
    page.add(html! { h3 { "Scene file" } pre { code { (source) } } (scripts) });
    page
}

/// Adds limits, and the drawing beside the outputs over life.
fn begin(page: &mut Page, input: &ReportInput, drawing: Option<&Figure>) {
    page.add(limits(input));
    page.add(chapters::notes(input));
    let drawing = studied::figure(input).or_else(|| drawing.cloned());
    let drawn = drawing.into_iter().chain(studied::loads(input)).chain(figures::histories(input));
    let drawn = page.draw(drawn, "two");
    page.add(drawn);
}

/// Limit states with values, margins and expected lives, as far as they are known.
fn limits(input: &ReportInput) -> Markup {
    let scene = &input.scene;
    if scene.limit_states.is_empty() {
        return html! {};
    }
    let lives = input.nominal.as_ref().map(|evaluation| nominal_lives(scene, evaluation));
    let rows = scene.limit_states.iter().enumerate().map(|(k, limit)| {
        let output = &scene.outputs[limit.output];
        let shown = |value: f64| with_unit(&scene.unit_of(output), value);
        let known = lives.as_ref().map(|lives| &lives[k]);
        let of = |value: &dyn Fn(&NominalLife) -> Option<String>| {
            known.and_then(value).unwrap_or_else(|| UNKNOWN.to_owned())
        };
        [
            limit.name.clone(),
            output.name.clone(),
            of(&|life| life.unworn.map(shown)),
            of(&|life| {
                let error = Some(life.errors[1]).filter(|error| *error > 0.0);
                Some(
                    shown(life.last)
                        + &error.map_or(String::new(), |error| format!(" \u{b1} {}", shown(error))),
                )
            }),
            joined(limit.thresholds().into_iter().map(shown), " to "),
            of(&|life| life.margin_in_words()),
            of(&|life| Some(life.reached.life().map_or("beyond the life studied".to_owned(), whole))),
        ]
    });
    let at_end = format!("after {} cycles", count(scene.life.cycles.into()));
    let head = ["limit state", "output", "unworn", &at_end, "limit", "margin", "expected life [cycles]"];
    captioned("limits-now", "This mechanism against its limits", tables::table(&head, rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Settings, blank};
    use crate::tests::test_study;

    #[test]
    fn a_page_has_limits_drawing_histories_bores_and_cycles() {
        let scene = &test_study::scene();
        let summary = blank(scene, &Settings::from(scene.study));
        let before = ReportInput::of_one(scene, summary.clone(), None);
        let text = before_results(&before, None, "no results").html(None);
        assert!(text.contains("no results"));
        assert!(text.contains("limits-now") && text.contains(UNKNOWN), "{text}");
        assert!(!text.contains("history-wear"), "there is no history yet");

        let mut input = ReportInput::of_one(scene, summary, test_study::report_input().nominal);
        input.notes.push("the cam pulls".into());
        let nominal = input.nominal.as_mut().expect("an evaluation");
        nominal.errors = nominal.histories.iter().map(|history| vec![1.25e-6; history.len()]).collect();
        let facts = [("accuracy", "draft".to_owned())];
        let page = page(&input, &facts, "gravity = 0").html(None);
        for piece in [
            "id=\"drawing\"",
            "id=\"history-wear\"",
            "Worn bores",
            "First and last cycle",
            "id=\"motion\"",
            "<strong>Caution:</strong> The cam pulls.",
            " \u{b1} 1.25",
            "draft",
        ] {
            assert!(page.contains(piece), "no {piece}");
        }
        assert!(!page.contains("http://") && !page.contains("https://"), "the page loads nothing");
    }
}
