//! The page of the report: sections with their figures and tables, one style sheet, and one script that animates the
//! drawing of the mechanism. Without the script the drawing shows its first frame.

mod end;
mod head;
mod parts;

pub use parts::{figures, standalone, wrapped};

use super::animation::{Animation, SCRIPT};
use super::figure::Figure;
use super::figures::lives_in_words;
use super::format::count;
use super::input::ReportInput;
use super::life::rows_that_matter;
use super::{stated, tables};
use maud::{Markup, PreEscaped, html};
use parts::{details, inline, section};

/// Figures by section of the page.
pub struct Sections {
    pub(super) reliability: Vec<Figure>,
    pub(super) outputs: Vec<Figure>,
    pub(super) sensitivity: Vec<Figure>,
    pub(super) variance: Vec<Figure>,
    pub(super) motion: Option<Animation>,
    pub(super) first_cycle: Vec<Figure>,
    pub(super) last_cycle: Vec<Figure>,
    pub(super) bores: Vec<Figure>,
    pub(super) orbits: Vec<Figure>,
    pub(super) learning: Vec<Figure>,
    pub(super) numerical: Vec<Figure>,
}

impl Sections {
    /// All figures in the order of the page.
    pub fn into_figures(self) -> Vec<Figure> {
        [
            self.reliability,
            self.outputs,
            self.sensitivity,
            self.variance,
            self.motion.into_iter().map(|motion| motion.figure).collect(),
            self.bores,
            self.orbits,
            self.first_cycle,
            self.last_cycle,
            self.learning,
            self.numerical,
        ]
        .concat()
    }
}

/// The whole page.
pub fn html(input: &ReportInput, sections: &Sections) -> String {
    let convergence = &input.summary.convergence;
    let stated = stated::sentences(input).join(" ");
    let body = html! {
        (head::head(input))
        (reliability(input, &sections.reliability))
        (section(
            "Distributions of the outputs",
            html! {},
            figures(&sections.outputs, "two"),
            html! { "The study stored no distributions." },
        ))
        (influences(input, sections))
        @if input.summary.of_mechanism() { (mechanism(input, sections)) }
        (section(
            "Convergence of the study",
            html! { @if !convergence.stopped_because.is_empty() { "Stopped because: " (convergence.stopped_because) "." } },
            figures(&sections.learning, "three"),
            html! { "The study had no rounds of learning." },
        ))
        @if !convergence.rounds.is_empty() { (details("All rounds", tables::rounds(input))) }
        (section(
            "Numerical error",
            html! { (stated) },
            figures(&sections.numerical, "three"),
            html! { @if stated.is_empty() { "The simulations state no numerical errors." } @else { (stated) } },
        ))
        (stated::errors_over_life(input))
        (end::end(input))
        @if let Some(motion) = &sections.motion {
            script type="application/json" id="motion" { (PreEscaped(&motion.data)) } "\n"
            script { "\n" (PreEscaped(SCRIPT)) } "\n"
        }
    };
    wrapped(&input.title, &body)
}

/// Curves, what fails first, and the numbers.
fn reliability(input: &ReportInput, drawn: &[Figure]) -> Markup {
    let rows = rows_that_matter(&input.summary, 1);
    let all = &input.summary.reliability;
    html! {
        h2 { "Reliability" }
        (figures(drawn, "two"))
        (tables::reliability(input, rows))
        @if rows.len() < all.len() { (details("All checkpoints", tables::reliability(input, all))) }
    }
}

/// Sensitivities of the failures, and contributions to the variance of the outputs.
fn influences(input: &ReportInput, sections: &Sections) -> Markup {
    let tables: Vec<(&str, Markup)> = input
        .limit_states
        .iter()
        .filter_map(|state| Some((state.name.as_str(), tables::sensitivity(input, &state.name)?)))
        .collect();
    html! {
        (section(
            "Sensitivity",
            html! {},
            figures(&sections.sensitivity, "two"),
            html! { "No sensitivities were computed." },
        ))
        (figures(&sections.variance, "two"))
        @if sections.variance.is_empty() {
            p.none { "No Sobol indices: the study has no surrogates, or its variables are dependent." }
        }
        @if !tables.is_empty() {
            (details("All variables", html! {
                @for (name, table) in &tables { h3 { "Failure by " (name) } (table) }
            }))
        }
    }
}

/// The nominal mechanism: its motion, its bores and orbits, its first and its last cycle.
fn mechanism(input: &ReportInput, sections: &Sections) -> Markup {
    let end = input.nominal.as_ref().and_then(|nominal| nominal.cycles.last()).map_or(0, |cycles| *cycles);
    let lives = lives_in_words(input);
    let no_history = input.nominal.as_ref().is_none_or(|nominal| nominal.worn.is_none());
    html! {
        (section(
            "The mechanism",
            html! {},
            sections.motion.as_ref().map_or(html! {}, |motion| moving(&motion.figure)),
            html! { "The nominal evaluation does not include the motion of every body." },
        ))
        (section(
            "Worn bores",
            html! {
                "The nominal mechanism after " (count(end.into())) " cycles"
                @if no_history {
                    "; this campaign stores the bores at the end of life only"
                } @else if !lives.is_empty() {
                    "; thin lines: after " (lives)
                }
                ". The inner circle is the unworn bore. Wear is drawn outward from it, magnified, at one scale for all \
                 joints; angles are in the frame of the bushing's body."
            },
            figures(&sections.bores, "many"),
            html! { "There is no nominal evaluation with worn joints." },
        ))
        (section(
            "Journal orbits",
            html! {
                "Centre of the journal relative to that of the bushing over a cycle, in the frame of the bushing's body, at \
                 one scale for all joints: "
                span.first { "first cycle" } ", " span.last { "last cycle" }
                ". Circle: radial clearance; outer curve: with the wear at the end of life."
            },
            figures(&sections.orbits, "many"),
            html! { "The nominal evaluation does not include the motion of journals and bushings." },
        ))
        (section(
            "First and last cycle",
            html! {},
            figures(&[sections.first_cycle.clone(), sections.last_cycle.clone()].concat(), "three"),
            html! { "The nominal evaluation has no first cycle." },
        ))
        @if sections.last_cycle.is_empty() && !sections.first_cycle.is_empty() {
            p.none { "The nominal evaluation has no last cycle." }
        }
    }
}

/// The drawing of the mechanism with the controls of its animation, which the script unhides.
fn moving(figure: &Figure) -> Markup {
    html! {
        figure id=(figure.name) class="moving" {
            h3 { (figure.title) }
            (inline(figure))
            div.controls hidden="" {
                button type="button" { "Play" }
                input type="range" min="0" value="0" aria-label="instant of the cycle";
                select aria-label="cycle" {}
            }
            figcaption { (figure.caption) }
        }
    }
}
