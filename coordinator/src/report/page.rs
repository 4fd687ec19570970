//! The page of the report: head, sections, figures in place, one style sheet, no script.

use super::figures::Figure;
use super::format::{UNKNOWN, count, escape};
use super::input::ReportInput;
use super::life::{life_at, rows_that_matter};
use super::{palette, stated, tables, words};
use std::fmt::Write;

/// The figures by section.
pub struct Sections {
    pub(super) reliability: Vec<Figure>,
    pub(super) distributions: Vec<Figure>,
    pub(super) histories: Vec<Figure>,
    pub(super) first_cycle: Vec<Figure>,
    pub(super) bores: Vec<Figure>,
    pub(super) sensitivity: Vec<Figure>,
    pub(super) learning: Vec<Figure>,
    pub(super) numerical: Vec<Figure>,
}

impl Sections {
    /// All figures in the order of the page.
    pub fn into_figures(self) -> Vec<Figure> {
        [
            self.reliability,
            self.distributions,
            self.histories,
            self.first_cycle,
            self.bores,
            self.sensitivity,
            self.learning,
            self.numerical,
        ]
        .concat()
    }
}

/// Failed evaluations listed one by one.
const FAILURES_LISTED: usize = 50;

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
    let mut body = String::new();
    let mut put = |text: &str| body.push_str(text);
    put(&head(input));
    put("<h2>Reliability</h2>\n<div class=\"pair\"><div>");
    put(&figures(&sections.reliability, "one"));
    let rows = rows_that_matter(summary, 1);
    let all = &summary.reliability;
    put("</div><div>");
    put(&tables::reliability(input, rows));
    if rows.len() < all.len() {
        put(&details("All checkpoints", &tables::reliability(input, all)));
    }
    put("</div></div>\n");
    put(&section(
        "How outputs spread",
        "",
        &figures(&[sections.distributions.clone(), sections.histories.clone()].concat(), "two"),
        "The campaign holds no distributions.",
    ));
    if summary.of_mechanism() {
        put(&mechanism(input, sections));
    }
    let sensitivities: String = input
        .limit_states
        .iter()
        .map(|state| (escape(&state.name), tables::sensitivity(input, &state.name)))
        .filter(|(_, table)| !table.is_empty())
        .map(|(name, table)| format!("<h3>Failure by {name}</h3>\n{table}"))
        .collect();
    put(&section(
        "Sensitivity",
        "",
        &figures(&sections.sensitivity, "two"),
        "No sensitivities were computed.",
    ));
    if !sensitivities.is_empty() {
        put(&details("All variables", &sensitivities));
    }
    let why = escape(&summary.convergence.stopped_because);
    put(&section(
        "Learning",
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
    put(&numerics(input));
    put(&repeat(input));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{} · Hingewise</title>\n<style>\n{}{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        escape(&input.title),
        palette::css()
    )
}

/// What there is to see of the nominal mechanism: its first cycle and its bores.
fn mechanism(input: &ReportInput, sections: &Sections) -> String {
    let first_cycle = section(
        "First cycle",
        "",
        &figures(&sections.first_cycle, "three"),
        "The nominal evaluation holds no first cycle.",
    );
    let bores = section(
        "Worn bores",
        &input.nominal.as_ref().and_then(|nominal| nominal.cycles.last()).map_or(String::new(), |cycles| {
            format!(
                "The nominal mechanism after {} cycles. The inner circle is the unworn bore; wear is drawn outward \
                 from it, magnified, on one scale for all joints; angles in the frame of the bushing's body.",
                count((*cycles).into())
            )
        }),
        &figures(&sections.bores, "many"),
        "There is no nominal evaluation with worn joints.",
    );
    first_cycle + &bores
}

/// Title, the three lives, and the sentences.
fn head(input: &ReportInput) -> String {
    let summary = &input.summary;
    let mut html = format!(
        "<header><p class=\"brand\">Hingewise</p><h1>{}</h1>\
         <p class=\"meta\">Reliability study of scene <code>{}</code>, method {}, accuracy {}, seed {}</p></header>\n<div class=\"tiles\">",
        escape(&input.title),
        escape(&summary.scene),
        escape(&summary.method),
        escape(&words::accuracy(summary)),
        summary.seed
    );
    if summary.is_static() {
        let probability = words::failure_probability(&summary.reliability[0], "total");
        let _ = write!(
            html,
            "<div class=\"tile\"><p>P<sub>f</sub></p><p class=\"figure\">{probability}</p></div>"
        );
    }
    for level in words::LEVELS.into_iter().filter(|_| !summary.is_static()) {
        let (life, bounds) = words::life(life_at(summary, "total", level));
        let _ = write!(
            html,
            "<div class=\"tile\"><p>R = {level}</p><p class=\"figure\">{life}</p><p>cycles<br>{bounds}</p></div>"
        );
    }
    html += "</div>\n<div class=\"says\">";
    for sentence in words::sentences(input) {
        let _ = write!(html, "<p>{}</p>", escape(&sentence));
    }
    for note in &input.notes {
        let _ = write!(html, "<p class=\"note\"><strong>Mind:</strong> {}</p>", escape(note));
    }
    html + "</div>\n"
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
fn figures(figures: &[Figure], columns: &str) -> String {
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

fn details(title: &str, content: &str) -> String {
    format!("<details><summary>{title}</summary>\n{content}</details>\n")
}

/// Work, times, repairs and failed runs.
fn numerics(input: &ReportInput) -> String {
    let repairs: usize = input.summary.convergence.rounds.iter().map(|round| round.repairs).sum();
    let mut html = String::from("<h2>Numerics</h2>\n<div class=\"pair\"><div>");
    if input.summary.of_mechanism() {
        html += &tables::diagnostics(input);
    }
    html += &tables::stated_errors(input);
    html += "</div><div>";
    html += &tables::timing(input);
    html += "</div></div>\n";
    let _ = writeln!(html, "<p>Repairs of the surrogates over all rounds: {}.</p>", count(repairs as u64));
    if input.failures.is_empty() {
        html += "<p>Every evaluation has a result.</p>\n";
    } else {
        let failed = input.failures.len() as u64;
        let _ = writeln!(
            html,
            "<p>Evaluations without a result: {}. They are left out of the design.{}</p>",
            count(failed),
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
    if !input.settings.is_null() {
        let settings = serde_json::to_string_pretty(&input.settings).unwrap_or_default();
        html += &details("Settings", &format!("<pre>{}</pre>\n", escape(&settings)));
    }
    html + &details("Scene", &format!("<pre>{}</pre>\n", or_unknown(&input.scene_source)))
}
