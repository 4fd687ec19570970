//! The head of the page: subject, method and main results of the study.

use crate::presentation::report::input::ReportInput;
use crate::presentation::report::life::{FAILED_UNWORN, LEVELS, failure_probability};
use crate::presentation::report::page::captioned;
use crate::presentation::report::{tables, words};
use maud::{Markup, html};

/// Title, and what was studied how.
pub fn header(input: &ReportInput) -> Markup {
    let summary = &input.summary;
    html! {
        header {
            p.brand { "Hingewise" }
            h1 { (input.scene.title) }
            p.meta {
                "Reliability study of scene " code { (summary.scene) } ", method " (summary.method) ", accuracy "
                (words::accuracy(summary)) ", seed " (summary.seed)
            }
        }
    }
}

/// The three lives (or the failure probability), and the summary in sentences.
pub fn lead(input: &ReportInput) -> Markup {
    let summary = &input.summary;
    html! {
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
                        p { @if life != FAILED_UNWORN { "cycles" br; } (bounds) }
                    }
                }
            }
        }
        @if !summary.is_static() { (captioned("lives", "Lives, with 95 % intervals", tables::lives(input))) }
        div.says {
            @for sentence in words::sentences(input) { p { (sentence) } }
            @for note in &input.notes { p.note { strong { "Caution:" } " " (note) } }
        }
    }
}
