//! Figures of the outputs: their distributions late in life, and how they move through life.

use super::{LifeAxis, capital, file_name, ink_of, words};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::format::{count, fixed, three_digits};
use crate::presentation::report::input::{LimitStateInfo, OutputDistribution, ReportInput};
use crate::presentation::report::life::governing;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Band, Plot, PlotError, Series, Shape, short};
use crate::results::output_unit::OutputUnit;
use crate::results::summary::StudySummary;
use common::scene::Fails;

/// One figure per limit state: its output's distribution at three checkpoints around the governing one.
///
/// # Errors
/// [`PlotError`].
pub fn distributions(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    let mut figures = Vec::new();
    for state in &input.limit_states {
        let shown = three_around_governing(input, state);
        if shown.is_empty() {
            continue;
        }
        let output = &input.outputs[state.output];
        let unit = &output.unit;
        let threshold = unit.to_shown(state.threshold);
        let mut series = Vec::new();
        let (mut low, mut high, mut top) = (threshold, threshold, 0.0_f64);
        for (k, distribution) in shown.iter().enumerate() {
            let all: u64 = distribution.counts.iter().sum();
            let bars: Vec<_> = distribution
                .edges
                .windows(2)
                .zip(&distribution.counts)
                .map(|(edges, count)| {
                    let (left, right) = (unit.to_shown(edges[0]), unit.to_shown(edges[1]));
                    (left, right, *count as f64 / (all.max(1) as f64 * (right - left)))
                })
                .filter(|(left, right, height)| right > left && height.is_finite())
                .collect();
            for (left, right, height) in &bars {
                (low, high, top) = (low.min(*left), high.max(*right), top.max(*height));
            }
            let at = format!("{} cycles", count(u64::from(distribution.cycles)));
            let label = if input.summary.is_static() { "population".to_owned() } else { at };
            series.push(Series::new(label, Ink::Series(k + 2), Shape::Steps(bars)));
        }
        series.push(Series::new("threshold", Ink::Limit, Shape::Upright(threshold)));
        let name = format!("distribution-{}", file_name(&state.name));
        let margin = 0.03 * (high - low);
        let labels = [unit.axis(&words(&output.name)), density(unit)];
        let plot = Plot {
            figure: &name,
            x: Axis::linear(&labels[0], (low - margin, high + margin)),
            y: Axis::linear(&labels[1], (0.0, 1.08 * top)),
            series: &series,
        };
        let means: Vec<String> = shown
            .iter()
            .map(|d| {
                format!(
                    "{} ± {} at {}",
                    in_short(unit, d.mean),
                    unit.after(&in_short(unit, d.std)),
                    count(d.cycles.into())
                )
            })
            .collect();
        let caption = format!(
            "{}. Mean ± standard deviation: {} {}. {} the threshold of {} the {} has failed.",
            capital(&origin(&input.summary)),
            means.join(", "),
            if shown.len() == 1 && shown[0].cycles == 1 { "cycle" } else { "cycles" },
            if state.fails == Fails::Above { "Beyond" } else { "Below" },
            unit.after(&short(threshold)),
            input.subject()
        );
        let title = if input.summary.is_static() {
            format!("distribution of {}", words(&output.name))
        } else {
            format!("{} late in life", words(&output.name))
        };
        figures.push(plot.figure(&capital(&title), &caption)?);
    }
    Ok(figures)
}

/// A mean or standard deviation: hundredths of the unit that this program chose, else three digits.
fn in_short(unit: &OutputUnit, value: f64) -> String {
    match unit {
        OutputUnit::External(_) => three_digits(value),
        own => fixed(own.to_shown(value), 2),
    }
}

/// What the axis of a density shows.
fn density(unit: &OutputUnit) -> String {
    if unit.symbol().is_empty() { "density".to_owned() } else { format!("density [1/({})]", unit.symbol()) }
}

/// Distributions of a limit state's output at the governing checkpoint and two checkpoints before and after,
/// the governing one being moved to a multiple of two checkpoints; or the three nearest there are.
fn three_around_governing<'a>(input: &'a ReportInput, state: &LimitStateInfo) -> Vec<&'a OutputDistribution> {
    let name = &input.outputs[state.output].name;
    let mut shown: Vec<&OutputDistribution> =
        input.distributions.iter().filter(|d| d.output == *name && d.edges.len() > 1).collect();
    shown.sort_by_key(|d| d.cycles);
    let Some(governing) = governing(&input.summary) else { return shown.into_iter().take(3).collect() };
    let every = input.summary.reliability.first().map_or(1, |row| row.cycles).max(1);
    let centre = (governing.cycles + every) / (2 * every) * (2 * every);
    let wanted = [centre.saturating_sub(2 * every), centre, centre + 2 * every];
    let exact: Vec<_> = shown.iter().copied().filter(|d| wanted.contains(&d.cycles)).collect();
    if exact.len() == 3 {
        return exact;
    }
    shown.sort_by_key(|d| (d.cycles.abs_diff(centre), d.cycles));
    shown.truncate(3);
    shown.sort_by_key(|d| d.cycles);
    shown
}

/// One figure per limit state: its output over the whole life, of the nominal mechanism and of the population.
///
/// # Errors
/// [`PlotError`].
pub fn histories(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    if input.summary.is_static() {
        return Ok(vec![]);
    }
    let axis = LifeAxis::of(&input.summary);
    let mut figures = Vec::new();
    for state in &input.limit_states {
        let output = &input.outputs[state.output];
        let unit = &output.unit;
        let threshold = unit.to_shown(state.threshold);
        let nominal: Vec<_> = input.nominal.as_ref().map_or(vec![], |nominal| {
            let history = nominal.histories.get(state.output).map_or(&[][..], Vec::as_slice);
            nominal.cycles.iter().zip(history).map(|(n, v)| (axis.at(*n), unit.to_shown(*v))).collect()
        });
        let bands = spread(input, state, &axis);
        let of_bands = bands.iter().flat_map(|(_, band)| band);
        let ends = nominal.last().map(|p| p.0).into_iter().chain(of_bands.clone().map(|p| p.0));
        let Some(last) = ends.reduce(f64::max) else { continue };
        let values = nominal.iter().map(|p| p.1).chain(of_bands.flat_map(|p| [p.1, p.2]));
        let (low, high) = values.fold((threshold, threshold), |(low, high), v| (low.min(v), high.max(v)));
        let signed = threshold < 0.0 || nominal.iter().any(|p| p.1 < 0.0);
        let low = if low < 0.5 * high && !signed { 0.0 } else { low - 0.1 * (high - low) };
        let caption = format!(
            "{} The nominal {} has every variable at its mean{}.",
            if bands.is_empty() {
                String::new()
            } else {
                format!("Bands: how many of a hundred lie within, {}.", origin(&input.summary))
            },
            input.subject(),
            if input.summary.of_mechanism() {
                "; each value belongs to the profile worn to that many cycles"
            } else {
                ""
            }
        );
        let mut series = vec![Series::new("threshold", Ink::Limit, Shape::Level(threshold))];
        let ink = ink_of(&input.summary, &state.name);
        series.extend(bands.into_iter().map(|(label, band)| Series::new(label, ink, Shape::Band(band))));
        if !nominal.is_empty() {
            series.push(Series::new("nominal", Ink::Ink, Shape::Line(nominal)));
        }
        let name = format!("history-{}", file_name(&state.name));
        let label = unit.axis(&words(&output.name));
        let plot = Plot {
            figure: &name,
            x: Axis::linear(axis.label, (0.0, last)),
            y: Axis::linear(&label, (low, high + 0.05 * (high - low))),
            series: &series,
        };
        figures
            .push(plot.figure(&capital(&format!("{} through life", words(&output.name))), caption.trim())?);
    }
    Ok(figures)
}

/// Pairs of probabilities between which a band lies, and its label.
const BANDS: [(f64, f64, &str); 2] = [(0.01, 0.99, "98 of 100"), (0.25, 0.75, "50 of 100, darker")];

/// Bands of quantiles of a limit state's output over life, the widest first, as (label, points); empty where the
/// study kept no distributions.
fn spread(input: &ReportInput, state: &LimitStateInfo, axis: &LifeAxis) -> Vec<(&'static str, Band)> {
    let output = &input.outputs[state.output];
    let mut at: Vec<_> = input.distributions.iter().filter(|d| d.output == output.name).collect();
    at.sort_by_key(|d| d.cycles);
    let quantile = |d: &OutputDistribution, p: f64| {
        let found = d.quantiles.iter().find(|(probability, _)| (probability - p).abs() < 1e-9)?;
        Some(output.unit.to_shown(found.1)).filter(|value| value.is_finite())
    };
    let band = |(low, high, label): (f64, f64, &'static str)| {
        let point =
            |d: &&OutputDistribution| Some((axis.at(d.cycles), quantile(d, low)?, quantile(d, high)?));
        (label, at.iter().filter_map(point).collect::<Band>())
    };
    BANDS.map(band).into_iter().filter(|(_, band)| band.len() > 1).collect()
}

/// Whose values a distribution holds.
fn origin(summary: &StudySummary) -> String {
    let of = |what: String| format!("{what} of {} {}s", count(summary.population as u64), summary.subject());
    if summary.method == "ak" {
        of("as the surrogates predict it for the population".into())
    } else {
        of("as simulated, for all".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::synthetic;

    #[test]
    fn the_three_checkpoints_straddle_the_governing_one() {
        let input = synthetic::input();
        let shown = three_around_governing(&input, &input.limit_states[1]);
        assert_eq!(shown.iter().map(|d| d.cycles).collect::<Vec<_>>(), [64_000, 66_000, 68_000]);
        let mut few = input.clone();
        few.distributions.retain(|d| d.cycles == 10_000 || d.cycles >= 69_000);
        let shown = three_around_governing(&few, &few.limit_states[0]);
        assert_eq!(shown.iter().map(|d| d.cycles).collect::<Vec<_>>(), [69_000, 70_000, 71_000]);
    }
}
