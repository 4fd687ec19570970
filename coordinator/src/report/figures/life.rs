//! Figures over the life of the mechanism: reliability, outputs, their distributions late in life.

use super::{Figure, LifeAxis, capital, figure, file_name, ink_of, words};
use crate::output_unit::OutputUnit;
use crate::report::format::{count, fixed, three_digits};
use crate::report::input::{LimitStateInfo, OutputDistribution, ReportInput};
use crate::report::life::{governing, rows_that_matter};
use crate::report::palette::Ink;
use crate::report::plot::{Plot, PlotError, Series, Shape, short};
use crate::summary::ReliabilityRow;
use common::scene::Fails;

/// Reliability over life per limit state and in total, with bands of 1.96 standard errors.
///
/// # Errors
/// [`PlotError`].
pub fn reliability(input: &ReportInput) -> Result<Option<Figure>, PlotError> {
    if input.summary.is_static() {
        return Ok(None);
    }
    let rows = rows_that_matter(&input.summary, 3);
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Ok(None) };
    let axis = LifeAxis::of(input);
    let mut names: Vec<&str> = input.limit_states.iter().map(|state| state.name.as_str()).collect();
    if names.len() != 1 {
        names.push("total");
    }
    let value = |row: &ReliabilityRow, name: &str| row.reliability.get(name).copied().unwrap_or(f64::NAN);
    let mut series = Vec::new();
    for name in &names {
        let band = rows
            .iter()
            .map(|row| {
                let (r, error) = (value(row, name), row.standard_error.get(*name).copied().unwrap_or(0.0));
                (axis.at(row.cycles), (r - 1.96 * error).max(0.0), (r + 1.96 * error).min(1.0))
            })
            .collect();
        series.push(Series::new("", ink_of(input, name), Shape::Band(band)));
    }
    for name in &names {
        let points = rows.iter().map(|row| (axis.at(row.cycles), value(row, name))).collect();
        let shape = if *name == "total" { Shape::Dashed(points) } else { Shape::Line(points) };
        series.push(Series::new(*name, ink_of(input, name), shape));
    }
    let svg = Plot {
        figure: "reliability",
        x_label: axis.label,
        y_label: "reliability R",
        x: (axis.at(first.cycles), axis.at(last.cycles)),
        y: (0.0, 1.0),
        x_text: &short,
        y_text: &short,
        series: &series,
    }
    .svg()?;
    let caption = format!(
        "Probability that no failure has occurred up to this life, per limit state and for the whole {}, which fails by \
         whichever comes first. Bands: 1.96 standard errors, sampling and surrogate together; what numerical errors of the \
         simulations can do is shown further below.",
        input.subject()
    );
    Ok(Some(figure("reliability", "Reliability over life", &caption, svg)))
}

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
        let svg = Plot {
            figure: &name,
            x_label: &unit.axis(&words(&output.name)),
            y_label: &density(unit),
            x: (low - 0.03 * (high - low), high + 0.03 * (high - low)),
            y: (0.0, 1.08 * top),
            x_text: &short,
            y_text: &short,
            series: &series,
        }
        .svg()?;
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
            "Over the whole population. Mean ± standard deviation: {} {}. {} the threshold of {} the {} has failed.",
            means.join(", "),
            if shown.len() == 1 && shown[0].cycles == 1 { "cycle" } else { "cycles" },
            if state.fails == Fails::Above { "Beyond" } else { "Below" },
            unit.after(&short(threshold)),
            input.subject()
        );
        figures.push(figure(
            &name,
            &capital(&if input.summary.is_static() {
                format!("distribution of {}", words(&output.name))
            } else {
                format!("{} late in life", words(&output.name))
            }),
            &caption,
            svg,
        ));
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

/// One figure per limit state: its output over the whole life, nominal mechanism and population.
///
/// # Errors
/// [`PlotError`].
pub fn histories(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    if input.summary.is_static() {
        return Ok(vec![]);
    }
    let axis = LifeAxis::of(input);
    let mut figures = Vec::new();
    for state in &input.limit_states {
        let output = &input.outputs[state.output];
        let unit = &output.unit;
        let threshold = unit.to_shown(state.threshold);
        let key = |what: &str| unit.key(&format!("{}_{what}", state.name));
        let band: Vec<_> = input
            .summary
            .moments
            .iter()
            .filter_map(|row| {
                let mean = unit.file_to_shown(*row.moments.get(&key("mean"))?);
                let spread = 2.0 * unit.file_to_shown(*row.moments.get(&key("std"))?);
                Some((axis.at(row.cycles), mean - spread, mean + spread))
            })
            .filter(|(_, low, high)| low.is_finite() && high.is_finite())
            .collect();
        let nominal: Vec<_> = input.nominal.as_ref().map_or(vec![], |nominal| {
            let history = nominal.histories.get(state.output).map_or(&[][..], Vec::as_slice);
            nominal.cycles.iter().zip(history).map(|(n, v)| (axis.at(*n), unit.to_shown(*v))).collect()
        });
        let last = nominal.last().map(|p| p.0).into_iter().chain(band.last().map(|p| p.0)).reduce(f64::max);
        let Some(last) = last else { continue };
        let values = nominal.iter().map(|p| p.1).chain(band.iter().flat_map(|p| [p.1, p.2]));
        let (low, high) = values.fold((threshold, threshold), |(low, high), v| (low.min(v), high.max(v)));
        let signed = threshold < 0.0 || nominal.iter().any(|p| p.1 < 0.0);
        let low = if low < 0.5 * high && !signed { 0.0 } else { low - 0.1 * (high - low) };
        let mut series = vec![Series::new("threshold", Ink::Limit, Shape::Level(threshold))];
        if !band.is_empty() {
            series.push(Series::new(
                "population, mean ± 2 std",
                ink_of(input, &state.name),
                Shape::Band(band),
            ));
        }
        if !nominal.is_empty() {
            series.push(Series::new("nominal", Ink::Ink, Shape::Line(nominal)));
        }
        let name = format!("history-{}", file_name(&state.name));
        let svg = Plot {
            figure: &name,
            x_label: axis.label,
            y_label: &unit.axis(&words(&output.name)),
            x: (0.0, last),
            y: (low, high + 0.05 * (high - low)),
            x_text: &short,
            y_text: &short,
            series: &series,
        }
        .svg()?;
        let caption = if input.summary.of_mechanism() {
            "Each value belongs to the profile worn to that many cycles. The nominal mechanism has every variable at its mean."
        } else {
            "The nominal system has every variable at its mean."
        };
        figures.push(figure(&name, &capital(&format!("{} over life", words(&output.name))), caption, svg));
    }
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::synthetic;

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
