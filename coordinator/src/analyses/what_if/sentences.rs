//! Sentences on the meaning of an answer to a what-if, on its errors, and on the population outside the simulated region.

use super::answer::{Agreement, WhatIf};
use crate::presentation::report::format::{count, percent, three_digits};
use crate::presentation::report::life::{states_numerical_errors, unresolved_fall};

/// What the numbers mean, how far they can be trusted, and what would improve them.
pub fn sentences(answer: &WhatIf, added: usize, command: &str) -> Vec<String> {
    let mut all = Vec::new();
    let new = if added == 0 {
        "none of them new".to_owned()
    } else {
        format!("{} of them new", count(added as u64))
    };
    all.push(format!(
        "Answered from {} simulations, {new}, with a population of {} before and after.",
        count(answer.simulations as u64),
        count(answer.after.population as u64)
    ));
    all.push(
        "Both populations are made from the same random numbers, so the sampling error of a change is smaller than that of \
         its two values; their surrogate errors are taken as independent."
            .to_owned(),
    );
    if states_numerical_errors(&answer.after) {
        all.push(
            "The intervals of the lives contain the stated numerical errors of the simulations; those of the changes do not, \
             because these errors shift both lives in the same direction."
                .to_owned(),
        );
    }
    let differs = |agreement: &&Agreement| agreement.stated > 0.0 || agreement.largest_difference > 0.0;
    if let Some(agreement) = answer.agreement.as_ref().filter(differs) {
        all.push(format!(
            "Without the changes, R differs from that of the study's own summary by {} at most ({} at {} cycles, where the study states ± {}).",
            three_digits(agreement.largest_difference),
            agreement.limit_state,
            count(agreement.cycles.into()),
            three_digits(agreement.stated)
        ));
    }
    if answer.is_rare {
        all.push(
            "Failures of the study are rare: its own result comes from samples near the limit, this answer from a plain count, \
             which bounds small failure probabilities only."
                .to_owned(),
        );
    }
    all.push(region(answer));
    if answer.surrogate_error > answer.target_error {
        all.push(format!(
            "The estimated surrogate error of R after the change is up to {} (a study stops at {}); more simulations where it \
             arises reduce it: {command} --refine 20",
            three_digits(answer.surrogate_error),
            three_digits(answer.target_error)
        ));
    }
    all.extend(unresolved_fall(&answer.after).map(|note| format!("Caution: {note}")));
    all
}

/// Where the changed population leaves the simulated region.
fn region(answer: &WhatIf) -> String {
    let region = &answer.region;
    let mut text = format!(
        "{}{} of the changed population lie outside the range of the simulated values in at least one variable ({} of the \
         studied population); in {} the surrogates are less certain than for 99 % of the studied population.",
        if region.is_left() { "Caution: " } else { "" },
        percent(region.outside_after),
        percent(region.outside_before),
        percent(region.uncertain_after)
    );
    let most: Vec<String> = region
        .variables
        .iter()
        .filter(|v| v.is_left())
        .take(3)
        .map(|v| format!("{} ({}, before {})", v.name, percent(v.outside_after), percent(v.outside_before)))
        .collect();
    if !most.is_empty() {
        text += &format!(" Most of them leave it in {}.", most.join(", "));
    }
    if region.is_left() {
        text += " The stated errors grow there as the surrogates expect; whether the response goes on as inside, only \
                 simulations show (--refine).";
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
