//! Comparison of finished studies on one page: overlaid reliability curves, lives, and computing effort; the curves as CSV; and the change
//! of a life in words: the best estimate with its 95 % interval, or what is known of it where one of the lives is only bounded.

use super::figures::capital;
use super::format::{UNKNOWN, count, duration, rounded_cycles};
use super::life::{LEVELS, LifeAt, failure_probability, life_at, life_with_limits, unresolved_fall};
use super::words;
use super::{Answer, AnswerPart, SERIES, Table};
use crate::results::csv_table::{self, number};
use crate::results::summary::{PerLimitState, StudySummary};
use crate::statistics::reliability::paired::{Change, IntervalEstimate, OtherErrors, change};
use std::collections::BTreeSet;
use thiserror::Error;

pub use super::figures::ComparedStudy;

/// Why studies cannot be compared, in words.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Incomparable(String);

/// Checks that the studies can be compared: at least two, with the same limit states (in any order) and checkpoints.
///
/// # Errors
/// [`Incomparable`].
pub fn check(studies: &[ComparedStudy]) -> Result<(), Incomparable> {
    if !(2..=SERIES).contains(&studies.len()) {
        return Err(Incomparable(format!("{} studies: a comparison takes 2 to {SERIES}", studies.len())));
    }
    let states = |study: &ComparedStudy| BTreeSet::from_iter(study.summary.limit_states.iter().cloned());
    let cycles =
        |study: &ComparedStudy| Vec::from_iter(study.summary.reliability.iter().map(|row| row.cycles));
    for other in &studies[1..] {
        let both = [&studies[0], other];
        let [first, second] = both.map(|study| &study.name);
        if states(both[0]) != states(both[1]) {
            let [a, b] = both.map(|study| study.summary.limit_states.join(", "));
            return Err(Incomparable(format!(
                "{first} and {second} have different limit states: {a} against {b}; studies are compared by limit states of the \
                 same names"
            )));
        }
        let both = both.map(cycles);
        if both[0] != both[1] {
            let end = |cycles: Option<&u32>| cycles.copied().unwrap_or(0);
            let [[a, b], [c, d]] = both.map(|cycles| [end(cycles.first()), end(cycles.last())]);
            return Err(Incomparable(format!(
                "{first} and {second} have different checkpoints: every {a} cycles up to {b} against every {c} up to {d}; give the \
                 scenes the same life"
            )));
        }
    }
    Ok(())
}

/// Most differing keys that a terminal shows.
const MOST_KEYS: usize = 12;

/// The comparison; a function of the studies and of the keys in which their scenes differ, `(key, value in each study)`. `name` is that
/// of its files.
pub fn answer(name: String, studies: Vec<ComparedStudy>, differing: &[(String, Vec<String>)]) -> Answer {
    let names: Vec<&str> = studies.iter().map(|study| study.name.as_str()).collect();
    let scenes = BTreeSet::from_iter(studies.iter().map(|study| study.summary.scene.as_str()));
    let first = &studies[0];
    let is_static = first.summary.is_static();
    let text = |text: &str| AnswerPart::Text(text.to_owned());
    let mut parts = vec![AnswerPart::Figures];
    if is_static {
        parts.push(text("These studies have a single checkpoint and therefore no curves."));
    }
    parts.extend(first.summary.curve_names().map(|name| AnswerPart::Table(lives(&studies, name))));
    if !is_static {
        parts.push(AnswerPart::Text(format!(
            "Differences are lives minus those of {}. Their intervals contain every error of both studies, which are taken as \
             independent.",
            first.name
        )));
    }
    parts.extend(studies.iter().filter_map(|study| {
        let note = unresolved_fall(&study.summary)?;
        Some(AnswerPart::Text(format!("**Caution:** {}: {note}", study.name)))
    }));
    parts.push(if differing.is_empty() {
        text("The scenes are the same.")
    } else {
        AnswerPart::Table(differences(&names, differing))
    });
    parts.push(AnswerPart::Table(effort(&studies)));
    Answer {
        title: format!("Studies compared: {}", names.join(", ")),
        subtitle: format!("Scenes: {}", Vec::from_iter(scenes).join(", ")),
        files: vec![(format!("{name}.csv"), csv(&studies))],
        name,
        parts,
        curves: studies,
        ..Answer::default()
    }
}

/// Lives of every study at the usual levels of reliability, or its probability of failure.
fn lives(studies: &[ComparedStudy], name: &str) -> Table {
    if studies[0].summary.is_static() {
        let rows = studies.iter().map(|ComparedStudy { name: study, summary }| {
            let found = summary.reliability.first().map(|row| failure_probability(row, name));
            vec![study.clone(), found.unwrap_or(UNKNOWN.to_owned())]
        });
        return Table::new(capital(name), ["study", "probability of failure (95 %)"], rows);
    }
    let levels = LEVELS.map(|level| format!("at R = {level} (95 % interval)"));
    let row = |name: String, lives: [String; 3]| [name].into_iter().chain(lives).collect();
    let rows = studies.iter().map(|study| {
        row(study.name.clone(), LEVELS.map(|level| life_with_limits(life_at(&study.summary, name, level))))
    });
    let gains = studies.iter().skip(1).map(|study| {
        let gains =
            LEVELS.map(|level| change_between([&studies[0].summary, &study.summary], (name, level)).1);
        row(format!("{} minus {}", study.name, studies[0].name), gains)
    });
    let head = std::iter::once("life [cycles]".to_owned()).chain(levels);
    Table::new(capital(name), head, rows.chain(gains))
}

/// The keys in which the scenes differ, with their values.
fn differences(names: &[&str], differing: &[(String, Vec<String>)]) -> Table {
    let rows = differing.iter().map(|(key, values)| [std::slice::from_ref(key), values].concat());
    let head = ["key"].into_iter().chain(names.iter().copied());
    let more = differing.len().saturating_sub(MOST_KEYS);
    let shown =
        (more > 0).then(|| ((0..MOST_KEYS).collect(), format!("(and {more} further keys, see the page)")));
    Table { shown, ..Table::new("Differences of the scenes", head, rows) }
}

/// Scene, method, accuracy, seed, evaluations and time of every study.
fn effort(studies: &[ComparedStudy]) -> Table {
    let head = "study | scene | method | accuracy | seed | simulations | without a result | time of the study | version";
    let rows = studies.iter().map(|ComparedStudy { name, summary }| {
        vec![
            name.clone(),
            summary.scene.clone(),
            summary.method.clone(),
            words::accuracy(summary),
            summary.seed.to_string(),
            count(summary.evaluations.total as u64),
            count(summary.evaluations.failed as u64),
            duration(summary.timing_s.total),
            summary.version.clone(),
        ]
    });
    Table::new("Settings and computing effort", head.split(" | "), rows).with_left(&[0, 1, 2, 3])
}

/// Every curve of every study: `study`, `limit_state`, `cycles`, `R`, `standard_error`, and the 95 % interval `lower`, `upper`,
/// one row per checkpoint.
pub fn csv(studies: &[ComparedStudy]) -> String {
    let rows = studies.iter().flat_map(|ComparedStudy { name: study, summary }| {
        let cells = studies[0].summary.curve_names().flat_map(|name| curve_cells(summary, name));
        cells.map(|cells| [study.clone()].into_iter().chain(cells))
    });
    csv_table::csv(["study"].into_iter().chain(CURVE_COLUMNS), rows)
}

/// Columns of the rows of [`curve_cells`].
pub const CURVE_COLUMNS: [&str; 6] = ["limit_state", "cycles", "R", "standard_error", "lower", "upper"];

/// R of a curve at every checkpoint with its standard error and its 95 % interval.
pub fn curve_cells<'s>(summary: &'s StudySummary, name: &'s str) -> impl Iterator<Item = [String; 6]> + 's {
    let value = move |values: &PerLimitState| values.get(name).copied().map_or(String::new(), number);
    summary.reliability.iter().map(move |row| {
        let [r, error] = [&row.reliability, &row.standard_error].map(value);
        let range = row.interval_of(name).map(|range| [range.lower, range.upper].map(number));
        let [lower, upper] = range.unwrap_or_default();
        [name.to_owned(), row.cycles.to_string(), r, error, lower, upper]
    })
}

/// The change from `before` to `after` of a life, e.g. `+910 (700 to 1 120)` [cycles]; `known` is its estimate where both lives
/// are resolved.
pub fn change_of_life(known: Option<Change>, before: LifeAt, after: LifeAt) -> String {
    known.map_or_else(|| bound(before, after), |change| in_cycles(&change))
}

/// The change of a life between two studies with independent samples, of the curve `name` at `level`, and in words; `None` where
/// one of the lives is not resolved. All errors are taken as independent.
pub fn change_between(
    [before, after]: [&StudySummary; 2],
    (name, level): (&str, f64),
) -> (Option<Change>, String) {
    let [before, after] = [before, after].map(|summary| life_at(summary, name, level));
    let estimate = |life: LifeAt| match life {
        LifeAt::Cycles { life, lower, upper } => {
            // Without a correlation the part of sampling plays no role.
            Some(IntervalEstimate { value: life, lower, upper, sampling: 0.0 })
        }
        LifeAt::Unworn { .. } | LifeAt::Between { .. } | LifeAt::Beyond { .. } => None,
    };
    let known = estimate(before)
        .zip(estimate(after))
        .map(|(before, after)| change(before, after, 0.0, OtherErrors::Independent));
    (known, change_of_life(known, before, after))
}

fn in_cycles(change: &Change) -> String {
    let ends = [change.lower, change.upper];
    let width = ends.iter().flatten().map(|end| (end - change.value).abs()).fold(0.0, f64::max);
    let shown = |value: f64| {
        let text = rounded_cycles(value.abs(), width);
        match value {
            v if v < 0.0 && text != "0" => format!("\u{2212}{text}"),
            v if v > 0.0 && text != "0" => format!("+{text}"),
            _ => text,
        }
    };
    let value = shown(change.value);
    match ends.map(|end| end.map(shown)) {
        [Some(lower), Some(upper)] => format!("{value} ({lower} to {upper})"),
        [Some(lower), None] => format!("{value} (at least {lower})"),
        [None, Some(upper)] => format!("{value} (at most {upper})"),
        [None, None] => value,
    }
}

/// What is known of a change of life where one of the lives is only bounded.
fn bound(before: LifeAt, after: LifeAt) -> String {
    let (sign, change) = match (before, after) {
        (LifeAt::Cycles { upper: Some(upper), .. }, LifeAt::Beyond { lower, .. }) if lower > upper => {
            ("more than +", lower - upper)
        }
        (LifeAt::Beyond { lower, .. }, LifeAt::Cycles { upper: Some(upper), .. }) if lower > upper => {
            ("below \u{2212}", lower - upper)
        }
        _ => return "not known".to_owned(),
    };
    format!("{sign}{}", rounded_cycles(change, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::life::life_and_limits;
    use crate::tests::test_study;

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
        let width = ("parameters.width".to_owned(), vec!["10 mm".to_owned(), "12 mm".to_owned()]);
        let answer = answer("compare".to_owned(), studies.to_vec(), &[width]);
        let names: Vec<String> = answer.all_figures().into_iter().map(|figure| figure.name).collect();
        assert_eq!(names, ["reliability-wear", "reliability-asymmetry", "reliability-total"]);
        let markdown = answer.markdown();
        let life = life_and_limits(life_at(&studies[1].summary, "asymmetry", 0.5)).0;
        for text in [
            life,
            "| draft |".into(),
            "| a & b |".into(),
            "## Total".into(),
            "| 12 mm |".into(),
            "| harder minus a & b |".into(),
        ] {
            assert!(markdown.contains(&text), "{text}");
        }
        let csv = &answer.files[0].1;
        assert_eq!(csv.lines().count(), 1 + 2 * 3 * 72);
        let r = studies[1].summary.reliability[64].reliability["total"];
        assert!(csv.contains(&format!("harder,total,65000,{r:?},")), "{csv}");
    }

    #[test]
    fn issue_a_gain_between_two_accuracies_contains_the_numerical_errors_of_both() {
        let mut studies = two();
        studies[1].summary = studies[0].summary.clone();
        let both = [&studies[0].summary, &studies[1].summary];
        let change = change_between(both, ("total", 0.5)).0.unwrap();
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
        assert_eq!(
            check(std::slice::from_ref(&a)).unwrap_err().to_string(),
            "1 studies: a comparison takes 2 to 6"
        );
        b.summary.reliability.truncate(60);
        let said = check(&[a.clone(), b.clone()]).unwrap_err().to_string();
        assert!(said.contains("every 1000 cycles up to 72000 against every 1000 up to 60000"), "{said}");
        b.summary.limit_states.truncate(1);
        let said = check(&[a, b]).unwrap_err().to_string();
        assert!(said.contains("wear, asymmetry against asymmetry"), "{said}");
    }
    fn cycles(life: f64, half: f64) -> LifeAt {
        LifeAt::Cycles { life, lower: life - half, upper: Some(life + half) }
    }

    #[test]
    fn changes_have_signs_and_intervals_and_bounds_where_a_life_is_not_resolved() {
        let known = Change { value: 912.0, lower: Some(700.0), upper: Some(1124.0) };
        let said = change_of_life(Some(known), cycles(5000.0, 10.0), cycles(5912.0, 10.0));
        assert_eq!(said, "+910 (+700 to +1\u{a0}120)");
        let beyond = LifeAt::Beyond { lower: 8000.0, end: 8000.0 };
        assert_eq!(change_of_life(None, cycles(5000.0, 500.0), beyond), "more than +2\u{a0}500");
        assert_eq!(change_of_life(None, beyond, cycles(5000.0, 500.0)), "below \u{2212}2\u{a0}500");
        assert_eq!(change_of_life(None, beyond, beyond), "not known");
    }
}
