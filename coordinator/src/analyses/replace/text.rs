//! The answer of `coordinator replace` with its tables.

use super::{DemandedAge, InspectionRow, RateRow, ReplacementReport, Stated};
use crate::presentation::report::answer::{Answer, AnswerPart, Table};
use crate::presentation::report::format::{near_one, percent, short_percent};
use crate::results::life_summary::{CyclesRange, LifeRow};
use crate::statistics::replacement::PolicyOutcome;
use common::scene::Scene;

/// Reliability at the end of a study above which its hazard says nothing of later ages [1].
const MOST_SURVIVE: f64 = 0.5;
/// Rows of the table of rates on a terminal.
const ROWS: usize = 24;

/// The answer; the scene has the units of its outputs.
pub fn answer(report: &ReplacementReport, scene: &Scene) -> Answer {
    let ReplacementReport { planned_cost, failure_cost, .. } = report;
    let subject = if report.curve == "total" { "the whole system" } else { &report.curve };
    let numbers = Table { left: &[0, 1], ..Table::new("", [""; 0], numbers(report)) };
    let mut parts = vec![AnswerPart::Table(numbers), rates(&report.rates)];
    parts.extend(inspections(report, scene));
    Answer {
        name: "replace".to_owned(),
        title: format!(
            "Age replacement for failures of {subject}: planned replacement {planned_cost}, failure {failure_cost} \
             (95 % intervals)"
        ),
        subtitle: format!("Scene: {}", scene.name),
        parts,
        ..Answer::default()
    }
}

/// Age, costs and lives by name.
fn numbers(report: &ReplacementReport) -> Vec<Vec<String>> {
    let ReplacementReport { age, end, mean_life, gain, .. } = report;
    let life = |cycles: f64| life(cycles, *end);
    let (at_least, at_most) = if report.mean_life_is_bound { ("at least ", "at most ") } else { ("", "") };
    let rates = [&report.run_to_failure, &report.cost_rate];
    let [failures, cost] = rates.map(|rate| rate.shown(|x| format!("{x:.4e}")));
    let r = report.reliability_at_age.shown(|r| near_one(r, 4));
    let mut rows = Vec::new();
    let mut add = |name: &str, text: String| rows.push(vec![name.to_owned(), text]);
    if report.no_minimum {
        let reason = if report.reliability_at_age.value > MOST_SURVIVE {
            "the study ends before most units fail, and whether a replacement pays later is not known: study a longer life"
        } else {
            "run to failure: the hazard does not rise enough for a replacement to pay"
        };
        let falls = format!("the cost per cycle falls up to the end of the study, {end:.0} cycles");
        add("no best age", format!("{reason}; {falls}"));
        if age.lower < *end {
            let lower = life(age.lower);
            add("", format!("within the limits of R there may be a minimum, not before {lower} cycles"));
        }
        add("R at the end", r);
        add("cost at the end", format!("{cost} per cycle"));
    } else {
        let later = if age.upper >= *end { " or later" } else { "" };
        let [value, lower, upper] = [age.value, age.lower, age.upper].map(life);
        add("replace at", format!("{value} cycles ({lower} to {upper}{later}), where R = {r}"));
        add("cost", format!("{cost} per cycle"));
    }
    if let Some(DemandedAge { reliability, confidence, latest, age, cost_rate }) = report.demanded {
        let with = format!("R >= {reliability} with {} confidence", percent(confidence));
        let later = if latest >= *end { "the end of the study, " } else { "" };
        let [age, last] = [age, latest].map(life);
        let text =
            format!("replace at {age} cycles, {cost_rate:.4e} per cycle; it holds up to {later}{last}");
        add(&with, if latest > 0.0 { text } else { "it holds at no age".to_owned() });
    }
    if let Some(first) = report.constant_hazard_before {
        let cycles = if first == 1 { "cycle" } else { "cycles" };
        add(
            "caution",
            format!(
                "the fall of R before the first checkpoint, {first} {cycles}, is not resolved: the hazard is taken as constant \
                 there, the intervals contain any other fall; limits may be exceeded unworn, in the first cycle"
            ),
        );
    }
    add("run to failure", format!("{at_most}{failures} per cycle"));
    let [value, lower, upper] = [gain.value, gain.lower, gain.upper].map(|x| 100.0 * x);
    add("replacement saves", format!("{at_most}{value:.1} % ({lower:.1} to {upper:.1} %) of that"));
    add("mean life", format!("{at_least}{} cycles", mean_life.shown(life)));
    if report.mean_life_is_bound {
        add(
            "",
            format!(
                "units outlive the study, which ends at {end:.0} cycles: the mean life is that up to there"
            ),
        );
    }
    for row in &report.lives {
        add(&format!("B{:.0}", 100.0 * (1.0 - row.reliability)), life_text(row, *end));
    }
    rows
}

impl Stated {
    /// The number with its interval in brackets, each as `shown`.
    fn shown(&self, shown: impl Fn(f64) -> String) -> String {
        let [value, lower, upper] = [self.value, self.lower, self.upper].map(shown);
        format!("{value} ({lower} to {upper})")
    }
}

/// A life with three digits of the length of the study at least, whole cycles from 1000 on.
fn life(cycles: f64, end: f64) -> String {
    let decimals = (3.0 - end.max(1.0).log10().ceil()).clamp(0.0, 3.0) as usize;
    format!("{cycles:.decimals$}")
}

/// Life of a level with its interval, or its bound.
fn life_text(row: &LifeRow, end: f64) -> String {
    let CyclesRange { lower, upper } = row.whole_interval();
    let shown = |cycles: f64| life(cycles, end);
    let from = shown(lower);
    match (row.cycles.map(shown), upper) {
        (None, Some(0.0)) => "0 cycles: more units than that exceed a limit unworn".to_owned(),
        (Some(cycles), Some(upper)) => format!("{cycles} cycles ({from} to {})", shown(upper)),
        (Some(cycles), None) => format!("{cycles} cycles ({from} to beyond {end:.0})"),
        (None, Some(upper)) => format!("between {from} and {} cycles", shown(upper)),
        (None, None) => format!("beyond {from} cycles"),
    }
}

/// Density and hazard where units fail, on a terminal at most [`ROWS`] rows.
fn rates(rates: &[RateRow]) -> AnswerPart {
    let short = |stated: &Stated| stated.shown(|x| format!("{x:.2e}"));
    let failing: Vec<&RateRow> = rates.iter().filter(|row| row.density.value > 0.0).collect();
    if failing.is_empty() {
        let none = "No failure was found up to the end of the study: no density and no hazard.";
        return AnswerPart::Text(none.to_owned());
    }
    let step = failing.len().div_ceil(ROWS);
    let shown = (0..failing.len()).step_by(step).collect();
    let note = format!("(every {step} intervals; --json has all)");
    let rows = failing.iter().map(|row| {
        let hazard = row.hazard.as_ref().map_or("too few survivors".to_owned(), short);
        vec![format!("{:.0} to {:.0}", row.from, row.to), short(&row.density), hazard]
    });
    let head = ["cycles", "failure density [1/cycle] (95 %)", "hazard [1/cycle] (95 %)"];
    AnswerPart::Table(Table {
        left: &[],
        shown: (step > 1).then_some((shown, note)),
        ..Table::new("", head, rows)
    })
}

/// Replacement at measured levels, if it was asked for.
fn inspections(report: &ReplacementReport, scene: &Scene) -> Vec<AnswerPart> {
    let Some(first) = report.inspections.first() else { return vec![] };
    let output = scene.outputs.iter().find(|output| output.name == first.output);
    let unit = output.map(|output| scene.unit_of(output));
    let meaning = format!(
        "Replacement at levels of a measured {}, at a last age in any case; lives and ages in cycles, cost with 95 % limits by the number \
         of units, the upper one with failures that none of them shows",
        first.output
    );
    let head = "inspected every | replaced from | last age | cost per cycle (95 %) | failed | \
                replaced by level | mean life | inspections of a unit"
        .split(" | ");
    let row = |row: &InspectionRow| {
        let outcome = row.outcome;
        let shown =
            |level: f64| unit.as_ref().map(|unit| unit.after(&format!("{:.4}", unit.to_shown(level))));
        let levels: Vec<String> = row.lower_level.into_iter().chain(row.level).filter_map(shown).collect();
        let PolicyOutcome {
            cost_rate: value, lower, upper, failed, by_level, mean_life, inspections, ..
        } = outcome;
        let every = row.every.map_or("given".to_owned(), |every| every.to_string());
        let levels = if levels.is_empty() { "the age only".to_owned() } else { levels.join(", ") };
        let [age, mean_life] = [row.age, mean_life].map(|cycles| life(cycles, report.end));
        let cost = Stated { value, lower, upper }.shown(|x| format!("{x:.4e}"));
        let (by_level, inspections) = (format!("{:.1} %", 100.0 * by_level), format!("{inspections:.1}"));
        vec![every, levels, age, cost, short_percent(failed), by_level, mean_life, inspections]
    };
    let table = Table::new("", head, report.inspections.iter().map(row)).with_left(&[]);
    let least = report.inspections.iter().map(|row| row.outcome.cost_rate).fold(f64::INFINITY, f64::min);
    let saved = 100.0 * (1.0 - least / report.cost_rate.value);
    let which = if report.inspections.len() > 1 { "The best of these" } else { "This" };
    let (saved, less) = (saved.abs(), if saved >= 0.0 { "less" } else { "more" });
    let best = format!("{which} costs {saved:.1} % {less} than age replacement without inspections.");
    vec![AnswerPart::Text(meaning), AnswerPart::Table(table), AnswerPart::Text(best)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::life_summary::CyclesRange;

    #[test]
    fn issue_short_lives_had_no_decimals_and_bounds_no_sense() {
        let row = |cycles: Option<f64>, lower: f64, upper: Option<f64>| LifeRow {
            limit_state: "total".to_owned(),
            reliability: 0.9,
            cycles,
            interval: CyclesRange { lower, upper },
            with_numerical_error: None,
        };
        assert_eq!(life_text(&row(Some(7.4823), 7.1, Some(7.9)), 10.0), "7.48 cycles (7.10 to 7.90)");
        assert_eq!(life_text(&row(Some(7482.3), 7100.0, None), 1e4), "7482 cycles (7100 to beyond 10000)");
        assert_eq!(life_text(&row(None, 10.0, None), 10.0), "beyond 10.00 cycles");
        assert_eq!(life_text(&row(None, 0.0, Some(3.0)), 100.0), "between 0.0 and 3.0 cycles");
        let unworn = life_text(&row(None, 0.0, Some(0.0)), 10.0);
        assert_eq!(unworn, "0 cycles: more units than that exceed a limit unworn");
    }
}
