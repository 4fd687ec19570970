//! One figure per output: time of an evaluation against its error, with the Pareto front.

use super::compare::SettingComparison;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::{Axis, Plot, PlotError, Scale, Series, Shape, standalone};
use common::scene::Scene;

/// Smallest error on the logarithmic axis [1]; smaller ones are drawn there.
const LEAST: f64 = 1e-7;

/// One figure per output with logarithmic axes, as (name, SVG).
///
/// # Errors
/// [`PlotError`].
pub fn figures(scene: &Scene, rows: &[SettingComparison]) -> Result<Vec<(String, String)>, PlotError> {
    let mut drawn: Vec<&SettingComparison> = rows.iter().filter(|row| !row.outputs.is_empty()).collect();
    drawn.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let all = scene.outputs.iter().enumerate();
    all.map(|(k, output)| {
        let name = format!("tradeoff-{}", output.name);
        let svg = figure(&name, &output.name, k, &drawn)?;
        Ok((name, svg))
    })
    .collect()
}

/// The figure of output `k`; `rows` from the fastest to the slowest.
fn figure(name: &str, output: &str, k: usize, rows: &[&SettingComparison]) -> Result<String, PlotError> {
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
        figure: name,
        x: Axis { text: power_of_ten, scale: Scale::Logarithm, ..x },
        y: Axis { text: |v| power_of_ten(v + 2.0), scale: Scale::LogarithmOfShare, ..y },
        series: &series,
    };
    Ok(standalone(&plot.figure(&title, "")?))
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
