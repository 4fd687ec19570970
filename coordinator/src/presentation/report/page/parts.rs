//! Elements of pages: figures, tables with titles, foldable content.

use super::numbered;
use crate::presentation::report::figure::Figure;
use crate::presentation::report::palette;
use maud::{Markup, PreEscaped, html};

/// The figure as an SVG file that follows the light or dark setting of the reader's system.
pub fn standalone(figure: &Figure) -> String {
    figure.drawing.document(&html! {
        "\n" title { (figure.title) } "\n"
        style { "\n" (PreEscaped(palette::css())) } "\n"
    })
}

/// Figures side by side in the columns of a class of the style sheet; empty for none.
pub fn figures(figures: &[Figure], columns: &str) -> Markup {
    html! {
        @if !figures.is_empty() {
            div.figures.(columns) { @for drawn in figures { (figure(drawn, None)) } }
        }
    }
}

/// A figure with its title, its number and its caption, and below the drawing the controls of one that moves.
pub fn figure(figure: &Figure, controls: Option<Markup>) -> Markup {
    let drawing = &figure.drawing;
    html! {
        figure id=(figure.name) class=[controls.as_ref().map(|_| "moving")] {
            h3 { (figure.title) (numbered::files(&figure.name)) }
            // An element of a page needs no namespace.
            svg viewBox=(drawing.view) font-family=[drawing.letters.map(|_| "sans-serif")] font-size=[drawing.letters]
                data-axes=[&drawing.axes] role="img" aria-label=(figure.title) {
                (PreEscaped(&drawing.content))
            }
            @if let Some(controls) = controls { div.controls hidden="" { (controls) } }
            figcaption { strong { (numbered::figure(&figure.name)) "." } " " (figure.caption) }
        }
    }
}

/// A table with its number and title.
pub fn captioned(name: &str, title: &str, table: Markup) -> Markup {
    html! {
        div.titled id=(format!("table-{name}")) {
            p.caption { strong { (numbered::table(name)) "." } " " (title) }
            (table)
        }
    }
}

/// Content that unfolds on a click.
pub fn details(title: &str, content: Markup) -> Markup {
    html! { details { summary { (title) } (content) } }
}
