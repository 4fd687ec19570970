//! Parts of the interval of R and the levels of accuracy that correct it, in words and as a table; the stated numerical errors in words.

use super::format::{count, fixed, joined, percent, three_digits};
use super::life::governing;
use super::{ReportInput, table_of};
use crate::results::reliability_summary::ErrorParts;
use crate::results::summary::{ReliabilityRow, StudySummary};
use crate::results::summary_rows::{DifferenceRow, LevelsRow};
use crate::statistics::reliability::REACH;
use common::scene::LimitState;
use maud::{Markup, html};

/// Names of the parts of an interval.
pub const PARTS: [&str; 3] = ["samples", "surrogates", "numerical error"];

/// What reduces a part of the interval of a row, by its place in [`PARTS`], with its half width [1]; `None` where nothing of the program does.
fn remedy(summary: &StudySummary, row: &ReliabilityRow, place: usize, width: f64) -> Option<&'static str> {
    let r = row.reliability.get("total")?;
    let of_counting = REACH * (r * (1.0 - r) / summary.population.max(1) as f64).sqrt();
    let is_counting = width <= BEYOND_COUNTING * of_counting;
    match place {
        0 if summary.conditional.is_some() => None,
        0 if !is_counting && summary.failures.barred_share > 0.0 => {
            Some("simulations that give a result where they fail")
        }
        0 if !is_counting && summary.untested.is_some() => Some("more simulations, `--max-evaluations`"),
        0 => Some("a larger population, `--samples`"),
        1 => Some("more simulations, `--max-evaluations` and a smaller `--target-error`"),
        _ if summary.of_cycles() => {
            Some("more `control_points` or a finer `accuracy` of the scene, or more instants of the program")
        }
        _ if !summary.of_mechanism() && summary.levels.is_some() => {
            Some("a finer last level of the simulator, or `finest_is_exact`")
        }
        _ if !summary.of_mechanism() => Some("smaller errors, or `levels`, of the simulator"),
        _ if summary.is_direct() || summary.method == "ak-mcs" => Some("a finer accuracy, `--accuracy`"),
        _ => Some("finer levels or a finer accuracy, `--levels`"),
    }
}

/// Half width over that of counting samples beyond which the part of the samples has another reason [1].
const BEYOND_COUNTING: f64 = 1.5;

/// The half width of a part of the interval, by its place in [`PARTS`].
fn half_width(summary: &StudySummary, place: usize, width: f64) -> String {
    match (place, width) {
        (2, 0.0) if !summary.of_mechanism() && !has_correction(summary) => "not stated".to_owned(),
        (_, width) if !(1e-9..1e-4).contains(&width) => fixed(width, 4),
        _ => three_digits(width),
    }
}

/// Half widths of the 95 % interval by each part, in the order of [`PARTS`] [1].
pub fn half_widths(parts: &ErrorParts) -> [f64; 3] {
    [parts.sampling, parts.surrogate, parts.numerical].map(|part| REACH * part)
}

/// What the interval of R of the system consists of where it is nearest 1/2, what reduces its largest part, and the corrections by finer
/// levels; empty in studies by earlier versions.
pub fn parts_and_levels(summary: &StudySummary) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some((row, parts)) = governing(summary).and_then(|row| Some((row, row.parts.get("total")?))) {
        let widths = half_widths(parts);
        let is_shown = |place: &usize| !(summary.is_direct() && *place == 1);
        let shown = (0..PARTS.len()).filter(is_shown);
        let each = shown.clone().map(|i| format!("{} {}", PARTS[i], half_width(summary, i, widths[i])));
        let each = joined(each, ", ");
        let largest = shown.max_by(|a, b| widths[*a].total_cmp(&widths[*b])).filter(|i| widths[*i] > 0.0);
        let remedy = largest.and_then(|i| remedy(summary, row, i, widths[i]));
        let remedy = remedy.map_or(String::new(), |what| format!("; largest part reduced by {what}"));
        let at = format!(" at {} cycles", count(row.cycles.into()));
        let at = if summary.is_static() { "" } else { &at };
        lines.push(format!("parts of the interval of R total{at}, half widths: {each}{remedy}"));
    }
    if let Some(levels) = &summary.levels {
        let [pairs, thirds] = levels.pairs;
        let third = if thirds > 0 { format!(", {thirds} of them at a third one") } else { String::new() };
        let found = joined(levels.differences.iter().map(|row| difference(row, thirds > 0)), ", ");
        lines.push(if found.is_empty() {
            let known = if leaves_errors_to_levels(summary) {
                "of the numerical error the intervals contain that of the time steps alone; one level, `--levels`, has all of it stated"
            } else {
                "the intervals contain the numerical error that simulations state, if any, and nothing of what the levels would show"
            };
            format!("caution: too few pairs of levels gave a result{}; {known}", failures(levels))
        } else {
            let unordered = thirds > 0 && levels.differences.iter().any(|row| row.order.is_none());
            let ask = unordered && !summary.of_mechanism();
            format!(
                "levels: results corrected by {pairs} pairs at a finer level{third}, at the limit {found}{}{}",
                failures(levels),
                if ask { "; are the levels in order, the coarsest first?" } else { "" }
            )
        });
    }
    lines
}

/// A difference in words, e.g. `asymmetry +1.8 % +- 0.2 % (order 2.0)`, the order where there is a `third` level.
fn difference(row: &DifferenceRow, third: bool) -> String {
    let order = match row.order {
        Some(order) => format!(" (order {})", fixed(order, 1)),
        None if third => " (no order of convergence)".to_owned(),
        None => String::new(),
    };
    format!("{} {} ± {}{order}", row.limit_state, signed_percent(row.correction), percent(row.error))
}

/// Simulations at finer levels without a result, in brackets; empty without any.
fn failures(levels: &LevelsRow) -> String {
    let cause = levels.cause.as_ref().map_or(String::new(), |cause| format!(", first cause: {cause}"));
    match levels.failed {
        0 => String::new(),
        failed => format!(" ({failed} of {} finer simulations failed{cause})", levels.evaluations),
    }
}

/// True if pairs of levels correct the results.
fn has_correction(summary: &StudySummary) -> bool {
    summary.levels.as_ref().is_some_and(|levels| !levels.differences.is_empty())
}

fn signed_percent(share: f64) -> String {
    format!("{}{}", if share < 0.0 { "-" } else { "+" }, percent(share.abs()))
}

/// The differences of the levels; nothing for a study without any.
pub fn table_of_levels(summary: &StudySummary) -> Markup {
    let differences = summary.levels.as_ref().map_or(&[][..], |levels| &levels.differences);
    if differences.is_empty() {
        return html! {};
    }
    table_of::<&DifferenceRow>(
        &[
            ("difference of the levels", &|row| row.limit_state.clone()),
            ("form", &|row| row.form.clone()),
            ("of the limit", &|row| signed_percent(row.correction)),
            ("± (95 %)", &|row| percent(row.error)),
            ("spread from point to point", &|row| percent(row.rough)),
            ("order", &|row| row.order.map_or("not observed".to_owned(), |order| fixed(order, 1))),
        ],
        differences,
    )
}

/// True if simulations state a part of their error alone: of mechanisms with levels, unless all of it is the shape of a noise.
fn leaves_errors_to_levels(summary: &StudySummary) -> bool {
    let as_noise = summary.surrogates.iter().any(|one| one.share_of_stated_error.is_some());
    summary.of_mechanism() && summary.levels.is_some() && !as_noise
}

/// Meaning and size of the stated errors, and their place in the intervals; empty if no evaluation states errors.
pub fn sentences(input: &ReportInput) -> Vec<String> {
    let Some(row) = governing(&input.summary) else { return vec![] };
    let size = |state: &LimitState| {
        let of_limit = |error: f64| percent(error.abs() / state.scale());
        let [typical, largest] = input.stated.get(state.output)?.map(of_limit);
        Some(format!("{} {typical}, at most {largest}", input.output_of(state)))
    };
    let sizes = joined(input.scene.limit_states.iter().filter_map(size), "; ");
    if sizes.is_empty() {
        return vec![];
    }
    let states = match (input.summary.of_mechanism(), leaves_errors_to_levels(&input.summary)) {
        (true, true) => {
            "Every simulation but the nominal one states the error of its outputs by time steps alone; that by wear steps, blocks and \
             control points is left to the finer levels."
        }
        (true, false) => {
            "Every simulation states the numerical error of its outputs, estimated from its time and wear steps; the true error should \
             be less than twice the stated one in 95 % of cases."
        }
        (false, _) => {
            "Every simulation states the numerical error of its outputs; the true error should be less than twice the stated one in \
             95 % of cases."
        }
    };
    let cycles = count(row.cycles.into());
    let mut text = vec![format!(
        "{states} Typical and largest stated error at {cycles} cycles, as a share of the limit: {sizes}."
    )];
    text.push(
        if has_correction(&input.summary) {
            "Pairs of simulations at finer levels correct the results, and their error takes the place of the stated one in all intervals."
        } else {
            "In the intervals of R and of the lives every response is off by its stated error in the same direction; a finer accuracy, finer \
             levels and, for the wear, more control points reduce that, more simulations do not."
        }
        .to_owned(),
    );
    let shares = input.summary.surrogates.iter().filter_map(|surrogate| {
        let share = percent(surrogate.share_of_stated_error?);
        Some(format!("{share} for {}", surrogate.limit_state))
    });
    let shares = joined(shares, " and ");
    if !shares.is_empty() {
        text.push(format!(
            "The surrogates treat {shares} of the stated errors as noise that varies from one simulation to the next; the rest is \
             common to all simulations and remains in the predictions."
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::summary::{AROUND_CYCLES, ConditionRow};
    use crate::tests::test_study;

    #[test]
    fn the_largest_part_and_the_levels_are_named() {
        let mut summary = crate::tests::test_study::study().summary;
        let text = parts_and_levels(&summary).join("\n");
        assert!(text.contains("largest part reduced by finer levels"), "{text}");
        let row = DifferenceRow {
            limit_state: "wear".into(),
            cycles: 65_000,
            form: "constant".into(),
            correction: -0.018,
            error: 0.002,
            rough: 0.001,
            order: Some(2.0),
        };
        summary.levels = Some(LevelsRow { pairs: [9, 3], differences: vec![row], ..LevelsRow::default() });
        let text = parts_and_levels(&summary)[1].replace('\u{a0}', " ");
        assert!(
            text.contains("9 pairs at a finer level, 3 of them") && text.contains("wear -1.8 % ± 0.2 %"),
            "{text}"
        );
        assert!(text.contains("(order 2.0)"), "{text}");
        assert!(table_of_levels(&summary).0.contains("2.0"));
        let levels = summary.levels.as_mut().unwrap();
        levels.differences[0].order = None;
        (levels.evaluations, levels.failed, levels.cause) = (12, 1, Some("the steps ran out".to_owned()));
        let text = parts_and_levels(&summary)[1].clone();
        let failed = "(1 of 12 finer simulations failed, first cause: the steps ran out)";
        assert!(text.contains(failed) && text.contains("(no order of convergence)"), "{text}");
        // Nothing corrects the results.
        summary.levels.as_mut().unwrap().differences.clear();
        summary.accuracy_settings = None;
        let text = parts_and_levels(&summary)[1].clone();
        assert!(text.starts_with("caution: too few pairs of levels gave a result (1 of 12 finer"), "{text}");
        assert!(text.contains("nothing of what the levels would show"), "{text}");
        summary.levels = None;
        assert!(table_of_levels(&summary).0.is_empty());
    }

    #[test]
    fn advice_is_given_where_it_helps() {
        let summary = crate::tests::test_study::study().summary;
        let said = |change: &dyn Fn(&mut StudySummary), parts: [f64; 3]| {
            let mut summary = summary.clone();
            summary.levels = None;
            change(&mut summary);
            let [sampling, surrogate, numerical] = parts;
            for row in &mut summary.reliability {
                row.parts.insert("total".to_owned(), ErrorParts { sampling, surrogate, numerical });
            }
            parts_and_levels(&summary)[0].clone()
        };
        let condition = ConditionRow { probability: 1e-3, coefficient_of_variation: 0.1, levels: 2 };
        let rare = said(&|summary| summary.conditional = Some(condition), [6e-8, 1e-9, 0.0]);
        assert!(rare.contains("samples 1.18e\u{2212}7,") && !rare.contains("reduced by"), "{rare}");
        let failing = said(&|summary| summary.failures.barred_share = 0.12, [0.06, 0.0, 0.0]);
        assert!(failing.contains("reduced by simulations that give a result"), "{failing}");
        let direct = said(&|summary| summary.method = "monte-carlo".to_owned(), [0.001, 0.0, 0.01]);
        assert!(direct.contains("reduced by a finer accuracy, `--accuracy`"), "{direct}");
        let simulator = said(&|summary| summary.accuracy_settings = None, [0.001, 0.0, 0.0]);
        assert!(simulator.contains("numerical error not stated"), "{simulator}");
        let of_cycles = |summary: &mut StudySummary| {
            summary.accuracy_settings = None;
            summary.accuracy += AROUND_CYCLES;
        };
        let cycles = said(&of_cycles, [0.001, 1e-243, 0.01]);
        assert!(
            cycles.contains("surrogates 0.0000, ") && cycles.contains("reduced by more `control_points`"),
            "{cycles}"
        );
        let certain = said(&|_| {}, [0.0; 3]);
        assert!(certain.ends_with("numerical error 0.0000"), "{certain}");
    }

    #[test]
    fn the_sentences_contain_shares_and_lives() {
        let input = test_study::report_input();
        let text = sentences(&input).join(" ").replace('\u{a0}', " ");
        // 0.25 of 30 um, 0.1 of 25 r/min.
        assert!(text.contains("max wear depth 0.8 %, at most 0.8 %"), "{text}");
        assert!(text.contains("angular velocity difference 0.4 %, at most 0.4 %"), "{text}");
        assert!(text.contains("off by its stated error in the same direction"), "{text}");
        assert!(text.contains("5.0 % for wear"), "{text}");
        let mut with_levels = input.clone();
        with_levels.summary.levels = Some(LevelsRow::default());
        with_levels.summary.surrogates.clear();
        let text = sentences(&with_levels).join(" ");
        assert!(
            text.contains("is left to the finer levels. Typical") && !text.contains("95 % of cases"),
            "{text}"
        );
        assert!(!text.contains("correct the results"), "no pair gave a difference: {text}");
        let mut silent = input.clone();
        silent.stated.clear();
        assert!(sentences(&silent).is_empty());
    }
}
