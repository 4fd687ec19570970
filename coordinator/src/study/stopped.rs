//! Why the learning of a study stopped, in words, and whether it met its targets.

use super::as_published::change_over_1000_cycles;
use super::{CampaignResult, Method, Settings, StopReason};
use crate::results::summary::StudySummary;
use crate::statistics::learning::Rule;
use crate::statistics::reliability::REACH;
use common::scene::Scene;

/// Half width [1] that the sampling of the population alone gives R where it is widest, if that is more than the whole one asked for.
fn sampling_beyond(learned: &CampaignResult, settings: &Settings) -> Option<f64> {
    let (target, classified) = (settings.target_error?, &learned.classified);
    let half_width = |failed: &f64| {
        REACH * classified.condition.probability * failed * classified.coefficient_of_variation(*failed)
    };
    let widest = learned.assessment.curves.iter().flatten().map(half_width).fold(0.0, f64::max);
    (widest > target).then_some(widest)
}

/// Whether learning ended by a rule, with a population large enough for the interval asked for, and with failures enough for the coefficient of variation asked for, or for the share of the
/// population that cannot be simulated.
pub(super) fn targets_met(learned: &CampaignResult, settings: &Settings) -> bool {
    let enough = learned.rounds.last().is_some_and(|round| round.cov_pf <= settings.targets().cov);
    (enough || is_within_barred(learned))
        && sampling_beyond(learned, settings).is_none()
        && matches!(learned.stop, StopReason::Rule(_))
}

/// Notes where the whole interval of R is wider than the one asked for: pairs of levels have ended by their cost, or the stated errors
/// remain.
pub(super) fn note_whole_interval(summary: &mut StudySummary, settings: &Settings) {
    let Some(target) = settings.target_error.filter(|_| settings.method == Method::ActiveLearning) else {
        return;
    };
    let widths = summary.reliability.iter().flat_map(|row| {
        row.interval.iter().map(|(name, range)| (0.5 * (range.upper - range.lower), name, row.cycles))
    });
    let Some((width, name, cycles)) =
        widths.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|widest| widest.0 > target)
    else {
        return;
    };
    let at = if summary.is_static() { String::new() } else { format!(" at {cycles} cycles") };
    let note = format!(
        "; the whole interval of R {name}{at}, numerical error included, is ± {width:.2e}, not ± {target}"
    );
    summary.convergence.targets_met = false;
    summary.convergence.stopped_because += &note;
}

/// True if the share of the population that cannot be simulated outweighs the sampling of the failure probability.
fn is_within_barred(learned: &CampaignResult) -> bool {
    learned.classified.is_within_barred(learned.assessment.governing_failed(), learned.shares.missing)
}

/// What the intervals contain besides the surrogate error that the rules ask for, as the end of a sentence: noise and simulations
/// that fail, where they matter more than the `error` of a curve [1] asked for.
fn beyond_the_rules(learned: &CampaignResult, error: f64) -> String {
    let noise =
        learned.assessment.noise_shift.iter().flatten().fold(0.0, |most: f64, shift| most.max(*shift));
    let (noise, barred) = (learned.classified.condition.probability * noise, learned.shares.missing);
    let mut text = String::new();
    if noise > error {
        text +=
            &format!("; noise or steps of the outputs, no part of this error, move P_f by up to {noise:.1e}");
    }
    if barred > error {
        text += &format!(
            "; {:.1} % of the population, no part of this error, cannot be simulated, and the intervals contain both extremes, that all \
             or none of it fails",
            100.0 * barred
        );
    }
    text
}

/// The outputs of limit states that were the same in all simulations, as the end of a sentence; empty without any.
fn constant_outputs(scene: &Scene, learned: &CampaignResult) -> String {
    let mut constant: Vec<usize> = scene.limit_states.iter().map(|limit| limit.output).collect();
    constant.sort_unstable();
    constant.dedup();
    constant.retain(|output| learned.observations.is_constant(*output));
    let names: Vec<&str> = constant.iter().map(|output| scene.outputs[*output].name.as_str()).collect();
    if names.is_empty() {
        return String::new();
    }
    format!("; {} has the same values in every simulation, whatever the random variables", names.join(", "))
}

/// The end of learning as published: the sizes of the designs, U, and the printed relative change over 1000 cycles.
fn as_published(scene: &Scene, learned: &CampaignResult, settings: &Settings) -> String {
    let points = |s: usize| learned.observations.design_of(s).len();
    let designs = scene.limit_states.iter().enumerate();
    let designs = designs.map(|(s, limit)| format!("{} results for {}", points(s), limit.name));
    let designs = designs.collect::<Vec<_>>().join(", ");
    let end = match learned.stop {
        StopReason::Rule(_) => "U >= 2 at every point of the population".to_owned(),
        StopReason::Budget => format!(
            "the budget of {} evaluations is spent; the least U is {:.2}",
            settings.max_evaluations, learned.assessment.figures.min_u
        ),
    };
    let (k, curves) = (learned.assessment.governing, &learned.assessment.curves);
    let checkpoints = scene.life.checkpoints();
    let change = change_over_1000_cycles(&curves[curves.len() - 1], &checkpoints, k).map(|change| {
        let cycles = checkpoints[k];
        format!("; |R_k - R_(k-1000)| / R_k is {change:.3} at {cycles} cycles (published bound 0.02)")
    });
    format!("{end}; {designs}{}", change.unwrap_or_default())
}

/// Why learning stopped, and what was found by then.
pub(super) fn stop_in_words(scene: &Scene, learned: &CampaignResult, settings: &Settings) -> String {
    let targets = settings.targets();
    let figures = &learned.assessment.figures;
    let bound = (1e6 * targets.error).round() / 1e6;
    let condition = &learned.classified.condition;
    let held = targets.points_to_hold(learned.classified.population.dimension(), condition.levels > 0);
    let reason = match learned.stop {
        _ if settings.method == Method::AkMcs => as_published(scene, learned, settings),
        StopReason::Rule(Rule::Learning) => format!(
            "every U_c >= {} and no curve changed by more than {} of the smaller of R and P_f, {} rounds and {} points running, after a fresh fit",
            targets.min_u, targets.relative_change, targets.hold, held
        ),
        StopReason::Rule(Rule::Error) => format!(
            "the estimated surrogate error of every curve is below {} and no curve changed by more than {}, {} rounds and {} points running, after a fresh fit",
            bound, targets.change, targets.hold, held
        ),
        StopReason::Budget => format!(
            "the budget of {} evaluations is spent; {}",
            settings.max_evaluations,
            if figures.error > targets.error {
                format!("the estimated surrogate error is {:.1e} (target {bound})", figures.error)
            } else {
                format!(
                    "the estimated surrogate error is below its target {bound}, but has not been for {} rounds and {} points beyond {} \
                     simulations",
                    targets.hold, held, targets.least_points
                )
            }
        ),
    };
    let mut reason = reason + &beyond_the_rules(learned, targets.error);
    if let Some(width) = sampling_beyond(learned, settings) {
        let points = learned.classified.population.len();
        reason += &format!(
            "; the sampling of the {points} points alone gives R a half width of {width:.1e}, more than the one asked for"
        );
        if condition.levels == 0 {
            reason += ": take more points by --samples";
        }
    }
    let system = &learned.assessment.curves[learned.assessment.curves.len() - 1];
    let cov = learned.rounds.last().map_or(f64::INFINITY, |round| round.cov_pf);
    if system.iter().all(|failed| *failed == 0.0) {
        let points = learned.classified.population.len();
        let bound = match condition.levels {
            0 => String::new(),
            _ => format!(", which represent a probability of {:.0e}", condition.probability),
        };
        let constant = constant_outputs(scene, learned);
        format!("{reason}; no failure was found among {points} points of the population{bound}{constant}")
    } else if cov > targets.cov && !is_within_barred(learned) {
        format!("{reason}; the coefficient of variation of P_f is still {cov:.3} (target {})", targets.cov)
    } else {
        reason
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn issue_a_target_error_was_met_while_the_whole_interval_was_wider() {
        let mut summary = test_study::study().summary;
        let before = summary.convergence.clone();
        let settings = |target| Settings { target_error: Some(target), ..Settings::default() };
        note_whole_interval(&mut summary, &settings(0.6));
        note_whole_interval(&mut summary, &Settings { method: Method::MonteCarlo, ..settings(0.001) });
        assert_eq!(summary.convergence, before);
        note_whole_interval(&mut summary, &settings(0.001));
        let said = &summary.convergence.stopped_because;
        assert!(!summary.convergence.targets_met && said.starts_with(&before.stopped_because), "{said}");
        assert!(said.contains("the whole interval of R") && said.ends_with(", not ± 0.001"), "{said}");
    }
}
