//! Elements of the pages: figures, sections, foldable content, and the page around a body.

use super::numbered::{self, FigureFiles};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::palette;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");

/// The figure as an SVG file that follows the light or dark setting of the reader's system.
pub fn standalone(figure: &Figure) -> String {
    let svg = SvgParts::new(&figure.svg);
    let document = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=[svg.attribute("viewBox")]
            font-family=[svg.attribute("font-family")] font-size=[svg.attribute("font-size")] {
            "\n" title { (figure.title) } "\n"
            style { "\n" (PreEscaped(palette::css())) } "\n"
            (PreEscaped(svg.content))
        }
    };
    document.into_string() + "\n"
}

/// The figure as an element of the page, which needs no namespace.
pub fn inline(figure: &Figure) -> Markup {
    let svg = SvgParts::new(&figure.svg);
    html! {
        svg viewBox=[svg.attribute("viewBox")] font-family=[svg.attribute("font-family")]
            font-size=[svg.attribute("font-size")] data-axes=[svg.attribute("data-axes").map(unescaped)] role="img"
            aria-label=(figure.title) {
            (PreEscaped(svg.content))
        }
    }
}

/// The text of an attribute as written.
fn unescaped(text: &str) -> String {
    text.replace("&quot;", "\"").replace("&lt;", "<").replace("&amp;", "&")
}

/// An SVG document taken apart.
struct SvgParts<'a> {
    /// Attributes of the outermost element, as written.
    attributes: &'a str,
    /// What the outermost element contains, as written.
    content: &'a str,
}

impl<'a> SvgParts<'a> {
    fn new(svg: &'a str) -> Self {
        let from = svg.find("<svg").map_or(0, |place| place + 4);
        let (attributes, content) = svg[from..].split_once('>').unwrap_or_default();
        let content = content.trim();
        Self { attributes, content: content.strip_suffix("</svg>").unwrap_or(content) }
    }

    /// Value of an attribute of the outermost element.
    fn attribute(&self, name: &str) -> Option<&'a str> {
        let value = self.attributes.split_once(&format!("{name}=\""))?.1;
        Some(value.split_once('"')?.0)
    }
}

/// A page in the style of the report around a body.
pub fn wrapped(title: &str, body: &Markup) -> String {
    page_of(title, body, FigureFiles::Absent)
}

/// A page around a body, with numbered figures and tables, and links to the files of figures where there are any.
pub fn page_of(title: &str, body: &Markup, files: FigureFiles) -> String {
    let body = PreEscaped(numbered::resolve(&body.0, files));
    let page = html! {
        (DOCTYPE) "\n"
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) " · Hingewise" }
                style { "\n" (PreEscaped(palette::css())) (PreEscaped(STYLE)) (PreEscaped(running_head(title))) }
            }
            body { "\n" main { (body) } }
        }
        "\n"
    };
    page.into_string()
}

/// The style of the running head and the page numbers of a printed page.
fn running_head(title: &str) -> String {
    // What could end the string or the style element is left out.
    let plain: String = title.chars().filter(|c| !"\"\\<>\n".contains(*c)).collect();
    format!(
        "@page{{margin:18mm 14mm 16mm;@top-left{{content:\"Hingewise · {plain}\";font-size:8pt;color:#57616D}}\
         @bottom-right{{content:counter(page) \" / \" counter(pages);font-size:8pt;color:#57616D}}}}\n"
    )
}

/// A section with an introduction and figures; with the sentence `otherwise` alone if there are no figures.
pub fn section(title: &str, lead: Markup, figures: Markup, otherwise: Markup) -> Markup {
    html! {
        h2 { (title) }
        @if figures.0.is_empty() {
            p.none { (otherwise) }
        } @else {
            @if !lead.0.is_empty() { p { (lead) } }
            (figures)
        }
    }
}

/// Figures side by side in the columns of a class of the style sheet; empty for none.
pub fn figures(figures: &[Figure], columns: &str) -> Markup {
    html! {
        @if !figures.is_empty() {
            div.figures.(columns) {
                @for figure in figures {
                    figure id=(figure.name) {
                        h3 { (figure.title) (numbered::files(&figure.name)) }
                        (inline(figure))
                        figcaption { strong { (numbered::figure(&figure.name)) "." } " " (figure.caption) }
                    }
                }
            }
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
