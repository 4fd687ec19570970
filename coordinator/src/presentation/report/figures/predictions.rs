//! Predicted against simulated: every simulation, and what the surrogate of a limit state predicts for it from all others.

use super::{capital, file_name, ink_of, range};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::format::{count, fixed, percent};
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Plot, Series, Shape, tick_label};
use crate::results::point_summary::PredictionRow;
use crate::statistics::reliability::REACH;
use common::scene::{Fails, LimitState};

/// One figure per limit state; none for a study without surrogates, or by an earlier version.
pub fn predicted_against_simulated(input: &ReportInput) -> Vec<Figure> {
    let rows = input.summary.predictions.iter().filter(|row| !row.simulated.is_empty());
    let states = &input.scene.limit_states;
    let known =
        rows.filter_map(|row| Some((row, states.iter().find(|state| state.name == row.limit_state)?)));
    known.map(|(row, state)| figure(input, row, state)).collect()
}

fn figure(input: &ReportInput, row: &PredictionRow, state: &LimitState) -> Figure {
    let unit = input.unit_of(state);
    // The unit of files and the unit shown differ by a factor.
    let factor = unit.to_shown(1.0) / unit.to_file(1.0);
    let points: Vec<[f64; 4]> = row
        .simulated
        .iter()
        .zip(row.predicted.iter().zip(&row.std))
        .map(|(simulated, (predicted, std))| {
            [*simulated, *predicted, predicted - REACH * std, predicted + REACH * std]
                .map(|value| factor * value)
        })
        .collect();
    let (low, high) = range(points.iter().flat_map(|[x, y, ..]| [*x, *y]));
    let margin = 0.05 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let mut series =
        vec![Series::new("predicted = simulated", Ink::Muted, Shape::Line(vec![(low, low), (high, high)]))];
    let threshold = unit.to_shown(row_threshold(state));
    if (low..=high).contains(&threshold) {
        series.push(Series::new("threshold", Ink::Limit, Shape::Level(threshold)));
        series.push(Series::unlisted("threshold of the simulated", Ink::Limit, Shape::Upright(threshold)));
    }
    let within = points.iter().filter(|[x, _, lower, upper]| (lower..=upper).contains(&x)).count();
    let all = points.len();
    series.push(Series::new(
        "prediction with 95 % interval",
        ink_of(&input.summary, &row.limit_state),
        Shape::Measured(points),
    ));
    let mut name = input.output_of(state);
    if let Some(middle) = state.middle() {
        name = format!("distance of {name} from {}", unit.after(&tick_label(unit.to_shown(middle))));
    }
    let labels = ["simulated", "predicted"].map(|which| unit.axis(&format!("{which} {name}")));
    let plot = Plot {
        figure: &format!("predicted-{}", file_name(&row.limit_state)),
        x: Axis::linear(&labels[0], (low, high)),
        y: Axis::linear(&labels[1], (low, high)),
        series: &series,
    };
    let caption = format!(
        "{} {name} up to {} cycles in every simulation, and as the surrogate at the end of the study predicts it from all other \
         simulations (leave-one-out). Q2 = {}; {within} of {all} simulated values lie in the 95 % interval of their prediction ({}).",
        if state.fails == Fails::Below { "Smallest" } else { "Largest" },
        count(row.cycles.into()),
        fixed(row.q2, 4),
        percent(within as f64 / all as f64)
    );
    plot.figure(&capital(&format!("predicted against simulated {name}")), &caption)
}

/// Threshold of the values of a row: that of the output, or of its distance from the middle between two thresholds.
fn row_threshold(state: &LimitState) -> f64 {
    if state.middle().is_some() { state.response_threshold() } else { state.threshold }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;

    #[test]
    fn values_are_in_the_unit_shown_and_the_share_within_is_counted() {
        let mut input = test_study::report_input();
        let row = |predicted: [f64; 4]| PredictionRow {
            limit_state: "wear".into(),
            cycles: 66_000,
            unit: "m".into(),
            simulated: vec![28e-6, 29e-6, 30e-6, 31e-6],
            predicted: predicted.to_vec(),
            std: vec![1e-7; 4],
            q2: 0.987_65,
        };
        input.summary.predictions = vec![row([28e-6, 29.1e-6, 30.3e-6, 31e-6])];
        let [figure] = &predicted_against_simulated(&input).unwrap()[..] else { panic!("one figure") };
        assert_eq!(figure.name, "predicted-wear");
        let said = figure.caption.replace('\u{a0}', " ");
        for words in ["Q2 = 0.9877", "3 of 4", "(75.0 %)", "66 000 cycles"] {
            assert!(said.contains(words), "{words}: {said}");
        }
        let row: Vec<f64> = figure
            .csv
            .lines()
            .filter(|line| line.starts_with("prediction"))
            .nth(2)
            .map(|line| line.split(',').filter_map(|cell| cell.parse().ok()).collect())
            .unwrap();
        assert!((row[0] - 30.0).abs() < 1e-9 && (row[1] - 30.3).abs() < 1e-9, "{row:?}");
        input.summary.predictions.clear();
        assert!(predicted_against_simulated(&input).unwrap().is_empty());
    }
}
