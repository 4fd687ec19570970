//! Comparison of the settings with the reference: cost, error of every output, validity of the stated errors, and effect of
//! the errors on the reliability.

use super::lives::{LifeChange, life_changes};
use super::measure::Measurement;
use crate::farm::evaluate::Finished;
use common::accuracy::NamedAccuracy;
use common::outputs::Evaluation;
use common::scene::{LimitState, Scene};
use std::collections::BTreeSet;

/// Error of one output of a setting against the reference, over all points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputError {
    /// Largest difference over all checkpoints relative to the threshold of the output's limit state, or to the output's
    /// largest value without a limit state [1].
    pub relative: f64,
    /// Largest relative difference up to the first checkpoint at which the reference reaches the limit, which is the part
    /// that affects the reliability [1].
    pub until_limit: f64,
    /// Largest change of the life at which the limit state is reached [cycles]; `None` if no point reaches it.
    pub life: Option<f64>,
    /// Validity of the stated errors.
    pub stated: StatedErrorCheck,
}

/// Cost and errors of one setting.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingComparison {
    /// Setting compared with the reference.
    pub setting: NamedAccuracy,
    /// Mean time of an evaluation on one core [s].
    pub seconds: f64,
    /// Mean number of time steps.
    pub steps: f64,
    /// Mean number of simulated cycles.
    pub cycles: f64,
    /// Number of points at which the evaluation failed.
    pub failures: usize,
    /// Error of every output of the scene; empty if all evaluations failed.
    pub outputs: Vec<OutputError>,
    /// Validity of the stated errors over all outputs.
    pub stated: StatedErrorCheck,
    /// Change of the lives by every limit state and in total; empty without random points.
    pub lives: Vec<LifeChange>,
    /// True if no other setting is both faster and more accurate in its worst output.
    pub efficient: bool,
}

impl SettingComparison {
    /// Largest relative error of any output [1].
    pub fn worst(&self) -> f64 {
        self.outputs.iter().fold(0.0, |a: f64, o| a.max(o.relative))
    }
}

/// A setting and the reference at one point.
struct ComparedPoint<'m> {
    point: usize,
    measured: &'m Finished,
    found: &'m Evaluation,
    reference: &'m Evaluation,
}

/// Compares every setting with the reference. Points without a result of either are excluded; the first point is the nominal
/// one, which is excluded from the reliability.
pub fn compare(
    scene: &Scene,
    settings: &[NamedAccuracy],
    measurement: &Measurement,
) -> Vec<SettingComparison> {
    let measured = settings.iter().zip(&measurement.settings);
    let mut rows: Vec<SettingComparison> =
        measured.map(|(setting, points)| row(scene, setting, points, &measurement.reference)).collect();
    for k in 0..rows.len() {
        let (seconds, worst) = (rows[k].seconds, rows[k].worst());
        let beaten = rows.iter().filter(|other| !other.outputs.is_empty()).any(|other| {
            let is_better = other.seconds < seconds || other.worst() < worst;
            other.seconds <= seconds && other.worst() <= worst && is_better
        });
        rows[k].efficient = !rows[k].outputs.is_empty() && !beaten;
    }
    rows
}

/// Row of the reference: its cost and, in the column of outputs, its own stated errors.
pub fn reference_row(
    scene: &Scene,
    reference: &NamedAccuracy,
    measurement: &Measurement,
) -> SettingComparison {
    let mut own: Vec<Finished> = measurement.reference.clone();
    for measured in &mut own {
        if let Ok(evaluation) = &mut measured.outcome {
            for (history, errors) in evaluation.histories.iter_mut().zip(&evaluation.errors) {
                history.iter_mut().zip(errors).for_each(|(value, error)| *value += error);
            }
        }
    }
    row(scene, reference, &own, &measurement.reference)
}

fn row(
    scene: &Scene,
    setting: &NamedAccuracy,
    points: &[Finished],
    reference: &[Finished],
) -> SettingComparison {
    let all = points.iter().zip(reference).enumerate();
    let pairs = all.filter_map(|(point, (measured, r))| {
        let (found, reference) = (measured.outcome.as_ref().ok()?, r.outcome.as_ref().ok()?);
        Some(ComparedPoint { point, measured, found, reference })
    });
    let pairs: Vec<ComparedPoint> = pairs.collect();
    let mean = |quantity: &dyn Fn(&ComparedPoint) -> f64| {
        pairs.iter().map(quantity).sum::<f64>() / pairs.len().max(1) as f64
    };
    let cases: Vec<Vec<StatedValue>> = (0..scene.outputs.len()).map(|k| cases(k, &pairs)).collect();
    let outputs = cases.iter().enumerate().map(|(k, cases)| output_error(scene, k, &pairs, cases));
    let random = pairs.iter().filter(|pair| pair.point > 0);
    let random: Vec<_> = random.map(|pair| (pair.found, pair.reference)).collect();
    SettingComparison {
        setting: setting.clone(),
        seconds: mean(&|pair| pair.measured.wall),
        steps: mean(&|pair| pair.found.diagnostics.steps as f64),
        cycles: mean(&|pair| pair.found.diagnostics.simulated_cycles as f64),
        failures: points.iter().filter(|m| m.outcome.is_err()).count(),
        outputs: if pairs.is_empty() { vec![] } else { outputs.collect() },
        stated: StatedErrorCheck::new(&cases.concat()),
        lives: life_changes(scene, &random),
        efficient: false,
    }
}

/// Every value of output `k`.
fn cases(k: usize, pairs: &[ComparedPoint]) -> Vec<StatedValue> {
    let all = pairs.iter().flat_map(|&ComparedPoint { point, found, reference, .. }| {
        let values = found.histories[k].iter().zip(&reference.histories[k]).zip(&found.errors[k]);
        values.map(move |((x, truth), &stated)| StatedValue { point, off: (x - truth).abs(), stated })
    });
    all.collect()
}

fn output_error(scene: &Scene, k: usize, pairs: &[ComparedPoint], cases: &[StatedValue]) -> OutputError {
    let limits: Vec<&LimitState> = scene.limit_states.iter().filter(|l| l.output == k).collect();
    let values = pairs.iter().flat_map(|pair| &pair.reference.histories[k]);
    let scale = limits.iter().map(|l| l.scale()).reduce(f64::min);
    let scale = scale.unwrap_or_else(|| values.fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs())));
    let (mut until_limit, mut life) = (0.0_f64, None);
    for ComparedPoint { found, reference, .. } in pairs {
        let (found_history, true_history) = (&found.histories[k], &reference.histories[k]);
        let reached = true_history.iter().position(|y| limits.iter().any(|limit| limit.is_reached(*y)));
        let seen = reached.map_or(true_history.len(), |n| n + 1);
        let differences = found_history.iter().zip(true_history).take(seen);
        until_limit = differences.fold(until_limit, |a, (x, truth)| a.max((x - truth).abs() / scale));
        let [first, true_first] = [found_history, true_history].map(|history| {
            limits.iter().filter_map(|limit| crossing(&found.cycles, history, limit)).reduce(f64::min)
        });
        let change = first.zip(true_first).map(|(a, b)| (a - b).abs());
        life = change.map(|change| life.unwrap_or(0.0_f64).max(change)).or(life);
    }
    let relative = cases.iter().fold(0.0, |a: f64, case| a.max(case.off / scale));
    OutputError { relative, until_limit, life, stated: StatedErrorCheck::new(cases) }
}

/// Life at which a history first reaches a limit, by linear interpolation [cycles].
fn crossing(cycles: &[u32], history: &[f64], limit: &LimitState) -> Option<f64> {
    let k = history.iter().position(|x| limit.is_reached(*x))?;
    let at = |k: usize| (f64::from(cycles[k]), limit.response(history[k]));
    let (n1, y1) = at(k);
    let Some((n0, y0)) = k.checked_sub(1).map(at) else { return Some(n1) };
    Some(n0 + (n1 - n0) * (limit.response_threshold() - y0) / (y1 - y0))
}

/// Multiple of the stated error below which the true error must lie in [`REQUIRED_SHARE`] of the values.
pub const TIMES: f64 = 2.0;
/// Share of the values whose true error must lie within [`TIMES`] the stated one [1].
pub const REQUIRED_SHARE: f64 = 0.95;

/// One value with its true and its stated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedValue {
    /// Point, from 0.
    pub point: usize,
    /// True error, |value - reference| [SI unit of the output].
    pub off: f64,
    /// Stated error [SI unit of the output].
    pub stated: f64,
}

impl StatedValue {
    /// True error over stated error [1]; 0 if both are zero, infinite if only the stated error is zero.
    pub fn ratio(&self) -> f64 {
        if self.off == 0.0 { 0.0 } else { self.off / self.stated }
    }
}

/// Comparison of stated and true errors over all points and checkpoints of one or several outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedErrorCheck {
    /// Share of the values whose true error is within the stated one [1].
    pub within: f64,
    /// Share of the values whose true error is within twice the stated one [1].
    pub within_twice: f64,
    /// Median of true over stated error [1].
    pub median_ratio: f64,
    /// 95 % quantile of true over stated error [1]; above 2 the stated errors are not valid.
    pub ratio_95: f64,
    /// Number of points with such a value.
    pub points_missed: usize,
}

impl StatedErrorCheck {
    /// Statistics of these values.
    pub fn new(values: &[StatedValue]) -> Self {
        let share = |count: usize| count as f64 / values.len().max(1) as f64;
        let mut ratios: Vec<f64> = values.iter().map(StatedValue::ratio).collect();
        ratios.sort_by(f64::total_cmp);
        // The smallest ratio that at least this share of the values does not exceed.
        let quantile = |q: f64| {
            let rank = (q * ratios.len() as f64).ceil() as usize;
            ratios.get(rank.max(1) - 1).copied().unwrap_or(0.0)
        };
        let missed: Vec<&StatedValue> = values.iter().filter(|case| case.off > TIMES * case.stated).collect();
        StatedErrorCheck {
            within: share(values.iter().filter(|case| case.off <= case.stated).count()),
            within_twice: share(values.len() - missed.len()),
            median_ratio: quantile(0.5),
            ratio_95: quantile(REQUIRED_SHARE),
            points_missed: missed.iter().map(|case| case.point).collect::<BTreeSet<_>>().len(),
        }
    }

    /// True if enough values lie within twice their stated error.
    pub fn holds(&self) -> bool {
        self.within_twice >= REQUIRED_SHARE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(point: usize, off: f64, stated: f64) -> StatedValue {
        StatedValue { point, off, stated }
    }

    #[test]
    fn shares_and_quantiles_are_counted() {
        // Ratios 0.1, 0.2, ..., 2.0 at the first point.
        let mut cases: Vec<StatedValue> = (1..=20).map(|k| case(0, 0.1 * f64::from(k), 1.0)).collect();
        let all = StatedErrorCheck::new(&cases);
        assert_eq!((all.within, all.within_twice, all.points_missed), (0.5, 1.0, 0));
        assert!((all.median_ratio - 1.0).abs() < 1e-12 && (all.ratio_95 - 1.9).abs() < 1e-12);
        assert!(all.holds());
        // Three at two points; an error where none was stated is the worst of all.
        cases.extend([case(1, 3.0, 1.0), case(1, 2.1, 1.0), case(2, 1e-9, 0.0)]);
        let some = StatedErrorCheck::new(&cases);
        assert_eq!(some.points_missed, 2);
        assert!(!some.holds() && some.ratio_95 > 2.0);
        assert_eq!((case(2, 1e-9, 0.0).ratio(), case(0, 0.0, 0.0).ratio()), (f64::INFINITY, 0.0));
        assert_eq!(StatedErrorCheck::new(&[]).median_ratio, 0.0);
    }
}
