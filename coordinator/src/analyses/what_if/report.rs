//! The answer to a what-if as text for a terminal, as JSON and as a page with figures.

use super::answer::WhatIf;
use super::changes::{ChangedVariable, LawParameters};
use super::sentences::sentences;
use crate::analyses::paired_results::{ChangeOfLife, ChangeRow, curve_names};
use crate::presentation::report::decision::{DecisionPage, DecisionTable};
use crate::presentation::report::format::{count, percent, signed_with_width};
use crate::presentation::report::life::{
    Included, LEVELS, life_and_limits, life_at, reliability, rows_that_matter,
};
use crate::presentation::report::life_change::change_of_life;
use crate::results::summary::{FirstFailureRow, StudySummary};
use crate::statistics::reliability::paired::Change;
use common::scene::Scene;
use common::scene::expression::read_unit;
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

/// The answer as text; `settings` are the changes as typed, `added` is the number of simulations that were added, and
/// `command` the beginning of the command that would add more.
pub fn text(answer: &WhatIf, settings: &[String], added: usize, scene: &Scene, command: &str) -> String {
    let mut text = String::new();
    let typed = if settings.is_empty() { "nothing changes".to_owned() } else { settings.join(", ") };
    text += &format!("what if {typed}\n");
    for [what, before, after] in changes(answer, scene) {
        text += &format!("  {what}: {before} -> {after}\n");
    }
    text.push('\n');
    for table in
        [reliability_table(answer), lives_table(answer), first_failure_table(answer)].into_iter().flatten()
    {
        text += &table.in_columns();
        text.push('\n');
    }
    for sentence in sentences(answer, added, command) {
        text += &format!("{sentence}\n");
    }
    text.replace('\u{a0}', " ")
}

/// The answer as a page.
pub fn page(
    answer: &WhatIf,
    settings: &[String],
    added: usize,
    scene: &Scene,
    command: &str,
) -> DecisionPage {
    let typed = if settings.is_empty() { "nothing changes".to_owned() } else { settings.join(", ") };
    let changes = DecisionTable {
        heading: "Changes".to_owned(),
        head: ["", "before", "after"].map(str::to_owned).to_vec(),
        rows: changes(answer, scene).into_iter().map(|row| row.to_vec()).collect(),
    };
    let tables = [reliability_table(answer), lives_table(answer), first_failure_table(answer)];
    DecisionPage {
        title: format!("What if: {typed}"),
        subtitle: format!("Scene: {}", answer.after.scene),
        sentences: sentences(answer, added, command),
        figures: vec![],
        curves: vec![
            ("before".to_owned(), answer.before.clone()),
            ("after".to_owned(), answer.after.clone()),
        ],
        tables: std::iter::once(changes).chain(tables.into_iter().flatten()).collect(),
    }
}

/// What was changed: name, before, after.
fn changes(answer: &WhatIf, scene: &Scene) -> Vec<[String; 3]> {
    let changes = &answer.changes;
    let variables = changes.variables.iter().map(|v: &ChangedVariable| {
        [v.name.clone(), in_words(&v.before, &v.unit), in_words(&v.after, &v.unit)]
    });
    let thresholds = changes.thresholds.iter().map(|changed| {
        let state = scene.limit_states.iter().find(|state| state.name == changed.limit_state);
        let unit = state.map(|state| scene.outputs[state.output].kind.unit());
        let shown = |value: f64| match &unit {
            Some(unit) => unit.after(&six_digits(unit.to_shown(value))),
            None => six_digits(value),
        };
        let which = if changed.key == "threshold" { "" } else { changed.key.as_str() };
        [
            format!("{which} threshold of {}", changed.limit_state).trim_start().to_owned(),
            shown(changed.before),
            shown(changed.after),
        ]
    });
    let correlations = changes.correlations.iter().map(|changed| {
        let [a, b] = &changed.variables;
        [
            format!("correlation of {a} and {b}, as normals"),
            six_digits(changed.before),
            six_digits(changed.after),
        ]
    });
    variables.chain(thresholds).chain(correlations).collect()
}

fn in_words(law: &LawParameters, unit: &str) -> String {
    // The unit was read when the scene was checked; "1" denotes a plain number.
    let scale = read_unit(unit).map_or(1.0, |unit| unit.multiply / unit.divide);
    let shown = |value: f64| six_digits(value / scale);
    let mut text = format!("{}, mean {}, std {}", law.distribution, shown(law.mean), shown(law.std));
    match (law.lower, law.upper) {
        (Some(lower), Some(upper)) => text += &format!(", from {} to {}", shown(lower), shown(upper)),
        (Some(lower), None) => text += &format!(", from {}", shown(lower)),
        (None, Some(upper)) => text += &format!(", to {}", shown(upper)),
        (None, None) => {}
    }
    if unit == "1" { text } else { format!("{text} {unit}") }
}

/// A value with up to six digits.
fn six_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if (1e-3..1e6).contains(&rounded.abs()) || rounded == 0.0 {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

/// A change with the half-width of its interval and its sign.
fn signed(change: &ChangeRow) -> String {
    let widths = [change.upper.map(|u| u - change.value), change.lower.map(|l| change.value - l)];
    let width = widths.into_iter().flatten().fold(0.0, f64::max);
    signed_with_width(change.value, width)
}

/// R of the system before and after at the checkpoints that matter.
fn reliability_table(answer: &WhatIf) -> Option<DecisionTable> {
    let ends = [&answer.before, &answer.after].map(|summary| rows_that_matter(summary, 0));
    let first = ends.iter().filter_map(|rows| rows.first()).map(|row| row.cycles).min()?;
    let last = ends.iter().filter_map(|rows| rows.last()).map(|row| row.cycles).max()?;
    let matters: Vec<usize> = (0..answer.before.reliability.len())
        .filter(|n| (first..=last).contains(&answer.before.reliability[*n].cycles))
        .collect();
    let shown: Vec<usize> = if matters.len() <= ROWS {
        matters
    } else {
        (0..ROWS).map(|i| matters[i * (matters.len() - 1) / (ROWS - 1)]).collect()
    };
    let row = |n: usize| {
        let change = answer.reliability[n].change.get("total").map_or(String::new(), signed);
        vec![
            count(answer.before.reliability[n].cycles.into()),
            reliability(&answer.before.reliability[n], "total"),
            reliability(&answer.after.reliability[n], "total"),
            change,
        ]
    };
    Some(DecisionTable {
        heading: "Reliability of the system (no limit state exceeded)".to_owned(),
        head: ["cycles", "R before (95 %)", "R after (95 %)", "after minus before (95 %)"]
            .map(str::to_owned)
            .to_vec(),
        rows: shown.into_iter().map(row).collect(),
    })
}

/// Lives before and after, per limit state and in total.
fn lives_table(answer: &WhatIf) -> Option<DecisionTable> {
    if answer.before.lives.is_empty() || answer.after.lives.is_empty() {
        return None;
    }
    let cell = |summary: &StudySummary, name: &str, level: f64| {
        let (life, limits) = life_and_limits(life_at(summary, name, level, Included::All));
        if limits.is_empty() { life } else { format!("{life} ({limits})") }
    };
    let change = |name: &str, level: f64| {
        let is_asked =
            |row: &&ChangeOfLife| row.limit_state == name && row.reliability.to_bits() == level.to_bits();
        let found = answer.lives.iter().find(is_asked).and_then(|row| row.cycles);
        let [before, after] = [&answer.before, &answer.after]
            .map(|summary| life_at(summary, name, level, Included::Statistical));
        change_of_life(found.map(Change::from), before, after)
    };
    let mut names = curve_names(&answer.before);
    if names.len() == 2 {
        names.remove(0);
    }
    names.reverse();
    let rows = names.iter().flat_map(|name| {
        LEVELS.map(|level| {
            vec![
                format!("{name}, R = {level}"),
                cell(&answer.before, name, level),
                cell(&answer.after, name, level),
                change(name, level),
            ]
        })
    });
    Some(DecisionTable {
        heading: "Lives (total: the first failure by any limit state)".to_owned(),
        head: ["life [cycles] at", "before (95 %)", "after (95 %)", "after minus before (95 %)"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    })
}

/// Shares of the first failures at the checkpoint where R of the studied scene is nearest one half, and at the last one.
fn first_failure_table(answer: &WhatIf) -> Option<DecisionTable> {
    let names = &answer.before.limit_states;
    if names.len() < 2 || answer.before.first_failure.is_empty() {
        return None;
    }
    let r = |n: usize| answer.before.reliability[n].reliability.get("total").copied().unwrap_or(1.0);
    let distance = |n: &usize| (r(*n) - 0.5).abs();
    let last = answer.before.first_failure.len().min(answer.after.first_failure.len()) - 1;
    let half = (0..=last).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let mut shown = vec![half];
    if half != last {
        shown.push(last);
    }
    let share =
        |row: &FirstFailureRow, name: &str| row.first.get(name).map_or(String::new(), |s| percent(*s));
    let rows = shown.into_iter().flat_map(|n| {
        let (before, after) = (&answer.before.first_failure[n], &answer.after.first_failure[n]);
        let row = move |name: &String| {
            vec![
                format!("{name}, by {} cycles", count(before.cycles.into())),
                share(before, name),
                share(after, name),
            ]
        };
        let together = vec![
            format!("several at the same checkpoint, by {} cycles", count(before.cycles.into())),
            percent(before.together),
            percent(after.together),
        ];
        names.iter().map(row).chain([together]).collect::<Vec<_>>()
    });
    Some(DecisionTable {
        heading: "First failures".to_owned(),
        head: ["share of all that failed first by", "before", "after"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    })
}
