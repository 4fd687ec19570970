//! A figure of a report: a drawing with title and caption, and its numbers as CSV.

use maud::{Markup, PreEscaped, html};

/// A drawing in SVG, in the light colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Left end, upper end, width and height [drawing units].
    pub view: String,
    /// Size of letters whose elements state none [drawing units].
    pub letters: Option<f64>,
    /// Axes of a chart, JSON for the script that shows values.
    pub axes: Option<String>,
    /// Elements of the drawing as SVG.
    pub content: String,
}

impl Drawing {
    /// The drawing as a document that begins with these elements.
    pub fn document(&self, beginning: &Markup) -> String {
        let document = html! {
            svg xmlns="http://www.w3.org/2000/svg" viewBox=(self.view) font-family=[self.letters.map(|_| "sans-serif")]
                font-size=[self.letters] {
                (beginning) (PreEscaped(&self.content))
            }
        };
        document.into_string() + "\n"
    }
}

/// A figure of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, letters, digits and hyphens.
    pub name: String,
    /// Title, plain text.
    pub title: String,
    /// Caption, plain text.
    pub caption: String,
    /// What is drawn.
    pub drawing: Drawing,
    /// Numbers shown, as CSV with a header.
    pub csv: String,
}
