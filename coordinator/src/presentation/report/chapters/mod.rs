//! The page of the report: chapters with their figures and tables, and scripts that animate the drawing of the mechanism, answer to sliders,
//! and show the values of charts at the pointer. Without them the drawing shows its first frame.

mod end;

use super::animation::{SCRIPT, animation};
use super::figures;
use super::format::{count, fixed, joined, sentence};
use super::life::{LEVELS, failure_probability, rows_that_matter, unit_of_life};
use super::page::beside;
use super::{Page, ReportInput, captioned, table_of};
use super::{levels, sliders, studied, tables, variants, words};
use common::outputs::JointSummary;
use common::scene::{Joint, JointKind, OutputUnit};
use maud::{Markup, PreEscaped, html};

/// The script that shows the values of a chart at the pointer.
const HOVER: &str = include_str!("hover.js");

/// The whole page: the verdict, what a reader decides by, and an appendix with everything else; `has_files` if the files of its figures
/// stand next to it.
pub fn page(input: &ReportInput, has_files: bool) -> Page {
    let mut page = Page::new(&input.scene.title, header(input));
    page.has_files = has_files;
    lead(&mut page, input);
    page.add_contents();
    page.begin("What was studied");
    let drawing = page.draw(studied::figure(input), "one");
    page.add(studied::chapter(input, &drawing));
    reliability(&mut page, input);
    let sliders = sliders::chapter(&mut page, input);
    let none = "The study stored no distributions.";
    page.add_chapter("Outputs over life", html! {}, (figures::histories(input), "two"), none);
    variants_of_model(&mut page, input);
    influences(&mut page, input);
    end::failing(&mut page, input);
    let scripts = input.summary.of_mechanism().then(|| motion(&mut page, input));
    quality(&mut page, input);
    end::identification(&mut page, input);
    appendix(&mut page, input);
    page.add(html! { @if let Some(scripts) = scripts { (scripts) } (sliders) script { "\n" (PreEscaped(HOVER)) } "\n" });
    page
}

/// What fails first, and the numbers.
fn reliability(page: &mut Page, input: &ReportInput) {
    let (rows, all) = (rows_that_matter(&input.summary, 1), &input.summary.reliability);
    page.begin("Reliability");
    let drawn = page.draw(figures::first_failure(input), "one");
    let title = "Reliability at the checkpoints that matter, with 95 % intervals";
    page.add(html! {
        (beside(&drawn, captioned("reliability", title, tables::reliability(input, rows))))
        @if rows.len() < all.len() {
            p { "All checkpoints: " code { "reliability.csv" } "." }
        }
    });
}

/// Envelope of R and change of the lives by variants of the model, if there are any.
fn variants_of_model(page: &mut Page, input: &ReportInput) {
    let summary = &input.summary;
    if summary.variants.is_empty() {
        return;
    }
    page.begin("Variants of the model");
    let drawn = page.draw(variants::figure(summary), "two");
    let rows = captioned("variants", "Lives by variants of the model", variants::rows(summary));
    page.add(html! { (drawn) (rows) });
}

/// Sensitivities of the failures, and contributions to the variance of the outputs.
fn influences(page: &mut Page, input: &ReportInput) {
    let (derivatives, variance) = (figures::sensitivities(input), figures::variance_contributions(input));
    let has_indices = !variance.is_empty();
    page.add_chapter(
        "Sensitivity",
        html! {},
        ([derivatives, variance].concat(), "two"),
        "No sensitivities were computed.",
    );
    page.add(html! {
        @if !has_indices {
            p.none { "No Sobol indices: the study has no surrogates, or its variables are dependent." }
        }
        @if !input.summary.sensitivity.is_empty() {
            p { "All variables and checkpoints: " code { "summary.json" } "." }
        }
    });
}

/// Quality of the surrogates, convergence, and the parts of the interval.
fn quality(page: &mut Page, input: &ReportInput) {
    let summary = &input.summary;
    let stopped = &summary.convergence.stopped_because;
    let predicted = figures::predicted_against_simulated(input);
    let none = match (predicted.is_empty(), summary.is_direct()) {
        (true, true) => "Every sample was simulated; there are no surrogates.",
        (true, false) => "The study stored no predictions of its surrogates.",
        (false, _) => "",
    };
    page.begin("Quality of the result");
    let drawn =
        predicted.into_iter().chain(figures::learning(input)).chain(figures::parts_of_interval(summary));
    let drawn = page.draw(drawn, "two");
    page.add(html! {
        @if !none.is_empty() { p.none { (none) } }
        @if !stopped.is_empty() { p { "Stopped because: " (stopped) "." } }
        @for line in levels::parts_and_levels(summary) { p { (sentence(&line)) } }
        @for row in &input.verified {
            p {
                "Verified " (end::moment(&row.made)) ": " (row.compared) ": " (row.found) "."
                @if row.evaluations != summary.evaluations.total {
                    " The study had " (count(row.evaluations as u64)) " simulations then."
                }
            }
        }
        (drawn)
    });
}

/// Everything else: figures and tables that few readers need, and what is needed to repeat the study.
fn appendix(page: &mut Page, input: &ReportInput) {
    page.begin_appendix();
    studied::appendix(page, input);
    let (drawn, none) = (figures::papers(&input.summary), "Too few lives for a probability paper.");
    page.add_chapter("Lives on probability papers", html! {}, (drawn, "two"), none);
    let (drawn, none) = (figures::distributions(input), "The study stored no distributions.");
    page.add_chapter("Distributions of the outputs", html! {}, (drawn, "two"), none);
    wear_and_cycles(page, input);
    page.begin("Convergence of the study");
    page.add(html! {
        @if input.summary.convergence.rounds.is_empty() {
            p.none { "The study had no rounds of learning." }
        } @else {
            (captioned("rounds", "Rounds of learning", tables::rounds(input)))
        }
    });
    let stated = levels::sentences(input).join(" ");
    page.begin("Numerical error");
    page.add(html! {
        p { @if stated.is_empty() { "The simulations state no numerical errors." } @else { (stated) } }
        (levels::table_of_levels(&input.summary))
    });
    end::effort(page, input);
    page.add(end::repeat(input));
}

/// Adds the motion of the nominal mechanism. Returns the data of the animation and its script, for the end of the page.
pub fn motion(page: &mut Page, input: &ReportInput) -> Markup {
    page.begin("The mechanism");
    let Some((figure, data)) = animation(input) else {
        page.add(html! { p.none { "The nominal evaluation does not include the motion of every body." } });
        return html! {};
    };
    page.add_moving(figure, controls());
    html! {
        script type="application/json" id="motion" { (PreEscaped(data)) } "\n"
        script { "\n" (PreEscaped(SCRIPT)) } "\n"
    }
}

/// Adds the bores and guides of the nominal mechanism as they are worn.
fn worn_surfaces(page: &mut Page, input: &ReportInput) {
    let end = input.nominal.as_ref().and_then(|nominal| nominal.cycles.last()).map_or(0, |cycles| *cycles);
    let (lives, no_history) = (figures::lives_in_words(input), input.worn().is_none());
    let lead = html! {
        "The nominal " (input.subject()) " after " (count(end.into())) " cycles"
        @if no_history {
            "; this campaign stores the bores at the end of life only"
        } @else if !lives.is_empty() {
            "; thin lines: after " (lives)
        }
        ". The inner circle is the unworn bore. Wear is drawn outward from it, magnified, at one scale for all \
         joints; angles are in the frame of the bushing's body."
    };
    let (bores, guides) = (figures::bores(input), worn_guides(input));
    let title = if bores.is_empty() { "Worn surfaces" } else { "Worn bores" };
    if bores.is_empty() && !guides.0.is_empty() {
        page.begin(title);
    } else {
        page.add_chapter(title, lead, (bores, "many"), "No surface wears in the nominal evaluation.");
    }
    page.add(guides);
}

/// Adds the bores and orbits of the nominal mechanism, its first and its last cycle; nothing for a simulator that gives whole lives.
pub fn wear_and_cycles(page: &mut Page, input: &ReportInput) {
    if !input.has_lives() {
        return;
    }
    let by_program = input.scene.simulator.is_some();
    worn_surfaces(page, input);
    let of_cycles = html! { span.first { "first cycle" } ", " span.last { "last cycle" } };
    let (orbits, has_hinges) = (figures::orbits(input), input.scene.joints.iter().any(is_hinge));
    if has_hinges && !(by_program && orbits.is_empty()) {
        let lead = html! {
            "Centre of the journal relative to that of the bushing over a cycle, in the frame of the bushing's body, at \
             one scale for all joints: " (of_cycles)
            ". Circle: radial clearance; outer curve: with the wear at the end of life."
        };
        let none = "The nominal evaluation does not include the motion of journals and bushings.";
        page.add_chapter("Journal orbits", lead, (orbits, "many"), none);
    }
    let forces = figures::journal_forces(input);
    if !forces.is_empty() {
        let lead = html! {
            "Normal force of the journal on the bushing over a cycle, in the frame of the bushing's body, at one scale for all joints: "
            (of_cycles) "."
        };
        page.add_chapter("Journal forces", lead, (forces, "many"), "");
    }
    let [first, last] = [figures::first_cycle(input), figures::last_cycle(input)];
    let lacks_last = last.is_empty() && !first.is_empty();
    let drawn = ([first, last].concat(), "three");
    page.add_chapter("First and last cycle", html! {}, drawn, "The nominal evaluation has no first cycle.");
    page.add(html! {
        @if by_program {
            p.none {
                @if lacks_last { "One cycle of ideal joints stands for the whole life. " }
                "Not known of the cycles of a program: motion of the bodies, contact arcs and energy balance."
            }
        } @else if lacks_last {
            p.none { "The nominal evaluation has no last cycle." }
        }
    });
}

/// True for a hinge with clearance.
fn is_hinge(joint: &Joint) -> bool {
    matches!(joint.kind, JointKind::Clearance(_))
}

/// The controls of the animation, which its script unhides.
fn controls() -> Markup {
    html! {
        button type="button" { "Play" }
        input.instant type="range" min="0" value="0" aria-label="instant of the cycle";
        select aria-label="cycle" {}
        span.through hidden="" {
            "Life "
            input.life type="range" min="0" value="0" aria-label="life of the bores";
            " " output {}
        }
    }
}

/// Title, and what was studied how.
pub fn header(input: &ReportInput) -> Markup {
    let summary = &input.summary;
    let named = [("", "project"), ("revision ", "revision"), ("by ", "author")].into_iter();
    let text = |(before, key)| Some(format!("{before}{}", input.written.name(&format!("report.{key}"))?));
    let responsible = joined(named.filter_map(text), ", ");
    html! {
        header {
            p.brand { "Hingewise" }
            h1 { (input.scene.title) }
            p.meta {
                "Reliability study of scene " code { (summary.scene) } ", method " (summary.method) ", accuracy "
                (words::accuracy(summary)) ", seed " (summary.seed)
            }
            @if !responsible.is_empty() { p.meta { (responsible) } }
            @if let Some(note) = input.written.name("report.note") { p { (note) } }
        }
    }
}

/// Adds the three lives (or the failure probability) and the summary in sentences, the curve beside the lives, and the cautions.
fn lead(page: &mut Page, input: &ReportInput) {
    let summary = &input.summary;
    let curve = page.draw(figures::reliability(summary), "one");
    page.add(html! {
        div.tiles {
            @if summary.is_static() {
                div.tile {
                    p { "P" sub { "f" } }
                    p.figure { (failure_probability(&summary.reliability[0], "total")) }
                    p { "95 % interval" }
                }
            } @else {
                @for level in LEVELS {
                    @let (life, bounds) = words::life(summary, level);
                    div.tile {
                        p { "R = " (level) }
                        p.figure { (life) }
                        p { @let unit = unit_of_life(&life); @if !unit.is_empty() { (unit) br; } (bounds) }
                    }
                }
            }
        }
        div.beside {
            (curve)
            div {
                @if !summary.is_static() { (captioned("lives", "Lives, with 95 % intervals", tables::lives(input))) }
                div.says { @for sentence in words::sentences(input) { p { (sentence) } } }
            }
        }
        (notes(input))
    });
}

/// The cautions of a page, each a sentence.
pub fn notes(input: &ReportInput) -> Markup {
    html! { div.says { @for note in &input.notes { p.note { strong { "Caution:" } " " (sentence(note)) } } } }
}

/// Largest depths of both faces of each guide that wears and of its slider; nothing without any.
pub(super) fn worn_guides(input: &ReportInput) -> Markup {
    let joints = input.nominal.iter().flat_map(|nominal| &nominal.joints).zip(&input.scene.joints);
    let is_worn = |(summary, joint): &(&JointSummary, &Joint)| {
        matches!(joint.kind, JointKind::Guide(_)) && !summary.wear_depth.is_empty()
    };
    let worn: Vec<&JointSummary> = joints.filter(is_worn).map(|(summary, _)| summary).collect();
    if worn.is_empty() {
        return html! {};
    }
    let units = &input.scene.units;
    let [depth, force] = [OutputUnit::Length, OutputUnit::Force].map(|usual| units.of(usual));
    let deepest = |depths: &[f64], face: usize| {
        let (left, right) = depths.split_at(depths.len() / 2);
        fixed(depth.to_shown([left, right][face].iter().copied().fold(0.0, f64::max)), 2)
    };
    let head = |of: &str| units.head(&format!("{of} [µm]"));
    let table = table_of::<&JointSummary>(
        &[
            ("guide", &|guide| guide.name.clone()),
            (&head("left face"), &|guide| deepest(&guide.wear_depth, 0)),
            (&head("right face"), &|guide| deepest(&guide.wear_depth, 1)),
            (&head("slider, left"), &|guide| deepest(&guide.journal_wear_depth, 0)),
            (&head("slider, right"), &|guide| deepest(&guide.journal_wear_depth, 1)),
            (&units.head("peak force [N]"), &|guide| fixed(force.to_shown(guide.peak_force), 2)),
        ],
        worn,
    );
    captioned(
        "worn-guides",
        "Guides that wear: largest depth of each face of the guide and of its slider, seen along the axis of the guide, nominal mechanism at the \
         end of life; peak force of the first cycle",
        table,
    )
}
