//! Notes on what the simulations of a study do not support: failures that none of them has met, steps and noise of outputs.

use super::format::{count, joined, power, three_digits};
use crate::results::summary::{StudySummary, SurrogateRow, UntestedRow};
use crate::results::summary_rows::{OutlierEvaluation, OutlierRow};

/// A caution where no simulation exceeded a limit, or none where the population is, with the bound on P_f that the initial design
/// supports: of n independent samples without a failure, P_f < 1 - 0.05^(1/n) with a confidence of 95 %.
///
/// # Source
/// Clopper, Pearson (1934), The use of confidence or fiducial limits illustrated in the case of the binomial, Biometrika 26(4).
pub fn no_simulated_failure(summary: &StudySummary) -> Option<String> {
    let UntestedRow { curves, samples, bound, predicted } = summary.untested.as_ref()?;
    let (samples, bound) = (count(*samples as u64), three_digits(*bound));
    if !curves.iter().any(|curve| curve == "total") {
        return Some(format!(
            "no simulation exceeded the limit of {} where its failures would lie: its P_f is bounded by that of the whole system and by \
             the {samples} samples of the initial design alone, counted as independent, P_f < {bound} (95 %) over the whole life studied",
            curves.join(", ")
        ));
    }
    let simulations = count((summary.evaluations.total - summary.evaluations.failed) as u64);
    let exceeded = match summary.simulations_beyond_a_limit {
        Some(0) | None => format!("none of the {simulations} simulations exceeded a limit"),
        Some(beyond) => format!(
            "{} of the {simulations} simulations exceeded a limit, but none where the failures of this probability lie",
            count(beyond as u64)
        ),
    };
    Some(format!(
        "{exceeded}: R is what the surrogates predict beyond all simulated values. The {samples} samples of \
         the initial design alone, counted as independent, support P_f < {bound} (95 %) over the whole life studied; the surrogates \
         alone predict P_f < {}",
        power(*predicted, 1)
    ))
}

/// What simulations do not support of an answer by the surrogates alone, which takes no notice of the bound.
pub fn not_in_answer(summary: &StudySummary) -> Option<String> {
    let caution = no_simulated_failure(summary)?;
    Some(format!(
        "Caution: the study only bounds P_f; {caution}. This answer follows the surrogates without that bound."
    ))
}

/// Share of the variance above which the noise of the simulations limits learning and costs more than a finer accuracy [1].
const MUCH_NOISE: f64 = 0.02;

/// A line per limit state whose output has steps at its limit, or whose simulations are noisy, with what helps.
pub fn steps_and_noise(summary: &StudySummary) -> Vec<String> {
    let simulations = count((summary.evaluations.total - summary.evaluations.failed) as u64);
    let much = |share: &f64| *share > MUCH_NOISE;
    let line = |row: &SurrogateRow| match (row.different_values, row.outlier, row.noise_share.filter(much)) {
        (Some(values), ..) => Some(format!(
            "steps: the output of {} has {} different values in {simulations} simulations and jumps at the limit, which surrogates \
             resolve with many simulations only; return the quantity behind it, before it is counted, rounded or compared",
            row.limit_state,
            count(values as u64)
        )),
        // Each has a line of its own.
        (None, Some(_), _) if summary.outliers.iter().any(|of| of.limit_state == row.limit_state) => None,
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
    let of_outlier = |row: &OutlierRow| repeated_outlier(summary, row);
    summary.surrogates.iter().filter_map(line).chain(summary.outliers.iter().map(of_outlier)).collect()
}

/// The line of an outlier whose sample was evaluated again.
fn repeated_outlier(summary: &StudySummary, row: &OutlierRow) -> String {
    let limit = summary.limits.iter().find(|limit| limit.name == row.limit_state);
    let unit = limit.map_or(String::new(), |limit| format!(" {}", limit.unit));
    let name = |one: &OutlierEvaluation| match (one.number, one.value) {
        (Some(number), Some(value)) => {
            format!("evaluation {number} of worker {} gave {}{unit}", one.worker, three_digits(value))
        }
        _ => "one without a result".to_owned(),
    };
    let names =
        |used: bool| joined(row.evaluations.iter().skip(1).filter(|one| one.used == used).map(name), ", ");
    // The study uses an outlier with which another evaluation agrees.
    let is_confirmed = row.evaluations.first().is_some_and(|first| first.used);
    let verdict = match row.evaluations.iter().filter(|one| one.used).count() {
        0 if row.evaluations.len() < 3 => format!("{}: the budget allowed no further one", names(false)),
        0 => format!("{}: no two agree, and the sample counts as failed", names(false)),
        _ if is_confirmed => format!("confirmed: {}", names(true)),
        _ => format!("left out: {}; its worker or the simulator is at fault", names(true)),
    };
    let first = row.evaluations.first().map(name).unwrap_or_default();
    format!(
        "outlier: {first} for {} at {} cycles, {} interquartile ranges from the median of all; {verdict}",
        row.limit_state,
        count(u64::from(row.cycles)),
        three_digits(row.distance)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_a_study_without_a_simulated_failure_stated_a_tiny_bound_alone() {
        let mut summary = crate::tests::test_study::study().summary;
        assert_eq!(no_simulated_failure(&summary), None);
        summary.simulations_beyond_a_limit = Some(0);
        let curves = vec!["total".to_owned()];
        summary.untested = Some(UntestedRow { curves, samples: 118, bound: 0.0251, predicted: 1e-9 });
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
        let mut summary = crate::tests::test_study::study().summary;
        summary.simulations_beyond_a_limit = Some(3);
        let curves = vec!["play".to_owned()];
        summary.untested = Some(UntestedRow { curves, samples: 11, bound: 0.2384, predicted: 0.5 });
        for row in &mut summary.surrogates {
            (row.different_values, row.outlier, row.logarithms) = (Some(3), Some(41.0), true);
        }
        let failed = OutlierEvaluation { number: None, value: None, ..OutlierEvaluation::default() };
        summary.outliers = vec![OutlierRow { evaluations: vec![failed], ..OutlierRow::default() }];
        summary.scale = Some(crate::results::summary::ScaleRow::default());
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
        let mut summary = crate::tests::test_study::study().summary;
        (summary.surrogates[0].outlier, summary.surrogates[0].noise_share) = (Some(4610.0), Some(0.98));
        let said = steps_and_noise(&summary).remove(0);
        assert!(said.starts_with("outlier: ") && said.contains("4610 interquartile ranges"), "{said}");
        // With its further evaluations it has one line, which names them.
        let evaluation = |number, value, used| OutlierEvaluation {
            number: Some(number),
            worker: format!("w{number}/0"),
            value: Some(value),
            used,
        };
        let limit_state = summary.surrogates[0].limit_state.clone();
        let row = OutlierRow { limit_state, cycles: 1000, distance: 4610.0, evaluations: vec![] };
        let cases: [(&[bool], &str); 4] = [
            (&[true, true], "confirmed: evaluation 1 of worker w1/0"),
            (&[false, true, true], "left out: evaluation 1 of worker w1/0"),
            (&[false, false], "the budget allowed no further one"),
            (&[false; 3], "no two agree, and the sample counts as failed"),
        ];
        for (used, words) in cases {
            let evaluations = used.iter().zip(0..).map(|(used, k)| evaluation(k, 7.0, *used)).collect();
            summary.outliers = vec![OutlierRow { evaluations, ..row.clone() }];
            let said = steps_and_noise(&summary);
            let of_outliers = said.iter().filter(|line| line.starts_with("outlier")).collect::<Vec<_>>();
            let [said] = of_outliers[..] else { panic!("{said:?}") };
            assert!(said.contains("evaluation 0 of worker w0/0 gave 7") && said.contains(words), "{said}");
        }
    }
}
