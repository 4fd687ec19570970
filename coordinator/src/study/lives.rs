//! Lives of a study: counted over the population by the surrogates, or over the samples of a direct simulation, and their
//! rows in the summary.

use super::interim::InterimResult;
use super::life_model::history_of_mode;
use super::{CampaignResult, Method, Observed, Problem};
use crate::results::life_summary::{CyclesRange, LifeCurveRow, LifeRow, UnresolvedFall};
use crate::results::summary::StudySummary;
use crate::statistics::learning::Mode;
use crate::statistics::reliability::{
    ErrorLine, LifeAtLevel, LifeCounts, LifeCurve, LifeCurveInput, ModeLives, PredictedMode, REACH, Track,
    mode_lives, population_lives,
};

/// Reliabilities at which lives are stated.
pub const LEVELS: [f64; 3] = [0.99, 0.9, 0.5];

/// A fall of R between two checkpoints from above the first to below the second value is not resolved by them [1].
const FALL: (f64, f64) = (0.9, 0.1);

/// Number of checkpoints that should lie within the fall.
const WITHIN: f64 = 5.0;

/// Checkpoints as times `(m,)` [cycles].
fn times(checkpoints: &[u32]) -> Vec<f64> {
    checkpoints.iter().map(|cycles| f64::from(*cycles)).collect()
}

impl CampaignResult {
    /// Standard errors of P_f by the stated numerical errors of the simulations, curves as in [`Self::reliability`]; `problem` is that of
    /// the campaign.
    pub fn numerical_errors(&self, problem: &Problem) -> Vec<Vec<f64>> {
        let [least, most] = learned_lives(&problem.modes, &problem.checkpoints, self).numerical_band();
        let scale = 0.5 * self.classified.condition.probability / REACH;
        let error = |(most, least): (&f64, &f64)| scale * (most - least).max(0.0);
        let curve = |(most, least): (&Vec<f64>, &Vec<f64>)| most.iter().zip(least).map(error).collect();
        most.iter().zip(&least).map(curve).collect()
    }
}

/// Lives of the population by the surrogates of a campaign.
pub(super) fn learned_lives(modes: &[Mode], checkpoints: &[u32], learned: &CampaignResult) -> LifeCounts {
    let as_published = learned.method == Method::AkMcs;
    let assessed = learned.assessment.modes.iter().zip(&learned.assessment.surrogates);
    let modes = modes.iter().zip(assessed).enumerate();
    let modes = modes.map(|(index, (mode, (classified, surrogate)))| {
        let observations = learned.observations.design_of(index);
        let values = observations.running_maxima(mode.output);
        let errors = observations.errors_of_running_maxima(mode.output);
        PredictedMode {
            index,
            history: history_of_mode(surrogate, &observations, mode.output, false),
            lines: ErrorLine::by_checkpoint(values.as_ref(), errors.as_ref()),
            threshold: surrogate.scale.value(classified.threshold),
            first_failure: &classified.first_failure,
            variance_factor: if as_published { &[] } else { &classified.variance_factor },
        }
    });
    population_lives(&modes.collect::<Vec<_>>(), &learned.classified.population, &times(checkpoints))
}

/// Adds the lives of one simulation, and the indices of the checkpoints by which it has failed `(modes + 1)`, the system last; m if
/// never.
pub(super) fn add_simulated(
    problem: &Problem,
    observed: &Observed,
    lives: &mut LifeCounts,
    first_failures: &mut [Vec<u32>],
) {
    let times = times(&problem.checkpoints);
    let (mut room, mut earliest) = (Vec::new(), times.len());
    let mut by_mode = |(mode, all): (&Mode, &mut Vec<u32>)| -> ModeLives {
        let values = observed.running_maximum(mode.output);
        let first = values.iter().position(|y| *y >= mode.threshold).unwrap_or(times.len());
        earliest = earliest.min(first);
        all.push(first as u32);
        let start = observed.start.get(mode.output).copied().flatten();
        let track = Track { times: &times, values: &values, start };
        mode_lives(&track, (&observed.errors[mode.output], &[]), mode.threshold, first, &mut room)
    };
    let all: Vec<ModeLives> = problem.modes.iter().zip(first_failures.iter_mut()).map(&mut by_mode).collect();
    lives.add(&all);
    first_failures[problem.modes.len()].push(earliest as u32);
}

/// Reads curves, lives and the fall that the checkpoints do not resolve from the counts. `names` are those of the curves, the
/// system last.
pub(super) fn add_lives(
    summary: &mut StudySummary,
    counts: &LifeCounts,
    shares: &InterimResult,
    names: &[String],
    checkpoints: &[u32],
) {
    // A study with one checkpoint has no life.
    if checkpoints.len() < 2 {
        return;
    }
    let none = Vec::new();
    let curve = |c: usize| {
        LifeCurve::new(&LifeCurveInput {
            counts,
            curve: c,
            checkpoints,
            points: shares.points,
            missing: shares.missing,
            surrogate: shares.surrogate.get(c).unwrap_or(&none),
            condition: &shares.condition,
        })
    };
    let last = names.len() - 1;
    let system = curve(last);
    let untested = |time: f64| shares.untested.possible(last, 1.0 - system.lower_at(time)).unwrap_or(0.0);
    let system = curve(last).with_possible(untested);
    let possible = |c: usize, time: f64| shares.untested.possible(c, 1.0 - system.lower_at(time));
    let bounded = |c: usize| curve(c).with_possible(|time| possible(c, time).unwrap_or(0.0));
    let curves: Vec<LifeCurve> = (0..names.len()).map(bounded).collect();
    let row = |name: &String, curve: &LifeCurve, level: f64| {
        let LifeAtLevel { life: cycles, lower, upper } = curve.life_at(level);
        let (limit_state, interval) = (name.clone(), CyclesRange { lower, upper });
        LifeRow { limit_state, reliability: level, cycles, interval, with_numerical_error: None }
    };
    let rows = |(name, curve): (&String, &LifeCurve)| LEVELS.map(|level| row(name, curve, level));
    summary.lives = names.iter().zip(&curves).flat_map(rows).collect();
    let of_system = &summary.lives[summary.lives.len() - LEVELS.len()..];
    let total = curves.last();
    summary.unresolved_fall = total.and_then(|total| unresolved_fall(total, shares, checkpoints, of_system));
    let curve_row = |(name, curve): (&String, LifeCurve)| LifeCurveRow {
        limit_state: name.clone(),
        cycles: curve.cycles,
        reliability: curve.reliability,
        lower: curve.lower,
        upper: curve.upper,
        numerical_lower: vec![],
        numerical_upper: vec![],
    };
    summary.curves = names.iter().zip(curves).map(curve_row).collect();
}

/// The interval in which R of the system falls from above 0.9 to below 0.1, or in which a life is bounded but not resolved.
fn unresolved_fall(
    total: &LifeCurve,
    shares: &InterimResult,
    checkpoints: &[u32],
    lives: &[LifeRow],
) -> Option<UnresolvedFall> {
    let failed = shares.failed.last()?;
    let reliability = |k: usize| 1.0 - shares.condition.probability * failed[k];
    let at_start = total.reliability.first().copied().unwrap_or(1.0);
    let falls = |k: &usize| {
        let before = if *k == 0 { at_start } else { reliability(k - 1) };
        before > FALL.0 && reliability(*k) < FALL.1
    };
    let bounded = |life: &LifeRow| {
        let level = life.reliability;
        let k = (0..checkpoints.len()).find(|k| reliability(*k) <= level)?;
        // A level that is not reached even unworn is known.
        (life.cycles.is_none() && life.interval.upper != Some(0.0) && at_start > level).then_some(k)
    };
    let k = (0..checkpoints.len()).find(falls).or_else(|| lives.iter().find_map(bounded))?;
    let (from, to) = (if k == 0 { 0 } else { checkpoints[k - 1] }, checkpoints[k]);
    let between = |level: f64| total.life_at(level).life;
    // The fall as it was interpolated; otherwise all that is known is that it lies within the interval.
    let width = match (between(FALL.0), between(FALL.1)) {
        (Some(first), Some(last)) => last - first,
        _ => 0.5 * f64::from(to - from),
    };
    let every = largest_divisor(checkpoints[checkpoints.len() - 1], width / WITHIN);
    Some(UnresolvedFall { from, to, checkpoint_every: every.min((to - from).div_ceil(2)) })
}

/// The largest divisor of `cycles` that is not above `most` [cycles]; 1 below that.
fn largest_divisor(cycles: u32, most: f64) -> u32 {
    let least = (f64::from(cycles) / most.max(1.0)).ceil() as u32;
    cycles / (least.max(1)..=cycles).find(|number| cycles.is_multiple_of(*number)).unwrap_or(cycles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_of_checkpoints_divides_the_life() {
        let found = [0.3, 1.0, 37.0, 1500.0, 9e9].map(|most| largest_divisor(2000, most));
        assert_eq!(found, [1, 1, 25, 1000, 2000]);
    }
}
