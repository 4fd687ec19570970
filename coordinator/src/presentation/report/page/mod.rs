//! The page of the report: head, sections, figures in place, one style sheet, and one script, without which the picture of
//! the mechanism stands still.

mod end;
mod head;

use super::animation::Animation;
use super::figure::Figure;
use super::figures::lives_in_words;
use super::format::{count, escape};
use super::input::ReportInput;
use super::life::rows_that_matter;
use super::{palette, stated, tables};
use std::fmt::Write;

/// The figures by section.
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

const STYLE: &str = include_str!("style.css");

/// The figure as an SVG file of its own, light or dark as its reader's system is.
pub fn standalone(figure: &Figure) -> String {
    let (head, body) = split(&figure.svg);
    let title = escape(&figure.title);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" {}>\n<title>{title}</title>\n<style>\n{}</style>\n{body}",
        head.trim(),
        palette::css()
    )
}

/// The figure inside the page; HTML needs no namespace.
fn inline(figure: &Figure) -> String {
    let (head, body) = split(&figure.svg);
    format!("<svg {} role=\"img\" aria-label=\"{}\">\n{body}", head.trim(), escape(&figure.title))
}

/// Attributes of the outermost element without namespace and size in pixels, and all that follows.
fn split(svg: &str) -> (String, &str) {
    let start = svg.find("<svg").map_or(0, |at| at + 4);
    let end = svg[start..].find('>').map_or(svg.len(), |at| start + at);
    let kept = ["viewBox", "font-family", "font-size"].into_iter().filter_map(|name| {
        let from = svg[start..end].find(&format!("{name}=\""))? + start;
        let value = from + name.len() + 2;
        let to = value + svg[value..end].find('"')? + 1;
        Some(svg[from..to].to_string())
    });
    (kept.collect::<Vec<_>>().join(" "), svg[(end + 1).min(svg.len())..].trim_start())
}

/// The whole page.
pub fn html(input: &ReportInput, sections: &Sections) -> String {
    let summary = &input.summary;
    let mut body = head::head(input);
    let mut put = |text: &str| body.push_str(text);
    put(&reliability(input, &sections.reliability));
    put(&section(
        "How outputs spread",
        "",
        &figures(&sections.outputs, "two"),
        "The campaign holds no distributions.",
    ));
    put(&influences(input, sections));
    if summary.of_mechanism() {
        put(&mechanism(input, sections));
    }
    let why = escape(&summary.convergence.stopped_because);
    put(&section(
        "Convergence of the study",
        &if why.is_empty() { String::new() } else { format!("Ended because: {why}.") },
        &figures(&sections.learning, "three"),
        "The study had no rounds of learning.",
    ));
    if !summary.convergence.rounds.is_empty() {
        put(&details("All rounds", &tables::rounds(input)));
    }
    let stated =
        stated::sentences(input).iter().map(|sentence| escape(sentence)).collect::<Vec<_>>().join(" ");
    let without_figures =
        if stated.is_empty() { "The simulations state no numerical errors." } else { &stated };
    put(&section("Numerical error", &stated, &figures(&sections.numerical, "three"), without_figures));
    put(&stated::errors_over_life(input));
    put(&end::end(input));
    if let Some(motion) = &sections.motion {
        let _ = write!(
            body,
            "<script type=\"application/json\" id=\"motion\">{}</script>\n<script>\n{}</script>\n",
            motion.data,
            super::animation::SCRIPT
        );
    }
    wrapped(&input.title, &body)
}

/// A page of the house's style around a body.
pub fn wrapped(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{} · Hingewise</title>\n<style>\n{}{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        escape(title),
        palette::css()
    )
}

/// Curves, what fails first, and the numbers.
fn reliability(input: &ReportInput, drawn: &[Figure]) -> String {
    let rows = rows_that_matter(&input.summary, 1);
    let all = &input.summary.reliability;
    let mut html = String::from("<h2>Reliability</h2>\n");
    html += &figures(drawn, "two");
    html += &tables::reliability(input, rows);
    if rows.len() < all.len() {
        html += &details("All checkpoints", &tables::reliability(input, all));
    }
    html
}

/// What the variables do to failures, and to the outputs.
fn influences(input: &ReportInput, sections: &Sections) -> String {
    let mut html =
        section("Sensitivity", "", &figures(&sections.sensitivity, "two"), "No sensitivities were computed.");
    html += &figures(&sections.variance, "two");
    if sections.variance.is_empty() {
        html += "<p class=\"none\">No Sobol indices: the study has no surrogates, or its variables depend on each other.</p>\n";
    }
    let tables: String = input
        .limit_states
        .iter()
        .map(|state| (escape(&state.name), tables::sensitivity(input, &state.name)))
        .filter(|(_, table)| !table.is_empty())
        .map(|(name, table)| format!("<h3>Failure by {name}</h3>\n{table}"))
        .collect();
    if !tables.is_empty() {
        html += &details("All variables", &tables);
    }
    html
}

/// What there is to see of the nominal mechanism: its motion, its bores, its first and its last cycle.
fn mechanism(input: &ReportInput, sections: &Sections) -> String {
    let mut html = section(
        "The mechanism",
        "",
        &sections.motion.as_ref().map_or(String::new(), |motion| moving(&motion.figure)),
        "The nominal evaluation does not tell how every body moves.",
    );
    let end = input.nominal.as_ref().and_then(|nominal| nominal.cycles.last()).map_or(0, |cycles| *cycles);
    let lives = lives_in_words(input);
    html += &section(
        "Worn bores",
        &format!(
            "The nominal mechanism after {} cycles{}. The inner circle is the unworn bore; wear is drawn outward from it, \
             magnified, on one scale for all joints; angles in the frame of the bushing's body.",
            count(end.into()),
            if input.nominal.as_ref().is_none_or(|nominal| nominal.worn.is_none()) {
                ": this campaign kept the bores at the end alone".to_string()
            } else if lives.is_empty() {
                String::new()
            } else {
                format!(", the thin lines before: {lives}")
            }
        ),
        &figures(&sections.bores, "many"),
        "There is no nominal evaluation with worn joints.",
    );
    html += &section(
        "Journal orbits",
        "Centre of the journal from that of the bushing over a cycle, in the frame of the bushing's body, on one scale for all \
         joints: <span class=\"first\">first cycle</span>, <span class=\"last\">last cycle</span>. Circle: radial clearance; \
         around it: with the wear at the end of life.",
        &figures(&sections.orbits, "many"),
        "The nominal evaluation does not tell how journals and bushings move.",
    );
    html += &section(
        "First and last cycle",
        "",
        &figures(&[sections.first_cycle.clone(), sections.last_cycle.clone()].concat(), "three"),
        "The nominal evaluation holds no first cycle.",
    );
    if sections.last_cycle.is_empty() && !sections.first_cycle.is_empty() {
        html += "<p class=\"none\">The nominal evaluation holds no last cycle.</p>\n";
    }
    html
}

/// The picture of the mechanism with what moves it; without a script the controls stay hidden.
fn moving(figure: &Figure) -> String {
    format!(
        "<figure id=\"{}\" class=\"moving\"><h3>{}</h3>\n{}<div class=\"controls\" hidden=\"\">\
         <button type=\"button\">Play</button><input type=\"range\" min=\"0\" value=\"0\" aria-label=\"instant of the cycle\"/>\
         <select aria-label=\"cycle\"></select></div><figcaption>{}</figcaption></figure>\n",
        figure.name,
        escape(&figure.title),
        inline(figure),
        escape(&figure.caption)
    )
}

/// A section with its figures, or a sentence that says why there are none. `lead` and `otherwise` are HTML.
fn section(title: &str, lead: &str, figures: &str, otherwise: &str) -> String {
    let mut html = format!("<h2>{title}</h2>\n");
    if figures.is_empty() {
        let _ = writeln!(html, "<p class=\"none\">{otherwise}</p>");
        return html;
    }
    if !lead.is_empty() {
        let _ = writeln!(html, "<p>{lead}</p>");
    }
    html + figures
}

/// Figures in columns as wide screens have room for; empty for none.
pub(super) fn figures(figures: &[Figure], columns: &str) -> String {
    if figures.is_empty() {
        return String::new();
    }
    let mut html = format!("<div class=\"figures {columns}\">\n");
    for figure in figures {
        let _ = writeln!(
            html,
            "<figure id=\"{}\"><h3>{}</h3>\n{}<figcaption>{}</figcaption></figure>",
            figure.name,
            escape(&figure.title),
            inline(figure),
            escape(&figure.caption)
        );
    }
    html + "</div>\n"
}

pub(super) fn details(title: &str, content: &str) -> String {
    format!("<details><summary>{title}</summary>\n{content}</details>\n")
}
