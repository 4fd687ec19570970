//! Correction of the results of a study at its working accuracy by pairs of simulations at finer levels.
//!
//! What is corrected are the outputs of each evaluation, before limit states and surrogates see them, so that R(n), lives, first failures,
//! sensitivities and decisions follow from corrected results. Their stated errors are replaced by 1.96 standard deviations of the
//! correction, which moves all results together; the spread from point to point becomes [`Observed::rough`].
//!
//! What the pairs of a study gave, for its summary.

use super::requests::bits;
use super::{Observed, ObservedOutcome, Settings};
use crate::results::summary::StudySummary;
use crate::results::summary_rows::{DifferenceRow, LevelsRow};
use crate::statistics::levels::{HistoryDifference, HistoryPair};
use crate::statistics::reliability::REACH;
use common::failure::SimulationFailure;
use common::scene::{LimitState, Scene};
use std::collections::{HashMap, HashSet};

/// Fewest pairs for a correction.
const FEWEST: usize = 3;

/// Outcome of one evaluation of a study.
#[derive(Debug, Clone)]
pub struct StoredOutcome {
    /// Values of the random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Simulated histories per output of the scene, or the failure.
    pub outcome: ObservedOutcome,
}

/// Results of one sample, the values of the variables `(d,)` [SI]: at the working accuracy and the next finer level, and at the third
/// level, at few points.
pub(super) type LevelPair<'a> = (&'a [f64], [&'a Observed; 2], Option<&'a Observed>);

/// Correction of every output of a scene.
#[derive(Debug, Clone)]
pub struct Correction {
    /// What the second level is.
    target: PairedModel,
    /// Number of pairs.
    pub pairs: usize,
    /// Number of them with a third level.
    pub thirds: usize,
    /// Values of the variables of the first pair `(d,)` [SI].
    first: Vec<f64>,
    /// Difference of the history of each output; true if its first value is that at the start of life.
    outputs: Vec<(HistoryDifference, bool)>,
}

/// What the second level of a pair is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PairedModel {
    /// A finer level: its remainder is a part of the correction, whose error takes the place of the stated one.
    FinerLevel,
    /// A finer level, and the last one is exact: the difference to it is the correction, whose error takes the place of the stated one.
    ExactLevel,
    /// A variant of the model: the difference is the correction, whose error is added to the stated one.
    Variant,
}

/// Difference of the history of one output by pairs; true if its first value is that at the start of life.
fn difference_of(pairs: &[LevelPair<'_>], output: usize, target: PairedModel) -> (HistoryDifference, bool) {
    let has_start = |observed: &Observed| observed.start[output].is_some();
    let has_start = pairs
        .iter()
        .all(|(_, both, finest)| both.iter().all(|one| has_start(one)) && finest.is_none_or(has_start));
    let values = |observed: &Observed| -> Vec<f64> {
        let start = observed.start[output].filter(|_| has_start);
        start.into_iter().chain(observed.histories[output].iter().copied()).collect()
    };
    let histories = pairs.iter().map(|(point, [working, finer], finest)| HistoryPair {
        point,
        working: values(working),
        finer: values(finer),
        finest: finest.map(values),
    });
    let histories: Vec<_> = histories.collect();
    let difference = match target {
        PairedModel::FinerLevel => HistoryDifference::new(&histories),
        PairedModel::ExactLevel => HistoryDifference::to_exact(&histories),
        PairedModel::Variant => HistoryDifference::new(&histories).without_remainder(),
    };
    (difference, has_start)
}

impl PairedModel {
    /// What the finer levels of a scene are.
    pub fn of(scene: &Scene) -> Self {
        let is_exact = scene.simulator.as_ref().is_some_and(|simulator| simulator.finest_is_exact);
        if is_exact { Self::ExactLevel } else { Self::FinerLevel }
    }
}

impl Correction {
    /// The correction of the first `outputs` outputs; `None` with too few pairs.
    pub(super) fn new(pairs: &[LevelPair<'_>], outputs: usize, target: PairedModel) -> Option<Self> {
        (pairs.len() >= FEWEST).then(|| Self {
            target,
            pairs: pairs.len(),
            first: pairs[0].0.to_vec(),
            thirds: pairs.iter().filter(|(.., finest)| finest.is_some()).count(),
            outputs: (0..outputs).map(|output| difference_of(pairs, output, target)).collect(),
        })
    }

    /// The correction of a scene by stored outcomes at the working accuracy, and at finer levels `(level, outcome)` of the same samples.
    pub fn from_stored<'s>(
        scene: &Scene,
        working: &'s [StoredOutcome],
        finer: &'s [(u8, StoredOutcome)],
    ) -> Option<Self> {
        let of_level = |wanted: u8| -> HashMap<Vec<u64>, &Observed> {
            let own = finer.iter().filter(|(level, _)| *level == wanted);
            own.filter_map(|(_, one)| Some((bits(&one.sample), one.outcome.as_ref().ok()?))).collect()
        };
        let (second, third) = (of_level(1), of_level(2));
        let mut known = HashSet::new();
        let mut pair = |one: &'s StoredOutcome| {
            let key = bits(&one.sample);
            let both = [one.outcome.as_ref().ok()?, *second.get(&key)?];
            let finest = third.get(&key).copied();
            // A sample of two campaigns counts once.
            known.insert(key).then_some((&one.sample[..], both, finest))
        };
        let pairs: Vec<LevelPair<'_>> = working.iter().filter_map(&mut pair).collect();
        let (_, [first, _], _) = pairs.first()?;
        Self::new(&pairs, first.histories.len(), PairedModel::of(scene))
    }

    /// The corrected result of an evaluation at values of the variables `(d,)` [SI]; responses that were derived from its outputs are left
    /// out.
    pub fn correct(&self, sample: &[f64], observed: Observed) -> Observed {
        let Observed { mut histories, mut errors, mut start, rough: known, source, .. } = observed;
        let adds = self.target == PairedModel::Variant;
        let outputs = self.outputs.len();
        histories.truncate(outputs);
        errors.truncate(outputs);
        start.truncate(outputs);
        let mut rough = Vec::with_capacity(outputs);
        for (output, (difference, has_start)) in self.outputs.iter().enumerate() {
            let shift = usize::from(*has_start);
            for (n, (value, error)) in histories[output].iter_mut().zip(&mut errors[output]).enumerate() {
                let stated = if adds { *error } else { 0.0 };
                *error = stated.hypot(REACH * difference.std_at(n + shift, *value));
                *value += difference.at(n + shift, *value, sample);
            }
            if let (true, Some(value)) = (*has_start, start[output].as_mut()) {
                *value += difference.at(0, *value, sample);
            }
            let before =
                |n: usize| known.get(output).filter(|_| adds).map_or(0.0, |rough: &Vec<f64>| rough[n]);
            let checkpoints = 0..histories[output].len();
            let own = |n: usize| difference.rough(n + shift).hypot(before(n));
            rough.push(checkpoints.map(own).collect::<Vec<f64>>());
        }
        // A difference that is the same everywhere shows no noise where none was known.
        if adds && known.is_empty() && rough.iter().flatten().all(|rough| *rough == 0.0) {
            rough.clear();
        }
        Observed { histories, errors, rough, start, distances: vec![], source }
    }

    /// The corrected outcomes of stored ones.
    pub fn correct_all(&self, stored: Vec<StoredOutcome>) -> Vec<StoredOutcome> {
        let correct = |StoredOutcome { sample, outcome }| {
            let outcome = outcome.map(|observed| self.correct(&sample, observed));
            StoredOutcome { sample, outcome }
        };
        stored.into_iter().map(correct).collect()
    }

    /// The difference of an output at its `n`th checkpoint, at the value `at` and the first pair, that of the nominal point, and the 95 %
    /// reaches of the parts of its error that more pairs, and more points at the third level, reduce, and of all of it [unit of the output].
    pub(super) fn reaches(&self, output: usize, n: usize, at: f64) -> (f64, [f64; 3]) {
        let (difference, has_start) = &self.outputs[output];
        let n = n + usize::from(*has_start);
        let parts =
            [difference.std_of_pairs(n, at), difference.std_of_thirds(n, at), difference.std_at(n, at)];
        (difference.at(n, at, &self.first), parts.map(|std| REACH * std))
    }

    /// The difference at the threshold of a limit state and its `n`th checkpoint, in shares of the threshold, with 1.96 standard deviations
    /// of the correction, and roughness.
    fn row(&self, scene: &Scene, limit: &LimitState, n: usize) -> DifferenceRow {
        let (difference, has_start) = &self.outputs[limit.output];
        let (k, at) = (n + usize::from(*has_start), limit.threshold);
        let share = |value: f64| if at == 0.0 { value } else { value / at.abs() };
        DifferenceRow {
            limit_state: limit.name.clone(),
            cycles: scene.life.checkpoints()[n],
            form: difference.form().to_owned(),
            correction: share(difference.at(k, at, &self.first)),
            error: share(REACH * difference.std_at(k, at)),
            rough: share(difference.rough(k)),
            order: difference.remainders[k].order,
        }
    }
}

/// Adds the levels and their differences at the `n`th checkpoint to the summary, the number of simulations at finer levels, and the
/// causes of those that failed.
pub(super) fn add_levels(
    summary: &mut StudySummary,
    scene: &Scene,
    settings: &Settings,
    n: usize,
    (correction, evaluations, failed): (Option<&Correction>, usize, &[SimulationFailure]),
) {
    let finer = settings.finer_levels(scene);
    if finer.is_empty() {
        return;
    }
    let row = |limit: &LimitState| Some(correction?.row(scene, limit, n));
    let working = &settings.accuracy.setting;
    summary.evaluations.total += evaluations;
    summary.evaluations.failed += failed.len();
    summary.levels = Some(LevelsRow {
        names: std::iter::once(working).chain(&finer).map(|level| level.name.clone()).collect(),
        pairs: correction.map_or([0; 2], |correction| [correction.pairs, correction.thirds]),
        evaluations,
        failed: failed.len(),
        cause: failed.first().map(ToString::to_string),
        differences: scene.limit_states.iter().filter_map(row).collect(),
    });
}
