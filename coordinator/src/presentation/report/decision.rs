//! The page of a question about a finished study: sentences, reliability curves of the alternatives, and tables.

use super::compare::{ComparedStudy, figures};
use super::figure::Figure;
use super::page::{self, wrapped};
use super::plot::PlotError;
use super::tables::table;
use super::{ReportError, write_figures};
use crate::presentation::text_table::in_columns;
use crate::results::result_files::write_text;
use crate::results::summary::StudySummary;
use maud::{Render, html as markup};
use std::path::{Path, PathBuf};

/// Content of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionPage {
    /// Title of the page.
    pub title: String,
    /// Line below the title.
    pub subtitle: String,
    /// Sentences on the meaning and the errors of the numbers.
    pub sentences: Vec<String>,
    /// Figures before those of the curves.
    pub figures: Vec<Figure>,
    /// Alternatives whose curves are drawn, with their names: two or more of the same limit states and checkpoints.
    pub curves: Vec<(String, StudySummary)>,
    /// Tables in their order.
    pub tables: Vec<DecisionTable>,
}

/// A table with its heading, all as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DecisionTable {
    /// Heading above the table.
    pub heading: String,
    /// Names of the columns.
    pub head: Vec<String>,
    /// Cells by row, as many as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl DecisionTable {
    /// The table as text in columns of equal width, the first one to the left.
    pub fn in_columns(&self) -> String {
        let all: Vec<Vec<String>> = std::iter::once(&self.head).chain(&self.rows).cloned().collect();
        in_columns(&all, &[0])
    }
}

impl DecisionPage {
    /// The figures of the page: its own, and the curves of every limit state and of the system.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn all_figures(&self) -> Result<Vec<Figure>, PlotError> {
        let studies = self
            .curves
            .iter()
            .map(|(name, summary)| ComparedStudy { name: name.clone(), summary: summary.clone() });
        let studies: Vec<ComparedStudy> = studies.collect();
        let curves = if studies.is_empty() { vec![] } else { figures(&studies)? };
        Ok(self.figures.iter().cloned().chain(curves).collect())
    }

    /// The page with these figures.
    pub fn html(&self, drawn: &[Figure]) -> String {
        let body = markup! {
            header { p.brand { "Hingewise" } h1 { (self.title) } p.meta { (self.subtitle) } }
            (page::figures(drawn, "three"))
            @for part in &self.tables {
                h2 { (part.heading) }
                (table(&part.head, part.rows.iter().map(|row| row.iter().map(Render::render).collect())))
            }
            h2 { "Errors" }
            @for sentence in &self.sentences { p { (sentence) } }
        };
        wrapped(&self.title, &body)
    }

    /// Writes the page as `NAME.html`, and its figures as `figures/*.svg` with their numbers as `figures/*.csv`, into the
    /// folder `dir`, which is created if missing; returns the path of the page.
    ///
    /// # Errors
    /// [`ReportError`].
    pub fn write(&self, dir: &Path, name: &str) -> Result<PathBuf, ReportError> {
        let drawn = self.all_figures()?;
        write_figures(dir, &drawn)?;
        let path = dir.join(format!("{name}.html"));
        write_text(&path, &self.html(&drawn))?;
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;

    #[test]
    fn the_page_has_curves_tables_and_sentences() {
        let summary = test_study::study().summary;
        let page = DecisionPage {
            title: "What if: a < b".to_owned(),
            subtitle: "Scene".to_owned(),
            sentences: vec!["It is so.".to_owned()],
            figures: vec![],
            curves: vec![("before".to_owned(), summary.clone()), ("after".to_owned(), summary)],
            tables: vec![DecisionTable {
                heading: "Lives".to_owned(),
                head: vec!["life".to_owned()],
                rows: vec![vec!["63 000".to_owned()]],
            }],
        };
        let dir = tempfile::tempdir().unwrap();
        let path = page.write(dir.path(), "what-if").unwrap();
        let html = std::fs::read_to_string(path).unwrap();
        for text in ["<h2>Lives</h2>", "<td>63 000</td>", "<p>It is so.</p>", "a &lt; b", "<svg"] {
            assert!(html.contains(text), "{text}");
        }
        assert!(dir.path().join("figures/reliability-total.svg").exists());
        assert!(!html.contains("http") && !html.contains("<script"));
    }
}
