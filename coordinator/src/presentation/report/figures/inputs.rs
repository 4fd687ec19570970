//! Histograms of the random variables over the simulations, with the densities of their distributions.

use super::{by_influence, file_name, words};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::format::{count, plain, seven_digits};
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Plot, Points, Series, Shape};
use common::random::{Distribution, RandomVariable};
use common::scene::expression::read_unit;

/// Most variables shown.
pub const MOST_HISTOGRAMS: usize = 12;

/// Points of a density.
const POINTS: usize = 80;

/// Probability outside of the range drawn, on either side [1].
const TAIL: f64 = 5e-4;

/// One figure for each of the variables with the most influence; none with fewer than ten simulations.
pub fn input_histograms(input: &ReportInput) -> Vec<Figure> {
    if input.samples.len() < 10 {
        return vec![];
    }
    let shown = by_influence(input).into_iter().take(MOST_HISTOGRAMS);
    shown.map(|k| histogram(input, k, &input.scene.variables[k])).collect()
}

fn histogram(input: &ReportInput, k: usize, variable: &RandomVariable) -> Figure {
    let law = &variable.distribution;
    let unit_scale = read_unit(&variable.unit).map_or(1.0, |unit| unit.multiply / unit.divide);
    let (low, high) = (law.quantile(TAIL), law.upper_quantile(TAIL));
    let size = (low / unit_scale).abs().max((high / unit_scale).abs());
    // Numbers far from one are drawn over a power of ten.
    let power = size.log10().floor();
    let power = if (-2.0..4.0).contains(&power) { 0.0 } else { power };
    let scale = unit_scale * 10f64.powf(power);
    let values: Vec<f64> = input.samples.iter().filter_map(|sample| sample.values.get(k).copied()).collect();
    let (low, high) = values.iter().fold((low, high), |(low, high), x| (low.min(*x), high.max(*x)));
    let margin = 0.02 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let bins = (values.len() as f64).sqrt().ceil().clamp(6.0, 30.0) as usize;
    let width = (high - low) / bins as f64;
    // Densities are stated per standard deviation, so that all figures have one scale. Equal measured values have a share but no
    // density: theirs is the mean over the width of a bar.
    let std = law.std();
    let density = |x: f64| match law {
        Distribution::Empirical(_) => (law.cdf(x + 0.5 * width) - law.cdf(x - 0.5 * width)) / width,
        _ => law.pdf(x),
    };
    let density: Points = (0..=POINTS)
        .map(|p| low + (high - low) * p as f64 / POINTS as f64)
        .map(|x| (x / scale, std * density(x)))
        .collect();
    let mut counts = vec![0usize; bins];
    for x in &values {
        counts[(((x - low) / width) as usize).min(bins - 1)] += 1;
    }
    let bars: Vec<(f64, f64, f64)> = counts
        .iter()
        .enumerate()
        .map(|(bin, count)| {
            let left = low + width * bin as f64;
            (left / scale, (left + width) / scale, std * *count as f64 / (values.len() as f64 * width))
        })
        .collect();
    let top = bars.iter().map(|bar| bar.2).chain(density.iter().map(|point| point.1));
    let top = top.filter(|height| height.is_finite()).fold(0.0, f64::max);
    let label = axis_label(variable, power);
    // The edges of the first and the last bar lie within the axis whatever the rounding.
    let slack = 1e-6 * (high - low);
    let plot = Plot {
        figure: &format!("input-{}", file_name(&variable.name)),
        x: Axis {
            text: |value| plain(value, 6),
            ..Axis::linear(&label, ((low - slack) / scale, (high + slack) / scale))
        },
        y: Axis::linear("density × standard deviation", (0.0, 1.08 * top.min(3.0))),
        series: &[
            Series::new("simulations", Ink::Series(0), Shape::Steps(bars)),
            Series::new("density", Ink::Ink, Shape::Line(density)),
        ],
    };
    let caption = format!(
        "{}: mean {}, standard deviation {} {}; {} simulations.",
        law.word(),
        seven_digits(law.parent_mean() / unit_scale),
        seven_digits(law.given_std() / unit_scale),
        if variable.unit == "1" { "" } else { &variable.unit },
        count(values.len() as u64)
    );
    plot.figure(&super::capital(&words(&variable.name)), &caption.replace(" ;", ";"))
}

fn axis_label(variable: &RandomVariable, power: f64) -> String {
    let unit = if variable.unit == "1" { "" } else { variable.unit.as_str() };
    let power = if power == 0.0 { String::new() } else { format!("1e{power}").replace('-', "\u{2212}") };
    let both = format!("{power} {unit}");
    match both.trim() {
        "" => words(&variable.name),
        both => format!("{} [{both}]", words(&variable.name)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;

    /// Bars and density both enclose the area one: heights times widths, in standard deviations.
    #[test]
    fn bars_and_density_enclose_one() {
        let input = test_study::report_with_samples();
        let figures = input_histograms(&input);
        assert_eq!(figures.len(), MOST_HISTOGRAMS);
        for figure in &figures {
            let variable =
                input.scene.variables.iter().find(|v| figure.name == format!("input-{}", file_name(&v.name)));
            let variable = variable.unwrap();
            let rows: Vec<Vec<String>> =
                figure.csv.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
            let bars = rows.iter().filter(|row| row[0] == "simulations");
            let number = |text: &String| text.parse::<f64>().unwrap();
            let area: f64 = bars.map(|row| (number(&row[3]) - number(&row[1])) * number(&row[2])).sum();
            let curve: Vec<(f64, f64)> = rows
                .iter()
                .filter(|row| row[0] == "density")
                .map(|row| (number(&row[1]), number(&row[2])))
                .collect();
            let below: f64 =
                curve.windows(2).map(|pair| (pair[1].0 - pair[0].0) * 0.5 * (pair[0].1 + pair[1].1)).sum();
            // Both in units of the standard deviation as drawn.
            assert!((area / below - 1.0).abs() < 0.02, "{}: {area} {below}", variable.name);
        }
        let mut few = input;
        few.samples.truncate(9);
        assert!(input_histograms(&few).is_empty());
    }

    #[test]
    fn small_numbers_are_drawn_over_a_power_of_ten() {
        let input = test_study::report_with_samples();
        let wear = input.scene.variables.iter().find(|v| v.name == "wear_coefficient_12").unwrap();
        assert_eq!(axis_label(wear, -13.0), "wear coefficient 12 [1e\u{2212}13 1/Pa]");
        assert_eq!([40.0549, 0.5, -0.0].map(|value| plain(value, 6)), ["40.0549", "0.5", "0"]);
    }
}
