//! What a fleet says of its population, with tables and figures.

use super::result::{LearnReport, LearnedParameter};
use crate::presentation::report::format::{before_unit, count, percent, shortest, unit_scale};
use crate::presentation::report::{Answer, AnswerPart, Axis, Figure, Ink, Plot, Series, Shape, Table, csv};
use crate::results::csv_table::number;
use crate::results::summary::ReliabilityRow;
use crate::statistics::updating::{ConfidentLife, ConfidentReliability, ConfidentRow};

/// Most checkpoints in a table.
const ROWS: usize = 12;

/// The answer with its tables and figure.
pub fn answer(report: &LearnReport) -> Answer {
    let LearnReport { confident, parameters, .. } = report;
    let added = match report.evaluations {
        0 => "no simulation was made".to_owned(),
        1 => "1 simulation was added".to_owned(),
        n => format!("{n} simulations were added"),
    };
    let stated = confident_answer(confident, &report.scene, &report.study, report.end);
    let mut parts = stated.parts;
    let before = report.before.as_ref().map(|b| AnswerPart::Text(format!("Before {added}: {}", sentence(b))));
    parts.splice(1..1, before);
    let c = percent(confident.confidence);
    let head = [
        "parameter".to_owned(),
        "study".to_owned(),
        "prior, 5 to 95 %".to_owned(),
        "median".to_owned(),
        format!("{c} interval"),
    ];
    let rows = parameters.iter().map(parameter_row);
    parts.push(AnswerPart::Table(Table::new("Parameters of the population", head, rows)));
    if !report.values.is_empty() {
        let columns = if report.values.iter().any(|v| v.cost.is_some()) { 4 } else { 2 };
        let rows = report.values.iter().map(|v| {
            let percent = |share: f64| format!("{} %", shortest(100.0 * share, 3));
            let narrowing = format!("{:.0} ± {:.0} %", 100.0 * v.narrowing, 100.0 * v.standard_error);
            let [cost, for_cost] =
                [v.cost.map(|cost| shortest(cost, 4)), v.cost.map(|cost| percent(v.narrowing / cost))]
                    .map(Option::unwrap_or_default);
            [v.data.clone(), narrowing, cost, for_cost].into_iter().take(columns).collect()
        });
        let heading = "Which further data narrow the interval of the life at R = 0.99 most";
        let head = ["data", "expected narrowing", "cost", "narrowing over cost"].into_iter().take(columns);
        parts.push(AnswerPart::Table(Table::new(heading, head, rows)));
    }
    parts.push(AnswerPart::Notes("Errors", notes(report)));
    let checks: Vec<String> = report
        .checks
        .iter()
        .map(|check| format!("warning: unit {}: {}", check.unit, check.warning))
        .collect();
    if !checks.is_empty() {
        parts.push(AnswerPart::Notes("To be checked", checks));
    }
    Answer {
        name: "learn".to_owned(),
        title: format!("What {} of {} say of their population", units(report.units), report.scene),
        subtitle: format!(
            "Reliability with what differs between units and what is not known of them apart; {added}"
        ),
        parts,
        files: vec![("reliability.csv".to_owned(), reliability_csv(confident))],
        ..stated
    }
}

/// Reliability at a confidence: the bound in a sentence, lives, R at the checkpoints, and the figure with R of the study.
pub fn confident_answer(
    confident: &ConfidentReliability,
    scene: &str,
    study: &[ReliabilityRow],
    end: f64,
) -> Answer {
    let tables = confident_tables(confident, end).into_iter().map(AnswerPart::Table);
    Answer {
        name: "confidence".to_owned(),
        title: format!("Reliability of {scene} at a confidence"),
        parts: [AnswerPart::Text(sentence(confident)), AnswerPart::Figures]
            .into_iter()
            .chain(tables)
            .collect(),
        figures: vec![confident_figure(confident, study, end)],
        ..Answer::default()
    }
}

fn units(n: usize) -> String {
    format!("{n} {}", if n == 1 { "unit" } else { "units" })
}

/// The bound of the life at R = 0.99 in one sentence.
fn sentence(confident: &ConfidentReliability) -> String {
    let c = percent(confident.confidence);
    let known = confident.lives.iter().find_map(|life| Some((life, life.at_least?)));
    match known {
        Some((ConfidentLife { reliability, .. }, life)) => {
            format!("**Life at R = {reliability} with C = {c}: {} cycles.**", count(life as u64))
        }
        None => format!("With C = {c} every life stated is beyond the end of the study."),
    }
}

/// Lives, and R at the checkpoints where it falls.
pub fn confident_tables(confident: &ConfidentReliability, end: f64) -> [Table; 2] {
    let c = percent(confident.confidence);
    let cycles =
        |life: Option<f64>| life.map_or(format!("> {}", count(end as u64)), |life| count(life as u64));
    let life = |life: &ConfidentLife| {
        let [low, high] = life.interval.map(cycles);
        vec![
            format!("R = {}", life.reliability),
            cycles(life.at_least),
            cycles(life.median),
            format!("{low} to {high}"),
        ]
    };
    let head = |first: &str| {
        [first.to_owned(), format!("at least, C = {c}"), "median".to_owned(), format!("{c} interval")]
    };
    let rows = &confident.reliability;
    let falls = |row: &ConfidentRow| row.interval[0] < 0.9995 && row.interval[1] > 0.0005;
    let mut shown: Vec<&ConfidentRow> = rows.iter().filter(|row| falls(row)).collect();
    if shown.len() > ROWS {
        let all = std::mem::take(&mut shown);
        shown = (0..ROWS).map(|i| all[i * (all.len() - 1) / (ROWS - 1)]).collect();
    }
    let r = |row: &&ConfidentRow| {
        let [low, high] = row.interval;
        let mean = format!("{:.4}", row.mean);
        vec![
            count(row.cycles as u64),
            format!("{:.4}", row.at_least),
            format!("{:.4}", row.median),
            format!("{low:.4} to {high:.4}"),
            mean,
        ]
    };
    let of_r: Vec<String> = head("cycles").into_iter().chain(["one more unit".to_owned()]).collect();
    [
        Table::new("Lives of the system [cycles]", head("life at"), confident.lives.iter().map(life)),
        Table::new("Reliability of the system", of_r, shown.iter().map(r)),
    ]
}

fn parameter_row(parameter: &LearnedParameter) -> Vec<String> {
    let LearnedParameter {
        name, unit, median, interval: [low, high], study, prior: [from, to], is_flat, ..
    } = parameter;
    let scale = unit_scale(unit);
    let shown = |value: &f64| shortest(value / scale, 4);
    let with_unit = |text: String| before_unit(&text, unit);
    let flat = if *is_flat { ", flat" } else { "" };
    vec![
        name.clone(),
        with_unit(shown(study)),
        format!("{}{flat}", with_unit(format!("{} to {}", shown(from), shown(to)))),
        with_unit(shown(median)),
        with_unit(format!("{} to {}", shown(low), shown(high))),
    ]
}

/// What the numbers mean and how far they can be trusted.
fn notes(report: &LearnReport) -> Vec<String> {
    let c = percent(report.confident.confidence);
    let mut notes = vec![
        format!(
            "Median, interval and \"at least\" are quantiles over the parameters that the data leave possible: with a probability of {c} \
             the population has at least that life. R of one more unit is the mean over them."
        ),
        format!(
            "{:.0} effective sets of parameters after {} passes; the lives of a set are counted by {:.0} effective points.",
            report.effective_size, report.passes, report.confident.effective_size
        ),
        "The errors of the surrogates count as scatter between units; an error that all units share, and the numerical error of the \
         simulated lives, are not in the bounds."
            .to_owned(),
    ];
    if report.chosen_by_default {
        notes.push(
            "The file names no unknown parameter: they are those of the measured variables and of the one with the most influence on \
             the life. Rows of the unit `population` name others, with their priors."
                .to_owned(),
        );
    }
    notes.extend(report.left.iter().map(|left| {
        format!(
            "Caution: {} of the units have values of {} that were not simulated ({} in the study); the responses there are \
             extrapolated; --refine simulates them.",
            percent(left.outside),
            left.name,
            percent(left.of_study)
        )
    }));
    notes
}

/// The band of what is not known around the median of R, the lower bound, and R of the study.
pub fn confident_figure(confident: &ConfidentReliability, study: &[ReliabilityRow], end: f64) -> Figure {
    let c = percent(confident.confidence);
    let rows = &confident.reliability;
    let band = rows.iter().map(|row| (row.cycles, row.interval[0], row.interval[1])).collect();
    let line =
        |of: &dyn Fn(&ConfidentRow) -> f64| rows.iter().map(|row| (row.cycles, of(row))).collect::<Vec<_>>();
    let before = study
        .iter()
        .filter_map(|row| Some((f64::from(row.cycles), *row.reliability.get("total")?)))
        .collect();
    let series = [
        Series::new(format!("{c} band of what is not known"), Ink::Series(0), Shape::Band(band)),
        Series::new("study", Ink::Muted, Shape::Dashed(before)),
        Series::new("median", Ink::Series(0), Shape::Line(line(&|row| row.median))),
        Series::new(format!("at least, C = {c}"), Ink::Series(1), Shape::Line(line(&|row| row.at_least))),
    ];
    let x = Axis::linear("life [cycles]", (0.0, end));
    Plot::of_reliability("confident-reliability", x, &series).figure(
        "Reliability at a confidence",
        "Curve: what differs between units. Band: what is not known of their population.",
    )
}

/// R at the checkpoints: `cycles, median, mean, at_least, lower, upper`.
fn reliability_csv(confident: &ConfidentReliability) -> String {
    let row = |row: &ConfidentRow| {
        let [lower, upper] = row.interval;
        [row.cycles, row.median, row.mean, row.at_least, lower, upper].map(number)
    };
    csv("cycles,median,mean,at_least,lower,upper".split(','), confident.reliability.iter().map(row))
}
