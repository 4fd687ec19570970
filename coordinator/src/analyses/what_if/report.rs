//! The answer to a what-if as JSON, and with its tables, sentences and figures.

use super::answer::{Agreement, WhatIf};
use super::changes::{ChangedThreshold, ChangedVariable, LawParameters};
use crate::analyses::paired_results::{curve_names, spread};
use crate::presentation::report::compare::change_of_life;
use crate::presentation::report::format::{
    before_unit, count, percent, shortest, signed_with_width, three_digits, unit_scale,
};
use crate::presentation::report::life::{
    LEVELS, life_at, life_with_limits, reliability, rows_that_matter, unresolved_fall,
};
use crate::presentation::report::untested::no_simulated_failure;
use crate::presentation::report::{Answer, AnswerPart, ComparedStudy, Table};
use crate::results::summary::{FirstFailureRow, StudySummary};
use crate::statistics::reliability::paired::Change;
use common::scene::Scene;
use serde_json::{Value, json};

/// Most checkpoints in a table of the text.
const ROWS: usize = 12;

/// The answer as JSON. `reliability`, `lives`, `first_failure` and `curves` are those of the changed scene in the shape of
/// `summary.json`, `before` has the same for the studied scene, `evaluations` is the number of simulations that were added.
pub fn json(answer: &WhatIf, added: usize) -> Value {
    let of = |summary: &StudySummary| {
        json!({
            "reliability": summary.reliability,
            "lives": summary.lives,
            "curves": summary.curves,
            "first_failure": summary.first_failure,
            "unresolved_fall": summary.unresolved_fall,
            "untested": summary.untested,
        })
    };
    let mut found = of(&answer.after);
    let own = json!({
        "scene": answer.after.scene,
        "version": answer.after.version,
        "seed": answer.after.seed,
        "limit_states": answer.after.limit_states,
        "population": answer.after.population,
        "evaluations": added,
        "simulations": answer.simulations,
        "changes": answer.changes,
        "before": of(&answer.before),
        "change": { "reliability": answer.reliability, "lives": answer.lives },
        "region": answer.region,
        "agreement": answer.agreement,
        "surrogate_error": answer.surrogate_error,
        "target_error": answer.target_error,
        "seconds": answer.seconds,
    });
    if let (Value::Object(found), Value::Object(own)) = (&mut found, own) {
        found.extend(own);
    }
    found
}

/// The answer; `settings` are the changes as typed, `added` is the number of simulations that were added, and `command` the
/// beginning of the command that would add more.
pub fn answer(found: &WhatIf, settings: &[String], added: usize, scene: &Scene, command: &str) -> Answer {
    let typed = if settings.is_empty() { "nothing changes".to_owned() } else { settings.join(", ") };
    let changes = Table::new("Changes", ["", "before", "after"], changes(found, scene)).with_left(&[0, 1, 2]);
    let changes = Some(changes).filter(|changes| !changes.rows.is_empty());
    let tables = [changes, reliability_table(found), lives_table(found), first_failure_table(found)];
    let tables = tables.into_iter().flatten().map(AnswerPart::Table);
    let notes = AnswerPart::Notes("Errors", sentences(found, added, command));
    Answer {
        name: "what-if".to_owned(),
        title: format!("What if: {typed}"),
        subtitle: format!("Scene: {}", found.after.scene),
        parts: std::iter::once(AnswerPart::Figures).chain(tables).chain([notes]).collect(),
        curves: [("before", &found.before), ("after", &found.after)]
            .map(|(name, summary)| ComparedStudy { name: name.to_owned(), summary: summary.clone() })
            .to_vec(),
        ..Answer::default()
    }
}

/// What was changed: name, before, after.
fn changes(answer: &WhatIf, scene: &Scene) -> Vec<Vec<String>> {
    let changes = &answer.changes;
    let variables = changes.variables.iter().map(|v: &ChangedVariable| {
        vec![v.name.clone(), in_words(&v.before, &v.unit), in_words(&v.after, &v.unit)]
    });
    let thresholds = changes.thresholds.iter().map(|changed| {
        let ChangedThreshold { limit_state, key, before, after } = changed;
        let state = scene.limit_states.iter().find(|state| state.name == *limit_state);
        let unit = state.map(|state| scene.unit_of(&scene.outputs[state.output]));
        let [before, after] = [*before, *after].map(|value| match &unit {
            Some(unit) => unit.after(&shortest(unit.to_shown(value), 6)),
            None => shortest(value, 6),
        });
        let which = if key == "threshold" { String::new() } else { format!("{key} ") };
        vec![format!("{which}threshold of {limit_state}"), before, after]
    });
    let correlations = changes.correlations.iter().map(|changed| {
        let [a, b] = &changed.variables;
        let [before, after] = [changed.before, changed.after].map(|value| shortest(value, 6));
        vec![format!("correlation of {a} and {b}, as normals"), before, after]
    });
    variables.chain(thresholds).chain(correlations).collect()
}

fn in_words(law: &LawParameters, unit: &str) -> String {
    // The unit was read when the scene was checked; "1" denotes a plain number.
    let scale = unit_scale(unit);
    let shown = |value: f64| shortest(value / scale, 6);
    let from = law.lower.map_or(String::new(), |lower| format!(" from {}", shown(lower)));
    let to = law.upper.map_or(String::new(), |upper| format!(" to {}", shown(upper)));
    let comma = if from.is_empty() && to.is_empty() { "" } else { "," };
    let (mean, std) = (shown(law.mean), shown(law.std));
    before_unit(&format!("{}, mean {mean}, std {std}{comma}{from}{to}", law.distribution), unit)
}

/// A change with the half-width of its interval and its sign.
fn signed(change: &Change) -> String {
    let widths = [change.upper.map(|u| u - change.value), change.lower.map(|l| change.value - l)];
    let width = widths.into_iter().flatten().fold(0.0, f64::max);
    signed_with_width(change.value, width)
}

/// R of the system before and after at the checkpoints that matter.
fn reliability_table(answer: &WhatIf) -> Option<Table> {
    let ends = [&answer.before, &answer.after].map(|summary| rows_that_matter(summary, 0));
    let first = ends.iter().filter_map(|rows| rows.first()).map(|row| row.cycles).min()?;
    let last = ends.iter().filter_map(|rows| rows.last()).map(|row| row.cycles).max()?;
    let matters: Vec<usize> = (0..answer.before.reliability.len())
        .filter(|n| (first..=last).contains(&answer.before.reliability[*n].cycles))
        .collect();
    let row = |n: usize| {
        let rows = [&answer.before, &answer.after].map(|summary| &summary.reliability[n]);
        let [before, after] = rows.map(|row| reliability(row, "total"));
        let change = answer.reliability[n].change.get("total").map_or(String::new(), signed);
        vec![count(rows[0].cycles.into()), before, after, change]
    };
    let head = ["cycles", "R before (95 %)", "R after (95 %)", "after minus before (95 %)"];
    let rows = spread(&matters, ROWS).into_iter().map(row);
    Some(Table::new("Reliability of the system (no limit state exceeded)", head, rows))
}

/// Lives before and after, per limit state and in total.
fn lives_table(answer: &WhatIf) -> Option<Table> {
    if answer.before.lives.is_empty() || answer.after.lives.is_empty() {
        return None;
    }
    let mut names = curve_names(&answer.before);
    if names.len() == 2 {
        names.remove(0);
    }
    names.reverse();
    let rows = names.iter().flat_map(|name| {
        LEVELS.map(|level| {
            let found = answer.lives.iter().find(|row| row.is_of(name, level)).and_then(|row| row.cycles);
            let lives = [&answer.before, &answer.after].map(|summary| life_at(summary, name, level));
            let [before, after] = lives.map(life_with_limits);
            let change = change_of_life(found, lives[0], lives[1]);
            vec![format!("{name}, R = {level}"), before, after, change]
        })
    });
    let head = ["life [cycles] at", "before (95 %)", "after (95 %)", "after minus before (95 %)"];
    Some(Table::new("Lives (total: the first failure by any limit state)", head, rows))
}

/// Shares of the first failures at the checkpoint where R of the studied scene is nearest one half, and at the last one.
fn first_failure_table(answer: &WhatIf) -> Option<Table> {
    let names = &answer.before.limit_states;
    if names.len() < 2 || answer.before.first_failure.is_empty() {
        return None;
    }
    let r = |n: usize| answer.before.reliability[n].reliability.get("total").copied().unwrap_or(1.0);
    let distance = |n: &usize| (r(*n) - 0.5).abs();
    let last = answer.before.first_failure.len().min(answer.after.first_failure.len()) - 1;
    let half = (0..=last).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let shown = [Some(half), Some(last).filter(|last| *last != half)].into_iter().flatten();
    let rows = shown.flat_map(|n| {
        let both = [&answer.before, &answer.after].map(|summary| &summary.first_failure[n]);
        let row = move |name: &str, share: &dyn Fn(&FirstFailureRow) -> Option<f64>| {
            let [before, after] = both.map(|row| share(row).map_or(String::new(), percent));
            vec![format!("{name}, by {} cycles", count(both[0].cycles.into())), before, after]
        };
        let of_state = move |name: &String| row(name, &|found| found.first.get(name).copied());
        let together = row("several at the same life", &|found| Some(found.together));
        names.iter().map(of_state).chain([together])
    });
    Some(Table::new("First failures", ["share of all that failed first by", "before", "after"], rows))
}

/// What the numbers mean, how far they can be trusted, and what would improve them.
fn sentences(answer: &WhatIf, added: usize, command: &str) -> Vec<String> {
    let new = if added == 0 { "none".to_owned() } else { count(added as u64) };
    let both = [&answer.before, &answer.after];
    let [before, after] = both.map(|summary| count(summary.population as u64));
    let sizes = if before == after {
        format!("{after} before and after")
    } else {
        format!("{before} before, {after} after")
    };
    let samples = if both.iter().any(|summary| summary.conditional.is_some()) {
        "Failures of the study are rare: where they are, R is counted over samples near the limits, as in the study, and the errors of a \
         change are those of both its values."
    } else {
        "Both populations are made from the same random numbers, so the sampling error of a change is smaller than that of \
         its two values; their other errors are taken as independent."
    };
    let simulations = count(answer.simulations as u64);
    let mut all = vec![
        format!("Answered from {simulations} simulations, {new} of them new, with a population of {sizes}."),
        samples.to_owned(),
    ];
    let differs = |agreement: &&Agreement| agreement.stated > 0.0 || agreement.largest_difference > 0.0;
    if let Some(agreement) = answer.agreement.as_ref().filter(differs) {
        let Agreement { largest_difference, limit_state, cycles, stated } = agreement;
        let [difference, stated] = [*largest_difference, *stated].map(three_digits);
        all.push(format!(
            "Without the changes, R differs from that of the study's own summary by {difference} at most ({limit_state} at {} cycles, \
             where the study states ± {stated}).",
            count((*cycles).into())
        ));
    }
    all.extend(no_simulated_failure(&answer.after).map(|caution| format!("Caution: {caution}.")));
    all.push(region(answer));
    let [error, target] = [answer.surrogate_error, answer.target_error].map(three_digits);
    all.extend((answer.surrogate_error > answer.target_error).then(|| {
        format!(
            "The estimated surrogate error of R after the change is up to {error} (a study stops at {target}); more simulations where it \
             arises reduce it: {command} --max-evaluations 20"
        )
    }));
    all.extend(unresolved_fall(&answer.after).map(|note| format!("Caution: {note}")));
    all
}

/// Where the changed population leaves the simulated region.
fn region(answer: &WhatIf) -> String {
    let region = &answer.region;
    let caution = if region.is_left() { "Caution: " } else { "" };
    let shares = [region.outside_after, region.outside_before, region.uncertain_after];
    let [after, before, uncertain] = shares.map(percent);
    let mut text = format!(
        "{caution}{after} of the changed population lie outside the range of the simulated values in at least one variable ({before} of \
         the studied population); in {uncertain} the surrogates are less certain than for 99 % of the studied population."
    );
    let most =
        region.variables.iter().filter(|v| v.is_left()).take(3).map(|v| {
            format!("{} ({}, before {})", v.name, percent(v.outside_after), percent(v.outside_before))
        });
    let most: Vec<String> = most.collect();
    if !most.is_empty() {
        text += &format!(" Most of them leave it in {}.", most.join(", "));
    }
    if region.is_left() {
        text += " The stated errors grow there as the surrogates expect; whether the response goes on as inside, only \
                 simulations show (--max-evaluations).";
    }
    let unknown = region.unknown_share();
    if unknown > 0.0 {
        text += &format!(
            " That is most of it: the intervals after the change allow that all or none of these {} fail.",
            percent(unknown)
        );
    }
    text
}
