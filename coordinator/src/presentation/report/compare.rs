//! Comparison of finished studies on one page: overlaid reliability curves, lives, and computing effort; and the curves
//! as CSV.

use super::figure::Figure;
use super::figures::{LifeAxis, capital, curve, file_name};
use super::format::{UNKNOWN, count, duration};
use super::life::{LEVELS, failure_probability, life_at, rows_that_matter, unresolved_fall};
use super::life_change::change_between;
use super::page::{self, wrapped};
use super::palette::{Ink, SERIES};
use super::plot::{Axis, Plot, PlotError, Series, Shape};
use super::tables::{life_cell, table, table_of};
use super::words;
use crate::results::csv_table::{CsvTable, number};
use crate::results::summary::{PerLimitState, StudySummary};
use crate::statistics::reliability::paired::Change;
use maud::{Markup, Render, html as markup};
use std::collections::BTreeSet;
use thiserror::Error;

/// Largest number of studies that one figure can distinguish.
pub const MOST: usize = SERIES;

/// A study to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedStudy {
    /// Name in the comparison, unique.
    pub name: String,
    /// Result of the study.
    pub summary: StudySummary,
}

/// Studies that cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Incomparable {
    /// Fewer studies than a comparison needs, or more than there are distinct colours.
    #[error("{given} studies: a comparison takes 2 to {MOST}")]
    Number {
        /// Number of studies given.
        given: usize,
    },
    /// The limit states of the studies differ.
    #[error(
        "{} and {} have different limit states: {} against {}; studies are compared by limit states of the same \
         names",
        .names[0], .names[1], .limit_states[0].join(", "), .limit_states[1].join(", ")
    )]
    LimitStates {
        /// Names of the first study and of another.
        names: [String; 2],
        /// Their limit states.
        limit_states: [Vec<String>; 2],
    },
    /// The checkpoints of the studies differ.
    #[error(
        "{} and {} have different checkpoints: every {} cycles up to {} against every {} up to {}; give the scenes \
         the same life",
        .names[0], .names[1], .ends[0][0], .ends[0][1], .ends[1][0], .ends[1][1]
    )]
    Checkpoints {
        /// Names of the first study and of another.
        names: [String; 2],
        /// Their first and last checkpoints [cycles].
        ends: [[u32; 2]; 2],
    },
}

/// Checks that the studies can be compared: at least two, with the same limit states (in any order) and checkpoints.
///
/// # Errors
/// [`Incomparable`].
pub fn check(studies: &[ComparedStudy]) -> Result<(), Incomparable> {
    if !(2..=MOST).contains(&studies.len()) {
        return Err(Incomparable::Number { given: studies.len() });
    }
    let states = |study: &ComparedStudy| study.summary.limit_states.iter().cloned().collect::<BTreeSet<_>>();
    let cycles =
        |study: &ComparedStudy| study.summary.reliability.iter().map(|row| row.cycles).collect::<Vec<_>>();
    for other in &studies[1..] {
        let both = [&studies[0], other];
        let names = both.map(|study| study.name.clone());
        let [of_first, of_other] = both.map(states);
        if of_first != of_other {
            let limit_states = both.map(|study| study.summary.limit_states.clone());
            return Err(Incomparable::LimitStates { names, limit_states });
        }
        let both = both.map(cycles);
        if both[0] != both[1] {
            let end = |cycles: Option<&u32>| cycles.copied().unwrap_or(0);
            let ends = both.map(|cycles| [end(cycles.first()), end(cycles.last())]);
            return Err(Incomparable::Checkpoints { names, ends });
        }
    }
    Ok(())
}

/// Most differing keys in the table of the page.
const MOST_KEYS: usize = 40;

/// The page; a function of the studies and of the keys in which their scenes differ, `(key, value in each study)`.
///
/// # Errors
/// [`PlotError`].
pub fn html(studies: &[ComparedStudy], differing: &[(String, Vec<String>)]) -> Result<String, PlotError> {
    let names: Vec<&str> = studies.iter().map(|study| study.name.as_str()).collect();
    let title = format!("Studies compared: {}", names.join(", "));
    let scenes = scenes(studies).into_iter().collect::<Vec<_>>().join(", ");
    let figures = figures(studies)?;
    let body = markup! {
        header { p.brand { "Hingewise" } h1 { (title) } p.meta { "Scenes: " (scenes) } }
        h2 { "Reliability" }
        @if figures.is_empty() { p.none { "These studies have a single checkpoint and therefore no curves." } }
        (page::figures(&figures, "three"))
        h2 { "Lives" }
        @for name in studies[0].summary.curve_names() { h3 { (capital(name)) } (lives(studies, name)) }
        @if !studies[0].summary.is_static() {
            p.none {
                "Differences are lives minus those of " (studies[0].name) ". Their intervals contain every error of both studies, which \
                 are taken as independent."
            }
        }
        @for study in studies {
            @if let Some(note) = unresolved_fall(&study.summary) {
                p.note { strong { "Caution:" } " " (study.name) ": " (note) }
            }
        }
        h2 { "Differences of the scenes" }
        @if differing.is_empty() { p.none { "The scenes are the same." } }
        @else { (differences(studies, differing)) }
        @if differing.len() > MOST_KEYS {
            p.none { "And " (differing.len() - MOST_KEYS) " further keys." }
        }
        h2 { "Settings and computing effort" }
        (effort(studies))
    };
    Ok(wrapped(&title, &body))
}

fn scenes(studies: &[ComparedStudy]) -> BTreeSet<&str> {
    studies.iter().map(|study| study.summary.scene.as_str()).collect()
}

/// One figure per limit state and one of the whole system, each with the curves and bands of all studies.
///
/// # Errors
/// [`PlotError`].
pub fn figures(studies: &[ComparedStudy]) -> Result<Vec<Figure>, PlotError> {
    if studies[0].summary.is_static() {
        return Ok(vec![]);
    }
    // From the first failure in any study to the last survivor in any.
    let matter = studies.iter().map(|study| rows_that_matter(&study.summary, 1));
    let ends = matter.filter_map(|rows| Some((rows.first()?.cycles, rows.last()?.cycles)));
    let Some((from, to)) = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else { return Ok(vec![]) };
    let axis = LifeAxis::new(&studies[0].summary);
    let figure = |name: &str| {
        let (mut bands, mut lines) = (Vec::new(), Vec::new());
        for (k, ComparedStudy { name: study, summary }) in studies.iter().enumerate() {
            let (points, band) = curve(summary, name, &axis);
            bands.push(Series::unlisted(format!("{study}, band"), Ink::Series(k), Shape::Band(band)));
            // Every second curve is dashed, so that coinciding curves stay visible.
            let shape = if k % 2 == 1 { Shape::Dashed(points) } else { Shape::Line(points) };
            lines.push(Series::new(study, Ink::Series(k), shape));
        }
        let title = if name == "total" {
            "No failure of any kind".to_string()
        } else {
            format!("No failure by {name}")
        };
        Plot {
            figure: &format!("reliability-{}", file_name(name)),
            x: Axis::linear(axis.label, (axis.place(from), axis.place(to))),
            y: Axis::linear("reliability R", (0.0, 1.0)),
            series: &[bands, lines].concat(),
        }
        .figure(&title, "Bands: 95 % interval of sampling, surrogate, interpolation between the checkpoints and numerical error.")
    };
    studies[0].summary.curve_names().map(figure).collect()
}

/// Lives of every study at the usual levels of reliability, or its probability of failure.
fn lives(studies: &[ComparedStudy], name: &str) -> Markup {
    if studies[0].summary.is_static() {
        let rows = studies.iter().map(|study| {
            let row = study.summary.reliability.first();
            let pf = row.map_or(UNKNOWN.to_string(), |row| failure_probability(row, name));
            vec![study.name.render(), pf.render()]
        });
        return table(&["study", "probability of failure (95 %)"], rows);
    }
    let levels = LEVELS.map(|level| format!("at R = {level} (95 % interval)"));
    let head: Vec<String> = std::iter::once("life [cycles]".to_string()).chain(levels).collect();
    let rows = studies.iter().map(|study| {
        let lives = LEVELS.map(|level| life_cell(life_at(&study.summary, name, level)));
        std::iter::once(study.name.render()).chain(lives).collect()
    });
    let gains = studies.iter().enumerate().skip(1).map(|(k, study)| {
        let gains = LEVELS.map(|level| gain(studies, k, (name, level)).1.render());
        std::iter::once(format!("{} minus {}", study.name, studies[0].name).render()).chain(gains).collect()
    });
    table(&head, rows.chain(gains))
}

/// Change of a life, of a curve at a level, from the first study to study `k`, and in words.
pub fn gain(studies: &[ComparedStudy], k: usize, life: (&str, f64)) -> (Option<Change>, String) {
    change_between([&studies[0].summary, &studies[k].summary], life)
}

/// The keys in which the scenes differ, with their values.
fn differences(studies: &[ComparedStudy], differing: &[(String, Vec<String>)]) -> Markup {
    let head: Vec<&str> =
        std::iter::once("key").chain(studies.iter().map(|study| study.name.as_str())).collect();
    let rows = differing.iter().take(MOST_KEYS).map(|(key, values)| {
        std::iter::once(key.render()).chain(values.iter().map(Render::render)).collect()
    });
    table(&head, rows)
}

/// Scene, method, accuracy, seed, evaluations and time of every study.
fn effort(studies: &[ComparedStudy]) -> Markup {
    table_of::<&ComparedStudy>(
        &[
            ("study", &|study| study.name.clone()),
            ("scene", &|study| study.summary.scene.clone()),
            ("method", &|study| study.summary.method.clone()),
            ("accuracy", &|study| words::accuracy(&study.summary)),
            ("seed", &|study| study.summary.seed.to_string()),
            ("simulations", &|study| count(study.summary.evaluations.total as u64)),
            ("of these without a result", &|study| count(study.summary.evaluations.failed as u64)),
            ("time of the study", &|study| duration(study.summary.timing_s.total)),
            ("version", &|study| study.summary.version.clone()),
        ],
        studies,
    )
}

/// Every curve of every study: `study`, `limit_state`, `cycles`, `R`, `standard_error`, and the 95 % interval `lower`, `upper`,
/// one row per checkpoint.
pub fn csv(studies: &[ComparedStudy]) -> String {
    let mut table =
        CsvTable::new(["study", "limit_state", "cycles", "R", "standard_error", "lower", "upper"]);
    for ComparedStudy { name: study, summary } in studies {
        for name in studies[0].summary.curve_names() {
            let value = |values: &PerLimitState| values.get(name).copied().map_or(String::new(), number);
            for row in &summary.reliability {
                let [r, error] = [&row.reliability, &row.standard_error].map(value);
                let range = row.interval_of(name).map(|range| [range.lower, range.upper].map(number));
                let [lower, upper] = range.unwrap_or_default();
                table.push([study, name, &row.cycles.to_string(), &r, &error, &lower, &upper]);
            }
        }
    }
    table.into_text()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::life::life_and_limits;
    use crate::test_study;

    fn two() -> [ComparedStudy; 2] {
        let summary = test_study::study().summary;
        let mut harder = summary.clone();
        harder.accuracy = "draft".into();
        harder.limit_states.reverse();
        for row in &mut harder.reliability {
            row.reliability.values_mut().for_each(|r| *r = r.powi(3));
        }
        [
            ComparedStudy { name: "a & b".into(), summary },
            ComparedStudy { name: "harder".into(), summary: harder },
        ]
    }

    #[test]
    fn curves_lives_and_costs_of_all_stand_on_one_page() {
        let studies = two();
        check(&studies).unwrap();
        let names: Vec<String> = figures(&studies).unwrap().into_iter().map(|figure| figure.name).collect();
        assert_eq!(names, ["reliability-wear", "reliability-asymmetry", "reliability-total"]);
        let width = ("parameters.width".to_owned(), vec!["10 mm".to_owned(), "12 mm".to_owned()]);
        let html = html(&studies, &[width]).unwrap();
        roxmltree::Document::parse(&html[html.find("<body>").unwrap()..html.find("</html>").unwrap()])
            .unwrap();
        assert!(!html.contains("http") && !html.contains("<script"));
        let life = life_and_limits(life_at(&studies[1].summary, "asymmetry", 0.5)).0;
        for text in [
            life,
            "<td>draft</td>".into(),
            "<td>a &amp; b</td>".into(),
            "<h3>Total</h3>".into(),
            "<td>12 mm</td>".into(),
            "<td>harder minus a &amp; b</td>".into(),
        ] {
            assert!(html.contains(&text), "{text}");
        }
        let csv = csv(&studies);
        assert_eq!(csv.lines().count(), 1 + 2 * 3 * 72);
        let r = studies[1].summary.reliability[64].reliability["total"];
        assert!(csv.contains(&format!("harder,total,65000,{r:?},")), "{csv}");
    }

    #[test]
    fn issue_a_gain_between_two_accuracies_contains_the_numerical_errors_of_both() {
        let mut studies = two();
        studies[1].summary = studies[0].summary.clone();
        let change = gain(&studies, 1, ("total", 0.5)).0.unwrap();
        let lives = &studies[0].summary.lives;
        let life = lives.iter().find(|l| (&*l.limit_state, l.reliability) == ("total", 0.5)).unwrap();
        let (value, range) = (life.cycles.unwrap(), life.whole_interval());
        let whole = 2.0 * (value - range.lower).hypot(range.upper.unwrap() - value);
        let found = change.upper.unwrap() - change.lower.unwrap();
        assert!((found - whole).abs() < 1e-6 * whole, "{found} {whole}");
    }

    #[test]
    fn what_cannot_be_laid_over_each_other_is_refused() {
        let [a, mut b] = two();
        assert_eq!(check(std::slice::from_ref(&a)), Err(Incomparable::Number { given: 1 }));
        b.summary.reliability.truncate(60);
        let said = check(&[a.clone(), b.clone()]).unwrap_err().to_string();
        assert!(said.contains("every 1000 cycles up to 72000 against every 1000 up to 60000"), "{said}");
        b.summary.limit_states.truncate(1);
        let said = check(&[a, b]).unwrap_err().to_string();
        assert!(said.contains("wear, asymmetry against asymmetry"), "{said}");
    }
}
