//! The page of the report: sections with their figures and tables, one style sheet, one script that animates the
//! drawing of the mechanism, and one that shows the values of charts at the pointer. Without them the drawing shows its first frame.

mod end;
mod head;
pub mod numbered;
mod parts;
mod points;
mod worn_guides;

pub use numbered::FigureFiles;
pub use parts::{captioned, details, figures, standalone, wrapped};

use super::animation::{Animation, SCRIPT};
use super::figure::Figure;
use super::figures::file_name;
use super::figures::lives_in_words;
use super::format::count;
use super::input::ReportInput;
use super::life::rows_that_matter;
use super::{stated, studied, tables};
use maud::{Markup, PreEscaped, html};
use parts::{inline, page_of, section};

/// The script that shows the values of a chart at the pointer.
const HOVER: &str = include_str!("hover.js");

/// Figures by section of the page.
#[derive(Default)]
pub struct Sections {
    pub(super) studied: Vec<Figure>,
    pub(super) reliability: Vec<Figure>,
    pub(super) rates: Vec<Figure>,
    pub(super) outputs: Vec<Figure>,
    pub(super) inputs: Vec<Figure>,
    pub(super) combinations: Vec<Figure>,
    pub(super) sensitivity: Vec<Figure>,
    pub(super) variance: Vec<Figure>,
    pub(super) motion: Option<Animation>,
    pub(super) first_cycle: Vec<Figure>,
    pub(super) last_cycle: Vec<Figure>,
    pub(super) bores: Vec<Figure>,
    pub(super) orbits: Vec<Figure>,
    pub(super) predictions: Vec<Figure>,
    pub(super) learning: Vec<Figure>,
    pub(super) numerical: Vec<Figure>,
}

impl Sections {
    /// All figures in the order of the page.
    pub fn into_figures(self) -> Vec<Figure> {
        [
            self.studied,
            self.reliability,
            self.rates,
            self.outputs,
            self.sensitivity,
            self.variance,
            self.inputs,
            self.combinations,
            self.motion.into_iter().map(|motion| motion.figure).collect(),
            self.bores,
            self.orbits,
            self.first_cycle,
            self.last_cycle,
            self.predictions,
            self.learning,
            self.numerical,
        ]
        .concat()
    }
}

/// The whole page.
pub fn html(input: &ReportInput, sections: &Sections, files: FigureFiles) -> String {
    let convergence = &input.summary.convergence;
    let stated = stated::sentences(input).join(" ");
    let body = html! {
        (head::head(input))
        (numbered::contents())
        (studied::chapter(input, &sections.studied))
        (reliability(input, sections))
        (section(
            "Distributions of the outputs",
            html! {},
            figures(&sections.outputs, "two"),
            html! { "The study stored no distributions." },
        ))
        (influences(input, sections))
        (points::simulated(input, &sections.inputs, &sections.combinations))
        @if input.summary.of_mechanism() { (mechanism(input, sections)) }
        (section(
            "Quality of the surrogates",
            html! {},
            figures(&sections.predictions, "two"),
            html! {
                @if input.summary.is_direct() { "Every sample was simulated; there are no surrogates." }
                @else { "The study stored no predictions of its surrogates." }
            },
        ))
        (section(
            "Convergence of the study",
            html! { @if !convergence.stopped_because.is_empty() { "Stopped because: " (convergence.stopped_because) "." } },
            figures(&sections.learning, "three"),
            html! { "The study had no rounds of learning." },
        ))
        (section(
            "Numerical error",
            html! { (stated) },
            figures(&sections.numerical, "three"),
            html! { @if stated.is_empty() { "The simulations state no numerical errors." } @else { (stated) } },
        ))
        (stated::errors_over_life(input))
        (end::effort(input))
        (appendix(input))
        @if let Some(motion) = &sections.motion { (animated(motion)) }
        script { "\n" (PreEscaped(HOVER)) } "\n"
    };
    page_of(&input.title, &body, files)
}

/// Curves, what fails first, and the numbers.
fn reliability(input: &ReportInput, sections: &Sections) -> Markup {
    let rows = rows_that_matter(&input.summary, 1);
    let all = &input.summary.reliability;
    html! {
        h2 { "Reliability" }
        (figures(&[sections.reliability.clone(), sections.rates.clone()].concat(), "two"))
        (captioned("reliability", "Reliability at the checkpoints that matter, with 95 % intervals", tables::reliability(input, rows)))
        @if rows.len() < all.len() {
            p { "All checkpoints: " (numbered::refer_table(CHECKPOINTS)) "; more digits in " code { "reliability.csv" } "." }
        }
    }
}

/// Sensitivities of the failures, and contributions to the variance of the outputs.
fn influences(input: &ReportInput, sections: &Sections) -> Markup {
    let tables: Vec<String> = sensitivities(input).into_iter().map(|(name, _)| name).collect();
    html! {
        (section(
            "Sensitivity",
            html! {},
            figures(&[sections.sensitivity.clone(), sections.variance.clone()].concat(), "two"),
            html! { "No sensitivities were computed." },
        ))
        @if sections.variance.is_empty() {
            p.none { "No Sobol indices: the study has no surrogates, or its variables are dependent." }
        }
        @if !tables.is_empty() {
            p {
                "All variables: "
                @for (k, name) in tables.iter().enumerate() { @if k > 0 { ", " } (numbered::refer_table(name)) }
                "."
            }
        }
    }
}

/// Name of the table of all checkpoints.
const CHECKPOINTS: &str = "checkpoints";

/// Tables of the sensitivities by their names.
fn sensitivities(input: &ReportInput) -> Vec<(String, Markup)> {
    let of = |name: &str| {
        let title = format!("Sensitivity of the failure probability by {name}, all variables");
        let table_name = format!("sensitivity-{}", file_name(name));
        Some((table_name.clone(), captioned(&table_name, &title, tables::sensitivity(input, name)?)))
    };
    input.limit_states.iter().filter_map(|state| of(&state.name)).collect()
}

/// Long tables, and what is needed to repeat the study.
fn appendix(input: &ReportInput) -> Markup {
    let (rows, all) = (rows_that_matter(&input.summary, 1), &input.summary.reliability);
    html! {
        div.appendix { h2 { "Appendix" } }
        (studied::appendix(input))
        @if rows.len() < all.len() {
            (captioned(CHECKPOINTS, "Reliability at all checkpoints, with 95 % intervals", tables::reliability(input, all)))
        }
        @for (_, table) in sensitivities(input) { (table) }
        @if !input.summary.convergence.rounds.is_empty() {
            (captioned("rounds", "Rounds of learning", tables::rounds(input)))
        }
        (end::repeat(input))
    }
}

/// The data of an animation and the script that shows it.
pub fn animated(motion: &Animation) -> Markup {
    html! {
        script type="application/json" id="motion" { (PreEscaped(&motion.data)) } "\n"
        script { "\n" (PreEscaped(SCRIPT)) } "\n"
    }
}

/// The nominal mechanism: its motion, its bores and orbits, its first and its last cycle.
pub fn mechanism(input: &ReportInput, sections: &Sections) -> Markup {
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
            html! { "No bore is worn in a nominal evaluation." },
        ))
        (worn_guides::worn_guides(input))
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
            h3 { (figure.title) (numbered::files(&figure.name)) }
            (inline(figure))
            div.controls hidden="" {
                button type="button" { "Play" }
                input.instant type="range" min="0" value="0" aria-label="instant of the cycle";
                select aria-label="cycle" {}
                span.through hidden="" {
                    "Life "
                    input.life type="range" min="0" value="0" aria-label="life of the bores";
                    " " output {}
                }
            }
            figcaption { strong { (numbered::figure(&figure.name)) "." } " " (figure.caption) }
        }
    }
}
