//! The page of one mechanism without a study: what it is, its outputs over life against the limits, its motion, bores and cycles. The page of
//! `simulate --report`, and the beginning of the live page.

use super::figure::Figure;
use super::figures;
use super::format::{UNKNOWN, count, three_digits};
use super::input::ReportInput;
use super::page::{self, Sections, animated, captioned, figures as figures_in};
use super::plot::PlotError;
use super::{animation, studied, tables};
use crate::presentation::nominal_life::{NominalLife, Reached, nominal_lives};
use crate::results::summary::StudySummary;
use common::outputs::Evaluation;
use common::scene::Scene;
use maud::{Markup, Render, html};

/// One mechanism and what is known of it.
pub struct NominalView<'v> {
    /// Scene of the mechanism.
    pub scene: &'v Scene,
    /// Summary without results of a study.
    pub summary: StudySummary,
    /// Its evaluation, once there is one.
    pub evaluation: Option<&'v Evaluation>,
    /// Its drawing as long as there is no evaluation.
    pub drawing: Option<&'v Figure>,
}

impl NominalView<'_> {
    /// Limits, and the drawing beside the outputs over life.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn beginning(&self) -> Result<Markup, PlotError> {
        let input = self.input();
        let drawn = studied::figure(&input).or_else(|| self.drawing.cloned());
        let shown: Vec<Figure> = drawn.into_iter().chain(figures::histories(&input)?).collect();
        Ok(html! {
            (self.limits())
            (figures_in(&shown, "two"))
        })
    }

    /// A whole page; `facts` are pairs of a name and what it stands for, and `source` is the text of the scene.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn page(&self, facts: &[(&str, String)], source: &str) -> Result<String, PlotError> {
        let input = self.input();
        let sections = Sections {
            motion: animation::animation(&input),
            bores: figures::bores(&input),
            orbits: figures::orbits(&input),
            first_cycle: figures::first_cycle(&input)?,
            last_cycle: figures::last_cycle(&input)?,
            ..Sections::default()
        };
        let rows = facts.iter().map(|(name, value)| vec![html! { (name) }, html! { (value) }]);
        let body = html! {
            header {
                p.brand { "Hingewise" }
                h1 { (self.scene.title) }
                p.meta { "Simulation of one mechanism, scene " code { (self.scene.name) } }
            }
            (captioned("facts", "The simulation", tables::table_of_text(&["item", "value"], rows)))
            (self.beginning()?)
            (page::mechanism(&input, &sections))
            h2 { "What was simulated" }
            (studied::mechanism(self.scene, source))
            div.appendix { h2 { "Appendix" } }
            (page::details("Scene file", html! { pre { code { (source) } } }))
            @if let Some(motion) = &sections.motion { (animated(motion)) }
        };
        Ok(page::wrapped(&self.scene.title, &body))
    }

    fn input(&self) -> ReportInput {
        ReportInput::of_one(self.scene, self.summary.clone(), self.evaluation.cloned())
    }

    /// Limit states with values, margins and expected lives, as far as they are known.
    fn limits(&self) -> Markup {
        let scene = self.scene;
        if scene.limit_states.is_empty() {
            return html! {};
        }
        // A simulator's outputs have no first cycle.
        let known = self.evaluation.filter(|_| scene.simulator.is_none());
        let lives = known.map(|evaluation| nominal_lives(scene, evaluation));
        let rows = scene.limit_states.iter().enumerate().map(|(k, limit)| {
            let output = &scene.outputs[limit.output];
            let unit = output.kind.unit();
            let shown = |value: f64| unit.after(&three_digits(unit.to_shown(value)));
            let known = lives.as_ref().map(|lives| &lives[k]);
            let of = |value: &dyn Fn(&NominalLife) -> Option<String>| {
                known.and_then(value).unwrap_or_else(|| UNKNOWN.to_owned()).render()
            };
            vec![
                limit.name.render(),
                output.name.render(),
                of(&|life| life.unworn.map(shown)),
                of(&|life| Some(shown(life.last))),
                limit.thresholds().into_iter().map(shown).collect::<Vec<_>>().join(" to ").render(),
                of(&|life| Some(format!("{:.0} %", 100.0 * life.margin()))),
                of(&|life| Some(expected(life))),
            ]
        });
        let end = count(scene.life.cycles.into());
        let head = [
            "limit state".to_owned(),
            "output".to_owned(),
            "unworn".to_owned(),
            format!("after {end} cycles"),
            "limit".to_owned(),
            "margin".to_owned(),
            "expected life [cycles]".to_owned(),
        ];
        let head: Vec<&str> = head.iter().map(String::as_str).collect();
        captioned("limits-now", "This mechanism against its limits", tables::table(&head, rows))
    }
}

/// When a limit is reached.
fn expected(life: &NominalLife) -> String {
    match life.reached {
        Reached::FromTheStart => "0".to_owned(),
        Reached::After(cycles) => count(cycles.round() as u64),
        Reached::Beyond(_) => "beyond the life studied".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Settings, blank};
    use crate::test_study;

    #[test]
    fn a_page_has_limits_drawing_histories_bores_and_cycles() {
        let scene = &test_study::scene();
        let summary = blank(scene, &Settings::from(scene.study));
        let before = NominalView { scene, summary, evaluation: None, drawing: None };
        let text = before.beginning().unwrap().0;
        assert!(text.contains("limits-now") && text.contains(UNKNOWN), "{text}");
        assert!(!text.contains("history-wear"), "there is no history yet");

        let evaluation = test_study::report_input().nominal.unwrap();
        let view = NominalView { evaluation: Some(&evaluation), ..before };
        let facts = [("accuracy", "draft".to_owned())];
        let page = view.page(&facts, "gravity = 0").unwrap();
        for piece in [
            "id=\"drawing\"",
            "id=\"history-wear\"",
            "Worn bores",
            "First and last cycle",
            "id=\"motion\"",
            "draft",
        ] {
            assert!(page.contains(piece), "no {piece}");
        }
        assert!(!page.contains("http://") && !page.contains("https://"), "the page loads nothing");
    }
}
