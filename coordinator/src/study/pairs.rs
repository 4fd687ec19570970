//! Active learning with pairs: when learning has ended at the working accuracy, some of its points are simulated at finer levels, and the
//! results are corrected by the differences.
//!
//! The first chunk has [`FIRST`] pairs at the second level, [`THIRD`] of them at the third level too. More pairs follow while the numerical part
//! of the interval of some R(n) that they can reduce is larger than that of the surrogates, up to a quarter of the evaluations. The points are
//! the nominal one and those farthest from it and from each other, weighted by their nearness to a limit. Then the surrogates are fitted to
//! the corrected results; if they no longer meet the targets and the budget allows, learning goes on with them.
//!
//! # Source
//! Own; the pairs in the place of further levels of learning as in Chaudhuri, Marques, Willcox (2021), mfEGRA: Multifidelity efficient global
//! reliability analysis through active learning for failure boundary location, Structural and Multidisciplinary Optimization 64.

use super::campaign::Campaign;
use super::correction::{Correction, LevelPair};
use super::interim::InterimResult;
use super::learner::Learner;
use super::observations::{Observed, ObservedOutcome};
use super::plan::ResponseLayout;
use super::step::{CampaignError, SampleRequest, Step, StopReason};
use super::{CampaignResult, Settings};
use crate::results::level_summary::{DifferenceRow, LevelsRow};
use crate::results::summary::{Round, StudySummary};
use crate::statistics::design::deviation;
use crate::statistics::learning::{Figures, farthest};
use crate::statistics::reliability::REACH;
use common::scene::{LimitState, Scene};
use std::collections::VecDeque;

/// Pairs of the first chunk.
const FIRST: usize = 6;
/// Pairs of each later chunk.
const NEXT: usize = 3;
/// Points simulated at the third level.
const THIRD: usize = 3;
/// Share of the evaluations at the working accuracy that pairs may add [1].
const MOST: f64 = 0.25;

/// A simulation at the working accuracy.
#[derive(Debug)]
struct PairedPoint {
    sample: Vec<f64>,
    observed: Observed,
    /// Results at the second and at the third level; the outer `None` where none was requested.
    finer: [Option<Observed>; 2],
    is_paired: bool,
}

/// A request of the pairs: index of the simulation, level.
type PairRequest = (usize, u8);

/// A campaign that is followed by pairs.
#[derive(Debug)]
pub(super) struct PairedCampaign<'a> {
    scene: &'a Scene,
    campaign: Campaign,
    responses: ResponseLayout,
    /// Number of finer levels, 0 to 2.
    finer: usize,
    /// Samples of the chunks of the campaign under way, the oldest first.
    under_way: VecDeque<Vec<Vec<f64>>>,
    simulated: Vec<PairedPoint>,
    /// Pairs under way.
    requested: Vec<PairRequest>,
    /// Evaluations at finer levels whose outcome has been recorded, and those of them that failed.
    counts: [usize; 2],
    correction: Option<Correction>,
    has_ended: bool,
}

impl<'a> PairedCampaign<'a> {
    /// A campaign with a number of finer levels, 0 to 2.
    pub fn new(scene: &'a Scene, campaign: Campaign, finer: usize) -> Self {
        Self {
            scene,
            campaign,
            responses: ResponseLayout::from_scene(scene),
            finer,
            under_way: VecDeque::new(),
            simulated: vec![],
            requested: vec![],
            counts: [0; 2],
            correction: None,
            has_ended: false,
        }
    }

    /// Result of the campaign, and what the pairs gave.
    pub fn finish(self) -> Option<(CampaignResult, PairsResult)> {
        let [evaluations, failed] = self.counts;
        Some((self.campaign.finish()?, PairsResult { correction: self.correction, evaluations, failed }))
    }

    /// The next chunk of pairs; none if there are enough.
    fn next_pairs(&self) -> Vec<PairRequest> {
        let paired = self.simulated.iter().filter(|one| one.is_paired).count();
        if self.finer == 0 {
            return vec![];
        }
        let most = ((MOST * self.simulated.len() as f64) as usize).max(FIRST);
        let wanted = match self.current() {
            _ if paired == 0 => FIRST,
            Some(correction) if self.is_precise(&correction) => 0,
            _ => NEXT,
        };
        let chosen = self.farthest_points(wanted.min(most.saturating_sub(paired)));
        let third = chosen.iter().take(if paired == 0 && self.finer > 1 { THIRD } else { 0 });
        // The longest simulations first.
        third.map(|i| (*i, 2)).chain(chosen.iter().map(|i| (*i, 1))).collect()
    }

    /// Simulations without a pair: the nominal one first, then the farthest ones, weighted by their nearness to a limit.
    fn farthest_points(&self, count: usize) -> Vec<usize> {
        let free: Vec<usize> = (0..self.simulated.len()).filter(|i| !self.simulated[*i].is_paired).collect();
        let inputs = &self.campaign.problem.inputs;
        let z: Vec<Vec<f64>> = self.simulated.iter().map(|one| inputs.standardise(&one.sample)).collect();
        let mut chosen: Vec<usize> =
            free.iter().copied().take(usize::from(free.first() == Some(&0))).collect();
        let rest: Vec<usize> = free.iter().copied().filter(|i| !chosen.contains(i)).collect();
        let points: Vec<&[f64]> = rest.iter().map(|i| z[*i].as_slice()).collect();
        let nearness = self.nearness();
        let weights: Vec<f64> = rest.iter().map(|i| nearness[*i]).collect();
        let paired = (0..z.len()).filter(|i| self.simulated[*i].is_paired || chosen.contains(i));
        let found = farthest(&points, paired.map(|i| (z[i].as_slice(), 1.0)), &weights, count);
        chosen.extend(found.into_iter().map(|place| rest[place]));
        chosen.truncate(count);
        chosen
    }

    /// Weight of each simulation by the distance of its responses from the nearest limit, at the governing checkpoint [1].
    fn nearness(&self) -> Vec<f64> {
        let mut nearness = vec![0.0_f64; self.simulated.len()];
        let n = self.campaign.assessment().map_or(0, |assessment| assessment.governing);
        for mode in &self.campaign.problem.modes {
            let all: Vec<f64> =
                self.simulated.iter().map(|one| one.observed.running_maximum(mode.output)[n]).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            let variance = all.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / all.len() as f64;
            for (weight, y) in nearness.iter_mut().zip(&all) {
                let distance = (y - mode.threshold).powi(2) / variance.max(f64::MIN_POSITIVE);
                *weight = weight.max(1.0 / (1.0 + distance));
            }
        }
        // A point far from every limit still tells of the shape of the difference.
        nearness.iter().map(|weight| weight.max(0.1)).collect()
    }

    /// The correction by the pairs so far.
    fn current(&self) -> Option<Correction> {
        let pair = |one: &PairedPoint| {
            let [finer, finest] = one.finer.clone();
            Some(LevelPair { working: one.observed.clone(), finer: finer?, finest })
        };
        let pairs: Vec<LevelPair> = self.simulated.iter().filter_map(pair).collect();
        Correction::new(&pairs, self.scene.outputs.len())
    }

    /// True if the error that more pairs would reduce moves no R(n) by more than the errors of the surrogates do.
    fn is_precise(&self, correction: &Correction) -> bool {
        let Some(assessment) = self.campaign.assessment() else { return true };
        let of_surrogates = assessment.combined_errors();
        let of_surrogates = of_surrogates.iter().flatten().map(|(_, error)| *error).fold(0.0, f64::max);
        let points = self.campaign.classified.population.len();
        let moved = |(n, checkpoint): (usize, &usize)| {
            let reach = |s: usize| {
                let limit = &self.scene.limit_states[s];
                correction.figures(limit.output, *checkpoint, limit.threshold).of_pairs
            };
            let reaches: Vec<f64> = (0..assessment.modes.len()).map(reach).collect();
            let shifted = |j: &usize| {
                let fails = |sign: f64| {
                    assessment.modes.iter().enumerate().any(|(s, mode)| {
                        let std = mode.sigma[n] * mode.variance_factor[*j].max(0.0).sqrt();
                        mode.means_of(*j)[n] + std * deviation(s, *j) + sign * reaches[s] >= mode.threshold
                    })
                };
                fails(1.0) && !fails(-1.0)
            };
            0.5 * (0..points).filter(shifted).count() as f64 / points as f64
        };
        let largest = assessment.grid.iter().enumerate().map(moved).fold(0.0, f64::max);
        largest <= REACH * of_surrogates
    }

    /// Corrects the results of the campaign. Learning goes on with corrected results if these no longer meet the targets.
    fn correct(&mut self) -> Result<(), CampaignError> {
        self.correction = self.current();
        let Some(correction) = &self.correction else { return Ok(()) };
        let (campaign, responses) = (&mut self.campaign, &self.responses);
        campaign.data.observations.change(|observed| responses.complete(correction.correct(observed)));
        campaign.surrogates.reset_population();
        campaign.surrogates.require_fit();
        campaign.progress.stopping.reset();
        let (assessment, _) = campaign.assess_until_fresh()?;
        // The correction itself moves the curves; no round does.
        let met = campaign.plan.targets.met(&Figures { change: Some(0.0), ..assessment.figures });
        let cov = campaign.classified.coefficient_of_variation(assessment.governing_failed());
        campaign.add_round(&assessment, cov);
        campaign.progress.assessment = Some(assessment);
        if met.is_none() && matches!(campaign.progress.stop, Some(StopReason::Rule(_))) {
            campaign.progress.stop = None;
            return Ok(());
        }
        self.campaign.redraw_at_the_end()
    }

    fn record_pairs(&mut self, outcomes: Vec<ObservedOutcome>) {
        for ((i, level), outcome) in std::mem::take(&mut self.requested).into_iter().zip(outcomes) {
            self.counts[0] += 1;
            match outcome {
                Ok(observed) => self.simulated[i].finer[usize::from(level) - 1] = Some(observed),
                Err(_) => self.counts[1] += 1,
            }
        }
    }
}

/// What the pairs of a study gave.
#[derive(Debug)]
pub(super) struct PairsResult {
    correction: Option<Correction>,
    /// Simulations at finer levels, failed ones included.
    evaluations: usize,
    /// Those without a result.
    failed: usize,
}

impl PairsResult {
    /// Adds the levels and their differences to the summary.
    pub fn add_to(
        &self,
        summary: &mut StudySummary,
        scene: &Scene,
        settings: &Settings,
        learned: &CampaignResult,
    ) {
        let finer = settings.finer_levels(scene);
        if finer.is_empty() {
            return;
        }
        let n = learned.assessment.governing;
        let row = |limit: &LimitState| {
            let figures = self.correction.as_ref()?.figures(limit.output, n, limit.threshold);
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
            pairs: self
                .correction
                .as_ref()
                .map_or([0; 2], |correction| [correction.pairs, correction.thirds]),
            evaluations: self.evaluations,
            failed: self.failed,
            differences: scene.limit_states.iter().filter_map(row).collect(),
        });
    }
}

impl Learner for PairedCampaign<'_> {
    fn next_step(&mut self) -> Result<Step, CampaignError> {
        if !self.requested.is_empty() {
            return Ok(Step::Wait);
        }
        loop {
            let step = self.campaign.next_step()?;
            if let Step::Evaluate(requests) = &step {
                self.under_way.push_back(requests.iter().map(|request| request.sample.clone()).collect());
            }
            if step != Step::Done || self.has_ended {
                return Ok(step);
            }
            self.requested = self.next_pairs();
            if !self.requested.is_empty() {
                let request = |(i, level): &PairRequest| SampleRequest {
                    level: *level,
                    ..SampleRequest::new(self.simulated[*i].sample.clone())
                };
                let requests = self.requested.iter().map(request).collect();
                self.requested.iter().for_each(|(i, _)| self.simulated[*i].is_paired = true);
                return Ok(Step::Evaluate(requests));
            }
            self.has_ended = true;
            self.correct()?;
        }
    }

    fn record(&mut self, outcomes: Vec<ObservedOutcome>) -> Result<(), CampaignError> {
        if !self.requested.is_empty() {
            self.record_pairs(outcomes);
            return Ok(());
        }
        let samples = self.under_way.pop_front().expect("outcomes belong to a chunk under way");
        let results = samples.into_iter().zip(&outcomes);
        let simulated = results.filter_map(|(sample, outcome)| {
            let observed = outcome.as_ref().ok()?.clone();
            Some(PairedPoint { sample, observed, finer: [None, None], is_paired: false })
        });
        self.simulated.extend(simulated);
        let Self { correction, responses, .. } = &*self;
        let corrected = |observed: Observed| match correction {
            Some(correction) => responses.complete(correction.correct(observed)),
            None => observed,
        };
        let outcomes = outcomes.into_iter().map(|outcome| outcome.map(corrected)).collect();
        self.campaign.record(outcomes)
    }

    fn rounds(&self) -> &[Round] {
        Campaign::rounds(&self.campaign)
    }

    fn purpose(&self) -> String {
        if self.requested.is_empty() { self.campaign.purpose() } else { "finer levels".to_owned() }
    }

    fn interim(&self) -> Option<InterimResult> {
        Learner::interim(&self.campaign)
    }

    fn constant_limit_states(&self) -> Vec<usize> {
        self.campaign.constant_limit_states()
    }
}
