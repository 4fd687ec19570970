//! The trade-off as CSV: a row per setting with its parameters and errors, and a row per value with its error.

use super::compare::{OutputError, SettingComparison};
use super::lives::LifeChange;
use super::measure::Measurement;
use crate::results::csv_table::CsvTable;
use common::accuracy::NamedAccuracy;
use common::scene::Scene;

/// Columns of a setting.
const SETTING: [&str; 13] = [
    "setting",
    "step_tolerance",
    "largest_step",
    "wear_samples",
    "cycle_jump",
    "wear_tolerance",
    "warm_up",
    "seconds",
    "steps",
    "simulated_cycles",
    "failures",
    "efficient",
    "within_twice",
];

/// Columns of every output, after its name.
const OUTPUT: [&str; 8] = [
    "error",
    "error_until_limit",
    "life_cycles",
    "within",
    "within_twice",
    "median_ratio",
    "ratio_95",
    "missed_points",
];

/// Columns of every limit state, after its name.
const LIMIT_STATE: [&str; 6] =
    ["lives_changed", "R_change", "R_change_cycles", "R_change_at_0.9", "R_change_at_0.5", "R_change_at_0.1"];

/// One row per setting: its parameters, its cost, the errors of every output, and for every limit state the effect on the
/// reliability. Shares and relative errors are plain numbers; an unknown value is empty.
pub fn csv(scene: &Scene, rows: &[SettingComparison]) -> String {
    let states = limit_states(scene);
    let mut columns: Vec<String> = SETTING.map(str::to_owned).to_vec();
    for output in &scene.outputs {
        columns.extend(OUTPUT.map(|column| format!("{}_{column}", output.name)));
    }
    for name in &states {
        columns.extend(LIMIT_STATE.map(|column| format!("{name}_{column}")));
    }
    let mut table = CsvTable::new(&columns);
    for row in rows {
        let mut cells = setting_cells(row);
        for k in 0..scene.outputs.len() {
            cells.extend(row.outputs.get(k).map(output_cells).unwrap_or_default());
        }
        for name in &states {
            let change = row.lives.iter().find(|life| life.limit_state == *name);
            cells.extend(change.map(life_cells).unwrap_or_default());
        }
        table.push(&cells);
    }
    table.into_text()
}

/// Limit states, and `total` if there are several.
fn limit_states(scene: &Scene) -> Vec<&str> {
    let names = scene.limit_states.iter().map(|limit| limit.name.as_str());
    names.chain((scene.limit_states.len() > 1).then_some("total")).collect()
}

fn setting_cells(row: &SettingComparison) -> Vec<String> {
    let a = &row.setting.accuracy;
    vec![
        row.setting.name.clone(),
        format!("{:e}", a.step_tolerance),
        format!("{:e}", a.largest_step),
        a.wear_samples.to_string(),
        a.cycle_jump.to_string(),
        format!("{:e}", a.wear_tolerance),
        a.warm_up.to_string(),
        format!("{:e}", row.seconds),
        row.steps.to_string(),
        row.cycles.to_string(),
        row.failures.to_string(),
        row.efficient.to_string(),
        row.stated.within_twice.to_string(),
    ]
}

fn output_cells(output: &OutputError) -> [String; OUTPUT.len()] {
    let stated = &output.stated;
    [
        format!("{:e}", output.relative),
        format!("{:e}", output.until_limit),
        output.life.map_or_else(String::new, |cycles| cycles.to_string()),
        stated.within.to_string(),
        stated.within_twice.to_string(),
        format!("{:e}", stated.median_ratio),
        format!("{:e}", stated.ratio_95),
        stated.points_missed.to_string(),
    ]
}

fn life_cells(life: &LifeChange) -> [String; LIMIT_STATE.len()] {
    let [first, second, third] =
        life.at_levels.map(|level| level.map_or_else(String::new, |r| r.difference().to_string()));
    let largest = life.largest;
    let changed = life.changed.to_string();
    [changed, largest.difference().to_string(), largest.cycles.to_string(), first, second, third]
}

/// One row per setting, point, output and checkpoint, with its reference and its stated error, in the unit of the column
/// `unit`.
pub fn values_csv(scene: &Scene, settings: &[NamedAccuracy], measurement: &Measurement) -> String {
    let columns = ["setting", "point", "output", "unit", "cycles", "value", "reference", "stated_error"];
    let mut table = CsvTable::new(columns);
    for (setting, points) in settings.iter().zip(&measurement.settings) {
        for (point, (measured, reference)) in points.iter().zip(&measurement.reference).enumerate() {
            let (Ok(found), Ok(reference)) = (&measured.outcome, &reference.outcome) else { continue };
            for (k, output) in scene.outputs.iter().enumerate() {
                let unit = output.kind.unit();
                for (n, cycles) in found.cycles.iter().enumerate() {
                    let values = [found.histories[k][n], reference.histories[k][n], found.errors[k][n]];
                    let [value, truth, stated] = values.map(|si| format!("{:e}", unit.to_file(si)));
                    let (point, cycles) = (point.to_string(), cycles.to_string());
                    table.push([
                        &setting.name,
                        &point,
                        &output.name,
                        unit.suffix(),
                        &cycles,
                        &value,
                        &truth,
                        &stated,
                    ]);
                }
            }
        }
    }
    table.into_text()
}
