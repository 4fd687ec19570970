//! Parallel coordinates of the simulations: one line per simulation over the variables with the most influence, in standard
//! deviations, coloured by the limit state that failed first.

use super::influences::by_influence;
use super::{governing_cycles, ink_of, words};
use crate::presentation::report::bars::{NamedRows, shortened};
use crate::presentation::report::format::count;
use crate::presentation::report::plot::px;
use crate::presentation::report::{Drawing, Figure, Ink, ReportInput, Series, Shape, SimulatedSample, csv};
use crate::results::csv_table::number;
use plotters::prelude::*;

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
    let lines: Vec<DrawnLine> = input
        .samples
        .iter()
        .step_by(every)
        .map(|sample| {
            let normals = variables.iter().map(|k| normal(input, sample, *k)).collect();
            (normals, first_failure(input, sample, cycles))
        })
        .collect();
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
    let mut columns = vec!["simulation", "failed first"];
    columns.extend(names.iter().map(String::as_str));
    let rows = lines.iter().enumerate().map(|(k, (normals, failed))| {
        let mut cells = vec![(k * every).to_string(), failed.clone().unwrap_or_default()];
        cells.extend(normals.iter().copied().map(number));
        cells
    });
    let csv = csv(&columns, rows);
    let (name, title) = ("parallel-coordinates".to_owned(), "Which combinations fail".to_owned());
    Some(Figure { name, title, caption, drawing: drawing(input, &names, &lines), csv })
}

/// A simulation as it is drawn: standard normals of the variables, and the limit state that failed first, if any has.
type DrawnLine = (Vec<f64>, Option<String>);

/// Standard normal of a variable of a sample, within what is drawn.
fn normal(input: &ReportInput, sample: &SimulatedSample, k: usize) -> f64 {
    let value = sample.values.get(k).copied().unwrap_or(f64::NAN);
    let u = input.scene.variables[k].distribution.to_standard_normal(value);
    if u.is_nan() { 0.0 } else { u.clamp(-REACH, REACH) }
}

/// The limit state that a simulation reached first, up to this life.
fn first_failure(input: &ReportInput, sample: &SimulatedSample, cycles: u32) -> Option<String> {
    let reached = input.scene.limit_states.iter().zip(&sample.failed_at);
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
            let points: Vec<(f64, f64)> = points.collect();
            let (ink, opacity) = match failed {
                None => (Ink::Muted, 0.35),
                Some(state) => (ink_of(&input.summary, state), 0.75),
            };
            let pen = ink.rgb().mix(opacity).stroke_width(px(0.9) as u32);
            chart.draw_series([PathElement::new(points, pen)])?;
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
            sample.failed_at = match k % 3 {
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
