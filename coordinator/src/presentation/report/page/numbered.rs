//! Numbers of figures and tables, references to them, and the contents list: a page is written with marks, which are replaced
//! in the order of the page once it is complete.

use maud::{Markup, html};
use std::collections::BTreeMap;

/// Begin and end of a mark, characters without meaning of their own (Unicode, private use).
const MARK: [char; 2] = ['\u{E000}', '\u{E001}'];

/// Files of the figures that a page refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureFiles {
    /// `figures/NAME.svg` and `figures/NAME.csv` stand next to the page.
    NextToPage,
    /// The page stands alone.
    Absent,
}

fn mark(kind: &str, name: &str) -> Markup {
    html! { (MARK[0]) (kind) " " (name) (MARK[1]) }
}

/// The number of a figure, at the figure itself.
pub fn figure(name: &str) -> Markup {
    mark("figure", name)
}

/// The number of a table, at the table itself.
pub fn table(name: &str) -> Markup {
    mark("table", name)
}

/// A link to a figure by its number, e.g. `Figure 3`.
pub fn refer(name: &str) -> Markup {
    mark("see-figure", name)
}

/// A link to a table by its number, e.g. `Table 2`.
pub fn refer_table(name: &str) -> Markup {
    mark("see-table", name)
}

/// Links to the files of a figure.
pub fn files(name: &str) -> Markup {
    mark("files", name)
}

/// The contents list.
pub fn contents() -> Markup {
    mark("contents", "all")
}

/// The mark that begins at the start of `rest`, as (kind, name), and what follows it.
fn taken(rest: &str) -> Option<((&str, &str), &str)> {
    let (inside, after) = rest.strip_prefix(MARK[0])?.split_once(MARK[1])?;
    Some((inside.split_once(' ')?, after))
}

/// Pieces of a page: text, each followed by a mark as (kind, name).
fn pieces(page: &str) -> Vec<(&str, Option<(&str, &str)>)> {
    let (mut found, mut rest) = (Vec::new(), page);
    while let Some(at) = rest.find(MARK[0]) {
        let (text, from) = rest.split_at(at);
        let Some((mark, after)) = taken(from) else { break };
        found.push((text, Some(mark)));
        rest = after;
    }
    found.push((rest, None));
    found
}

/// Chapters of a page: number from 1 on, and title as markup.
fn chapters(page: &str) -> Vec<&str> {
    page.split("<h2>").skip(1).filter_map(|rest| rest.split("</h2>").next()).collect()
}

/// The body of a page with numbers, links and anchors instead of marks. A reference to what the page does not have is its
/// name alone.
pub fn resolve(body: &str, with: FigureFiles) -> String {
    let (mut numbers, mut counts) = (BTreeMap::new(), BTreeMap::from([("figure", 0), ("table", 0)]));
    for (_, mark) in pieces(body) {
        let Some((kind, name)) = mark else { continue };
        if let Some(count) = counts.get_mut(kind) {
            *count += 1;
            numbers.insert((kind, name), *count);
        }
    }
    let word = |kind: &str| if kind == "figure" { "Figure" } else { "Table" };
    let link = |kind: &str, name: &str| match numbers.get(&(kind, name)) {
        Some(number) => {
            let target = if kind == "figure" { name.to_owned() } else { format!("table-{name}") };
            format!("<a href=\"#{target}\">{} {number}</a>", word(kind))
        }
        None => name.to_owned(),
    };
    let mut page = String::with_capacity(body.len() + 4096);
    for (text, mark) in pieces(body) {
        page += text;
        let Some((kind, name)) = mark else { continue };
        page += &match kind {
            "figure" | "table" => format!("{} {}", word(kind), numbers[&(kind, name)]),
            "see-figure" => link("figure", name),
            "see-table" => link("table", name),
            "contents" => contents_of(&chapters(body)),
            _ if with == FigureFiles::Absent => String::new(),
            _ => format!(
                "<span class=\"files\"> <a href=\"figures/{name}.svg\">SVG</a> <a href=\"figures/{name}.csv\">CSV</a></span>"
            ),
        };
    }
    for number in 1..=chapters(body).len() {
        let anchor = format!("<a id=\"chapter-{number}\"></a><h2 >");
        page = page.replacen("<h2>", &anchor, 1);
    }
    page.replace("<h2 >", "<h2>")
}

fn contents_of(chapters: &[&str]) -> String {
    let items: String = chapters
        .iter()
        .enumerate()
        .map(|(k, title)| format!("<li><a href=\"#chapter-{}\">{title}</a></li>", k + 1))
        .collect();
    format!("<nav aria-label=\"contents\"><ol>{items}</ol></nav>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_the_page_and_references_find_them() {
        let body = html! {
            (contents())
            h2 { "One" } p { "See " (refer("b")) ", " (refer_table("t")) " and " (refer("lost")) "." }
            (figure("a")) (files("a")) h2 { "Two" } (figure("b")) (table("t"))
        };
        let page = resolve(&body.0, FigureFiles::NextToPage);
        for said in [
            "<li><a href=\"#chapter-1\">One</a></li><li><a href=\"#chapter-2\">Two</a></li>",
            "<a id=\"chapter-2\"></a><h2>Two</h2>",
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
