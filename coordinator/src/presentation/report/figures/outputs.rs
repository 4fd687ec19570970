//! Figures of the outputs: their distributions late in life, and their course over life.

use super::{LifeAxis, capital, file_name, ink_of, range};
use crate::presentation::report::format::{
    count, exactly_with_unit, fixed, joined, number_of_cycles, three_digits,
};
use crate::presentation::report::life::governing;
use crate::presentation::report::{
    Axis, Band, CheckpointDistribution, Figure, Ink, Plot, Points, ReportInput, Series, Shape,
};
use crate::results::summary::StudySummary;
use common::scene::{Fails, LimitState, OutputUnit};

/// Two figures per limit state: density and cumulative distribution of its output at three checkpoints around the governing one.
pub fn distributions(input: &ReportInput) -> Vec<Figure> {
    let drawn = input.scene.limit_states.iter().map(|state| (state, three_around_governing(input, state)));
    let drawn = drawn.filter(|(_, shown)| !shown.is_empty());
    drawn
        .flat_map(|(state, shown)| [false, true].map(|sum| distribution(input, state, &shown, sum)))
        .collect()
}

/// The densities of one limit state's output, or their `sum`, with its threshold; in the caption their origin, means and standard
/// deviations, and the side of the threshold on which failure lies.
fn distribution(
    input: &ReportInput,
    state: &LimitState,
    shown: &[&CheckpointDistribution],
    sum: bool,
) -> Figure {
    let (output, unit) = (input.output_of(state), &input.unit_of(state));
    let thresholds: Vec<f64> = state.thresholds().into_iter().map(|si| unit.to_shown(si)).collect();
    let mut series = Vec::new();
    let (mut low, mut high) = range(thresholds.iter().copied());
    let (mut top, is_static) = (0.0_f64, input.summary.is_static());
    for (k, distribution) in shown.iter().enumerate() {
        let bars = densities(distribution, unit);
        for (left, right, height) in &bars {
            (low, high, top) = (low.min(*left), high.max(*right), top.max(*height));
        }
        let cycles = number_of_cycles(distribution.cycles);
        let label = if is_static { "population".to_owned() } else { cycles };
        let shape = if sum { Shape::Line(cumulated(&bars)) } else { Shape::Steps(bars) };
        series.push(Series::new(label, Ink::Series(k + 2), shape));
    }
    series.extend(threshold_lines(state, unit, Shape::Upright));
    let name = format!("{}-{}", if sum { "cumulative" } else { "distribution" }, file_name(&state.name));
    let margin = 0.03 * (high - low);
    let (of_share, top) =
        if sum { ("share of the population".to_owned(), 1.0) } else { (density(unit), top) };
    let labels = [unit.axis(&output), of_share];
    let x = Axis::linear(&labels[0], (low - margin, high + margin));
    let y = Axis::linear(&labels[1], (0.0, 1.08 * top));
    let late = format!("{output} late in life");
    let title = if is_static { format!("distribution of {output}") } else { late };
    let title = if sum { format!("{title}, cumulative") } else { title };
    let moments = shown.iter().map(|distribution| {
        let [mean, std] = [distribution.mean, distribution.std].map(|si| moment(unit, si));
        format!("{mean} ± {} at {}", unit.after(&std), count(distribution.cycles.into()))
    });
    let caption = format!(
        "{}. Mean ± standard deviation: {} {}. {} the {} has failed.",
        capital(&origin(&input.summary)),
        joined(moments, ", "),
        if shown.len() == 1 && shown[0].cycles == 1 { "cycle" } else { "cycles" },
        beyond(state, unit),
        input.subject()
    );
    Plot { figure: &name, x, y, series: &series }.figure(&capital(&title), &caption)
}

/// Lines at the thresholds of a limit state, ascending.
fn threshold_lines(state: &LimitState, unit: &OutputUnit, line: fn(f64) -> Shape) -> Vec<Series> {
    let names: &[&str] =
        if state.middle().is_some() { &["lower threshold", "upper threshold"] } else { &["threshold"] };
    let thresholds = state.thresholds().into_iter().zip(names);
    thresholds.map(|(si, name)| Series::new(*name, Ink::Limit, line(unit.to_shown(si)))).collect()
}

/// Where failure lies, as the beginning of a sentence.
fn beyond(state: &LimitState, unit: &OutputUnit) -> String {
    let threshold = exactly_with_unit(unit, state.threshold);
    match state.fails {
        Fails::Above => format!("Above the threshold of {threshold}"),
        Fails::Below => format!("Below the threshold of {threshold}"),
        Fails::Outside { lower } => {
            format!("Below {} and above {threshold}", exactly_with_unit(unit, lower))
        }
    }
}

/// Probability density over each bin as (left, right, height), in the unit shown.
fn densities(distribution: &CheckpointDistribution, unit: &OutputUnit) -> Vec<(f64, f64, f64)> {
    let all: u64 = distribution.counts.iter().sum();
    let bins = distribution.edges.windows(2).zip(&distribution.counts);
    let bars = bins.map(|(edges, count)| {
        let (left, right) = (unit.to_shown(edges[0]), unit.to_shown(edges[1]));
        (left, right, *count as f64 / (all.max(1) as f64 * (right - left)))
    });
    bars.filter(|(left, right, height)| right > left && height.is_finite()).collect()
}

/// Share of the population at or below the ends of these bins `(left, right, height)`.
fn cumulated(bars: &[(f64, f64, f64)]) -> Points {
    let start = bars.first().map(|bar| (bar.0, 0.0));
    let mut share = 0.0;
    let ends = bars.iter().map(|(left, right, height)| {
        share += height * (right - left);
        (*right, share)
    });
    start.into_iter().chain(ends).collect()
}

/// A mean or standard deviation: with two decimals in a unit in which values are of the order of one to a hundred, else with three
/// digits.
fn moment(unit: &OutputUnit, value: f64) -> String {
    use OutputUnit::{Angle, AngularVelocity, Force, Length, Torque};
    match unit {
        Length | AngularVelocity | Angle | Force | Torque => fixed(unit.to_shown(value), 2),
        other => three_digits(other.to_shown(value)),
    }
}

/// Label of the axis of a density.
fn density(unit: &OutputUnit) -> String {
    match unit.symbol() {
        "" => "density".to_owned(),
        symbol if symbol.contains(['/', ' ', '*']) => format!("density [1/({symbol})]"),
        symbol => format!("density [1/{symbol}]"),
    }
}

/// Distributions of a limit state's output at the governing checkpoint and two checkpoints before and after,
/// the governing one being moved to a multiple of two checkpoints; or the three nearest there are.
fn three_around_governing<'a>(input: &'a ReportInput, state: &LimitState) -> Vec<&'a CheckpointDistribution> {
    let name = &input.scene.outputs[state.output].name;
    let mut shown: Vec<&CheckpointDistribution> =
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
pub fn histories(input: &ReportInput) -> Vec<Figure> {
    if input.summary.is_static() {
        return vec![];
    }
    let axis = LifeAxis::new(&input.summary);
    input.scene.limit_states.iter().filter_map(|state| history(input, state, &axis)).collect()
}

/// The output of one limit state over life; `None` if neither the nominal evaluation nor the population has it.
fn history(input: &ReportInput, state: &LimitState, axis: &LifeAxis) -> Option<Figure> {
    let (output, unit) = (input.output_of(state), &input.unit_of(state));
    let thresholds: Vec<f64> = state.thresholds().into_iter().map(|si| unit.to_shown(si)).collect();
    let nominal: Points = input.nominal.as_ref().map_or(vec![], |nominal| {
        let history = nominal.histories.get(state.output).map_or(&[][..], Vec::as_slice);
        nominal.cycles.iter().zip(history).map(|(n, v)| (axis.place(*n), unit.to_shown(*v))).collect()
    });
    let bands = spread(input, state, axis);
    let edges = bands.iter().flat_map(|(_, band)| band);
    let ends = nominal.last().map(|p| p.0).into_iter().chain(edges.clone().map(|p| p.0));
    let last = ends.reduce(f64::max)?;
    let values = nominal.iter().map(|p| p.1).chain(edges.flat_map(|p| [p.1, p.2]));
    let (low, high) = range(values.chain(thresholds.iter().copied()));
    let signed = thresholds[0] < 0.0 || nominal.iter().any(|p| p.1 < 0.0);
    let low = if low < 0.5 * high && !signed { 0.0 } else { low - 0.1 * (high - low) };
    let subject = input.subject();
    let of_bands = format!("Bands: central 98 % and 50 % of {subject}s, {}. ", origin(&input.summary));
    let of_bands = if bands.is_empty() { "" } else { of_bands.as_str() };
    let profiles = "; each value belongs to the profile worn to that many cycles";
    let profiles = if input.summary.of_mechanism() { profiles } else { "" };
    let caption = format!("{of_bands}The nominal {subject} has every variable at its mean{profiles}.");
    let mut series = threshold_lines(state, unit, Shape::Level);
    let ink = ink_of(&input.summary, &state.name);
    // The inner band lies on the outer one.
    let drawn = bands.into_iter().zip([0.16, 0.5]);
    series.extend(drawn.map(|((label, band), fill)| Series::new(label, ink, Shape::Band(band)).filled(fill)));
    if !nominal.is_empty() {
        series.push(Series::new("nominal", Ink::Ink, Shape::Line(nominal)));
    }
    let name = format!("history-{}", file_name(&state.name));
    let label = unit.axis(&output);
    let x = Axis::linear(axis.label, (0.0, last));
    let y = Axis::linear(&label, (low, high + 0.05 * (high - low)));
    let plot = Plot { figure: &name, x, y, series: &series };
    Some(plot.figure(&capital(&format!("{output} over life")), &caption))
}

/// Pairs of probabilities that bound a band.
const BANDS: [(f64, f64); 2] = [(0.01, 0.99), (0.25, 0.75)];

/// Bands of quantiles of a limit state's output over life, the widest first, as (label, points); empty if the study
/// stored no distributions.
fn spread(input: &ReportInput, state: &LimitState, axis: &LifeAxis) -> Vec<(String, Band)> {
    let (output, unit) = (&input.scene.outputs[state.output], input.unit_of(state));
    let mut stored: Vec<_> = input.distributions.iter().filter(|d| d.output == output.name).collect();
    stored.sort_by_key(|d| d.cycles);
    let quantile = |d: &CheckpointDistribution, p: f64| {
        let found = d.quantiles.iter().find(|(probability, _)| (probability - p).abs() < 1e-9)?;
        Some(unit.to_shown(found.1)).filter(|value| value.is_finite())
    };
    let band = |(low, high): (f64, f64)| {
        let point =
            |d: &&CheckpointDistribution| Some((axis.place(d.cycles), quantile(d, low)?, quantile(d, high)?));
        let label = format!("{:.0} % of {}s", 100.0 * (high - low), input.subject());
        (label, stored.iter().filter_map(point).collect::<Band>())
    };
    BANDS.map(band).into_iter().filter(|(_, band)| band.len() > 1).collect()
}

/// Source of the values of a distribution.
fn origin(summary: &StudySummary) -> String {
    let population = format!("{} {}s", count(summary.population as u64), summary.subject());
    let predicted = format!("predicted by the surrogates for a population of {population}");
    if summary.method == "ak" { predicted } else { format!("simulated for all {population}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn the_three_checkpoints_straddle_the_governing_one() {
        let input = test_study::report_input();
        let shown = three_around_governing(&input, &input.scene.limit_states[1]);
        assert_eq!(shown.iter().map(|d| d.cycles).collect::<Vec<_>>(), [64_000, 66_000, 68_000]);
        let mut few = input.clone();
        few.distributions.retain(|d| d.cycles == 10_000 || d.cycles >= 69_000);
        let shown = three_around_governing(&few, &few.scene.limit_states[0]);
        assert_eq!(shown.iter().map(|d| d.cycles).collect::<Vec<_>>(), [69_000, 70_000, 71_000]);
    }
    #[test]
    fn both_thresholds_of_a_two_sided_limit_are_drawn_and_within_the_axes() {
        let mut input = test_study::report_input();
        let upper = input.scene.limit_states[0].threshold;
        let mentions = |figures: Vec<Figure>| figures[0].drawing.content.matches("threshold").count();
        let single = [histories(&input), distributions(&input)].map(mentions);
        input.scene.limit_states[0].fails = Fails::Outside { lower: -0.5 * upper };
        for (figures, single) in [histories(&input), distributions(&input)].into_iter().zip(single) {
            let svg = &figures[0].drawing.content;
            for name in ["lower threshold", "upper threshold"] {
                assert!(svg.contains(name), "{name}: {svg}");
            }
            assert!(svg.matches("threshold").count() > single);
        }
        // The axis of the values reaches below the lower threshold, which is negative.
        let svg = &histories(&input)[0].drawing.content;
        assert!(svg.contains('\u{2212}'), "no negative value on the axis: {svg}");
    }
}
