//! Active learning with pairs: when learning has ended at the working accuracy, some of its points are simulated at finer levels, and the
//! results are corrected by the differences.
//!
//! The first chunk has [`FIRST`] pairs at the second level, [`THIRD`] of them at the third level too. With n pairs and m points at the third
//! level, whose scatter moves some R(n) of the system, counted around the curves with the correction of the nominal point, by A and by B, more
//! pairs or more points at the third level follow, whichever reduces A^2 + B^2 more for its cost, A^2 / n / c against B^2 / m / c^2, where c is
//! the cost of a level over that of the coarser one, that of the scene or [`HALVED_COST`]. They end when hypot(A, B) is no larger than the error
//! of the surrogates in R(n), when the whole half width of R(n) is that of `--target-error`, or [`HALF_WIDTH`], or with the cost of [`MOST`]
//! times the evaluations at the working accuracy; while hypot(A, B) is above [`WIDE`], with what those evaluations would cost at the finest
//! level. The points are the nominal one and those farthest from it and from each other, weighted by their nearness to a limit. Then the
//! surrogates are fitted to the corrected results; if they no longer meet the targets and the budget allows, learning goes on with them.
//!
//! # Source
//! Own; the pairs in the place of further levels of learning as in Chaudhuri, Marques, Willcox (2021), mfEGRA: Multifidelity efficient global
//! reliability analysis through active learning for failure boundary location, Structural and Multidisciplinary Optimization 64.

use super::correction::{Correction, LevelPair, PairedModel};
use super::interim::InterimResult;
use super::learner::Learner;
use super::{Campaign, CampaignResult, Observed, ObservedOutcome};

use super::plan::ResponseLayout;
use super::step::{CampaignError, SampleRequest, Step, StopReason};
use crate::results::summary::Round;
use crate::statistics::design::deviation;
use crate::statistics::learning::{Figures, farthest};
use crate::statistics::reliability::REACH;
use common::failure::SimulationFailure;
use common::scene::{LimitState, Scene};
use std::collections::VecDeque;

/// Pairs of the first chunk.
const FIRST: usize = 6;
/// Pairs of each later chunk of pairs.
const NEXT: usize = 3;
/// Points simulated at the third level first.
const THIRD: usize = 3;
/// Points of each later chunk of points at the third level.
const NEXT_THIRD: usize = 2;
/// Cost of all pairs over that of the evaluations at the working accuracy [1].
const MOST: f64 = 1.5;
/// Reach of the scatter [1] above which a study whose pairs end is worth less than one at the finest level.
const WIDE: f64 = 0.05;
/// Half width of the whole interval of R(n) of the system with which pairs end in a study without `--target-error` [1].
///
/// The corrected results widen it by up to a tenth: it is to be at most 0.015 then.
const HALF_WIDTH: f64 = 0.0135;
/// Cost of a finer level over that of the level before, for a mechanism [1]: 2.4 to 4.2 measured for halved levels of `four-bar`, `slider-crank`,
/// `flapping-wing` and `flapping-wing-experiment`, 3.2 in the geometric mean.
const HALVED_COST: f64 = 3.2;

/// A simulation at the working accuracy.
#[derive(Debug)]
struct PairedPoint {
    sample: Vec<f64>,
    observed: Observed,
    /// Results at the second and at the third level; the outer `None` where none was requested.
    finer: [Option<Observed>; 2],
    /// True for the second and the third level once it was requested.
    requested: [bool; 2],
}

impl PairedPoint {
    /// A sample with its outcome, if that is a result.
    fn new(sample: &[f64], outcome: &ObservedOutcome) -> Option<Self> {
        let (sample, observed) = (sample.to_vec(), outcome.as_ref().ok()?.clone());
        Some(Self { sample, observed, finer: [None, None], requested: [false; 2] })
    }
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
    /// What they are, and the number of the level before them.
    target: PairedModel,
    before: u8,
    /// Samples of the chunks of the campaign under way, the oldest first.
    under_way: VecDeque<Vec<Vec<f64>>>,
    simulated: Vec<PairedPoint>,
    /// Pairs under way.
    requested: Vec<PairRequest>,
    /// Number of evaluations at finer levels whose outcome has been recorded, and the causes of those that failed.
    evaluations: usize,
    failed: Vec<SimulationFailure>,
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
            target: PairedModel::of(scene),
            before: 0,
            under_way: VecDeque::new(),
            simulated: vec![],
            requested: vec![],
            evaluations: 0,
            failed: vec![],
            correction: None,
            has_ended: false,
        }
    }

    /// A campaign without budget that begins with results, complete ones, with pairs of a variant of the model as `level`.
    pub fn of_variant(
        scene: &'a Scene,
        campaign: Campaign,
        results: &[(Vec<f64>, ObservedOutcome)],
        level: u8,
    ) -> Self {
        let paired = Self::new(scene, campaign, 1);
        let simulated =
            results.iter().filter_map(|(sample, outcome)| PairedPoint::new(sample, outcome)).collect();
        Self { target: PairedModel::Variant, before: level - 1, simulated, ..paired }
    }

    /// What the pairs of a variant gave: the correction, and the numbers of evaluations and of those that failed.
    pub fn of_pairs(self) -> (Option<Correction>, [usize; 2]) {
        (self.correction, [self.evaluations, self.failed.len()])
    }

    /// Result of the campaign, the correction by the pairs, the number of their evaluations, and the causes of those that failed.
    pub fn finish(self) -> Option<(CampaignResult, Option<Correction>, usize, Vec<SimulationFailure>)> {
        Some((self.campaign.finish()?, self.correction, self.evaluations, self.failed))
    }

    /// The next chunk of pairs; none if there are enough.
    fn next_pairs(&self) -> Vec<PairRequest> {
        let requested = |level: usize| self.simulated.iter().filter(|one| one.requested[level]).count();
        let (paired, thirds) = (requested(0), requested(1));
        let at = |points: Vec<usize>, level: u8| points.into_iter().map(move |i| (i, level));
        if self.finer == 0 {
            return vec![];
        }
        if paired == 0 {
            let chosen = self.farthest_points(FIRST, 0);
            let third = chosen.iter().copied().take(if self.finer > 1 { THIRD } else { 0 }).collect();
            // The longest simulations first.
            return at(third, 2).chain(at(chosen, 1)).collect();
        }
        let scatter = self.current().and_then(|correction| self.scatter_to_reduce(&correction));
        let Some([of_pairs, of_thirds]) = scatter else { return vec![] };
        let level_cost = self.scene.simulator.as_ref().map_or(HALVED_COST, |simulator| simulator.level_cost);
        let gains = [of_pairs / paired as f64, of_thirds / (level_cost * thirds as f64)];
        let has_more = self.simulated.iter().any(|one| one.finer[0].is_some() && !one.requested[1]);
        let cost = |pairs: usize, thirds: usize| level_cost * (pairs as f64 + level_cost * thirds as f64);
        let is_wide = self.target != PairedModel::Variant && of_pairs + of_thirds > WIDE * WIDE;
        let most = if is_wide { MOST.max(level_cost.powi(self.finer as i32) - 1.0) } else { MOST };
        let is_within = |further: f64| cost(paired, thirds) + further <= most * self.simulated.len() as f64;
        // The chunk that gains more, if it is not too much, or the other one.
        let pairs = (of_pairs > 0.0 && is_within(cost(NEXT, 0))).then_some((gains[0], 1, NEXT));
        let further = thirds > 0 && has_more && is_within(cost(0, NEXT_THIRD));
        let further = further.then_some((gains[1], 2, NEXT_THIRD));
        let chosen = [further, pairs].into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0));
        chosen.map_or(vec![], |(_, level, count)| at(self.farthest_points(count, level - 1), level).collect())
    }

    /// Simulations with results at `level`, 0 for the working accuracy, that are requested at no finer one: the nominal one first, then those
    /// farthest from the others, weighted by their nearness to a limit.
    fn farthest_points(&self, count: usize, level: u8) -> Vec<usize> {
        let is_refined = |one: &PairedPoint| one.requested[usize::from(level)];
        let is_free = |one: &PairedPoint| !is_refined(one) && (level == 0 || one.finer[0].is_some());
        let free: Vec<usize> = (0..self.simulated.len()).filter(|i| is_free(&self.simulated[*i])).collect();
        let inputs = &self.campaign.problem.inputs;
        let z: Vec<Vec<f64>> = self.simulated.iter().map(|one| inputs.standardise(&one.sample)).collect();
        let (mut chosen, rest): (Vec<usize>, Vec<usize>) = free.into_iter().partition(|i| *i == 0);
        let points: Vec<&[f64]> = rest.iter().map(|i| z[*i].as_slice()).collect();
        let nearness = self.nearness();
        let weights: Vec<f64> = rest.iter().map(|i| nearness[*i]).collect();
        let refined = (0..z.len()).filter(|i| is_refined(&self.simulated[*i]) || chosen.contains(i));
        let found = farthest(&points, refined.map(|i| (z[i].as_slice(), 1.0)), &weights, count);
        chosen.extend(found.into_iter().map(|place| rest[place]));
        chosen.truncate(count);
        chosen
    }

    /// Weight of each simulation by the distance of its responses from the nearest limit, at the governing checkpoint [1].
    fn nearness(&self) -> Vec<f64> {
        let mut nearness = vec![0.0_f64; self.simulated.len()];
        let n = self.campaign.assessment.as_ref().map_or(0, |assessment| assessment.governing);
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
        fn pair(one: &PairedPoint) -> Option<LevelPair<'_>> {
            let [finer, finest] = &one.finer;
            Some((&one.sample, [&one.observed, finer.as_ref()?], finest.as_ref()))
        }
        let pairs: Vec<LevelPair<'_>> = self.simulated.iter().filter_map(pair).collect();
        Correction::new(&pairs, self.scene.outputs.len(), self.target)
    }

    /// Squares of the largest 95 % reaches [1] by which the scatter of the pairs, and of the points at the third level, moves any R(n); `None`
    /// if they need not be reduced.
    fn scatter_to_reduce(&self, correction: &Correction) -> Option<[f64; 2]> {
        let assessment = self.campaign.assessment.as_ref()?;
        let errors = assessment.combined_errors();
        let of_surrogates = REACH * errors.last()?.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        let points = self.campaign.classified.population.len();
        let modes = 0..assessment.modes.len();
        let deviations = |j| modes.clone().map(|s| deviation(s, j)).collect::<Vec<f64>>();
        let deviations: Vec<Vec<f64>> = (0..points).map(deviations).collect();
        // Half the share of the population whose failure depends on the sign of the reaches, at the worst checkpoint, for each of them.
        let mut moved = [0.0_f64; 3];
        for (n, checkpoint) in assessment.grid.iter().enumerate() {
            let reach = |limit: &LimitState| correction.reaches(limit.output, *checkpoint, limit.threshold);
            let reaches: Vec<(f64, [f64; 3])> = self.scene.limit_states.iter().map(reach).collect();
            let mut shifted = [0_u32; 3];
            for (j, deviations) in deviations.iter().enumerate() {
                // Largest distances beyond a limit with all responses shifted by the reaches to the safe and to the unsafe side.
                let mut beyond = [[f64::NEG_INFINITY; 2]; 3];
                for (s, mode) in assessment.modes.iter().enumerate() {
                    let std = mode.sigma[n] * mode.variance_factor[j].max(0.0).sqrt();
                    let ((correction, reaches), scale) = (reaches[s], assessment.surrogates[s].scale);
                    let value = scale.value(mode.means_of(j)[n] + std * deviations[s]);
                    let distance = value + correction - scale.value(mode.threshold);
                    for (beyond, reach) in beyond.iter_mut().zip(reaches) {
                        *beyond = [beyond[0].max(distance - reach), beyond[1].max(distance + reach)];
                    }
                }
                for (shifted, [safely, unsafely]) in shifted.iter_mut().zip(beyond) {
                    *shifted += u32::from(safely < 0.0 && unsafely >= 0.0);
                }
            }
            for (moved, shifted) in moved.iter_mut().zip(shifted) {
                *moved = moved.max(0.5 * f64::from(shifted) / points as f64);
            }
        }
        let [of_pairs, of_thirds, of_all] = moved;
        let numerical = of_pairs.hypot(of_thirds);
        let whole = of_all.hypot(of_surrogates).hypot(REACH * (0.25 / points as f64).sqrt());
        let target = self.campaign.plan.settings.target_error.unwrap_or(HALF_WIDTH);
        let is_enough = numerical <= of_surrogates || whole <= target;
        (!is_enough).then_some([of_pairs, of_thirds].map(|reach| reach * reach))
    }

    /// Corrects the results of the campaign. Learning goes on with corrected results if these no longer meet the targets.
    fn correct(&mut self) -> Result<(), CampaignError> {
        self.correction = self.current();
        let Some(correction) = self.correction.as_ref().filter(|_| self.target != PairedModel::Variant)
        else {
            return Ok(());
        };
        let (campaign, responses) = (&mut self.campaign, &self.responses);
        let Campaign { problem, data, .. } = &mut *campaign;
        let corrected = |z: &[f64], one| correction.correct(&problem.inputs.to_physical(z), one);
        data.observations.change(|z, one| responses.complete(corrected(z, one)));
        campaign.surrogates.reset_population();
        campaign.surrogates.require_fit();
        campaign.stopping.reset(false);
        let (assessment, _) = campaign.assess_until_fresh()?;
        // The correction itself moves the curves; no round does.
        let met = campaign.plan.targets.met(&Figures { change: Some(0.0), ..assessment.figures });
        campaign.add_round(&assessment);
        campaign.assessment = Some(assessment);
        if met.is_none() && matches!(campaign.stop, Some(StopReason::Rule(_))) {
            campaign.stop = None;
            return Ok(());
        }
        self.campaign.redraw_at_the_end()
    }

    fn record_pairs(&mut self, outcomes: Vec<ObservedOutcome>) {
        for ((i, level), outcome) in std::mem::take(&mut self.requested).into_iter().zip(outcomes) {
            self.evaluations += 1;
            match outcome {
                Ok(observed) => self.simulated[i].finer[usize::from(level) - 1] = Some(observed),
                Err(cause) => self.failed.push(cause),
            }
        }
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
                    level: self.before + *level,
                    ..SampleRequest::new(self.simulated[*i].sample.clone())
                };
                let requests = self.requested.iter().map(request).collect();
                for (i, level) in &self.requested {
                    self.simulated[*i].requested[usize::from(*level) - 1] = true;
                }
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
        // An outlier that is evaluated again keeps its place, see below.
        let known: Vec<bool> =
            samples.iter().map(|sample| self.simulated.iter().any(|one| one.sample == *sample)).collect();
        let repeated = known.contains(&true);
        let new = samples.iter().zip(&outcomes).zip(known);
        let results = new.filter(|(_, known)| !*known).map(|(result, _)| result);
        self.simulated.extend(results.filter_map(|(sample, outcome)| PairedPoint::new(sample, outcome)));
        let Self { correction, responses, .. } = &*self;
        let corrected = |sample: &[f64], observed: Observed| match correction {
            Some(correction) => responses.complete(correction.correct(sample, observed)),
            None => observed,
        };
        let new = samples.iter().zip(outcomes);
        let outcomes = new.map(|(sample, outcome)| outcome.map(|one| corrected(sample, one))).collect();
        self.campaign.record(outcomes)?;
        if repeated && self.correction.is_none() {
            let Campaign { problem, data, .. } = &self.campaign;
            for one in &mut self.simulated {
                if let Some(used) = data.observations.result_at(&problem.inputs.standardise(&one.sample)) {
                    one.observed = used.clone();
                }
            }
        }
        Ok(())
    }

    fn rounds(&self) -> &[Round] {
        &self.campaign.rounds
    }

    fn purpose(&self) -> String {
        match self.campaign.rounds.len() {
            _ if !self.requested.is_empty() => "finer levels".to_owned(),
            0 if self.campaign.evaluations() == 0 => "nominal point".to_owned(),
            0 => "initial design".to_owned(),
            round => format!("round {round}"),
        }
    }

    fn interim(&self) -> Option<InterimResult> {
        self.campaign.interim()
    }

    fn constant_limit_states(&self) -> Vec<usize> {
        let Campaign { problem, data, .. } = &self.campaign;
        let constant = |mode: &usize| data.observations.is_constant(problem.modes[*mode].output);
        (0..problem.modes.len()).filter(constant).collect()
    }
}
