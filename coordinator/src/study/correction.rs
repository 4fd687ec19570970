//! Correction of the results of a study at its working accuracy by pairs of simulations at finer levels.
//!
//! What is corrected are the outputs of each evaluation, before limit states and surrogates see them, so that R(n), lives, first failures,
//! sensitivities and decisions follow from corrected results. Their stated errors are replaced by 1.96 standard deviations of the
//! correction, which moves all results together; the spread from point to point becomes [`Observed::rough`].
//!
//! What the pairs of a study gave, for its summary.

use super::{Observed, ObservedOutcome, Settings};
use crate::results::summary::StudySummary;
use crate::results::summary_rows::{DifferenceRow, LevelsRow};
use crate::statistics::levels::{HistoryDifference, HistoryPair};
use crate::statistics::reliability::REACH;
use common::scene::{LimitState, Scene};
use std::collections::HashMap;

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

/// Results of one sample at several levels.
#[derive(Debug, Clone)]
pub(super) struct LevelPair {
    /// Values of the variables `(d,)` [SI].
    pub sample: Vec<f64>,
    /// At the working accuracy.
    pub working: Observed,
    /// At the next finer level.
    pub finer: Observed,
    /// At the third level, at few points.
    pub finest: Option<Observed>,
}

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
    outputs: Vec<OutputCorrection>,
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

/// Correction of the history of one output.
#[derive(Debug, Clone)]
struct OutputCorrection {
    difference: HistoryDifference,
    /// True if the first value of the difference is that at the start of life.
    has_start: bool,
}

impl OutputCorrection {
    fn new(pairs: &[LevelPair], output: usize, target: PairedModel) -> Self {
        let both = |pair: &LevelPair| {
            let third = pair.finest.as_ref().is_none_or(|finest| finest.start[output].is_some());
            third && pair.working.start[output].is_some() && pair.finer.start[output].is_some()
        };
        let has_start = pairs.iter().all(both);
        let values = |observed: &Observed| -> Vec<f64> {
            let start = observed.start[output].filter(|_| has_start);
            start.into_iter().chain(observed.histories[output].iter().copied()).collect()
        };
        let of_pair =
            |pair: &LevelPair| (values(&pair.working), values(&pair.finer), pair.finest.as_ref().map(values));
        let all: Vec<_> = pairs.iter().map(of_pair).collect();
        let slices = std::iter::zip(&all, pairs).map(|((working, finer, finest), pair)| HistoryPair {
            point: &pair.sample,
            working,
            finer,
            finest: finest.as_deref(),
        });
        let slices: Vec<HistoryPair<'_>> = slices.collect();
        let difference = match target {
            PairedModel::FinerLevel => HistoryDifference::new(&slices),
            PairedModel::ExactLevel => HistoryDifference::to_exact(&slices),
            PairedModel::Variant => HistoryDifference::new(&slices).without_remainder(),
        };
        Self { difference, has_start }
    }
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
    pub(super) fn new(pairs: &[LevelPair], outputs: usize, target: PairedModel) -> Option<Self> {
        (pairs.len() >= FEWEST).then(|| Self {
            target,
            pairs: pairs.len(),
            first: pairs[0].sample.clone(),
            thirds: pairs.iter().filter(|pair| pair.finest.is_some()).count(),
            outputs: (0..outputs).map(|output| OutputCorrection::new(pairs, output, target)).collect(),
        })
    }

    /// The correction of a scene by stored outcomes at the working accuracy, and at finer levels `(level, outcome)` of the same samples.
    pub fn from_stored(
        scene: &Scene,
        working: &[StoredOutcome],
        finer: &[(u8, StoredOutcome)],
    ) -> Option<Self> {
        let bits = |sample: &[f64]| sample.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
        let of_level = |wanted: u8| -> HashMap<Vec<u64>, &Observed> {
            let own = finer.iter().filter(|(level, _)| *level == wanted);
            own.filter_map(|(_, one)| Some((bits(&one.sample), one.outcome.as_ref().ok()?))).collect()
        };
        let (second, third) = (of_level(1), of_level(2));
        let mut known = HashMap::new();
        let pair = |one: &StoredOutcome| {
            let sample = one.sample.clone();
            let key = bits(&one.sample);
            let working = one.outcome.as_ref().ok()?.clone();
            let finer = (*second.get(&key)?).clone();
            let finest = third.get(&key).map(|observed| (*observed).clone());
            // A sample of two campaigns counts once.
            known.insert(key, ()).is_none().then_some(LevelPair { sample, working, finer, finest })
        };
        let pairs: Vec<LevelPair> = working.iter().filter_map(pair).collect();
        Self::new(&pairs, pairs.first()?.working.histories.len(), PairedModel::of(scene))
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
        for (output, OutputCorrection { difference, has_start }) in self.outputs.iter().enumerate() {
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

    /// The difference of an output at its `n`th checkpoint, without what remains of the finer level: form and order of convergence in words,
    /// value, 1.96 standard deviations of the correction, and roughness, at the value `at` [unit of the output] and the first pair, that of
    /// the nominal point.
    pub(super) fn figures(&self, output: usize, n: usize, at: f64) -> LevelFigures {
        let OutputCorrection { difference, has_start } = &self.outputs[output];
        let n = n + usize::from(*has_start);
        LevelFigures {
            form: difference.form(),
            correction: difference.at(n, at, &self.first),
            of_pairs: REACH * difference.std_of_pairs(n, at),
            of_thirds: REACH * difference.std_of_thirds(n, at),
            error: REACH * difference.std_at(n, at),
            rough: difference.rough(n),
            order: difference.remainders[n].order,
        }
    }
}

/// What the pairs say of an output at a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LevelFigures {
    /// Form of the difference.
    pub form: &'static str,
    /// What is added to a result [unit of the output].
    pub correction: f64,
    /// 95 % reach of the part of its error that more pairs reduce [unit of the output].
    pub of_pairs: f64,
    /// 95 % reach of the part that more points at the third level reduce [unit of the output].
    pub of_thirds: f64,
    /// 95 % reach of its error [unit of the output].
    pub error: f64,
    /// Spread from point to point [unit of the output].
    pub rough: f64,
    /// Observed order of convergence [1].
    pub order: Option<f64>,
}

/// What the pairs of a study gave.
#[derive(Debug)]
pub(super) struct PairsResult {
    pub(super) correction: Option<Correction>,
    /// Simulations at finer levels, failed ones included.
    pub(super) evaluations: usize,
    /// Those without a result.
    pub(super) failed: usize,
}

impl PairsResult {
    /// Adds the levels and their differences at the `n`th checkpoint to the summary.
    pub fn add_to(&self, summary: &mut StudySummary, scene: &Scene, settings: &Settings, n: usize) {
        let finer = settings.finer_levels(scene);
        if finer.is_empty() {
            return;
        }
        let correction = self.correction.as_ref();
        let row = |limit: &LimitState| {
            let figures = correction?.figures(limit.output, n, limit.threshold);
            let share =
                |value: f64| if limit.threshold == 0.0 { value } else { value / limit.threshold.abs() };
            Some(DifferenceRow {
                limit_state: limit.name.clone(),
                cycles: scene.life.checkpoints()[n],
                form: figures.form.to_owned(),
                correction: share(figures.correction),
                error: share(figures.error),
                rough: share(figures.rough),
                order: figures.order,
            })
        };
        let working = &settings.accuracy.setting;
        summary.evaluations.total += self.evaluations;
        summary.evaluations.failed += self.failed;
        summary.levels = Some(LevelsRow {
            names: std::iter::once(working).chain(&finer).map(|level| level.name.clone()).collect(),
            pairs: correction.map_or([0; 2], |correction| [correction.pairs, correction.thirds]),
            evaluations: self.evaluations,
            failed: self.failed,
            differences: scene.limit_states.iter().filter_map(row).collect(),
        });
    }
}
