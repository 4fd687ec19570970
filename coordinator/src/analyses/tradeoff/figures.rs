//! One figure an output: time of an evaluation against its error, with the front that nothing beats.

use super::compare::Row;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::{Axis, Plot, PlotError, Series, Shape, standalone};
use common::scene::Scene;

/// Errors below this are drawn at it [1].
const LEAST: f64 = 1e-7;

/// One figure an output, both axes by powers of ten, as (name, SVG).
///
/// # Errors
/// [`PlotError`].
pub fn figures(scene: &Scene, rows: &[Row]) -> Result<Vec<(String, String)>, PlotError> {
    let mut drawn: Vec<&Row> = rows.iter().filter(|row| !row.outputs.is_empty()).collect();
    drawn.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let all = scene.outputs.iter().enumerate();
    all.map(|(k, output)| {
        let name = format!("tradeoff-{}", output.name);
        let svg = figure(&name, &output.name, k, &drawn)?;
        Ok((name, svg))
    })
    .collect()
}

/// The figure of output `k`; `rows` from the quickest to the slowest.
fn figure(name: &str, output: &str, k: usize, rows: &[&Row]) -> Result<String, PlotError> {
    let at = |row: &Row| (row.seconds.max(1e-6).log10(), row.outputs[k].relative.max(LEAST).log10());
    let mut front: Vec<(f64, f64)> = Vec::new();
    for row in rows {
        if front.last().is_none_or(|last| at(row).1 < last.1) {
            front.push(at(row));
        }
    }
    let others = rows.iter().filter(|row| !row.setting.is_preset()).map(|row| (at(row), String::new()));
    let presets = rows.iter().filter(|row| row.setting.is_preset());
    let presets = presets.map(|row| (at(row), row.setting.name.clone())).collect();
    let series = [
        Series::new("no other is quicker and nearer", Ink::Muted, Shape::Line(front)),
        Series::new("settings", Ink::Series(0), Shape::Marked(others.collect())),
        Series::new("presets", Ink::Series(1), Shape::Marked(presets)),
    ];
    let range = |of: fn((f64, f64)) -> f64| {
        let values = rows.iter().map(|row| of(at(row)));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if low <= high { (low - 0.1, high + 0.15) } else { (-1.0, 1.0) }
    };
    let title = format!("error of {output} [% of its limit]");
    let x = Axis::linear("time of an evaluation on one core [s]", range(|at| at.0));
    let y = Axis::linear(&title, range(|at| at.1));
    let plot = Plot {
        figure: name,
        x: Axis { text: power_of_ten, value: |v| 10f64.powf(v), ..x },
        y: Axis { text: |v| power_of_ten(v + 2.0), value: |v| 10f64.powf(v + 2.0), ..y },
        series: &series,
    };
    Ok(standalone(&plot.figure(&title, "")?))
}

/// The number of which this is the decimal logarithm, with two digits: 0.032, 1, 3.2, 32.
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
