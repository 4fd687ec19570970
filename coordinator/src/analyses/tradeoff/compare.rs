//! How settings compare with the reference: cost, error of every output, whether the stated errors hold, and what the
//! errors mean for the reliability.

use super::lives::{LifeChange, life_changes};
use super::measure::{Measured, Measurement};
use super::stated::{Case, Stated};
use common::accuracy::NamedAccuracy;
use common::outputs::Evaluation;
use common::scene::Scene;

/// How one output of a setting compares with the reference, over all points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputError {
    /// Largest difference over all checkpoints, over the threshold of the output's limit state, or over the output's largest
    /// value where it has none [1].
    pub relative: f64,
    /// The same up to the first checkpoint at which the reference reaches the limit: what the reliability sees [1].
    pub until_limit: f64,
    /// Largest displacement of the life at which the limit state is reached [cycles]; none where no point reaches it.
    pub life: Option<f64>,
    /// Whether the errors that the evaluations state hold.
    pub stated: Stated,
}

/// One setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The setting.
    pub setting: NamedAccuracy,
    /// Mean time of an evaluation on one core [s].
    pub seconds: f64,
    /// Mean number of time steps.
    pub steps: f64,
    /// Mean number of simulated cycles.
    pub cycles: f64,
    /// Points at which it failed.
    pub failures: usize,
    /// One per output of the scene; empty if it failed everywhere.
    pub outputs: Vec<OutputError>,
    /// Whether the stated errors hold, over all outputs.
    pub stated: Stated,
    /// One per limit state and one for all; empty without random points.
    pub lives: Vec<LifeChange>,
    /// Whether no other setting is both quicker and nearer in the worst of its outputs.
    pub efficient: bool,
}

impl Row {
    /// Error of its worst output.
    pub fn worst(&self) -> f64 {
        self.outputs.iter().fold(0.0, |a: f64, o| a.max(o.relative))
    }
}

/// A setting and the reference at one point.
struct Pair<'m> {
    point: usize,
    measured: &'m Measured,
    found: &'m Evaluation,
    reference: &'m Evaluation,
}

/// Compares every setting with the reference. Points at which one of the two has no result are left out; the first point is
/// the nominal one, which says nothing about reliability.
pub fn compare(scene: &Scene, settings: &[NamedAccuracy], measurement: &Measurement) -> Vec<Row> {
    let mut rows: Vec<Row> = settings
        .iter()
        .zip(&measurement.settings)
        .map(|(setting, points)| row(scene, setting, points, &measurement.reference))
        .collect();
    for k in 0..rows.len() {
        let (seconds, worst) = (rows[k].seconds, rows[k].worst());
        let beaten = rows.iter().any(|other| {
            !other.outputs.is_empty()
                && other.seconds <= seconds
                && other.worst() <= worst
                && (other.seconds < seconds || other.worst() < worst)
        });
        rows[k].efficient = !rows[k].outputs.is_empty() && !beaten;
    }
    rows
}

/// Compares the reference with itself: its cost, and in [`Row::outputs`] the errors it states of itself.
pub fn reference_row(scene: &Scene, measurement: &Measurement) -> Row {
    let mut own: Vec<Measured> = measurement.reference.clone();
    for measured in &mut own {
        if let Ok(evaluation) = &mut measured.outcome {
            for (history, errors) in evaluation.histories.iter_mut().zip(&evaluation.errors) {
                history.iter_mut().zip(errors).for_each(|(value, error)| *value += error);
            }
        }
    }
    let setting = NamedAccuracy {
        name: super::settings::REFERENCE.into(),
        accuracy: common::accuracy::Accuracy::reference(),
    };
    row(scene, &setting, &own, &measurement.reference)
}

fn row(scene: &Scene, setting: &NamedAccuracy, points: &[Measured], reference: &[Measured]) -> Row {
    let pairs: Vec<Pair> = points
        .iter()
        .zip(reference)
        .enumerate()
        .filter_map(|(point, (measured, r))| {
            let (found, reference) = (measured.outcome.as_ref().ok()?, r.outcome.as_ref().ok()?);
            Some(Pair { point, measured, found, reference })
        })
        .collect();
    let mean = |of: &dyn Fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len().max(1) as f64;
    let cases: Vec<Vec<Case>> = (0..scene.outputs.len()).map(|k| cases(k, &pairs)).collect();
    let outputs = cases.iter().enumerate().map(|(k, cases)| output_error(scene, k, &pairs, cases));
    let random: Vec<_> =
        pairs.iter().filter(|pair| pair.point > 0).map(|pair| (pair.found, pair.reference)).collect();
    Row {
        setting: setting.clone(),
        seconds: mean(&|pair| pair.measured.seconds),
        steps: mean(&|pair| pair.found.diagnostics.steps as f64),
        cycles: mean(&|pair| pair.found.diagnostics.simulated_cycles as f64),
        failures: points.iter().filter(|m| m.outcome.is_err()).count(),
        outputs: if pairs.is_empty() { vec![] } else { outputs.collect() },
        stated: Stated::of(&cases.concat()),
        lives: life_changes(scene, &random),
        efficient: false,
    }
}

/// Every value of output `k`.
fn cases(k: usize, pairs: &[Pair]) -> Vec<Case> {
    let mut all = Vec::new();
    for Pair { point, found, reference, .. } in pairs {
        let last = found.cycles.last().copied().unwrap_or(1);
        let values = found.histories[k].iter().zip(&reference.histories[k]).zip(&found.errors[k]);
        all.extend(found.cycles.iter().zip(values).map(|(&cycles, ((x, truth), &stated))| Case {
            point: *point,
            cycles,
            life: f64::from(cycles) / f64::from(last),
            off: (x - truth).abs(),
            stated,
        }));
    }
    all
}

fn output_error(scene: &Scene, k: usize, pairs: &[Pair], cases: &[Case]) -> OutputError {
    let threshold = scene.limit_states.iter().filter(|l| l.output == k).map(|l| l.threshold).reduce(f64::min);
    let values = pairs.iter().flat_map(|pair| &pair.reference.histories[k]);
    let scale = threshold.unwrap_or_else(|| values.fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs())));
    let (mut until_limit, mut life) = (0.0_f64, None);
    for Pair { found, reference, .. } in pairs {
        let (found_history, true_history) = (&found.histories[k], &reference.histories[k]);
        let reached = threshold.and_then(|limit| true_history.iter().position(|y| *y >= limit));
        let seen = reached.map_or(true_history.len(), |n| n + 1);
        let differences =
            found_history.iter().zip(true_history).take(seen).map(|(x, truth)| (x - truth).abs());
        until_limit = differences.fold(until_limit, |a, off| a.max(off / scale));
        let crossing = |history: &[f64]| threshold.and_then(|limit| crossing(&found.cycles, history, limit));
        if let (Some(a), Some(b)) = (crossing(found_history), crossing(true_history)) {
            life = Some(life.unwrap_or(0.0_f64).max((a - b).abs()));
        }
    }
    let relative = cases.iter().fold(0.0, |a: f64, case| a.max(case.off / scale));
    OutputError { relative, until_limit, life, stated: Stated::of(cases) }
}

/// Life at which a history first reaches a limit, by linear interpolation [cycles].
fn crossing(cycles: &[u32], history: &[f64], limit: f64) -> Option<f64> {
    let k = history.iter().position(|x| *x >= limit)?;
    if k == 0 {
        return Some(f64::from(cycles[0]));
    }
    let (n0, n1, y0, y1) = (f64::from(cycles[k - 1]), f64::from(cycles[k]), history[k - 1], history[k]);
    Some(n0 + (n1 - n0) * (limit - y0) / (y1 - y0))
}
