//! Notes on what the simulations of a study do not support: failures that none of them has met, steps and noise of outputs.

use super::format::{count, power, three_digits};
use crate::results::summary::{StudySummary, SurrogateRow, UntestedRow};

/// A caution where no simulation exceeded a limit, or none where the population is, with the bound on P_f that the initial design
/// supports: of n independent samples without a failure, P_f < 1 - 0.05^(1/n) with a confidence of 95 %.
///
/// # Source
/// Clopper, Pearson (1934), The use of confidence or fiducial limits illustrated in the case of the binomial, Biometrika 26(4).
pub fn no_simulated_failure(summary: &StudySummary) -> Option<String> {
    let counts = summary.evaluations;
    let of_system = summary.untested.as_ref().filter(|untested| untested.curves.iter().any(|c| c == "total"));
    let (samples, bound, predicted) = match of_system {
        Some(UntestedRow { samples, bound, predicted, .. }) => {
            let predicted = format!("; the surrogates alone predict P_f < {}", power(*predicted, 1));
            (*samples, *bound, predicted)
        }
        None if summary.untested.is_some() => return summary.untested.as_ref().map(of_limit_states),
        None => {
            // A study by an earlier version. The first evaluation of its design is the nominal one, which is no sample.
            let samples = counts.initial.saturating_sub(1 + counts.failed);
            if summary.simulations_beyond_a_limit != Some(0) || samples == 0 {
                return None;
            }
            (samples, 1.0 - 0.05f64.powf(1.0 / samples as f64), String::new())
        }
    };
    let simulations = count((counts.total - counts.failed) as u64);
    let exceeded = match summary.simulations_beyond_a_limit {
        Some(0) | None => format!("none of the {simulations} simulations exceeded a limit"),
        Some(beyond) => format!(
            "{} of the {simulations} simulations exceeded a limit, but none where the failures of this probability lie",
            count(beyond as u64)
        ),
    };
    Some(format!(
        "{exceeded}: R is what the surrogates predict beyond all simulated values. The {} samples of \
         the initial design alone, counted as independent, support P_f < {} (95 %) over the whole life studied{predicted}",
        count(samples as u64),
        three_digits(bound)
    ))
}

/// The caution where no simulation has tested single limit states, but some the system.
fn of_limit_states(untested: &UntestedRow) -> String {
    format!(
        "no simulation exceeded the limit of {} where its failures would lie: its P_f is bounded by that of the whole system and by \
         the {} samples of the initial design alone, counted as independent, P_f < {} (95 %) over the whole life studied",
        untested.curves.join(", "),
        count(untested.samples as u64),
        three_digits(untested.bound)
    )
}

/// A line per limit state whose output has steps at its limit, or whose simulations are noisy, with what helps.
pub fn steps_and_noise(summary: &StudySummary) -> Vec<String> {
    let simulations = count((summary.evaluations.total - summary.evaluations.failed) as u64);
    let line = |row: &SurrogateRow| match (row.different_values, row.outlier, row.much_noise()) {
        (Some(values), ..) => Some(format!(
            "steps: the output of {} has {} different values in {simulations} simulations and jumps at the limit, which surrogates \
             resolve with many simulations only; return the quantity behind it, before it is counted, rounded or compared",
            row.limit_state,
            count(values as u64)
        )),
        (None, Some(distance), _) => Some(format!(
            "outlier: a simulated value of {} lies {} interquartile ranges from the median of all (samples.csv), and the surrogates \
             follow it; if the simulator or a machine is at fault, correct that and run the study again",
            row.limit_state,
            three_digits(distance)
        )),
        (None, None, Some(share)) => Some(format!(
            "noise: {:.1} % of the variance of {} is numerical noise; {} may need fewer simulations",
            100.0 * share,
            row.limit_state,
            if summary.of_mechanism() { "a finer --accuracy" } else { "finer tolerances in the simulator" }
        )),
        (None, None, None) => None,
    };
    summary.surrogates.iter().filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_a_study_without_a_simulated_failure_stated_a_tiny_bound_alone() {
        let mut summary = crate::test_study::study().summary;
        assert_eq!(no_simulated_failure(&summary), None);
        summary.simulations_beyond_a_limit = Some(0);
        let said = no_simulated_failure(&summary).unwrap();
        // 3 / n for many samples.
        assert!(said.starts_with("none of the 215 simulations exceeded a limit"), "{said}");
        assert!(
            said.contains("The 118 samples of the initial design") && said.contains("P_f < 0.0251 (95 %)"),
            "{said}"
        );
        let curves = vec!["play".to_owned()];
        summary.untested = Some(UntestedRow { curves, samples: 11, bound: 0.2384, predicted: 0.5 });
        let said = no_simulated_failure(&summary).unwrap();
        assert!(said.contains("the limit of play") && said.contains("P_f < 0.238 (95 %)"), "{said}");
    }

    #[test]
    fn issue_rows_that_few_studies_have_were_missing_in_the_schema() {
        let mut summary = crate::test_study::study().summary;
        summary.simulations_beyond_a_limit = Some(3);
        let curves = vec!["play".to_owned()];
        summary.untested = Some(UntestedRow { curves, samples: 11, bound: 0.2384, predicted: 0.5 });
        for row in &mut summary.surrogates {
            (row.different_values, row.outlier) = (Some(3), Some(41.0));
        }
        let schema: serde_json::Value =
            serde_json::from_str(include_str!("../../../schemas/summary.schema.json")).unwrap();
        let summary = serde_json::to_value(&summary).unwrap();
        let faults: Vec<String> = jsonschema::validator_for(&schema)
            .unwrap()
            .iter_errors(&summary)
            .map(|e| e.to_string())
            .collect();
        assert_eq!(faults, Vec::<String>::new());
    }

    #[test]
    fn issue_an_outlier_was_called_noise() {
        let mut summary = crate::test_study::study().summary;
        (summary.surrogates[0].outlier, summary.surrogates[0].noise_share) = (Some(4610.0), Some(0.98));
        let said = steps_and_noise(&summary).remove(0);
        assert!(said.starts_with("outlier: ") && said.contains("4610 interquartile ranges"), "{said}");
    }
}
