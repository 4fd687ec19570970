//! Tables of what is uncertain and of what counts as failure: random variables, correlations, outputs, limit states, life.

use super::exact::{ExactTexts, exact, exact_number, read};
use super::mechanism_tables::{stated, subject};
use crate::presentation::report::format::{UNKNOWN, count, exactly_with_unit, joined, seven_digits};
use crate::presentation::report::{WrittenScene, captioned, table};
use crate::results::scene_summary::{LimitRow, VariableRow};
use crate::results::summary::StudySummary;
use crate::study::Settings;
use common::random::{Correlation, RandomVariable};
use common::scene::expression::read_unit;
use common::scene::{Fails, Key, Output, OutputUnit, Scene, Value};
use maud::{Markup, html};

/// Distribution, moments and bounds of every random variable, in the unit in which it is displayed, and the correlations.
pub fn variables(scene: &Scene, summary: &StudySummary) -> Markup {
    let correlations = scene.correlations.iter().map(|Correlation { first, second, coefficient }| {
        let name = |k: usize| scene.variables[k].name.clone();
        [name(*first), name(*second), exact_number(*coefficient)]
    });
    let rows = scene.variables.iter().zip(&summary.variables).map(|(variable, row)| cells(variable, row));
    html! {
        (stated(
            "variables",
            "Random variables; of a truncated distribution mean and standard deviation are those before truncation",
            rows,
        ))
        @if !scene.correlations.is_empty() {
            (captioned(
                "correlations",
                "Correlations of the standard normals behind the variables (Gaussian copula); all other pairs are independent",
                table(&["variable", "and", "coefficient"], correlations),
            ))
        }
    }
}

fn cells(variable: &RandomVariable, row: &VariableRow) -> [(&'static str, String); 8] {
    let is_constant = variable.distribution.is_constant();
    let shown = |value: Option<f64>| {
        let value = value.filter(|_| !is_constant);
        value.map_or(UNKNOWN.to_owned(), |value| in_unit(variable, value))
    };
    let changes = variable.changes.join(", ");
    let sets = if changes.is_empty() { "input of the simulator".to_owned() } else { changes };
    let distribution = match variable.distribution.mode() {
        Some(mode) => format!("{}, mode {}", row.distribution, in_unit(variable, mode)),
        None => row.distribution.clone(),
    };
    let (lower, upper) = truncation(row).unwrap_or_else(|| (shown(row.lower), shown(row.upper)));
    let std = if is_constant { UNKNOWN.to_owned() } else { spread(variable, row) };
    [
        ("variable", row.name.clone()),
        ("unit", variable.unit.clone()),
        ("distribution", distribution),
        ("mean", in_unit(variable, row.mean)),
        ("std", std),
        ("lower bound", lower),
        ("upper bound", upper),
        ("sets", sets),
    ]
}

/// A value in the unit of its variable, which stands in a column of its own.
fn in_unit(variable: &RandomVariable, value: f64) -> String {
    let unit = if variable.unit == "1" { "" } else { variable.unit.as_str() };
    if read_unit(unit).is_err() {
        return exact_number(value);
    }
    let text = if unit.is_empty() { exact_number(value) } else { exact(value, unit) };
    // The unit as the function prints it.
    match text.split_once('\u{a0}') {
        Some((number, printed)) if printed == unit.replace("^2", "²") => number.to_owned(),
        _ => text,
    }
}

/// Most letters of a number that is stated in the unit of its variable.
const SHORT: usize = 10;

/// The standard deviation in the unit of its variable; where that has many digits, as the share of the mean that gives it.
fn spread(variable: &RandomVariable, row: &VariableRow) -> String {
    let text = in_unit(variable, row.std);
    if text.chars().count() <= SHORT {
        return text;
    }
    let percent = 100.0 * row.std / row.mean.abs();
    let shares = (0..8).filter_map(|decimals| format!("{percent:.decimals$}").parse::<f64>().ok());
    let same = |share: &f64| {
        let read = read(&format!("{share} %"));
        read.is_some_and(|share| (share * row.mean.abs()).to_bits() == row.std.to_bits())
    };
    shares.into_iter().find(same).map_or(text, |share| format!("{share}\u{a0}%"))
}

/// Bounds of a truncated normal that lie at whole standard deviations, in words.
fn truncation(row: &VariableRow) -> Option<(String, String)> {
    let (lower, upper) = (row.lower?, row.upper?);
    let reach = (1..=6).map(f64::from).find(|k| {
        let reach = k * row.std;
        row.distribution == "truncated-normal" && lower == row.mean - reach && upper == row.mean + reach
    })?;
    Some((format!("mean \u{2212} {reach} std"), format!("mean + {reach} std")))
}

/// The bodies or joints that an output belongs to.
fn subjects(scene: &Scene, written: &WrittenScene, output: &Output) -> String {
    let text = |(key, value): (&Key, Value)| {
        subject(scene, written, &format!("outputs.{}.{}", output.name, key.name), &value)
    };
    let found = joined(output.kind.values().into_iter().map(text).filter(|text| !text.is_empty()), "; ");
    if found.is_empty() { UNKNOWN.to_owned() } else { found }
}

/// The settings that the study used, with the values of its last run; `stored` are those of its file. A study by an earlier version
/// has stored fewer.
pub(super) fn study_settings(scene: &Scene, summary: &StudySummary, stored: &serde_json::Value) -> Markup {
    let settings = Settings::from_stored(stored).ok();
    let samples = if summary.is_direct() { "samples" } else { "population" };
    let mut rows = vec![(samples, summary.population.to_string())];
    if scene.simulator.is_none() {
        rows.insert(0, ("accuracy", summary.accuracy.clone()));
    }
    rows.extend(summary.levels.iter().map(|levels| ("levels", levels.names.join(", "))));
    if let Some(settings) = settings.filter(|_| !summary.is_direct()) {
        rows.extend([
            ("initial", settings.initial.to_string()),
            ("batch", settings.batch.to_string()),
            ("max_evaluations", settings.max_evaluations.to_string()),
        ]);
    }
    rows.push(("seed", summary.seed.to_string()));
    let rows = rows.into_iter().map(|(name, value)| [("setting", name.to_owned()), ("value", value)]);
    stated("settings", "Settings of the study, as it was run", rows)
}

/// The length of a cycle as the scene states it, or the period of the drive that it follows from; `None` without one.
fn cycle_of(scene: &Scene, written: &WrittenScene) -> Option<String> {
    let period = Some(scene.life.period).filter(|period| *period > 0.0)?;
    if let Some(body) = scene.life.turn_of {
        return Some(format!("one turn of {}", scene.bodies[body].name));
    }
    Some(match written.quantity("life.period") {
        Some(_) => exact(period, "s"),
        None => format!("{}\u{a0}s, the period of the drive", seven_digits(period)),
    })
}

/// Outputs, limit states and life.
pub fn limits(scene: &Scene, rows: &[LimitRow], written: &WrittenScene) -> Markup {
    let outputs = scene.outputs.iter().map(|output| {
        [
            ("output", output.name.clone()),
            ("unit", scene.unit_of(output).symbol().to_owned()),
            ("quantity", output.kind.description(scene)),
            ("of", subjects(scene, written, output)),
        ]
    });
    let limits = rows.iter().zip(&scene.limit_states).map(|(row, limit)| {
        let unit = scene.unit_of(&scene.outputs[limit.output]);
        let shown = |key: &str, value: f64| match &unit {
            OutputUnit::External(_) => unit.after(&exact_number(value)),
            OutputUnit::Shown { .. } => exactly_with_unit(&unit, value),
            own => {
                let texts = ExactTexts::below(written, format!("limit_states.{}", limit.name));
                texts.value(key, value, own.symbol())
            }
        };
        let fails = match limit.fails {
            Fails::Above => format!("≥ {}", shown("threshold", limit.threshold)),
            Fails::Below => format!("≤ {}", shown("threshold", limit.threshold)),
            Fails::Outside { lower } => {
                format!("≤ {} or ≥ {}", shown("lower", lower), shown("upper", limit.threshold))
            }
        };
        [row.name.clone(), row.output.clone(), fails]
    });
    let life = &scene.life;
    html! {
        (stated("outputs", "Outputs at every checkpoint", outputs))
        (captioned("limits", "Limit states", table(&["limit state", "output", "failed where the output is"], limits)))
        @if life.cycles > 1 {
            p {
                "Life studied: " (count(life.cycles.into())) " cycles"
                @if let Some(cycle) = cycle_of(scene, written) { " of " (cycle) }
                ", with a checkpoint every " (count(life.checkpoint_every.into())) " cycles"
                @if scene.simulator.is_none() { "; cycles that settle the motion before the first measured one: " (life.settle_cycles) }
                "."
            }
        }
        @for choice in scene.wear.chosen() { p { "Wear: " (choice) "." } }
        @if !scene.conditions.is_empty() { (conditions(scene, written)) }
    }
}

/// Operating conditions with their shares of the cycles and what they change.
fn conditions(scene: &Scene, written: &WrittenScene) -> Markup {
    let rows = scene.conditions.iter().map(|condition| {
        let texts = ExactTexts::below(written, format!("conditions.{}", condition.name));
        [
            ("condition", condition.name.clone()),
            ("share of the cycles", texts.number("share", condition.share)),
            ("changes", written.changes_of(&condition.name)),
        ]
    });
    stated("conditions", "Operating conditions; outputs are the worst of them", rows)
}
