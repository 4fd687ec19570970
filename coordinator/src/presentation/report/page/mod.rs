//! A page as a value: a header, and below it text and chapters with their figures. It is written once it is complete: then figures and
//! tables have numbers, and references to them are links. Until then content has marks. A figure is a drawing with title and caption, and its
//! numbers as CSV.

use super::palette;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::collections::BTreeMap;

const STYLE: &str = include_str!("style.css");

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

/// A page in the style of the report.
#[derive(Debug, Clone)]
pub struct Page {
    title: String,
    header: Markup,
    /// Content before the list of the chapters, where there is a list.
    before_contents: Option<Markup>,
    body: Markup,
    /// The appendix, folded on a screen and from a new page on paper; absent before its first chapter.
    appendix: Option<Markup>,
    /// Titles of the chapters, and whether they are in the appendix.
    chapters: Vec<(&'static str, bool)>,
    /// The figures in their order.
    pub figures: Vec<Figure>,
    /// True if `figures/NAME.svg` and `figures/NAME.csv` of every figure stand next to the page.
    pub has_files: bool,
}

/// What the page of a running study has besides.
pub struct LiveStatus {
    /// Number of the page, for the script that asks for a newer one.
    pub revision: u64,
    /// Further elements of the head.
    pub head: Markup,
    /// The line above everything.
    pub line: Markup,
    /// The progress of the study, below the header.
    pub progress: Markup,
}

impl Page {
    /// A page with this header, which stands alone.
    pub fn new(title: &str, header: Markup) -> Self {
        Self {
            title: title.to_owned(),
            header,
            before_contents: None,
            body: html! {},
            appendix: None,
            chapters: vec![],
            figures: vec![],
            has_files: false,
        }
    }

    /// Adds content to the last chapter.
    pub fn add(&mut self, content: Markup) {
        self.appendix.as_mut().unwrap_or(&mut self.body).0 += &content.0;
    }

    /// Adds the list of all chapters.
    pub fn add_contents(&mut self) {
        self.before_contents = Some(std::mem::replace(&mut self.body, html! {}));
    }

    /// Begins a chapter.
    pub fn begin(&mut self, title: &'static str) {
        self.chapters.push((title, self.appendix.is_some()));
        let anchor = format!("chapter-{}", self.chapters.len());
        self.add(html! { a id=(anchor) {} h2 { (title) } });
    }

    /// Begins the appendix: all that is added from here on is folded on a screen.
    pub fn begin_appendix(&mut self) {
        self.appendix = Some(html! {});
    }

    /// Figures side by side in the columns of a class of the style sheet, as content that is to be added; empty for none.
    pub fn draw(&mut self, drawn: impl IntoIterator<Item = Figure>, columns: &str) -> Markup {
        let drawn: Vec<Figure> = drawn.into_iter().collect();
        let content = figures(&drawn, columns);
        self.figures.extend(drawn);
        content
    }

    /// A figure with controls that a script unhides, as content that is to be added.
    pub fn add_moving(&mut self, drawn: Figure, controls: Markup) {
        self.add(figure(&drawn, Some(controls)));
        self.figures.push(drawn);
    }

    /// Adds a chapter of drawn figures with an introduction; of the sentence `otherwise` alone if there are none.
    pub fn add_chapter(
        &mut self,
        title: &'static str,
        lead: Markup,
        (drawn, columns): (Vec<Figure>, &str),
        otherwise: &str,
    ) {
        self.begin(title);
        let drawn = self.draw(drawn, columns);
        self.add(html! {
            @if drawn.0.is_empty() {
                p.none { (otherwise) }
            } @else {
                @if !lead.0.is_empty() { p { (lead) } }
                (drawn)
            }
        });
    }

    /// The list of the chapters of the body, or of the appendix.
    fn contents(&self, of_appendix: bool) -> Markup {
        let all =
            self.chapters.iter().enumerate().filter(|(_, (_, is_appended))| *is_appended == of_appendix);
        html! {
            ol type=[of_appendix.then_some("A")] {
                @for (k, (title, _)) in all { li { a href=(format!("#chapter-{}", k + 1)) { (title) } } }
            }
        }
    }

    /// The text of the page; of a running study with its status.
    pub fn html(&self, live: Option<&LiveStatus>) -> String {
        let body = html! {
            (self.header)
            @if let Some(live) = live { "\n" (live.progress) }
            @if let Some(lead) = &self.before_contents {
                (lead)
                nav aria-label="contents" { (self.contents(false)) @if self.appendix.is_some() { p { "Appendix" } (self.contents(true)) } }
            }
            (self.body)
            @if let Some(appendix) = &self.appendix { details.appendix { summary { "Appendix" } (appendix) } }
        };
        let body = PreEscaped(resolve(&body.0, self.has_files));
        let page = html! {
            (DOCTYPE) "\n"
            html lang="en" data-revision=[live.map(|live| live.revision)] {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) " · Hingewise" }
                    style { "\n" (PreEscaped(palette::css())) (PreEscaped(STYLE)) (PreEscaped(running_head(&self.title))) }
                    @if let Some(live) = live { (live.head) "\n" }
                }
                body { "\n" @if let Some(live) = live { (live.line) } main { (body) } }
            }
            "\n"
        };
        page.into_string()
    }
}

/// The style of the running head and the page numbers of a printed page.
fn running_head(title: &str) -> String {
    // What could end the string or the style element is left out.
    let plain: String = title.chars().filter(|c| !"\"\\<>\n".contains(*c)).collect();
    format!(
        "@page{{size:A4;margin:18mm 14mm 16mm;@top-left{{content:\"Hingewise · {plain}\";font-size:8pt;color:#57616D}}\
         @bottom-right{{content:counter(page) \" / \" counter(pages);font-size:8pt;color:#57616D}}}}\n"
    )
}

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
fn figure(figure: &Figure, controls: Option<Markup>) -> Markup {
    let drawing = &figure.drawing;
    html! {
        figure id=(figure.name) class=[controls.as_ref().map(|_| "moving")] {
            h3 { (figure.title) (mark("files", &figure.name)) }
            // An element of a page needs no namespace.
            svg viewBox=(drawing.view) font-family=[drawing.letters.map(|_| "sans-serif")] font-size=[drawing.letters]
                data-axes=[&drawing.axes] role="img" aria-label=(figure.title) {
                (PreEscaped(&drawing.content))
            }
            @if let Some(controls) = controls { div.controls hidden="" { (controls) } }
            figcaption { strong { (mark("Figure", &figure.name)) "." } " " (figure.caption) }
        }
    }
}

/// A table with its number and title.
pub fn captioned(name: &str, title: &str, table: Markup) -> Markup {
    html! {
        div.titled id=(format!("table-{name}")) {
            p.caption { strong { (mark("Table", name)) "." } " " (title) }
            (table)
        }
    }
}

/// A table beside a drawing, if there is one.
pub fn beside(drawn: &Markup, table: Markup) -> Markup {
    html! { @if drawn.0.is_empty() { (table) } @else { div.beside { (drawn) (table) } } }
}

/// Content that unfolds on a click.
pub fn details(title: &str, content: Markup) -> Markup {
    html! { details { summary { (title) } (content) } }
}

/// Begin and end of a mark: that of a comment, which no escaped text contains.
const MARK: [&str; 2] = ["<!--", "-->"];

pub fn mark(kind: &str, name: &str) -> Markup {
    let [begin, end] = MARK;
    PreEscaped(format!("{begin}{kind} {name}{end}"))
}

/// A link to a table by its number, e.g. `Table 2`.
pub fn refer_table(name: &str) -> Markup {
    mark("see-table", name)
}

/// The mark at the beginning of `piece`, as (kind, name), and what follows it.
fn taken(piece: &str) -> ((&str, &str), &str) {
    let (mark, after) = piece.split_once(MARK[1]).unwrap_or_default();
    (mark.split_once(' ').unwrap_or_default(), after)
}

/// The body of a page with numbers and links instead of marks. A reference to what the page does not have is its name alone.
pub fn resolve(body: &str, has_files: bool) -> String {
    let mut pieces = body.split(MARK[0]);
    let text = pieces.next().unwrap_or_default();
    let marked: Vec<((&str, &str), &str)> = pieces.map(taken).collect();
    let numbers = |kind: &str| -> BTreeMap<&str, usize> {
        let own = marked.iter().filter(|((of, _), _)| *of == kind);
        own.enumerate().map(|(k, ((_, name), _))| (*name, k + 1)).collect()
    };
    let (figures, tables) = (numbers("Figure"), numbers("Table"));
    let link = |number: Option<&usize>, word: &str, target: &str, name: &str| match number {
        Some(number) => html! { a href=(format!("#{target}{name}")) { (word) " " (number) } },
        None => html! { (name) },
    };
    let mut page = text.to_owned();
    for ((kind, name), text) in marked {
        page += &match kind {
            "Figure" => html! { "Figure " (figures[name]) },
            "Table" => html! { "Table " (tables[name]) },
            "see-figure" => link(figures.get(name), "Figure", "", name),
            "see-table" => link(tables.get(name), "Table", "table-", name),
            "files" if has_files => html! {
                span.files {
                    " " a href=(format!("figures/{name}.svg")) { "SVG" } " " a href=(format!("figures/{name}.csv")) { "CSV" }
                }
            },
            _ => html! {},
        }
        .0;
        page += text;
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chapters_have_numbers_that_the_contents_lead_to() {
        let mut page = Page::new("T", html! { header { "H" } });
        page.add(html! { p { "before" } });
        page.add_contents();
        ["One", "Two"].into_iter().for_each(|title| page.begin(title));
        page.begin_appendix();
        page.begin("Three");
        let text = page.html(None);
        for said in [
            "<p>before</p><nav",
            "<li><a href=\"#chapter-1\">One</a></li><li><a href=\"#chapter-2\">Two</a></li>",
            "<ol type=\"A\"><li><a href=\"#chapter-3\">Three</a></li></ol>",
            "<a id=\"chapter-2\"></a><h2>Two</h2><details class=\"appendix\"><summary>Appendix</summary><a id=\"chapter-3\"></a>",
        ] {
            assert!(text.contains(said), "{said} in {text}");
        }
    }

    #[test]
    fn numbers_follow_the_page_and_references_find_them() {
        let body = html! {
            p { "See " (mark("see-figure", "b")) ", " (refer_table("t")) " and " (mark("see-figure", "lost")) "." }
            (mark("Figure", "a")) (mark("files", "a")) (mark("Figure", "b")) (mark("Table", "t"))
        };
        let page = resolve(&body.0, true);
        for said in [
            "See <a href=\"#b\">Figure 2</a>, <a href=\"#table-t\">Table 1</a> and lost.",
            "Figure 1<span class=\"files\"> <a href=\"figures/a.svg\">SVG</a>",
        ] {
            assert!(page.contains(said), "{said} in {page}");
        }
        assert!(!page.contains(MARK[0]) && !page.contains(MARK[1]));
        assert!(!resolve(&body.0, false).contains("figures/"));
    }

    #[test]
    fn a_page_without_marks_keeps_its_text() {
        assert_eq!(resolve("<p>a \u{b1} b</p>", false), "<p>a \u{b1} b</p>");
    }
}
