//! The trade-off as a table, as CSV, and as one figure an output.

use super::Row;
use crate::report::palette::Ink;
use crate::report::{Figure, Plot, PlotError, Series, Shape, standalone};
use common::scene::Scene;
use std::fmt::Write;

/// Errors below this are drawn at it [1].
const LEAST: f64 = 1e-7;

/// A Markdown table: a row per setting, from the quickest to the slowest.
pub fn table(scene: &Scene, rows: &[Row], points: usize) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = table_into(&mut out, scene, rows, points);
    out
}

fn table_into(out: &mut String, scene: &Scene, rows: &[Row], points: usize) -> std::fmt::Result {
    writeln!(out, "Accuracy settings of `{}`, against `reference`, at {points} points.\n", scene.name)?;
    writeln!(
        out,
        "Error: largest difference over all points and checkpoints, of the threshold of the output's limit state or of its \
         largest value. Life: by how much the life at which that threshold is reached is displaced at most. Stated: share \
         of the values within the error that the evaluation states of itself, and within twice that. A star marks \
         settings that no other beats in both time and error.\n"
    )?;
    write!(out, "| setting | s | steps |")?;
    for output in &scene.outputs {
        write!(out, " {} | life | stated |", output.name)?;
    }
    writeln!(out, "\n|---|---|---|{}", "---|---|---|".repeat(scene.outputs.len()))?;
    for row in by_time(rows) {
        let star = if row.efficient { " *" } else { "" };
        let name =
            if row.setting.preset { format!("**{}**", row.setting.name) } else { row.setting.name.clone() };
        write!(out, "| {name}{star} | {:.3} | {:.0} |", row.seconds, row.steps)?;
        if row.outputs.is_empty() {
            write!(out, "{}", " failed | | |".repeat(scene.outputs.len()))?;
        }
        for o in &row.outputs {
            let life = o.life.map_or_else(|| "-".to_owned(), |cycles| format!("{cycles:.0} cycles"));
            write!(
                out,
                " {:.3} % | {life} | {:.0} %, {:.0} % |",
                100.0 * o.relative,
                100.0 * o.within,
                100.0 * o.within_twice
            )?;
        }
        writeln!(out)?;
        if row.failures > 0 && !row.outputs.is_empty() {
            writeln!(out, "| ({} points failed) |", row.failures)?;
        }
    }
    Ok(())
}

fn by_time(rows: &[Row]) -> Vec<&Row> {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    sorted
}

/// The same for programs, with the knobs of every setting.
pub fn csv(scene: &Scene, rows: &[Row]) -> String {
    let mut out = String::from(
        "setting,step_tolerance,largest_step,wear_samples,cycle_jump,wear_tolerance,warm_up,seconds,steps,failures,efficient",
    );
    for output in &scene.outputs {
        let name = &output.name;
        out.push_str(&format!(",{name}_error,{name}_life_cycles,{name}_within,{name}_within_twice"));
    }
    out.push('\n');
    for row in rows {
        let a = &row.setting.accuracy;
        out.push_str(&format!(
            "\"{}\",{:e},{:e},{},{},{:e},{},{:e},{},{},{}",
            row.setting.name,
            a.step_tolerance,
            a.largest_step,
            a.wear_samples,
            a.cycle_jump,
            a.wear_tolerance,
            a.warm_up,
            row.seconds,
            row.steps,
            row.failures,
            row.efficient
        ));
        for k in 0..scene.outputs.len() {
            match row.outputs.get(k) {
                Some(o) => {
                    let life = o.life.map_or_else(String::new, |cycles| cycles.to_string());
                    out.push_str(&format!(",{:e},{life},{},{}", o.relative, o.within, o.within_twice));
                }
                None => out.push_str(",,,,"),
            }
        }
        out.push('\n');
    }
    out
}

/// One figure an output: time of an evaluation against its error, both by powers of ten, as (name, SVG).
///
/// # Errors
/// [`PlotError`].
pub fn figures(scene: &Scene, rows: &[Row]) -> Result<Vec<(String, String)>, PlotError> {
    let drawn: Vec<&Row> = by_time(rows).into_iter().filter(|row| !row.outputs.is_empty()).collect();
    let mut all = Vec::new();
    for (k, output) in scene.outputs.iter().enumerate() {
        let at = |row: &Row| (row.seconds.log10(), row.outputs[k].relative.max(LEAST).log10());
        let mut front: Vec<(f64, f64)> = Vec::new();
        for row in &drawn {
            if front.last().is_none_or(|last| at(row).1 < last.1) {
                front.push(at(row));
            }
        }
        let mut series = vec![Series::new("no other is quicker and nearer", Ink::Muted, Shape::Line(front))];
        let others = drawn.iter().filter(|row| !row.setting.preset);
        series.extend(others.map(|row| Series::new("", Ink::Series(0), Shape::Dotted(vec![at(row)]))));
        let presets = drawn.iter().filter(|row| row.setting.preset).enumerate();
        series.extend(presets.map(|(n, row)| {
            Series::new(row.setting.name.clone(), Ink::Series(n + 1), Shape::Dotted(vec![at(row)]))
        }));
        let range = |of: &dyn Fn(&Row) -> f64| {
            let values = drawn.iter().map(|row| of(row));
            let (low, high) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            if low <= high { (low - 0.1, high + 0.1) } else { (-1.0, 1.0) }
        };
        let figure = format!("tradeoff-{}", output.name);
        let error = format!("error of {}, share of its limit", output.name);
        let plot = Plot {
            figure: &figure,
            x_label: "time of an evaluation on one core, log10 of seconds",
            y_label: &error,
            x: range(&|row| at(row).0),
            y: range(&|row| at(row).1),
            y_text: &|v| format!("{:.1e}", 10f64.powf(v)),
            series: &series,
        };
        let (title, caption) = (error.clone(), String::new());
        let drawn = Figure { name: figure.clone(), title, caption, svg: plot.svg()? };
        all.push((figure.clone(), standalone(&drawn)));
    }
    Ok(all)
}
