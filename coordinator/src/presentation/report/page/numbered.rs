//! Numbers of figures and tables, and references to them: content has marks, which are replaced in the order of the page once that is
//! complete.

use maud::{Markup, PreEscaped, html};
use std::collections::BTreeMap;

/// Begin and end of a mark: that of a comment, which no escaped text contains.
const MARK: [&str; 2] = ["<!--", "-->"];

/// Files of the figures that a page refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureFiles {
    /// `figures/NAME.svg` and `figures/NAME.csv` stand next to the page.
    NextToPage,
    /// The page stands alone.
    Absent,
}

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
pub fn resolve(body: &str, with: FigureFiles) -> String {
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
            "files" if with == FigureFiles::NextToPage => html! {
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
    fn numbers_follow_the_page_and_references_find_them() {
        let body = html! {
            p { "See " (mark("see-figure", "b")) ", " (refer_table("t")) " and " (mark("see-figure", "lost")) "." }
            (mark("Figure", "a")) (mark("files", "a")) (mark("Figure", "b")) (mark("Table", "t"))
        };
        let page = resolve(&body.0, FigureFiles::NextToPage);
        for said in [
            "See <a href=\"#b\">Figure 2</a>, <a href=\"#table-t\">Table 1</a> and lost.",
            "Figure 1<span class=\"files\"> <a href=\"figures/a.svg\">SVG</a>",
        ] {
            assert!(page.contains(said), "{said} in {page}");
        }
        assert!(!page.contains(MARK[0]) && !page.contains(MARK[1]));
        assert!(!resolve(&body.0, FigureFiles::Absent).contains("figures/"));
    }

    #[test]
    fn a_page_without_marks_keeps_its_text() {
        assert_eq!(resolve("<p>a \u{b1} b</p>", FigureFiles::Absent), "<p>a \u{b1} b</p>");
    }
}
