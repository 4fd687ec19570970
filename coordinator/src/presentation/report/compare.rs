//! Several finished studies on one page: their reliability curves over each other, their lives and what they cost; and the
//! curves as CSV.

use super::figure::Figure;
use super::figures::{LifeAxis, capital, curve, file_name};
use super::format::{UNKNOWN, count, duration, escape};
use super::life::{LifeAt, life_at, rows_that_matter};
use super::page::{self, wrapped};
use super::palette::{Ink, SERIES};
use super::plot::{Axis, Plot, PlotError, Series, Shape};
use super::tables::{table, whole};
use super::words;
use crate::results::result_files::{field, number};
use crate::results::summary::StudySummary;
use std::collections::BTreeSet;
use std::fmt::Write;
use thiserror::Error;

/// Most studies that one figure can tell apart.
pub const MOST: usize = SERIES;

/// A study to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// How it is called in the comparison, different for each.
    pub name: String,
    /// What it found.
    pub summary: StudySummary,
}

/// Studies that cannot be laid over each other.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Incomparable {
    /// Not as many as a comparison needs, or more than colours tell apart.
    #[error("{given} studies: a comparison takes 2 to {MOST}")]
    Number {
        /// How many were given.
        given: usize,
    },
    /// Other limit states.
    #[error(
        "{first} and {second} have different limit states: {} against {}; studies are compared by limit states of the same \
         names",
        .of_first.join(", "), .of_second.join(", ")
    )]
    LimitStates {
        /// Name of the first study.
        first: String,
        /// Its limit states.
        of_first: Vec<String>,
        /// Name of the other.
        second: String,
        /// Its limit states.
        of_second: Vec<String>,
    },
    /// Other checkpoints.
    #[error(
        "{first} and {second} have different checkpoints: every {} cycles up to {} against every {} up to {}; give the scenes \
         the same life",
        .of_first[0], .of_first[1], .of_second[0], .of_second[1]
    )]
    Checkpoints {
        /// Name of the first study.
        first: String,
        /// Its first and last checkpoint [cycles].
        of_first: [u32; 2],
        /// Name of the other.
        second: String,
        /// Its first and last checkpoint [cycles].
        of_second: [u32; 2],
    },
}

/// Whether the studies can be compared: at least two, of the same limit states (in any order) at the same checkpoints.
///
/// # Errors
/// [`Incomparable`].
pub fn check(studies: &[Compared]) -> Result<(), Incomparable> {
    if !(2..=MOST).contains(&studies.len()) {
        return Err(Incomparable::Number { given: studies.len() });
    }
    let first = &studies[0];
    let states = |study: &Compared| study.summary.limit_states.iter().cloned().collect::<BTreeSet<_>>();
    let cycles =
        |study: &Compared| study.summary.reliability.iter().map(|row| row.cycles).collect::<Vec<_>>();
    let ends = |study: &Compared| {
        let cycles = cycles(study);
        [cycles.first().copied().unwrap_or(0), cycles.last().copied().unwrap_or(0)]
    };
    for other in &studies[1..] {
        if states(first) != states(other) {
            return Err(Incomparable::LimitStates {
                first: first.name.clone(),
                of_first: first.summary.limit_states.clone(),
                second: other.name.clone(),
                of_second: other.summary.limit_states.clone(),
            });
        }
        if cycles(first) != cycles(other) {
            return Err(Incomparable::Checkpoints {
                first: first.name.clone(),
                of_first: ends(first),
                second: other.name.clone(),
                of_second: ends(other),
            });
        }
    }
    Ok(())
}

/// Limit states of the studies in the first one's order, then `total` if there are several.
fn curves(studies: &[Compared]) -> Vec<&str> {
    let mut names: Vec<&str> = studies[0].summary.limit_states.iter().map(String::as_str).collect();
    if names.len() > 1 {
        names.push("total");
    }
    names
}

/// The page. The same studies give the same text.
///
/// # Errors
/// [`PlotError`].
pub fn html(studies: &[Compared]) -> Result<String, PlotError> {
    let names: Vec<&str> = studies.iter().map(|study| study.name.as_str()).collect();
    let title = format!("Studies compared: {}", names.join(", "));
    let mut body = format!(
        "<header><p class=\"brand\">Hingewise</p><h1>{}</h1><p class=\"meta\">Scenes: {}</p></header>\n",
        escape(&title),
        escape(&scenes(studies).into_iter().collect::<Vec<_>>().join(", "))
    );
    body += "<h2>Reliability</h2>\n";
    let figures = figures(studies)?;
    if figures.is_empty() {
        body += "<p class=\"none\">These studies have one checkpoint: there are no curves.</p>\n";
    }
    body += &page::figures(&figures, "three");
    body += "<h2>Lives</h2>\n";
    for name in curves(studies) {
        let _ = writeln!(body, "<h3>{}</h3>\n{}", escape(&capital(name)), lives(studies, name));
    }
    body += "<h2>What they are, and what they cost</h2>\n";
    body += &effort(studies);
    Ok(wrapped(&title, &body))
}

fn scenes(studies: &[Compared]) -> BTreeSet<&str> {
    studies.iter().map(|study| study.summary.scene.as_str()).collect()
}

/// One figure per limit state and one of the whole system, each with the curves and bands of all studies.
///
/// # Errors
/// [`PlotError`].
pub fn figures(studies: &[Compared]) -> Result<Vec<Figure>, PlotError> {
    if studies[0].summary.is_static() {
        return Ok(vec![]);
    }
    // From the first failure in any study to the last survivor in any.
    let matter = studies.iter().map(|study| rows_that_matter(&study.summary, 1));
    let ends = matter.filter_map(|rows| Some((rows.first()?.cycles, rows.last()?.cycles)));
    let Some((from, to)) = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else { return Ok(vec![]) };
    let axis = LifeAxis::of(&studies[0].summary);
    let figure = |name: &str| {
        let (mut bands, mut lines) = (Vec::new(), Vec::new());
        for (k, Compared { name: study, summary }) in studies.iter().enumerate() {
            let rows = &summary.reliability;
            let (points, band) = curve(rows, name, |cycles| axis.at(cycles));
            bands.push(Series::unlisted(format!("{study}, band"), Ink::Series(k), Shape::Band(band)));
            // Curves that lie upon each other are still seen.
            let shape = if k % 2 == 1 { Shape::Dashed(points) } else { Shape::Line(points) };
            lines.push(Series::new(study, Ink::Series(k), shape));
        }
        let title =
            if name == "total" { "No failure at all".to_string() } else { format!("No failure by {name}") };
        Plot {
            figure: &format!("reliability-{}", file_name(name)),
            x: Axis::linear(axis.label, (axis.at(from), axis.at(to))),
            y: Axis::linear("reliability R", (0.0, 1.0)),
            series: &[bands, lines].concat(),
        }
        .figure(&title, "Bands: 1.96 standard errors, sampling and surrogate together.")
    };
    curves(studies).into_iter().map(figure).collect()
}

/// Lives of every study at the levels that decisions ask for.
fn lives(studies: &[Compared], name: &str) -> String {
    if studies[0].summary.is_static() {
        let rows = studies.iter().map(|study| {
            let row = study.summary.reliability.first();
            let pf = row.map_or(UNKNOWN.to_string(), |row| words::failure_probability(row, name));
            vec![escape(&study.name), pf]
        });
        return table(&["study".into(), "probability of failure".into()], rows);
    }
    let head =
        std::iter::once("cycles at".to_string()).chain(words::LEVELS.map(|level| format!("R = {level}")));
    let rows = studies.iter().map(|study| {
        let cell = |level: f64| match life_at(&study.summary, name, level) {
            LifeAt::Beyond(last) => format!("beyond {}", count(last.into())),
            LifeAt::Cycles { life, lower, upper } => {
                format!("{} <small>{} to {}</small>", whole(life), whole(lower), whole(upper))
            }
        };
        std::iter::once(escape(&study.name)).chain(words::LEVELS.map(cell)).collect()
    });
    table(&head.collect::<Vec<_>>(), rows)
}

/// Scene, method, accuracy, seed, evaluations and time of every study.
fn effort(studies: &[Compared]) -> String {
    let head = [
        "study",
        "scene",
        "method",
        "accuracy",
        "seed",
        "evaluations",
        "without a result",
        "time",
        "version",
    ];
    let rows = studies.iter().map(|Compared { name, summary }| {
        vec![
            escape(name),
            escape(&summary.scene),
            escape(&summary.method),
            escape(&words::accuracy(summary)),
            summary.seed.to_string(),
            count(summary.evaluations.total as u64),
            count(summary.evaluations.failed as u64),
            duration(summary.timing_s.total),
            escape(&summary.version),
        ]
    });
    table(&head.map(String::from), rows)
}

/// Every curve of every study: `study`, `limit_state`, `cycles`, `R`, `standard_error`, one row per checkpoint.
pub fn csv(studies: &[Compared]) -> String {
    let mut text = String::from("study,limit_state,cycles,R,standard_error\n");
    for Compared { name: study, summary } in studies {
        for name in curves(studies) {
            for row in &summary.reliability {
                let value = |of: &crate::results::summary::PerLimitState| {
                    of.get(name).copied().map_or(String::new(), number)
                };
                let (r, error) = (value(&row.reliability), value(&row.standard_error));
                text += &format!("{},{},{},{r},{error}\n", field(study), field(name), row.cycles);
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::synthetic;

    fn two() -> [Compared; 2] {
        let summary = synthetic::study().summary;
        let mut harder = summary.clone();
        harder.accuracy = "draft".into();
        harder.limit_states.reverse();
        for row in &mut harder.reliability {
            row.reliability.values_mut().for_each(|r| *r = r.powi(3));
        }
        [Compared { name: "a & b".into(), summary }, Compared { name: "harder".into(), summary: harder }]
    }

    #[test]
    fn curves_lives_and_costs_of_all_stand_on_one_page() {
        let studies = two();
        check(&studies).unwrap();
        let names: Vec<String> = figures(&studies).unwrap().into_iter().map(|figure| figure.name).collect();
        assert_eq!(names, ["reliability-wear", "reliability-asymmetry", "reliability-total"]);
        let html = html(&studies).unwrap();
        let body = &html[html.find("<body>").unwrap()..html.find("</html>").unwrap()];
        roxmltree::Document::parse(body).unwrap();
        assert!(!html.contains("http") && !html.contains("<script"));
        let LifeAt::Cycles { life, .. } = life_at(&studies[1].summary, "asymmetry", 0.5) else { panic!() };
        for text in
            [whole(life), "<td>draft</td>".into(), "<td>a &amp; b</td>".into(), "<h3>Total</h3>".into()]
        {
            assert!(html.contains(&text), "{text}");
        }
        let csv = csv(&studies);
        assert_eq!(csv.lines().count(), 1 + 2 * 3 * 72);
        let r = studies[1].summary.reliability[64].reliability["total"];
        assert!(csv.contains(&format!("harder,total,65000,{r:?},")), "{csv}");
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
