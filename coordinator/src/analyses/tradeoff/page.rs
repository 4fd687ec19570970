//! The trade-off with its tables: cost and error, validity of the stated errors, and reliability.

use super::compare::{OutputError, SettingComparison};
use super::csv::csv;
use super::lives::{LEVELS, LifeChange};
use super::stated::{REQUIRED_SHARE, StatedErrorCheck, TIMES};
use crate::presentation::report::answer::{Answer, AnswerPart, Table};
use crate::presentation::report::palette::Ink;
use crate::presentation::report::{Axis, Figure, Plot, PlotError, Scale, Series, Shape, standalone};
use common::scene::Scene;

/// Three tables, each with a row per setting from the fastest to the slowest; `points`: number of points measured.
///
/// # Errors
/// [`PlotError`].
pub fn answer(
    scene: &Scene,
    rows: &[SettingComparison],
    reference: &SettingComparison,
    points: usize,
) -> Result<Answer, PlotError> {
    let mut sorted: Vec<&SettingComparison> = rows.iter().collect();
    sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let with_reference: Vec<&SettingComparison> = sorted.iter().copied().chain([reference]).collect();
    let errors = "Error: largest difference over all points and checkpoints, relative to the threshold of the output's limit state or \
         to its largest value; in brackets, only up to where the reference reaches that limit. Life: largest change of the \
         life at which the limit is reached. A star marks the Pareto front of time and error. The last row is the \
         reference with its own stated error. All have the control points of the scene: what more of them change is not in these errors.";
    let mut parts = vec![
        AnswerPart::Figures,
        AnswerPart::Text(errors.to_owned()),
        AnswerPart::Table(cost_and_error(scene, &with_reference)),
    ];
    let failed = rows.iter().chain([reference]).filter(|row| row.failures > 0);
    let failed: Vec<String> = failed.map(|row| format!("{} at {}", row.setting.name, row.failures)).collect();
    if !failed.is_empty() {
        let text = format!("Without a result, and excluded there: {} of {points} points.", failed.join(", "));
        parts.push(AnswerPart::Text(text));
    }
    parts.push(AnswerPart::Text(format!(
        "Stated errors: share of the values whose true error is within the stated one, and within {TIMES} times the stated \
         one, which must hold for {:.0} %; median and 95 % quantile of true over stated error; number of values beyond \
         {TIMES} times the stated error in the first, second and last third of life, and number of points with such \
         values; the worst of them.",
        100.0 * REQUIRED_SHARE
    )));
    parts.push(AnswerPart::Table(stated(scene, &sorted)));
    if let Some(first) = rows.iter().find_map(|row| row.lives.first()) {
        parts.push(AnswerPart::Text(format!(
            "Reliability: share of the {} random points that fail at another checkpoint than with the reference, and reliability \
             R of these points minus that of the reference: where it differs most, and where R of the reference is nearest \
             {}, {} and {}.",
            first.points, LEVELS[0], LEVELS[1], LEVELS[2]
        )));
        parts.push(AnswerPart::Table(reliability(&sorted)));
    }
    let figures = figures(scene, rows)?;
    let drawings = figures.iter().map(|figure| (format!("{}.svg", figure.name), standalone(figure)));
    Ok(Answer {
        name: "tradeoff",
        title: format!("Accuracy settings of `{}`, against `reference`, at {points} points", scene.name),
        parts,
        files: drawings.chain([("tradeoff.csv".to_owned(), csv(scene, rows))]).collect(),
        figures,
        prints_markdown: true,
        ..Answer::default()
    })
}

fn shown_name(row: &SettingComparison) -> String {
    let name = &row.setting.name;
    let name = if row.setting.is_preset() { format!("**{name}**") } else { name.clone() };
    if row.efficient { format!("{name} *") } else { name }
}

fn cost_and_error(scene: &Scene, rows: &[&SettingComparison]) -> Table {
    let columns = scene.outputs.iter().flat_map(|output| [output.name.as_str(), "life"]);
    let percent = |share: f64| format!("{:.3} %", 100.0 * share);
    let of_output = |o: &OutputError| {
        let life = o.life.map_or_else(|| "-".to_owned(), |cycles| format!("{cycles:.0} cycles"));
        let (all, until) = (percent(o.relative), percent(o.until_limit));
        [if all == until { all } else { format!("{all} ({until})") }, life]
    };
    let row = |row: &&SettingComparison| {
        let [steps, cycles] = [row.steps, row.cycles].map(|count| format!("{count:.0}"));
        let mut cells = vec![shown_name(row), format!("{:.3}", row.seconds), steps, cycles];
        for k in 0..scene.outputs.len() {
            let failed = || ["failed".to_owned(), String::new()];
            cells.extend(row.outputs.get(k).map_or_else(failed, of_output));
        }
        cells
    };
    Table::new("", ["setting", "s", "steps", "cycles"].into_iter().chain(columns), rows.iter().map(row))
}

/// Validity of the stated errors.
fn stated(scene: &Scene, rows: &[&SettingComparison]) -> Table {
    let cells = |setting: &str, name: &str, s: &StatedErrorCheck| {
        let [first, second, last] = s.missed;
        vec![
            setting.to_owned(),
            name.to_owned(),
            format!("{:.1} %", 100.0 * s.within),
            format!("{:.1} %", 100.0 * s.within_twice),
            if s.holds() { "holds" } else { "DOES NOT HOLD" }.to_owned(),
            format!("{:.3}", s.median_ratio),
            format!("{:.3}", s.ratio_95),
            format!("{first}, {second}, {last} of {}", s.values),
            s.points_missed.to_string(),
            s.worst.map_or_else(
                || "-".to_owned(),
                |w| format!("{:.2} times, point {}, {} cycles", w.ratio(), w.point, w.cycles),
            ),
        ]
    };
    let of_setting = |row: &&SettingComparison| {
        let each = scene.outputs.iter().zip(&row.outputs).map(|(o, e)| (o.name.as_str(), &e.stated));
        let all = (row.outputs.len() > 1).then_some(("all", &row.stated));
        each.chain(all).map(|(name, s)| cells(&row.setting.name, name, s)).collect::<Vec<_>>()
    };
    let head = "setting | output | within | within twice |  | median | 95 % | missed by thirds of life | points | worst".split(" | ");
    Table::new("", head, rows.iter().flat_map(of_setting))
}

/// Effect of the errors on the reliability.
fn reliability(rows: &[&SettingComparison]) -> Table {
    let of_setting = |row: &&SettingComparison| {
        let name = row.setting.name.clone();
        let cells = move |life: &LifeChange| {
            let changed = format!("{:.1} %", 100.0 * life.changed);
            let largest = format!("{:+.2} at {}", life.largest.difference(), life.largest.cycles);
            let levels = life.at_levels.map(|level| {
                level.map_or("-".to_owned(), |r| {
                    format!("{:+.3} ({:.2} at {})", r.difference(), r.reference, r.cycles)
                })
            });
            [vec![name.clone(), life.limit_state.clone(), changed, largest], levels.to_vec()].concat()
        };
        row.lives.iter().map(cells).collect::<Vec<_>>()
    };
    let head = ["setting", "limit state", "lives changed", "largest"].map(str::to_owned);
    let levels = LEVELS.map(|level| format!("at R = {level}"));
    Table::new("", head.into_iter().chain(levels), rows.iter().flat_map(of_setting))
}

/// Smallest error on the logarithmic axis [1]; smaller ones are drawn there.
const LEAST: f64 = 1e-7;

/// One figure per output with logarithmic axes.
///
/// # Errors
/// [`PlotError`].
fn figures(scene: &Scene, rows: &[SettingComparison]) -> Result<Vec<Figure>, PlotError> {
    let mut drawn: Vec<&SettingComparison> = rows.iter().filter(|row| !row.outputs.is_empty()).collect();
    drawn.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let all = scene.outputs.iter().enumerate();
    all.map(|(k, output)| figure(&output.name, k, &drawn)).collect()
}

/// The figure of output `k`; `rows` from the fastest to the slowest.
fn figure(output: &str, k: usize, rows: &[&SettingComparison]) -> Result<Figure, PlotError> {
    let point =
        |row: &SettingComparison| (row.seconds.max(1e-6).log10(), row.outputs[k].relative.max(LEAST).log10());
    let mut front: Vec<(f64, f64)> = Vec::new();
    for row in rows {
        if front.last().is_none_or(|last| point(row).1 < last.1) {
            front.push(point(row));
        }
    }
    let others = rows.iter().filter(|row| !row.setting.is_preset()).map(|row| (point(row), String::new()));
    let presets = rows.iter().filter(|row| row.setting.is_preset());
    let presets = presets.map(|row| (point(row), row.setting.name.clone())).collect();
    let series = [
        Series::new("Pareto front", Ink::Muted, Shape::Line(front)),
        Series::new("settings", Ink::Series(0), Shape::Marked(others.collect())),
        Series::new("presets", Ink::Series(1), Shape::Marked(presets)),
    ];
    let range = |coordinate: fn((f64, f64)) -> f64| {
        let values = rows.iter().map(|row| coordinate(point(row)));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if low <= high { (low - 0.1, high + 0.15) } else { (-1.0, 1.0) }
    };
    let title = format!("error of {output} [% of its limit]");
    let x = Axis::linear("time of an evaluation on one core [s]", range(|point| point.0));
    let y = Axis::linear(&title, range(|point| point.1));
    let plot = Plot {
        figure: &format!("tradeoff-{output}"),
        x: Axis { text: power_of_ten, scale: Scale::Logarithm, ..x },
        y: Axis { text: |v| power_of_ten(v + 2.0), scale: Scale::LogarithmOfShare, ..y },
        series: &series,
    };
    plot.figure(&title, "")
}

/// 10 to this power with two digits, e.g. 0.032, 1, 3.2, 32.
fn power_of_ten(log: f64) -> String {
    let value = 10f64.powf(log);
    let decimals = (1.0 - log.floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_two_digits() {
        let found = [-2.0, -1.5, 0.0, 0.5, 1.5, 3.0].map(power_of_ten);
        assert_eq!(found, ["0.01", "0.032", "1", "3.2", "32", "1000"]);
    }
}
