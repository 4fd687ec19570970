//! The numerical errors that the evaluations state of their outputs, as a table over life and in sentences.

use super::format::{count, percent, with_unit};
use super::input::ReportInput;
use super::life::governing;
use super::stated_errors::StatedAt;
use super::tables::table_of;
use common::scene::LimitState;
use maud::{Markup, html};

/// Lives shown in the table: the end of every sixth of the life, and the governing checkpoint.
const SIXTHS: usize = 6;

/// Typical and largest stated error of every limit state's output over life, in its unit and relative to its limit;
/// empty if no evaluation states errors.
pub fn errors_over_life(input: &ReportInput) -> Markup {
    let governing = governing(&input.summary).map(|row| row.cycles);
    let rows = input.scene.limit_states.iter().flat_map(|state| {
        let errors = input.stated.get(state.output).map_or(&[][..], Vec::as_slice);
        let is_shown = move |(k, stated): &(usize, &StatedAt)| {
            (1..=SIXTHS).any(|sixth| k + 1 == errors.len() * sixth / SIXTHS)
                || Some(stated.cycles) == governing
        };
        errors.iter().enumerate().filter(is_shown).map(move |(_, stated)| (state, stated))
    });
    let rows: Vec<(&LimitState, &StatedAt)> = rows.collect();
    if rows.is_empty() {
        return html! {};
    }
    let value = |state: &LimitState, error: f64| with_unit(&input.unit_of(state), error);
    table_of::<(&LimitState, &StatedAt)>(
        &[
            ("stated error of", &|(state, _)| input.output_of(state)),
            ("at cycles", &|(_, stated)| count(stated.cycles.into())),
            ("typical", &|(state, stated)| value(state, stated.typical)),
            ("of the limit", &|(state, stated)| of_limit(state, stated.typical)),
            ("largest", &|(state, stated)| value(state, stated.largest)),
            ("of the limit", &|(state, stated)| of_limit(state, stated.largest)),
        ],
        rows,
    )
}

/// An error as a share of its limit.
fn of_limit(state: &LimitState, error: f64) -> String {
    percent(error.abs() / state.scale())
}

/// Meaning and size of the stated errors, and their place in the intervals; empty if no evaluation states errors.
pub fn sentences(input: &ReportInput) -> Vec<String> {
    let Some(row) = governing(&input.summary) else { return vec![] };
    let sizes: Vec<String> = input
        .scene
        .limit_states
        .iter()
        .filter_map(|state| {
            let stated = input.stated.get(state.output)?.iter().find(|stated| stated.cycles == row.cycles)?;
            let [typical, largest] = [stated.typical, stated.largest].map(|error| of_limit(state, error));
            Some(format!("{} {typical}, at most {largest}", input.output_of(state)))
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
    text.push(
        if input.summary.levels.is_some() {
            "Pairs of simulations at finer levels correct the results, and their error takes the place of the stated one in all intervals."
        } else {
            "In the intervals of R and of the lives every response is off by its stated error in the same direction; a finer accuracy, finer \
             levels and, for the wear, more control points reduce that, more simulations do not."
        }
        .to_owned(),
    );
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
        assert!(text.contains("off by its stated error in the same direction"), "{text}");
        assert!(text.contains("5.0 % for wear"), "{text}");
        let mut silent = input.clone();
        silent.stated.clear();
        assert!(sentences(&silent).is_empty() && errors_over_life(&silent).0.is_empty());
    }
}
