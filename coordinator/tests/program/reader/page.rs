//! Tables of a page, read as a person reads them.

use std::collections::BTreeMap;

/// A table of the page: its rows as cells by the names of their columns.
pub type Rows = Vec<BTreeMap<String, String>>;

/// Text of the page without elements, with the signs of the scene language.
pub fn plain(markup: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for letter in markup.chars() {
        match letter {
            '<' => inside = true,
            '>' => inside = false,
            other if !inside => text.push(other),
            _ => {}
        }
    }
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    text.replace('\u{2212}', "-").replace('\u{a0}', " ").replace('²', "^2").trim().to_owned()
}

/// The piece between two texts.
pub fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    let rest = text.split_once(from).unwrap_or_else(|| panic!("{from}")).1;
    rest.split_once(to).unwrap_or_else(|| panic!("{to}")).0
}

/// A table by its name; no rows if the page has none of this name.
pub fn table(page: &str, name: &str) -> Rows {
    let Some((_, rest)) = page.split_once(&format!("id=\"table-{name}\"")) else { return vec![] };
    let table = between(rest, "<table", "</table>");
    let cells = |row: &str, element: &str| -> Vec<String> {
        row.split(&format!("<{element}"))
            .skip(1)
            .map(|cell| {
                plain(cell.split_once('>').unwrap().1.split(&format!("</{element}>")).next().unwrap())
            })
            .collect()
    };
    let head = cells(between(table, "<thead>", "</thead>"), "th");
    let body = between(table, "<tbody>", "</tbody>");
    body.split("<tr>").skip(1).map(|row| head.iter().cloned().zip(cells(row, "td")).collect()).collect()
}
