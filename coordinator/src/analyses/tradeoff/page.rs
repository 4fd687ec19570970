//! The trade-off as one table: cost, error of every output, validity of the stated errors, and effect on the reliability.

use super::compare::{OutputError, SettingComparison};
use super::csv::csv;
use super::stated::{REQUIRED_SHARE, TIMES};
use crate::presentation::report::answer::{Answer, AnswerPart, Table};
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
    let text = format!(
        "Error: largest difference over all points and checkpoints, relative to the threshold of the output's limit state or to its largest \
         value; in brackets, only up to where the reference reaches that limit. Life: largest change of the life at which the limit is \
         reached. Stated: share of all values whose true error is within {TIMES} times the stated one, which must hold for {:.0} %. R: \
         largest change of the reliability of the random points by any limit state or by all. A star marks the Pareto front of time and \
         error. The last row is the reference with its own stated error. All have the control points of the scene: what more of them \
         change is not in these errors.",
        100.0 * REQUIRED_SHARE
    );
    let mut parts = vec![AnswerPart::Text(text), AnswerPart::Table(table(scene, &sorted, reference))];
    let failed = rows.iter().chain([reference]).filter(|row| row.failures > 0);
    let failed: Vec<String> = failed.map(|row| format!("{} at {}", row.setting.name, row.failures)).collect();
    if !failed.is_empty() {
        let text = format!("Without a result, and excluded there: {} of {points} points.", failed.join(", "));
        parts.push(AnswerPart::Text(text));
    }
    Answer {
        name: "tradeoff".to_owned(),
        title: format!("Accuracy settings of `{}`, against `reference`, at {points} points", scene.name),
        parts,
        files: vec![("tradeoff.csv".to_owned(), csv(scene, rows))],
        prints_markdown: true,
        ..Answer::default()
    }
}

fn shown_name(row: &SettingComparison) -> String {
    let name = &row.setting.name;
    let name = if row.setting.is_preset() { format!("**{name}**") } else { name.clone() };
    if row.efficient { format!("{name} *") } else { name }
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
        let mut cells = vec![shown_name(row), format!("{:.3}", row.seconds), steps, cycles];
        for k in 0..scene.outputs.len() {
            let failed = || ["failed".to_owned(), String::new()];
            cells.extend(row.outputs.get(k).map_or_else(failed, of_output));
        }
        cells
    };
    let compared = |row: &&SettingComparison| {
        let stated = if row.stated.holds() { "" } else { ", DOES NOT HOLD" };
        let changes = row.lives.iter().map(|life| life.largest.difference());
        let largest = changes.max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let last = [
            format!("{:.1} %{stated}", 100.0 * row.stated.within_twice),
            largest.map_or("-".to_owned(), |change| format!("{change:+.2}")),
        ];
        [own(row), last.to_vec()].concat()
    };
    let of_reference = [own(reference), vec![String::new(); 2]].concat();
    let columns = scene.outputs.iter().flat_map(|output| [output.name.as_str(), "life"]);
    let head = ["setting", "s", "steps", "cycles"].into_iter().chain(columns).chain(["stated", "R"]);
    Table::new("", head, rows.iter().map(compared).chain([of_reference]))
}
