//! The answers for all designs as JSON, and with their table, sentences and figures.

use super::answer::{Best, DesignAnswer, Objective, Refined};
use super::figures::figures;
use super::space::{DesignSpace, DesignVariable};
use crate::analyses::paired_results::curve_names;
use crate::presentation::report::compare::{CURVE_COLUMNS, curve_cells};
use crate::presentation::report::format::{count, percent, rounded_cycles, three_digits};
use crate::presentation::report::life::{
    LEVELS, LifeAt, life_and_limits, life_at, life_with_limits, reliability, unresolved_fall,
};
use crate::presentation::report::{Answer, AnswerPart, ComparedStudy, Table};
use crate::results::csv_table::{self, number};
use crate::results::summary::StudySummary;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Most designs in the table of a terminal.
const ROWS: usize = 16;

/// All that is reported of designs.
#[derive(Debug, Clone)]
pub struct DesignReport<'a> {
    /// Scene and design variables of the study.
    pub space: &'a DesignSpace,
    /// Their answers, at least one.
    pub answers: &'a [DesignAnswer],
    /// What makes a design good.
    pub objective: Objective,
    /// The best design, if the objective of any is known.
    pub best: Option<Best>,
    /// Errors of the designs, and simulations added for them by this command.
    pub refined: Refined,
    /// Simulations of which the answers are made, and those of them that were added for single designs.
    pub simulations: (usize, usize),
    /// Command that would add simulations, without their number.
    pub command: String,
}

impl DesignReport<'_> {
    /// The values of a design by key.
    fn design(&self, index: usize) -> Value {
        let values = self.space.variables.iter().zip(&self.answers[index].values);
        values.map(|(variable, value)| (variable.key.clone(), json!(value))).collect()
    }

    /// The values of a design in words.
    fn in_words(&self, index: usize) -> String {
        self.space.in_words(&self.answers[index].values)
    }
}

/// The answers as JSON.
pub fn json(report: &DesignReport<'_>) -> Value {
    let design = |(index, answer): (usize, &DesignAnswer)| {
        let summary = &answer.summary;
        json!({
            "design": report.design(index),
            "reliability": summary.reliability,
            "lives": summary.lives,
            "first_failure": summary.first_failure,
            "unresolved_fall": summary.unresolved_fall,
            "surrogate_error": answer.surrogate_error,
        })
    };
    let first = &report.answers[0].summary;
    let best = report.best.as_ref().map(|Best { index, objective, value, is_bound, equal }| {
        let equal: Vec<Value> = equal.iter().map(|i| report.design(*i)).collect();
        json!({
            "design": report.design(*index), "objective": objective, "value": value, "is_lower_bound": is_bound,
            "equal_within_errors": equal,
        })
    });
    json!({
        "scene": first.scene,
        "version": first.version,
        "seed": first.seed,
        "limit_states": first.limit_states,
        "population": first.population,
        "design_variables": report.space.variables,
        "designs": report.answers.iter().enumerate().map(design).collect::<Vec<_>>(),
        "best": best,
        "evaluations": report.refined.added,
        "simulations": report.simulations.0,
        "surrogate_error": report.refined.largest_error,
        "target_error": report.refined.target_error,
    })
}

/// The answers with their tables, sentences and figures.
pub fn answer(report: &DesignReport<'_>) -> Answer {
    let DesignReport { space, answers, best, .. } = report;
    let last = answers.len() - 1;
    let drawn: BTreeSet<usize> =
        [0, last / 2, last].into_iter().chain(best.as_ref().map(|best| best.index)).collect();
    let curve = |i: usize| ComparedStudy { name: report.in_words(i), summary: answers[i].summary.clone() };
    let text = best.as_ref().map(|best| AnswerPart::Text(best_in_words(report, best)));
    let (table, notes) = (AnswerPart::Table(table(report)), AnswerPart::Notes("Errors", sentences(report)));
    Answer {
        name: "designs".to_owned(),
        title: "Designs".to_owned(),
        subtitle: format!("Scene: {}", answers[0].summary.scene),
        parts: text.into_iter().chain([AnswerPart::Figures, table, notes]).collect(),
        figures: figures(space, answers, best.as_ref()),
        curves: if drawn.len() > 1 { drawn.into_iter().map(curve).collect() } else { vec![] },
        files: vec![("designs.csv".to_owned(), csv(space, answers))],
        ..Answer::default()
    }
}

/// The designs with their reliability or lives; of more than [`ROWS`] a terminal shows those at the front of the order of the best.
fn table(report: &DesignReport<'_>) -> Table {
    let DesignReport { space, answers, objective, .. } = report;
    let all = answers.len();
    let mut order: Vec<usize> = (0..all).collect();
    let value = |i: &usize| Best::among(&answers[*i..=*i], *objective).map_or(0.0, |b| b.value);
    order.sort_by(|a, b| value(b).total_cmp(&value(a)));
    order.truncate(ROWS);
    let note = format!("({ROWS} of {all} designs, the best first; --json and --out have all)");
    let cycles = if let Objective::Reliability { cycles } = objective { Some(*cycles) } else { None };
    let levels = if answers[0].summary.is_static() { &[] } else { &LEVELS[..] };
    let at = cycles.map(|cycles| format!("R({cycles}) (95 %)"));
    let lives = levels.iter().map(|level| format!("life at R = {level} (95 %)"));
    let first = (answers[0].summary.limit_states.len() > 1).then(|| "fails first by".to_owned());
    let head = space.variables.iter().map(DesignVariable::label).chain(at).chain(lives).chain(first.clone());
    let row = |DesignAnswer { values, summary, .. }: &DesignAnswer| {
        let at = cycles.map(|cycles| {
            let row = summary.reliability.iter().find(|row| row.cycles == cycles);
            row.map_or(String::new(), |row| reliability(row, "total"))
        });
        let values = values.iter().map(ToString::to_string);
        let lives = levels.iter().map(|level| life_with_limits(life_at(summary, "total", *level)));
        values.chain(at).chain(lives).chain(first.iter().map(|_| leader(summary))).collect()
    };
    let table = Table::new("", head, answers.iter().map(row));
    Table { shown: (all > ROWS).then_some((order, note)), ..table }
}

/// The limit state that most mechanisms of a design violate first by the end of life, with its share.
fn leader(summary: &StudySummary) -> String {
    let shares = summary.first_failure.last().into_iter().flat_map(|row| &row.first);
    let most = shares.max_by(|(_, a), (_, b)| a.total_cmp(b)).filter(|(_, share)| **share > 0.0);
    most.map_or("none".to_owned(), |(name, share)| format!("{name} ({})", percent(*share)))
}

/// The errors of the answers.
fn sentences(report: &DesignReport<'_>) -> Vec<String> {
    let DesignReport { answers, refined, simulations: (simulations, for_designs), command, .. } = report;
    let mut all = vec![format!(
        "Answered from {} simulations over random and design variables together, {} of them added where the reliability of \
         single designs was uncertain, with a population of {} per design.",
        count(*simulations as u64),
        if *for_designs == 0 { "none".to_owned() } else { count(*for_designs as u64) },
        count(answers[0].summary.population as u64)
    )];
    if answers.len() > 1 {
        let note = "The populations of all designs are made from the same random numbers, so the sampling error of a difference \
                    is smaller than that of its two values.";
        all.push(note.to_owned());
    }
    if !refined.is_reached() {
        let [largest, target] = [refined.largest_error, refined.target_error].map(three_digits);
        all.push(format!(
            "The estimated surrogate error of R is up to {largest} (a study stops at {target}); more simulations where it \
             arises reduce it: {command} --max-evaluations 20"
        ));
    }
    let answers = answers.iter().enumerate();
    let mut unresolved = answers.filter_map(|(i, answer)| Some((i, unresolved_fall(&answer.summary)?)));
    if let Some((first, note)) = unresolved.next() {
        let more = unresolved.count();
        let more = if more == 0 { String::new() } else { format!(", and in the same way {more} more") };
        all.push(format!("Caution, design {}{more}: {note}", report.in_words(first)));
    }
    all
}

fn best_in_words(report: &DesignReport<'_>, best: &Best) -> String {
    let (what, value) = match best.objective {
        Objective::Life { level } => {
            // The digits of the table.
            let found = life_at(&report.answers[best.index].summary, "total", level);
            let life = match found {
                LifeAt::Cycles { .. } => life_and_limits(found).0,
                _ => rounded_cycles(best.value, if best.value < 100.0 { 1.0 } else { 10.0 }),
            };
            let bound = if best.is_bound { "more than " } else { "" };
            (format!("Longest life at R = {level}"), format!("{bound}{life} cycles"))
        }
        Objective::Reliability { cycles } => (format!("Largest R({cycles})"), format!("{:.4}", best.value)),
    };
    let mut text = format!("{what}: {value} at {}.", report.in_words(best.index));
    let equal = best.equal.len() - 1;
    if equal > 0 {
        let others = best.equal.iter().filter(|i| **i != best.index);
        let named: Vec<String> = others.take(4).map(|i| report.in_words(*i)).collect();
        let more = if equal > 4 { format!(" and {} others", equal - 4) } else { String::new() };
        text += &format!(" Not worse within the errors: {}{more}.", named.join("; "));
    }
    let values = report.space.variables.iter().zip(&report.answers[best.index].values);
    let at_end = values.filter(|(variable, value)| [variable.lower, variable.upper].contains(value));
    let at_end: Vec<&str> = at_end.map(|(variable, _)| variable.key.as_str()).collect();
    if !at_end.is_empty() && report.answers.len() > 1 {
        text += &format!(" It lies at the end of the range of {}.", at_end.join(", "));
    }
    text
}

/// One row per design, curve and checkpoint: the values of the design variables, `limit_state`, `cycles`, `R`, `standard_error`,
/// and the 95 % interval `lower`, `upper`.
fn csv(space: &DesignSpace, answers: &[DesignAnswer]) -> String {
    let labels = space.variables.iter().map(DesignVariable::label);
    let mut rows = Vec::new();
    for answer in answers {
        let values: Vec<String> = answer.values.iter().map(|value| number(*value)).collect();
        for name in curve_names(&answer.summary) {
            let cells = curve_cells(&answer.summary, &name);
            rows.extend(cells.map(|cells| [&values[..], &cells[..]].concat()));
        }
    }
    csv_table::csv(labels.chain(CURVE_COLUMNS.map(str::to_owned)), rows)
}
