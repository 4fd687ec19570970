//! The numerical errors that the evaluations state of their outputs, as a table over life and in sentences.

use super::format::{count, percent, three_digits};
use super::input::ReportInput;
use super::life::{Included, LifeAt, governing, life_and_limits, life_at, states_numerical_errors};
use super::tables::table;
use maud::{Markup, Render, html};

/// Lives shown in the table: the end of every sixth of the life, and the governing checkpoint.
const SIXTHS: usize = 6;

/// Typical and largest stated error of every limit state's output over life, in its unit and relative to its limit;
/// empty if no evaluation states errors.
pub fn errors_over_life(input: &ReportInput) -> Markup {
    let governing = governing(&input.summary).map(|row| row.cycles);
    let mut rows = Vec::new();
    for state in &input.scene.limit_states {
        let errors = input.stated.get(state.output).map_or(&[][..], Vec::as_slice);
        let unit = input.unit_of(state);
        let share = |error: f64| percent(error.abs() / state.scale());
        let value = |error: f64| unit.after(&three_digits(unit.to_shown(error)));
        for (k, stated) in errors.iter().enumerate() {
            let ends_a_sixth = (1..=SIXTHS).any(|sixth| k + 1 == errors.len() * sixth / SIXTHS);
            if ends_a_sixth || Some(stated.cycles) == governing {
                let cells = [
                    input.output_of(state),
                    count(stated.cycles.into()),
                    value(stated.typical),
                    share(stated.typical),
                    value(stated.largest),
                    share(stated.largest),
                ];
                rows.push(cells.map(|cell| cell.render()).to_vec());
            }
        }
    }
    let head = ["stated error of", "at cycles", "typical", "of the limit", "largest", "of the limit"];
    if rows.is_empty() {
        html! {}
    } else {
        table(&head, rows.into_iter())
    }
}

/// Meaning and size of the stated errors, and their effect on the life; empty if no evaluation states errors.
pub fn sentences(input: &ReportInput) -> Vec<String> {
    let Some(row) = governing(&input.summary) else { return vec![] };
    let sizes: Vec<String> = input
        .scene
        .limit_states
        .iter()
        .filter_map(|state| {
            let stated = input.stated.get(state.output)?.iter().find(|stated| stated.cycles == row.cycles)?;
            let share = |error: f64| percent(error.abs() / state.scale());
            let name = input.output_of(state);
            Some(format!("{name} {}, at most {}", share(stated.typical), share(stated.largest)))
        })
        .collect();
    if sizes.is_empty() {
        return vec![];
    }
    let mut text = vec![format!(
        "Every simulation states the numerical error of its outputs{}; the true error should be less than twice the stated \
         one in 95 % of cases. Typical and largest stated error at {} cycles, as a share of the limit: {}.",
        if input.summary.of_mechanism() { ", estimated from its time and wear steps" } else { "" },
        count(row.cycles.into()),
        sizes.join("; ")
    )];
    if !input.summary.is_static() {
        text.extend(effect_on_life(input));
    }
    let shares: Vec<String> = input
        .summary
        .surrogates
        .iter()
        .filter_map(|surrogate| Some((surrogate, surrogate.share_of_stated_error?)))
        .map(|(surrogate, share)| format!("{} for {}", percent(share), surrogate.limit_state))
        .collect();
    if !shares.is_empty() {
        text.push(format!(
            "The surrogates treat {} of the stated errors as noise that varies from one simulation to the next; the rest is \
             common to all simulations and remains in the predictions.",
            shares.join(" and ")
        ));
    }
    text
}

/// Effect of the stated errors on the interval of the life at R = 0.5.
pub fn effect_on_life(input: &ReportInput) -> Option<String> {
    let summary = &input.summary;
    let limits = |included| match life_at(summary, "total", 0.5, included) {
        known @ LifeAt::Cycles { .. } => Some(life_and_limits(known).1),
        LifeAt::Unworn { .. } | LifeAt::Between { .. } | LifeAt::Beyond { .. } => None,
    };
    if !states_numerical_errors(summary) {
        return None;
    }
    let (with, without) = (limits(Included::All)?, limits(Included::Statistical)?);
    Some(format!(
        "The 95 % interval of the life at R = 0.5 is {without} cycles without the numerical errors, and {with} if in \
         addition every response is off by its stated error in the same direction. The latter is not a standard error: a finer \
         accuracy and, for the wear, more control points reduce it, more simulations do not."
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;

    #[test]
    fn the_sentences_contain_shares_and_lives() {
        let input = test_study::report_input();
        let text = sentences(&input).join(" ").replace('\u{a0}', " ");
        // 0.25 of 30 um, 0.1 of 25 r/min.
        assert!(text.contains("max wear depth 0.8 %, at most 0.8 %"), "{text}");
        assert!(text.contains("angular velocity difference 0.4 %, at most 0.4 %"), "{text}");
        assert!(text.contains("interval of the life at R = 0.5 is 65 "), "{text}");
        assert!(text.contains("5.0 % for wear"), "{text}");
        let mut silent = input.clone();
        silent.stated.clear();
        assert!(sentences(&silent).is_empty() && errors_over_life(&silent).0.is_empty());
    }
}
