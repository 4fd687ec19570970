//! The answer of a command: texts, tables and figures in their order, on a terminal, in Markdown and as a page.

use super::figures::compared;
use super::page::{self, Page};
use super::{ComparedStudy, Figure, table, write_figures};
use crate::presentation::format::{in_columns, joined};
use crate::results::result_files::{ResultFileError, create_folder, write_text};
use maud::{Markup, html};
use std::path::{Path, PathBuf};

/// An answer in every form.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer {
    /// Name of its files without their ending.
    pub name: String,
    /// Title, the first line of a terminal.
    pub title: String,
    /// Line below the title of the page.
    pub subtitle: String,
    /// Its parts in their order.
    pub parts: Vec<AnswerPart>,
    /// Figures of the page before those of the curves.
    pub figures: Vec<Figure>,
    /// Alternatives whose curves are drawn, with their names: two or more of the same limit states and checkpoints.
    pub curves: Vec<ComparedStudy>,
    /// Further files by name.
    pub files: Vec<(String, String)>,
    /// True if it is printed as Markdown, false if in columns.
    pub prints_markdown: bool,
}

/// A part of an answer.
#[derive(Debug, Clone, PartialEq)]
pub enum AnswerPart {
    /// A paragraph; `**` begins and ends what is important.
    Text(String),
    /// A table with its heading.
    Table(Table),
    /// Sentences below a heading.
    Notes(&'static str, Vec<String>),
    /// The place of the figures on the page.
    Figures,
}

/// A table, all as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Heading above the table, empty for none.
    pub heading: String,
    /// Names of the columns, empty for none.
    pub head: Vec<String>,
    /// Cells by row, as many as there are columns.
    pub rows: Vec<Vec<String>>,
    /// Columns that stand to the left on a terminal.
    pub left: &'static [usize],
    /// Indices of the rows that a terminal shows, and the line below them; all without it.
    pub shown: Option<(Vec<usize>, String)>,
}

impl Table {
    /// The table with its first column to the left.
    pub fn new<H: Into<String>>(
        heading: impl Into<String>,
        head: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        Self {
            heading: heading.into(),
            head: head.into_iter().map(H::into).collect(),
            rows: rows.into_iter().collect(),
            left: &[0],
            shown: None,
        }
    }

    /// The table with these columns to the left on a terminal.
    #[must_use]
    pub fn with_left(self, left: &'static [usize]) -> Self {
        Self { left, ..self }
    }

    /// The table as text in columns.
    fn in_columns(&self) -> String {
        let head = Some(&self.head).filter(|head| !head.is_empty());
        let (rows, note): (Vec<_>, _) = match &self.shown {
            None => (self.rows.iter().collect(), String::new()),
            Some((shown, note)) => (shown.iter().map(|k| &self.rows[*k]).collect(), format!("{note}\n")),
        };
        let all: Vec<Vec<String>> = head.into_iter().chain(rows).cloned().collect();
        let heading = if self.heading.is_empty() { String::new() } else { format!("{}\n", self.heading) };
        format!("{heading}{}{note}", in_columns(&all, self.left))
    }

    /// The table as Markdown.
    pub fn in_markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let columns = self.rows.first().map_or(self.head.len(), Vec::len);
        let head = if self.head.is_empty() { &vec![String::new(); columns] } else { &self.head };
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        let heading =
            if self.heading.is_empty() { String::new() } else { format!("## {}\n\n", self.heading) };
        format!("{heading}{}{}|\n{rows}", line(head), "|---".repeat(columns))
    }

    fn html(&self) -> Markup {
        html! { @if !self.heading.is_empty() { h2 { (self.heading) } } (table(&self.head, &self.rows)) }
    }
}

impl Answer {
    /// The answer as printed, with plain spaces.
    pub fn text(&self) -> String {
        if self.prints_markdown {
            return self.markdown();
        }
        let text = self.joined(&self.title, |part| match part {
            AnswerPart::Text(text) => Some(format!("{}\n", text.replace("**", ""))),
            AnswerPart::Table(table) => Some(table.in_columns()),
            AnswerPart::Notes(_, notes) => Some(notes.iter().map(|note| format!("{note}\n")).collect()),
            AnswerPart::Figures => None,
        });
        text.replace('\u{a0}', " ")
    }

    /// Title and parts with empty lines between them.
    fn joined(&self, title: &str, part: impl Fn(&AnswerPart) -> Option<String>) -> String {
        let title = std::iter::once(format!("{title}\n"));
        joined(title.chain(self.parts.iter().filter_map(part)), "\n")
    }

    /// The answer as Markdown.
    pub fn markdown(&self) -> String {
        self.joined(&format!("# {}", self.title), |part| match part {
            AnswerPart::Text(text) => Some(format!("{text}\n")),
            AnswerPart::Table(table) => Some(table.in_markdown()),
            AnswerPart::Notes(heading, notes) => {
                let notes: String = notes.iter().map(|note| format!("- {note}\n")).collect();
                Some(format!("## {heading}\n\n{notes}"))
            }
            AnswerPart::Figures => None,
        })
    }

    /// The figures of the page: its own, and the curves of every limit state and of the system.
    pub fn all_figures(&self) -> Vec<Figure> {
        let curves = if self.curves.is_empty() { vec![] } else { compared(&self.curves) };
        self.figures.iter().cloned().chain(curves).collect()
    }

    /// The page with these figures.
    fn html(&self, drawn: &[Figure]) -> String {
        let body = html! {
            header { p.brand { "Hingewise" } h1 { (self.title) } p.meta { (self.subtitle) } }
            @for part in &self.parts {
                @match part {
                    AnswerPart::Text(text) => p { (text.replace("**", "")) },
                    AnswerPart::Table(table) => (table.html()),
                    AnswerPart::Notes(heading, notes) => { h2 { (heading) } @for note in notes { p { (note) } } },
                    AnswerPart::Figures => (page::figures(drawn, "three")),
                }
            }
        };
        Page::new(&self.title, body).html(None)
    }

    /// Writes the page as `NAME.html`, the text as `NAME.md`, the figures as `figures/*.svg` with their numbers as `figures/*.csv`,
    /// and the further files into the folder `dir`, which is created if missing; returns the path of the page.
    ///
    /// # Errors
    /// [`ResultFileError`].
    pub fn write(&self, dir: &Path) -> Result<PathBuf, ResultFileError> {
        let drawn = self.all_figures();
        create_folder(dir)?;
        if !drawn.is_empty() {
            write_figures(dir, &drawn)?;
        }
        for (name, text) in &self.files {
            write_text(&dir.join(name), text)?;
        }
        write_text(&dir.join(format!("{}.md", self.name)), &self.markdown())?;
        let path = dir.join(format!("{}.html", self.name));
        write_text(&path, &self.html(&drawn))?;
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn an_answer_has_the_same_parts_in_every_form() {
        let summary = test_study::study().summary;
        let table = |heading: &str, rows: usize| {
            let rows = (0..rows).map(|k| vec![format!("life {k}"), "63\u{a0}000".to_owned()]);
            Table::new(heading, ["life", "cycles"], rows)
        };
        let short = Table { shown: Some((vec![2], "(1 of 3)".to_owned())), ..table("All", 3) };
        let answer = Answer {
            name: "what-if".to_owned(),
            title: "What if: a < b".to_owned(),
            parts: vec![
                AnswerPart::Text("**First** this.".to_owned()),
                AnswerPart::Figures,
                AnswerPart::Table(table("Lives", 1)),
                AnswerPart::Table(short),
                AnswerPart::Notes("Errors", vec!["It is so.".to_owned()]),
            ],
            curves: ["before", "after"]
                .map(|name| ComparedStudy { name: name.to_owned(), summary: summary.clone() })
                .to_vec(),
            files: vec![("more.csv".to_owned(), "a\n".to_owned())],
            ..Answer::default()
        };
        let columns = "life    cycles\nlife 0  63 000\n";
        let short = "life    cycles\nlife 2  63 000\n(1 of 3)\n";
        let expected =
            format!("What if: a < b\n\nFirst this.\n\nLives\n{columns}\nAll\n{short}\nIt is so.\n");
        assert_eq!(answer.text(), expected);
        let dir = tempfile::tempdir().unwrap();
        let html = std::fs::read_to_string(answer.write(dir.path()).unwrap()).unwrap();
        let cell = "<td>63\u{a0}000</td>";
        for text in
            ["<h2>Lives</h2>", cell, "life 1", "<p>It is so.</p>", "a &lt; b", "<svg", "<p>First this."]
        {
            assert!(html.contains(text), "{text}");
        }
        assert!(!html.contains("http") && !html.contains("<script"));
        let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
        let markdown = read("what-if.md");
        assert!(
            markdown.starts_with("# What if: a < b\n\n**First** this.\n\n## Lives\n\n| life | cycles |\n")
        );
        assert!(
            markdown.contains("|---|---|\n| life 0 |") && markdown.ends_with("## Errors\n\n- It is so.\n")
        );
        assert_eq!(read("more.csv"), "a\n");
        assert!(dir.path().join("figures/reliability-total.svg").exists());
        let bare = Table { head: vec![], ..table("", 1) };
        assert_eq!(bare.in_columns(), "life 0  63\u{a0}000\n");
        assert_eq!(bare.in_markdown(), "|  |  |\n|---|---|\n| life 0 | 63\u{a0}000 |\n");
    }
}
