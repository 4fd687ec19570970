//! Figures of the rounds of learning, of the predictions of the surrogates, and of the parts of the interval.

use super::{LifeAxis, capital, file_name, ink_of, range, rows_that_matter, span, stacked};
use crate::presentation::report::format::{count, exactly_with_unit, fixed, percent};
use crate::presentation::report::levels::{PARTS, half_widths};
use crate::presentation::report::{Axis, Figure, Ink, Plot, Points, ReportInput, Series, Shape};
use crate::results::summary::{Round, StudySummary};
use crate::results::summary_rows::PredictionRow;
use crate::statistics::reliability::REACH;
use common::scene::{Fails, LimitState};

/// Convergence of the reliability over the rounds.
pub fn learning(input: &ReportInput) -> Option<Figure> {
    let rounds = &input.summary.convergence.rounds;
    let (first, last) = (rounds.first()?, rounds.last()?);
    let point = |round: &Round| (round.evaluations as f64, round.reliability_total);
    let reliability: Points = rounds.iter().map(point).collect();
    let (low, high) = range(reliability.iter().map(|point| point.1));
    let margin = (0.15 * (high - low)).max(0.01);
    let label = format!("R of the {}", input.subject());
    let x = Axis::linear("evaluations", (first.evaluations as f64, last.evaluations as f64));
    let y = Axis::linear(&label, ((low - margin).max(0.0), (high + margin).min(1.0)));
    let series = &[Series::unlisted("R", Ink::Ink, Shape::Dotted(reliability))];
    let caption =
        format!("At the checkpoint where R is nearest 1/2: at the end {} cycles.", count(last.cycles.into()));
    let plot = Plot { figure: "learning-reliability", x, y, series };
    Some(plot.figure("R at the governing checkpoint", &caption))
}

/// One figure per limit state; none for a study without surrogates, or by an earlier version.
pub fn predicted_against_simulated(input: &ReportInput) -> Vec<Figure> {
    let rows = input.summary.predictions.iter().filter(|row| !row.simulated.is_empty());
    let states = &input.scene.limit_states;
    let figure = |row: &PredictionRow| {
        let state = states.iter().find(|state| state.name == row.limit_state)?;
        Some(predicted(input, row, state))
    };
    rows.filter_map(figure).collect()
}

fn predicted(input: &ReportInput, row: &PredictionRow, state: &LimitState) -> Figure {
    let unit = input.unit_of(state);
    // The unit of files and the unit shown differ by a factor.
    let factor = unit.to_shown(1.0) / unit.to_file(1.0);
    let point = |(simulated, (predicted, std)): (&f64, (&f64, &f64))| {
        [*simulated, *predicted, predicted - REACH * std, predicted + REACH * std].map(|value| factor * value)
    };
    let points: Vec<[f64; 4]> =
        row.simulated.iter().zip(row.predicted.iter().zip(&row.std)).map(point).collect();
    let (low, high) = range(points.iter().flat_map(|[x, y, ..]| [*x, *y]));
    let margin = 0.05 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let mut series =
        vec![Series::new("predicted = simulated", Ink::Muted, Shape::Line(vec![(low, low), (high, high)]))];
    // That of the output, or of its distance from the middle between two thresholds.
    let middle = state.middle();
    let threshold =
        unit.to_shown(if middle.is_some() { state.response_threshold() } else { state.threshold });
    if (low..=high).contains(&threshold) {
        series.push(Series::new("threshold", Ink::Limit, Shape::Level(threshold)));
        series.push(Series::unlisted("threshold of the simulated", Ink::Limit, Shape::Upright(threshold)));
    }
    let within = points.iter().filter(|[x, _, lower, upper]| (lower..=upper).contains(&x)).count();
    let all = points.len();
    let ink = ink_of(&input.summary, &row.limit_state);
    series.push(Series::new("prediction with 95 % interval", ink, Shape::Measured(points)));
    let mut name = input.output_of(state);
    if let Some(middle) = middle {
        name = format!("distance of {name} from {}", exactly_with_unit(&unit, middle));
    }
    let labels = ["simulated", "predicted"].map(|which| unit.axis(&format!("{which} {name}")));
    let x = Axis::linear(&labels[0], (low, high));
    let y = Axis::linear(&labels[1], (low, high));
    let plot = Plot { figure: &format!("predicted-{}", file_name(&row.limit_state)), x, y, series: &series };
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

/// Half width of the 95 % interval of R of the system over life, stacked by the shares of its parts in the variance; no figure for a study
/// without parts.
pub fn parts_of_interval(summary: &StudySummary) -> Option<Figure> {
    let rows = rows_that_matter(summary, 1).iter();
    let rows: Vec<(u32, [f64; 3])> =
        rows.filter_map(|row| Some((row.cycles, half_widths(row.parts.get("total")?)))).collect();
    if summary.is_static() || rows.len() < 2 {
        return None;
    }
    let axis = LifeAxis::new(summary);
    let whole = |widths: &[f64; 3]| widths.iter().map(|width| width * width).sum::<f64>().sqrt();
    let height = |(_, widths): &(u32, [f64; 3]), part: usize| match whole(widths) {
        0.0 => 0.0,
        whole => widths[part].powi(2) / whole,
    };
    let layer = |(part, name): (usize, &&str)| {
        let heights = rows.iter().map(|row| height(row, part)).collect();
        (capital(name), Ink::Series(part), heights)
    };
    let is_drawn = |(part, _): &(usize, _)| !(summary.is_direct() && *part == 1);
    let places: Vec<f64> = rows.iter().map(|(cycles, _)| axis.place(*cycles)).collect();
    let series = stacked(&places, PARTS.iter().enumerate().filter(is_drawn).map(layer));
    let top = rows.iter().map(|(_, widths)| whole(widths)).fold(0.0, f64::max);
    let x = Axis::linear(axis.label, span(summary, &axis));
    let y = Axis::linear("half width of the 95 % interval of R", (0.0, 1.05 * top.max(1e-6)));
    let caption = "The half width of R of the system, divided by the shares of samples, surrogates and numerical error in its square.";
    Some(Plot { figure: "parts-of-interval", x, y, series: &series }.figure("Parts of the interval", caption))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

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
        let [figure] = &predicted_against_simulated(&input)[..] else { panic!("one figure") };
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
        assert!(predicted_against_simulated(&input).is_empty());
    }
}
