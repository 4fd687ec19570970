//! The trade-off as one table: cost, error of every output, validity of the stated errors, and effect on the reliability.

use super::compare::{OutputError, REQUIRED_SHARE, SettingComparison, TIMES};
use super::lives::LifeChange;
use super::measure::Measurement;
use crate::presentation::report::{Answer, AnswerPart, Table, csv};
use common::accuracy::NamedAccuracy;
use common::scene::Scene;

/// A row per setting from the fastest to the slowest, and the reference; `points`: number of points measured. All that was compared
/// is in `tradeoff.csv`.
pub fn answer(
    scene: &Scene,
    rows: &[SettingComparison],
    reference: &SettingComparison,
    points: usize,
) -> Answer {
    let mut sorted: Vec<&SettingComparison> = rows.iter().collect();
    sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let own_points = if reference.setting.accuracy.points > 1 {
        ""
    } else {
        " All have the control points of the scene: what more of them change is not in these errors."
    };
    let text = format!(
        "Error: largest difference over all points and checkpoints, relative to the threshold of the output's limit state or to its largest \
         value; in brackets, only up to where the reference reaches that limit. Life: largest change of the life at which the limit is \
         reached. Stated: share of all values whose true error is within {TIMES} times the stated one, which must hold for {:.0} %. R: \
         largest change of the reliability of the random points by any limit state or by all. A star marks the Pareto front of time and \
         error. The last row is the reference with its own stated error.{own_points}",
        100.0 * REQUIRED_SHARE
    );
    let table = AnswerPart::Table(table(scene, &sorted, reference));
    let failed = rows.iter().chain([reference]).filter(|row| row.failures > 0);
    let failed: Vec<String> = failed.map(|row| format!("{} at {}", row.setting.name, row.failures)).collect();
    let names = failed.join(", ");
    let failed = format!("Without a result, and excluded there: {names} of {points} points.");
    let failed = (!names.is_empty()).then_some(AnswerPart::Text(failed));
    Answer {
        name: "tradeoff".to_owned(),
        title: format!(
            "Accuracy settings of `{}`, against `{}`, at {points} points",
            scene.name, reference.setting.name
        ),
        parts: [AnswerPart::Text(text), table].into_iter().chain(failed).collect(),
        files: vec![("tradeoff.csv".to_owned(), settings_csv(scene, rows))],
        prints_markdown: true,
        ..Answer::default()
    }
}

fn table(scene: &Scene, rows: &[&SettingComparison], reference: &SettingComparison) -> Table {
    let percent = |share: f64| format!("{:.3} %", 100.0 * share);
    let of_output = |o: &OutputError| {
        let life = o.life.map_or_else(|| "-".to_owned(), |cycles| format!("{cycles:.0} cycles"));
        let (all, until) = (percent(o.relative), percent(o.until_limit));
        [if all == until { all } else { format!("{all} ({until})") }, life]
    };
    let own = |row: &SettingComparison| {
        let [steps, cycles] = [row.steps, row.cycles].map(|count| format!("{count:.0}"));
        let stars = if row.setting.is_preset() { "**" } else { "" };
        let star = if row.efficient { " *" } else { "" };
        let name = format!("{stars}{}{stars}{star}", row.setting.name);
        let mut cells = vec![name, format!("{:.3}", row.seconds), steps, cycles];
        for k in 0..scene.outputs.len() {
            let failed = || ["failed".to_owned(), String::new()];
            cells.extend(row.outputs.get(k).map_or_else(failed, of_output));
        }
        cells
    };
    let compared = |row: &&SettingComparison| {
        let holds = if row.stated.holds() { "" } else { ", DOES NOT HOLD" };
        let stated = format!("{:.1} %{holds}", 100.0 * row.stated.within_twice);
        let changes = row.lives.iter().map(|life| life.largest.difference());
        let largest = changes.max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let largest = largest.map_or("-".to_owned(), |change| format!("{change:+.2}"));
        own(row).into_iter().chain([stated, largest]).collect()
    };
    let of_reference = [own(reference), vec![String::new(); 2]].concat();
    let columns = scene.outputs.iter().flat_map(|output| [output.name.as_str(), "life"]);
    let head = ["setting", "s", "steps", "cycles"].into_iter().chain(columns).chain(["stated", "R"]);
    Table::new("", head, rows.iter().map(compared).chain([of_reference]))
}

/// A cell with the name of its column.
type Cell = (&'static str, String);

/// One row per setting: its parameters, its cost, the errors of every output, and for every limit state the effect on the
/// reliability. Shares and relative errors are plain numbers; an unknown value is empty.
fn settings_csv(scene: &Scene, rows: &[SettingComparison]) -> String {
    let total = (scene.limit_states.len() > 1).then_some("total");
    let states: Vec<&str> = scene.limit_states.iter().map(|limit| limit.name.as_str()).chain(total).collect();
    let cells = |row: &SettingComparison| -> Vec<(String, String)> {
        let own = setting_cells(row).map(|(column, cell)| (column.to_owned(), cell));
        let of = |name: &str, cells: &[Cell]| {
            cells.iter().map(|(column, cell)| (format!("{name}_{column}"), cell.clone())).collect::<Vec<_>>()
        };
        let outputs = scene.outputs.iter().enumerate();
        let outputs = outputs.flat_map(|(k, output)| of(&output.name, &output_cells(row.outputs.get(k))));
        let life = |name: &str| row.lives.iter().find(|life| life.limit_state == name);
        let lives = states.iter().flat_map(|name| of(name, &life_cells(life(name))));
        own.into_iter().chain(outputs).chain(lives).collect()
    };
    let rows: Vec<_> = rows.iter().map(cells).collect();
    let columns = rows.first().into_iter().flatten().map(|(column, _)| column);
    csv(columns, rows.iter().map(|row| row.iter().map(|(_, cell)| cell)))
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
    let mut rows = Vec::new();
    for (setting, points) in settings.iter().zip(&measurement.settings) {
        for (point, (measured, reference)) in points.iter().zip(&measurement.reference).enumerate() {
            let (Ok(found), Ok(reference)) = (&measured.outcome, &reference.outcome) else { continue };
            for (k, output) in scene.outputs.iter().enumerate() {
                let unit = output.kind.unit();
                for (n, cycles) in found.cycles.iter().enumerate() {
                    let own =
                        [&setting.name, &point.to_string(), &output.name, unit.suffix(), &cycles.to_string()];
                    let values = [found.histories[k][n], reference.histories[k][n], found.errors[k][n]];
                    let values = values.map(|si| format!("{:e}", unit.to_file(si)));
                    rows.push([own.map(str::to_owned).as_slice(), values.as_slice()].concat());
                }
            }
        }
    }
    csv(columns, rows)
}
