//! Figures of the influence of the variables: derivatives of the failure probabilities, contributions to the variance of the outputs, and
//! parallel coordinates of the simulations: one line per simulation over the variables with the most influence, in standard deviations,
//! coloured by the limit state that failed first.

use super::{file_name, governing_cycles, ink_of, words};
use crate::presentation::report::bars::{NamedRows, shortened};
use crate::presentation::report::format::{count, number_of_cycles};
use crate::presentation::report::plot::px;
use crate::presentation::report::{
    Bars, Drawing, Figure, Ink, ReportInput, Series, Shape, SimulatedSample, csv,
};
use crate::results::csv_table::number;
use crate::results::summary::{SensitivityRow, SobolRow};
use common::scene::LimitState;
use plotters::prelude::*;

/// Bars shown per figure.
const SHOWN: usize = 12;

/// The checkpoint of `all` nearest to the governing one.
fn nearest_to_governing(input: &ReportInput, all: impl Iterator<Item = u32>) -> Option<u32> {
    let governing = governing_cycles(input);
    all.min_by_key(|cycles| cycles.abs_diff(governing))
}

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// The rows of one limit state at the checkpoint nearest to the governing one where derivatives are known, longest bar first.
fn rows_at_governing<'a>(input: &'a ReportInput, limit_state: &str) -> Vec<&'a SensitivityRow> {
    let all = input.summary.sensitivity.iter().filter(|row| row.limit_state == limit_state);
    let known = all.clone().filter(|row| row.is_known()).map(|row| row.cycles);
    let Some(cycles) = nearest_to_governing(input, known) else { return vec![] };
    let mut rows: Vec<_> = all.filter(|row| row.cycles == cycles).collect();
    rows.sort_by(|a, b| finite(b.strength()).total_cmp(&finite(a.strength())));
    rows
}

/// Indices of the variables that are not constant, the one with the largest effect on any failure probability first; in the order of
/// the scene where no effects are known.
pub fn by_influence(input: &ReportInput) -> Vec<usize> {
    let variables = &input.scene.variables;
    let rows: Vec<&SensitivityRow> =
        input.summary.curve_names().flat_map(|name| rows_at_governing(input, name)).collect();
    let effect = |k: &usize| {
        let own = rows.iter().filter(|row| row.variable == variables[*k].name);
        own.map(|row| finite(row.strength())).fold(0.0, f64::max)
    };
    let mut all: Vec<usize> =
        (0..variables.len()).filter(|k| !variables[*k].distribution.is_constant()).collect();
    all.sort_by(|a, b| effect(b).total_cmp(&effect(a)));
    all
}

/// One figure per limit state with derivatives of its failure probability.
pub fn sensitivities(input: &ReportInput) -> Vec<Figure> {
    let figure = |name: &String| {
        let rows = rows_at_governing(input, name);
        let first = rows.first()?;
        let caption = format!(
            "Derivatives of the probability of failure by {name} at {} by the mean and the standard deviation of a variable, times \
             its standard deviation: to first order the change for an increase by one, with the bounds of bounded variables held; \
             positive: more failures. Thin lines: 1.96 standard errors of sampling alone. The {} largest of {}.",
            number_of_cycles(first.cycles),
            rows.len().min(SHOWN),
            rows.len()
        );
        // The errors of the derivatives, on the scale of the scaled derivatives.
        let pair = |row: &&SensitivityRow| {
            let values = [row.scaled.d_pf_d_mean, row.scaled.d_pf_d_std].map(finite);
            (words(&row.variable), values, row.scaled_errors().map(finite))
        };
        let (figure, all) = (&format!("sensitivity-{}", file_name(name)), rows.iter().map(pair).collect());
        let (labels, axis) = (["mean", "std"], "derivative of failure probability, times std");
        let bars = Bars { figure, labels, axis, signed: true, all, shown: SHOWN };
        Some(bars.figure(&format!("Sensitivity of failure by {name}"), &caption))
    };
    input.summary.limit_states.iter().filter_map(figure).collect()
}

/// One figure per limit state with Sobol indices of its output.
pub fn variance_contributions(input: &ReportInput) -> Vec<Figure> {
    let figure = |state: &LimitState| {
        let all = input.summary.sobol.iter().filter(|row| row.limit_state == state.name);
        let cycles = nearest_to_governing(input, all.clone().map(|row| row.cycles))?;
        let mut rows: Vec<&SobolRow> = all.filter(|row| row.cycles == cycles).collect();
        rows.sort_by(|a, b| finite(b.total).total_cmp(&finite(a.total)));
        let output = input.output_of(state);
        let caption = format!(
            "Sobol indices of the surrogate at {}: share of the variance of the {output} due to a variable alone \
             (first order) and with its interactions (total). Thin lines: 1.96 standard errors by sampling and surrogate. The {} largest of {}.",
            number_of_cycles(cycles),
            rows.len().min(SHOWN),
            rows.len()
        );
        let pair = |row: &&SobolRow| {
            let errors = [row.standard_error.first_order, row.standard_error.total].map(finite);
            (words(&row.variable), [row.first_order, row.total].map(finite), errors)
        };
        let (figure, all) = (&format!("sobol-{}", file_name(&state.name)), rows.iter().map(pair).collect());
        let (labels, axis) = (["first order", "total"], "share of the variance");
        let bars = Bars { figure, labels, axis, signed: false, all, shown: SHOWN };
        Some(bars.figure(&format!("Variance contributions (Sobol): {output}"), &caption))
    };
    input.scene.limit_states.iter().filter_map(figure).collect()
}

/// Most variables and lines drawn.
const VARIABLES: usize = 14;
const LINES: usize = 300;

/// Largest standard normal drawn [1].
const REACH: f64 = 4.0;

/// Height of all variables together where there are few, and limits of the height of one [CSS pixels].
const HEIGHT: f64 = 240.0;
const ROW: (f64, f64) = (26.0, 60.0);

/// The figure; `None` with fewer than ten simulations or two variables.
pub fn parallel_coordinates(input: &ReportInput) -> Option<Figure> {
    let variables: Vec<usize> = by_influence(input).into_iter().take(VARIABLES).collect();
    let all = input.samples.len();
    if all < 10 || variables.len() < 2 {
        return None;
    }
    let cycles = governing_cycles(input);
    let every = all.div_ceil(LINES);
    let line = |(values, failed_at): &SimulatedSample| -> DrawnLine {
        let normals = variables.iter().map(|k| normal(input, values, *k)).collect();
        (normals, first_failure(input, failed_at, cycles))
    };
    let lines: Vec<DrawnLine> = input.samples.iter().step_by(every).map(line).collect();
    let failed = lines.iter().filter(|(_, failed)| failed.is_some()).count();
    let drawn = lines.len();
    let most = format!("{} variables with the most influence on failures", variables.len());
    let caption = format!(
        "One line per simulation: values of the {} in standard deviations (of the standard \
         normal with the same probability, drawn up to {REACH}). Coloured: failed by {} cycles, by the limit state that failed first; \
         {failed} of the {drawn} drawn{}. Learning chooses simulations near the limits, so that this share is not a probability.",
        if variables.len() < input.scene.variables.len() { &most } else { "variables" },
        count(cycles.into()),
        if every > 1 { format!(" (every {every}th of {})", count(all as u64)) } else { String::new() }
    );
    let names: Vec<String> = variables.iter().map(|k| input.scene.variables[*k].name.clone()).collect();
    let columns = ["simulation", "failed first"].into_iter().chain(names.iter().map(String::as_str));
    let rows = lines.iter().enumerate().map(|(k, (normals, failed))| {
        let numbers = normals.iter().copied().map(number);
        [(k * every).to_string(), failed.clone().unwrap_or_default()].into_iter().chain(numbers)
    });
    let csv = csv(columns, rows);
    let (name, title) = ("parallel-coordinates".to_owned(), "Which combinations fail".to_owned());
    Some(Figure { name, title, caption, drawing: drawing(input, &names, &lines), csv })
}

/// A simulation as it is drawn: standard normals of the variables, and the limit state that failed first, if any has.
type DrawnLine = (Vec<f64>, Option<String>);

/// Standard normal of a variable of a sample, within what is drawn.
fn normal(input: &ReportInput, values: &[f64], k: usize) -> f64 {
    let value = values.get(k).copied().unwrap_or(f64::NAN);
    let u = input.scene.variables[k].distribution.to_standard_normal(value);
    if u.is_nan() { 0.0 } else { u.clamp(-REACH, REACH) }
}

/// The limit state that a simulation reached first, up to this life.
fn first_failure(input: &ReportInput, failed_at: &[Option<u32>], cycles: u32) -> Option<String> {
    let reached = input.scene.limit_states.iter().zip(failed_at);
    let reached = reached.filter_map(|(state, at)| Some((at.filter(|at| *at <= cycles)?, state)));
    reached.min_by_key(|(at, _)| *at).map(|(_, state)| state.name.clone())
}

fn drawing(input: &ReportInput, names: &[String], lines: &[DrawnLine]) -> Drawing {
    let count = names.len() as f64;
    let row = (HEIGHT / count).clamp(ROW.0, ROW.1);
    let meaning = |label: &str, ink: Ink| Series::new(shortened(label), ink, Shape::Line(vec![]));
    let mut legend = vec![meaning("works", Ink::Muted)];
    let states = input.scene.limit_states.iter().map(|state| &state.name);
    legend.extend(states.map(|name| meaning(&format!("{name} first"), ink_of(&input.summary, name))));
    let names: Vec<String> = names.iter().map(|name| words(name)).collect();
    let (axis, range) = ("standard deviations", -REACH..REACH);
    let chart = NamedRows { names: &names, row, legend: &legend, axis, range, ticks: 9 };
    chart.draw(|chart| {
        // Failures lie on top.
        let (works, fails): (Vec<_>, Vec<_>) = lines.iter().partition(|(_, failed)| failed.is_none());
        for (normals, failed) in works.into_iter().chain(fails) {
            let points = normals.iter().enumerate().map(|(k, u)| (*u, count - k as f64 - 0.5));
            let (ink, opacity) = match failed {
                None => (Ink::Muted, 0.35),
                Some(state) => (ink_of(&input.summary, state), 0.75),
            };
            let pen = ink.rgb().mix(opacity).stroke_width(px(0.9) as u32);
            chart.draw_series([PathElement::new(points.collect::<Vec<_>>(), pen)])?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn failures_are_those_up_to_the_governing_checkpoint() {
        let mut input = test_study::report_with_samples();
        let cycles = governing_cycles(&input);
        for (k, sample) in input.samples.iter_mut().enumerate() {
            sample.1 = match k % 3 {
                0 => vec![Some(cycles), Some(cycles - 1000)],
                1 => vec![Some(cycles + 1000), None],
                _ => vec![None, None],
            };
        }
        let figure = parallel_coordinates(&input).unwrap();
        let firsts: Vec<&str> =
            figure.csv.lines().skip(1).map(|line| line.split(',').nth(1).unwrap()).collect();
        for (k, first) in firsts.iter().enumerate() {
            assert_eq!(*first, if k % 3 == 0 { "asymmetry" } else { "" }, "{k}");
        }
        let lines = figure.drawing.content.matches("opacity=\"0.75\"").count();
        assert_eq!(lines, firsts.len().div_ceil(3));
        input.samples.truncate(9);
        assert_eq!(parallel_coordinates(&input), None);
    }
}
