//! The progress of a study as all its views count it, in the terminal, in `status` and on the live page, and the time that it still takes.

use super::format::{count, duration, fixed, reliability, share, three_digits};
use crate::results::progress::Progress;
use crate::statistics::reliability::REACH;
use common::wire::{ReliabilitySoFar, StudyStatus};

/// Records progress in the status.
pub fn record(study: &mut StudyStatus, progress: &Progress) {
    match progress {
        Progress::BatchStarted { planned, budget, purpose, .. } => {
            (study.planned, study.budget) = (*planned as u64, *budget as u64);
            study.purpose.clone_from(purpose);
        }
        Progress::Evaluated { done, failed, recalled, wall } => {
            study.done = *done as u64;
            study.planned = study.planned.max(study.done);
            study.failed += u64::from(*failed);
            study.recalled += u64::from(*recalled);
            if !recalled && wall.is_finite() {
                study.simulation += wall;
            }
        }
        Progress::RoundFinished(round) => {
            study.rounds += 1;
            study.reliability = Some(ReliabilitySoFar {
                cycles: round.cycles,
                total: round.reliability_total,
                standard_error: round.standard_error(),
            });
        }
        Progress::Warning(_) => study.warnings += 1,
        Progress::Reliability { .. } | Progress::Ending => {}
    }
}

/// Largest number of evaluations that the study may have.
pub fn most_evaluations(study: &StudyStatus) -> u64 {
    study.budget.max(study.planned).max(study.done)
}

/// The time until all evaluations are done [s] at a rate of them [1/s], and in words, as `at most 4 min 03 s left` if learning may end
/// before its budget is spent; none without a rate, or if nothing is left.
pub fn remaining_time(study: &StudyStatus, rate: Option<f64>) -> Option<(f64, String)> {
    let most = most_evaluations(study);
    let left = most.checked_sub(study.done).filter(|left| *left > 0)?;
    let seconds = left as f64 / rate.filter(|rate| *rate > 0.0)?;
    let bound = if most > study.planned { "at most " } else { "" };
    Some((seconds, format!("{bound}{} left", duration(seconds))))
}

/// What the intervals of rounds are: finer levels are simulated, and stated errors counted, at the end.
const SO_FAR: &str = "(95 % but for numerical error)";

/// R of the system at a checkpoint [cycles] with its standard error, e.g. `R(66 000) = 0.347 ± 0.012 (95 % but for numerical error)`, or P_f
/// where R has no digits left to show.
pub fn reliability_so_far(cycles: u32, r: f64, standard_error: f64) -> String {
    let (pf, width, cycles) = (1.0 - r, REACH * standard_error, count(cycles.into()));
    if pf > 0.0 && pf < 1e-3 {
        let value = share(pf, (pf - width).max(0.0), (pf + width).min(1.0));
        return format!("P_f({cycles}) = {value} {SO_FAR}");
    }
    let value = reliability(r, (r - width).max(0.0), (r + width).min(1.0));
    let equal = if value.starts_with(['>', '<']) { "" } else { "= " };
    format!("R({cycles}) {equal}{value} {SO_FAR}")
}

/// Evaluations, time left in the study, rate [1/s], surrogate error, R so far and the rest, the most important first, since terminals cut the
/// end off; e.g. `84/400 evaluations, at most 4 min 03 s left, 1.30/s, error 0.0090, R(66 000) = 0.347 ± 0.012 (95 % but for numerical
/// error), round 2`.
pub fn state_of_study(study: &StudyStatus, ending: bool, rate: Option<f64>, error: Option<f64>) -> String {
    let StudyStatus { done, failed, recalled, purpose, reliability, .. } = study;
    let mut parts = vec![format!("{done}/{} evaluations", most_evaluations(study))];
    if ending {
        parts.push("computing the results".to_owned());
    } else {
        parts.extend(remaining_time(study, rate).map(|(_, left)| left));
    }
    parts.extend(rate.map(per_second));
    parts.extend(error.filter(|error| *error > 0.0).map(|error| format!("error {}", three_digits(error))));
    let so_far = |r: &ReliabilitySoFar| reliability_so_far(r.cycles, r.total, r.standard_error);
    parts.extend(reliability.as_ref().map(so_far));
    parts.extend((!purpose.is_empty()).then(|| purpose.clone()));
    parts.extend((*failed > 0).then(|| format!("{failed} failed")));
    parts.extend((*recalled > 0).then(|| format!("{recalled} from the campaign file")));
    parts.join(", ")
}

/// A rate of evaluations [1/s] as text.
pub fn per_second(rate: f64) -> String {
    format!("{}/s", fixed(rate, if rate < 10.0 { 2 } else { 0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_rare_failures_are_shown_by_their_probability_and_its_error() {
        let rare = reliability_so_far(500, 1.0 - 3.2e-5, 1.886_7e-6);
        assert_eq!(rare, "P_f(500) = 3.20e\u{2212}5 ± 3.7e\u{2212}6 (95 % but for numerical error)");
        assert!(reliability_so_far(500, 1.0, 1e-6).starts_with("R(500) "));
    }

    #[test]
    fn a_budget_is_a_bound_and_a_plan_is_carried_out() {
        let study = |done, planned| StudyStatus { done, planned, budget: 400, ..StudyStatus::default() };
        let (seconds, left) = remaining_time(&study(84, 120), Some(2.0)).unwrap();
        assert_eq!(seconds, 158.0);
        assert_eq!(left.replace('\u{a0}', " "), "at most 2 min 38 s left");
        let direct = study(84, 400);
        assert!(remaining_time(&direct, Some(2.0)).unwrap().1.starts_with("2\u{a0}min"));
        assert_eq!(remaining_time(&direct, None), None);
        assert_eq!(remaining_time(&direct, Some(0.0)), None);
        assert_eq!(remaining_time(&study(400, 400), Some(2.0)), None);
    }
}
