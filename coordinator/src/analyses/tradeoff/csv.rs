//! The trade-off as CSV: a row per setting with its parameters and errors, and a row per value with its error.

use super::compare::{OutputError, SettingComparison};
use super::lives::LifeChange;
use super::measure::Measurement;
use crate::results::csv_table::CsvTable;
use common::accuracy::NamedAccuracy;
use common::scene::Scene;

/// A cell with the name of its column.
type Cell = (&'static str, String);

/// One row per setting: its parameters, its cost, the errors of every output, and for every limit state the effect on the
/// reliability. Shares and relative errors are plain numbers; an unknown value is empty.
pub fn csv(scene: &Scene, rows: &[SettingComparison]) -> String {
    let total = (scene.limit_states.len() > 1).then_some("total");
    let states: Vec<&str> = scene.limit_states.iter().map(|limit| limit.name.as_str()).chain(total).collect();
    let cells = |row: &SettingComparison| -> Vec<(String, String)> {
        let own = setting_cells(row).map(|(column, cell)| (column.to_owned(), cell));
        let outputs = scene.outputs.iter().enumerate().flat_map(|(k, output)| {
            let cells = output_cells(row.outputs.get(k));
            cells.map(|(column, cell)| (format!("{}_{column}", output.name), cell))
        });
        let lives = states.iter().flat_map(|name| {
            let cells = life_cells(row.lives.iter().find(|life| life.limit_state == *name));
            cells.map(|(column, cell)| (format!("{name}_{column}"), cell))
        });
        own.into_iter().chain(outputs).chain(lives).collect()
    };
    let rows: Vec<_> = rows.iter().map(cells).collect();
    let mut table = CsvTable::new(rows.first().into_iter().flatten().map(|(column, _)| column));
    rows.iter().for_each(|row| table.push(row.iter().map(|(_, cell)| cell)));
    table.into_text()
}

fn setting_cells(row: &SettingComparison) -> [Cell; 13] {
    let a = &row.setting.accuracy;
    [
        ("setting", row.setting.name.clone()),
        ("step_tolerance", format!("{:e}", a.step_tolerance)),
        ("largest_step", format!("{:e}", a.largest_step)),
        ("wear_samples", a.wear_samples.to_string()),
        ("cycle_jump", a.cycle_jump.to_string()),
        ("wear_tolerance", format!("{:e}", a.wear_tolerance)),
        ("warm_up", a.warm_up.to_string()),
        ("seconds", format!("{:e}", row.seconds)),
        ("steps", row.steps.to_string()),
        ("simulated_cycles", row.cycles.to_string()),
        ("failures", row.failures.to_string()),
        ("efficient", row.efficient.to_string()),
        ("within_twice", row.stated.within_twice.to_string()),
    ]
}

/// Columns of an output, after its name.
fn output_cells(output: Option<&OutputError>) -> [Cell; 8] {
    let cell = |of: &dyn Fn(&OutputError) -> String| output.map(of).unwrap_or_default();
    [
        ("error", cell(&|o| format!("{:e}", o.relative))),
        ("error_until_limit", cell(&|o| format!("{:e}", o.until_limit))),
        ("life_cycles", cell(&|o| o.life.map_or_else(String::new, |cycles| cycles.to_string()))),
        ("within", cell(&|o| o.stated.within.to_string())),
        ("within_twice", cell(&|o| o.stated.within_twice.to_string())),
        ("median_ratio", cell(&|o| format!("{:e}", o.stated.median_ratio))),
        ("ratio_95", cell(&|o| format!("{:e}", o.stated.ratio_95))),
        ("missed_points", cell(&|o| o.stated.points_missed.to_string())),
    ]
}

/// Columns of a limit state, after its name.
fn life_cells(life: Option<&LifeChange>) -> [Cell; 6] {
    let cell = |of: &dyn Fn(&LifeChange) -> String| life.map(of).unwrap_or_default();
    let at = |level: usize| {
        cell(&|life| life.at_levels[level].map_or_else(String::new, |r| r.difference().to_string()))
    };
    [
        ("lives_changed", cell(&|life| life.changed.to_string())),
        ("R_change", cell(&|life| life.largest.difference().to_string())),
        ("R_change_cycles", cell(&|life| life.largest.cycles.to_string())),
        ("R_change_at_0.9", at(0)),
        ("R_change_at_0.5", at(1)),
        ("R_change_at_0.1", at(2)),
    ]
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
