//! What a fleet says of its population, with tables and figures.

use super::result::{LearnReport, LearnedParameter};
use crate::analyses::paired_results::spread;
use crate::analyses::update::counted_units;
use crate::presentation::report::format::{before_unit, count, percent, shortest, unit_scale};
use crate::presentation::report::{Answer, AnswerPart, Axis, Figure, Ink, Plot, Series, Shape, Table, csv};
use crate::results::csv_table::number;
use crate::results::summary::ReliabilityRow;
use crate::statistics::updating::{ConfidentLife, ConfidentReliability, ConfidentRow};

/// Share of the units outside the simulated values above which the lives are extrapolations [1].
const MOST_OUTSIDE: f64 = 0.5;

/// What the bounds leave out.
const NOT_IN_BOUNDS: &str = "The errors of the surrogates count as scatter between units; an error that all units share, and the \
                                 numerical error of the simulated lives, are not in the bounds.";

/// Most checkpoints in a table.
const ROWS: usize = 12;

/// The answer with its tables and figure.
pub fn answer(report: &LearnReport) -> Answer {
    let LearnReport { confident, parameters, values, .. } = report;
    let added = match report.evaluations {
        0 => "no simulation was made".to_owned(),
        1 => "1 simulation was added".to_owned(),
        n => format!("{n} simulations were added"),
    };
    let stated = confident_answer(confident, &report.scene, &report.study, report.end);
    let mut parts = stated.parts;
    if let Some(left) =
        report.left.iter().max_by(|a, b| a.outside.total_cmp(&b.outside)).filter(|l| l.outside > MOST_OUTSIDE)
    {
        let (outside, name) = (percent(left.outside), &left.name);
        let text = format!(
            "**Not supported: {outside} of the units have values of {name} that were not simulated.**"
        );
        parts.insert(1, AnswerPart::Text(text));
    }
    let before = report.before.as_ref().map(|b| AnswerPart::Text(format!("Before {added}: {}", sentence(b))));
    let caution = report.caution.clone().map(AnswerPart::Text);
    parts.splice(1..1, caution.into_iter().chain(before));
    let interval = format!("{} interval", percent(confident.confidence));
    let head = ["parameter", "study", "prior, 5 to 95 %", "median", &interval];
    let rows = parameters.iter().map(parameter_row);
    parts.push(AnswerPart::Table(Table::new("Parameters of the population", head, rows)));
    if !values.is_empty() {
        let columns = if values.iter().any(|v| v.cost.is_some()) { 4 } else { 2 };
        let rows = values.iter().map(|v| {
            let narrowing = format!("{:.0} ± {:.0} %", 100.0 * v.narrowing, 100.0 * v.standard_error);
            let cost = v.cost.map_or(String::new(), |cost| shortest(cost, 4));
            let for_cost = |cost: f64| format!("{} %", shortest(100.0 * (v.narrowing / cost), 3));
            let for_cost = v.cost.map_or(String::new(), for_cost);
            [v.data.clone(), narrowing, cost, for_cost].into_iter().take(columns).collect()
        });
        let heading = "Which further data narrow the interval of the life at R = 0.99 most";
        let head = ["data", "expected narrowing", "cost", "narrowing over cost"].into_iter().take(columns);
        parts.push(AnswerPart::Table(Table::new(heading, head, rows)));
    }
    parts.push(AnswerPart::Notes("Errors", notes(report)));
    let checks = report.checks.iter().map(|check| format!("warning: unit {}: {}", check.unit, check.warning));
    if !report.checks.is_empty() {
        parts.push(AnswerPart::Notes("To be checked", checks.collect()));
    }
    let subject = "Reliability with what differs between units and what is not known of them";
    Answer {
        name: "learn".to_owned(),
        title: format!("The population of {} by {}", report.scene, counted_units(report.units)),
        subtitle: format!("{subject} apart; {added}"),
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
    let first = [AnswerPart::Text(sentence(confident)), AnswerPart::Figures];
    Answer {
        name: "confidence".to_owned(),
        title: format!("Reliability of {scene} at a confidence"),
        parts: first.into_iter().chain(confident_parts(confident, end)).collect(),
        figures: vec![confident_figure(confident, study, end)],
        ..Answer::default()
    }
}

/// The bound of the life at R = 0.99 in one sentence.
fn sentence(confident: &ConfidentReliability) -> String {
    let c = percent(confident.confidence);
    let known = confident.lives.iter().find_map(|life| Some((life.reliability, life.at_least?)));
    known.map_or(format!("With C = {c} every life stated is beyond the end of the study."), |(r, life)| {
        format!("**Life at R = {r} with C = {c}: {} cycles.**", count(life as u64))
    })
}

/// Lives, R at the checkpoints where it falls, the same by limit state with first failures, and what these bounds leave out.
pub fn confident_parts(confident: &ConfidentReliability, end: f64) -> Vec<AnswerPart> {
    let c = percent(confident.confidence);
    let cycles =
        |life: Option<f64>| life.map_or(format!("> {}", count(end as u64)), |life| count(life as u64));
    let life = |life: &ConfidentLife| {
        let [low, high] = life.interval.map(cycles);
        let [at_least, median] = [life.at_least, life.median].map(cycles);
        vec![format!("R = {}", life.reliability), at_least, median, format!("{low} to {high}")]
    };
    let falls = |row: &&ConfidentRow| row.interval[0] < 0.9995 && row.interval[1] > 0.0005;
    let falling: Vec<&ConfidentRow> = confident.reliability.iter().filter(falls).collect();
    let r = |first: String, row: &ConfidentRow| {
        let [low, high] = row.interval;
        let [at_least, median, mean] = [row.at_least, row.median, row.mean].map(|r| format!("{r:.4}"));
        vec![first, at_least, median, format!("{low:.4} to {high:.4}"), mean]
    };
    let (bound, interval) = (format!("at least, C = {c}"), format!("{c} interval"));
    let of_life = ["life at", &bound, "median", &interval];
    let of_r = ["cycles", &bound, "median", &interval, "one more unit"];
    let rows = spread(&falling, ROWS).into_iter().map(|row| r(count(row.cycles as u64), row));
    let mut tables = vec![
        Table::new("Lives of the system [cycles]", of_life, confident.lives.iter().map(life)),
        Table::new("Reliability of the system", of_r, rows),
    ];
    if !confident.limit_states.is_empty() {
        let states = confident.limit_states.iter();
        let lives = states
            .clone()
            .flat_map(|own| own.lives.iter().map(|one| [vec![own.limit_state.clone()], life(one)].concat()));
        let head = ["by", "life at", &bound, "median", &interval];
        tables.push(Table::new("Lives by each limit state alone [cycles]", head, lives));
        let first = states.filter_map(|own| Some(r(own.limit_state.clone(), own.first_failures.last()?)));
        let head = ["fails first by", &bound, "median", &interval, "one more unit"];
        tables.push(Table::new(
            format!("Share of first failures until {} cycles", count(end as u64)),
            head,
            first,
        ));
    }
    let left_out = AnswerPart::Text(NOT_IN_BOUNDS.to_owned());
    tables.into_iter().map(AnswerPart::Table).chain([left_out]).collect()
}

fn parameter_row(parameter: &LearnedParameter) -> Vec<String> {
    let LearnedParameter {
        name, unit, median, interval: [low, high], study, prior: [from, to], is_flat, ..
    } = parameter;
    let scale = unit_scale(unit);
    let shown = |value: &f64| shortest(value / scale, 4);
    let range = |from: &f64, to: &f64| format!("{} to {}", shown(from), shown(to));
    let texts = [shown(study), range(from, to), shown(median), range(low, high)];
    let [study, prior, median, interval] = texts.map(|text| before_unit(&text, unit));
    let flat = if *is_flat { ", flat" } else { "" };
    vec![name.clone(), study, format!("{prior}{flat}"), median, interval]
}

/// What the numbers mean and how far they can be trusted.
fn notes(report: &LearnReport) -> Vec<String> {
    let LearnReport { effective_size, passes, confident, .. } = report;
    let mut notes = vec![
        format!(
            "Median, interval and \"at least\" are quantiles over the parameters that the data leave possible: with a probability of {} \
             the population has at least that life. R of one more unit is the mean over them.",
            percent(confident.confidence)
        ),
        format!(
            "{effective_size:.0} effective sets of parameters after {passes} passes; the lives of a set are counted by {:.0} effective \
             points.",
            confident.effective_size
        ),
    ];
    let chosen = "The file names no unknown parameter: they are those of the measured variables and of the one with the most influence \
                  on the life. Rows of the unit `population` name others, with their priors.";
    notes.extend(report.chosen_by_default.then(|| chosen.to_owned()));
    notes.extend(report.left.iter().map(|left| {
        format!(
            "Caution: {} of the units have values of {} that were not simulated ({} in the study); the responses there are \
             extrapolated; --max-evaluations simulates them.",
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
    let line = |of: fn(&ConfidentRow) -> f64| rows.iter().map(|row| (row.cycles, of(row))).collect();
    let before = |row: &ReliabilityRow| Some((f64::from(row.cycles), *row.reliability.get("total")?));
    let before = study.iter().filter_map(before).collect();
    let series = [
        Series::new(format!("{c} band of what is not known"), Ink::Series(0), Shape::Band(band)),
        Series::new("study", Ink::Muted, Shape::Dashed(before)),
        Series::new("median", Ink::Series(0), Shape::Line(line(|row| row.median))),
        Series::new(format!("at least, C = {c}"), Ink::Series(1), Shape::Line(line(|row| row.at_least))),
    ];
    let x = Axis::linear("life [cycles]", (0.0, end));
    let caption = "Curve: what differs between units. Band: what is not known of their population.";
    Plot::of_reliability("confident-reliability", x, &series).figure("Reliability at a confidence", caption)
}

/// R at the checkpoints: `cycles, median, mean, at_least, lower, upper`.
fn reliability_csv(confident: &ConfidentReliability) -> String {
    let row = |row: &ConfidentRow| {
        let [lower, upper] = row.interval;
        [row.cycles, row.median, row.mean, row.at_least, lower, upper].map(number)
    };
    csv("cycles,median,mean,at_least,lower,upper".split(','), confident.reliability.iter().map(row))
}
