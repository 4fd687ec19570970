//! Results of a study in sentences.

use super::ReportInput;
use super::figures::shares_of_failures;
use super::format::{count, duration, exactly_with_unit, joined, number_of_cycles, percent, short_percent};
use super::life::{
    LifeAt, failure_probability, governing, leaders, life_and_limits, life_at, unresolved_fall,
};
use super::variants;
use crate::results::summary::StudySummary;
use common::scene::Fails;

/// The life of the system at a level as a card: the life, and its interval or why there is none.
pub fn life(summary: &StudySummary, level: f64) -> (String, String) {
    let found = life_at(summary, "total", level);
    let (life, limits) = life_and_limits(found);
    let below = match found {
        LifeAt::Cycles { .. } => format!("95 % interval {limits}"),
        LifeAt::Unworn { .. } if limits.is_empty() => "too many exceed a limit unworn".into(),
        LifeAt::Unworn { .. } => format!("95 % interval {limits}"),
        LifeAt::Between { .. } => "95 % bound; not resolved by the checkpoints".into(),
        LifeAt::Beyond { lower, end } if lower < end => "95 % bound".into(),
        LifeAt::Beyond { .. } => "end of the life studied".into(),
    };
    (life, below)
}

/// The accuracy of a study, e.g. `balanced`, `draft+step-x0.71 (stated errors below 1 % at the points tried)`.
pub fn accuracy(summary: &StudySummary) -> String {
    let name = &summary.accuracy;
    let tried = |share| format!("{name} (stated errors below {} at the points tried)", short_percent(share));
    summary.max_error.map_or_else(|| name.clone(), tried)
}

/// The sentences at the head of the report.
pub fn sentences(input: &ReportInput) -> Vec<String> {
    let summary = &input.summary;
    let mut text = Vec::new();
    if summary.is_static() {
        text.extend(failure_probabilities(input));
    } else {
        text.extend(variants::sentence(summary));
        text.extend(unresolved_fall(summary));
        text.extend(failures_over_life(input));
    }
    text.push(effort(summary));
    text.extend(failed_runs(summary));
    text
}

/// Failure probabilities of a study with a single checkpoint.
fn failure_probabilities(input: &ReportInput) -> Option<String> {
    let row = input.summary.reliability.first()?;
    let names = input.summary.curve_names();
    let each = joined(names.map(|name| format!("{} ({name})", failure_probability(row, name))), ", ");
    Some(format!("The probability of failure (95 % interval) is {each}."))
}

/// The most frequent failure over life, and the failures at the governing checkpoint.
fn failures_over_life(input: &ReportInput) -> Vec<String> {
    let summary = &input.summary;
    let mut text = Vec::new();
    let criterion = |name: &str| {
        let state = input.scene.limit_states.iter().find(|state| state.name == name)?;
        let (unit, output) = (input.unit_of(state), input.output_of(state));
        let threshold = exactly_with_unit(&unit, state.threshold);
        let how = match state.fails {
            Fails::Above => format!("reaching {threshold}"),
            Fails::Below => format!("falling to {threshold}"),
            Fails::Outside { lower } => {
                format!("falling to {} or reaching {threshold}", exactly_with_unit(&unit, lower))
            }
        };
        Some(format!("{name} ({output} {how})"))
    };
    let named = |name: &str| criterion(name).unwrap_or_else(|| name.to_owned());
    match leaders(summary).as_slice() {
        [] => text.push(without_leader(summary, input.subject())),
        [(from, only)] if summary.limit_states.len() == 1 => text.push(format!(
            "The {} fails by {}; the failed share exceeds 0.1 % from {} on.",
            input.subject(),
            named(only),
            number_of_cycles(*from)
        )),
        [(from, first), rest @ ..] => {
            let always = if rest.is_empty() { ", over the whole life studied" } else { "" };
            let until = rest.first().map_or("cycles on".to_string(), |(next, _)| {
                format!("cycles until another leads from {}", count((*next).into()))
            });
            text.push(format!(
                "Most frequent failure: {}, ahead of any other by more than 0.1 % of the {}s from {} {until}{always}.",
                named(first),
                input.subject(),
                count((*from).into())
            ));
            text.extend(rest.iter().map(|(from, next)| {
                let from = number_of_cycles(*from);
                format!("From {from} on, {} has been the first failure of most.", named(next))
            }));
        }
    }
    if let Some(row) = governing(summary).filter(|_| summary.limit_states.len() > 1) {
        let failed = |name: &str| row.reliability.get(name).map_or(f64::NAN, |r| 1.0 - r);
        let parts = summary.limit_states.iter().map(|name| format!("{} by {name}", percent(failed(name))));
        if failed("total") > 5e-4 {
            text.push(format!(
                "At {}, {} have failed: {} (a {} that failed in several ways is counted in each).",
                number_of_cycles(row.cycles),
                percent(failed("total")),
                joined(parts, ", "),
                input.subject()
            ));
            let causes = shares_of_failures(summary, row.cycles);
            text.extend(causes.map(|shares| format!("First cause of these failures: {shares}.")));
        }
    }
    text
}

/// Where no limit state leads: nothing fails, or several fail about as often.
fn without_leader(summary: &StudySummary, subject: &str) -> String {
    let share = |name: &str| {
        let r = summary.reliability.last().and_then(|row| row.reliability.get(name));
        1.0 - r.copied().unwrap_or(1.0)
    };
    let failed = share("total");
    if failed <= 0.0 {
        return "No limit state is reached within the life studied.".to_owned();
    }
    let Some(last) = summary.reliability.last() else { return String::new() };
    let by = match summary.limit_states.as_slice() {
        [only] => format!(" by {only}"),
        _ => format!(
            ": no limit state is ahead of the others by more than 0.1 % of the {subject}s at any checkpoint"
        ),
    };
    format!("By {}, {} have failed{by}.", number_of_cycles(last.cycles), percent(failed))
}

/// Simulations without a result, the share of the population they represent, and the first cause; `None` if there are
/// none.
fn failed_runs(summary: &StudySummary) -> Option<String> {
    let first = summary.failures.simulations.first()?;
    let counts = summary.evaluations;
    let share = percent(summary.failures.barred_share);
    let meaning = if summary.is_direct() {
        format!(
            "the intervals of R contain both extremes, that all or none of these {share} of the samples have failed"
        )
    } else {
        format!(
            "up to an estimated {share} of the population, near these, cannot be simulated: R is extrapolated there, and its intervals contain both extremes, that all or none of these points fail"
        )
    };
    Some(format!(
        "{} of {} simulations gave no result and are excluded; {meaning}. First cause: {}.",
        count(counts.failed as u64),
        count(counts.total as u64),
        first.cause.trim_end_matches('.')
    ))
}

/// Number of simulations, population and time.
pub fn effort(summary: &StudySummary) -> String {
    let counts = summary.evaluations;
    let failed = match counts.failed {
        0 => "none without a result".to_string(),
        n => format!("{} without a result", count(n as u64)),
    };
    let surrogate = if summary.is_direct() {
        format!(", of the nominal point and of {} samples", count(counts.added as u64))
    } else if counts.added > 0 || !summary.convergence.rounds.is_empty() {
        format!(
            ", {} of them placed by learning, represent a population of {} {}",
            count(counts.added as u64),
            count(summary.population as u64),
            if summary.of_mechanism() { "mechanisms" } else { "systems" }
        )
    } else {
        String::new()
    };
    format!(
        "{} simulations ({failed}){surrogate}; total time {}.",
        count(counts.total as u64),
        duration(summary.timing_s.total)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_failures_without_a_leading_limit_state_were_denied() {
        let mut summary = crate::tests::test_study::study().summary;
        summary.first_failure.clear();
        let names = summary.limit_states.clone();
        for row in &mut summary.reliability {
            row.reliability.extend(names.iter().map(|name| (name.clone(), 0.955)));
            row.reliability.insert("total".to_owned(), 0.955);
        }
        assert!(super::super::life::leaders(&summary).is_empty());
        let said = without_leader(&summary, "mechanism");
        assert!(said.contains("4.5") && said.contains("have failed: no limit state is ahead"), "{said}");
        for row in &mut summary.reliability {
            row.reliability.values_mut().for_each(|r| *r = 1.0);
        }
        assert!(without_leader(&summary, "mechanism").starts_with("No limit state is reached"));
    }
}
