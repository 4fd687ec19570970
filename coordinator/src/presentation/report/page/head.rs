//! The head of the page: what was studied, and what came of it.

use crate::presentation::report::format::escape;
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::life::life_at;
use crate::presentation::report::{tables, words};
use std::fmt::Write;

/// Title, the three lives, and the sentences.
pub fn head(input: &ReportInput) -> String {
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
    html += "</div>\n";
    if !summary.is_static() {
        html += &tables::lives(input);
    }
    html += "<div class=\"says\">";
    for sentence in words::sentences(input) {
        let _ = write!(html, "<p>{}</p>", escape(&sentence));
    }
    for note in &input.notes {
        let _ = write!(html, "<p class=\"note\"><strong>Mind:</strong> {}</p>", escape(note));
    }
    html + "</div>\n"
}
