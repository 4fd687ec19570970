//! A campaign that begins with results that exist: those of a finished study, assessed on a population that may be
//! distributed otherwise than the one they were chosen from.
//!
//! The surrogates describe the response, not the distribution of its inputs, so they hold for any distribution; where the
//! population leaves the region of the results, the predicted variances grow, and with them the stated errors. The points
//! keep the coordinates of the study ([`InputModel::standardised_as`]), so that the bounds of the correlation lengths are
//! those of its surrogates.
//!
//! A variant of the model is a finished study with the same variables, outputs and limits and another choice of the model, e.g. its
//! contact law. Some of the samples of the study are simulated once more by the variant, chosen like those of the pairs of finer levels;
//! the differences, a constant or a line over the value, shift all results, from which the variant is learned like the study itself. The
//! correction of the study to finer levels is that of the variant, too. Spread and error of the differences are in its intervals.
//!
//! Samples that no campaign of a study has requested are looked up in the journal first, and recorded there.
//!
//! [`InputModel::standardised_as`]: crate::statistics::design::InputModel::standardised_as

use super::dispatching::Dispatcher;
use super::learner::Learner;
use super::outliers::decided;
use super::pairs::PairedCampaign;
use super::plan::{Plan, Problem, ResponseLayout};
use super::requests::bits;
use super::result::curves_from_learning;
use super::{
    Campaign, CampaignError, CampaignResult, Correction, Method, ObservedOutcome, SampleRequest, Settings,
    Step, StoredOutcome, StudyError, StudyResult, Surrogate,
};
use crate::farm::evaluate::Evaluator;
use crate::results::journal::Journal;
use crate::results::progress::{Observer, Silent};
use crate::results::summary::Timing;
use crate::statistics::learning::{StoppingTargets, is_settled};
use crate::statistics::surrogate::Effort;
use common::scene::Scene;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::time::Instant;

impl Problem {
    /// The problem of `changed`, a scene that differs from `studied` in distributions, correlations and thresholds only, in
    /// the coordinates of the studied scene.
    pub fn of_changed_scene(changed: &Scene, studied: &Scene) -> Self {
        let problem = Self::from_scene(changed);
        let inputs = problem.inputs.standardised_as(&Self::from_scene(studied).inputs);
        Self { inputs, ..problem }
    }
}

impl Campaign {
    /// A campaign that begins with all these `outcomes` `(sample, outcome)`, in the order of their requests; they count
    /// as its initial design. Without further budget ([`Settings::max_evaluations`] at most their number) it requests no
    /// simulation: [`Campaign::next_step`] assesses them on the population of `problem` and is done. Otherwise learning
    /// goes on from them.
    ///
    /// A sample that failed and gave a result when repeated counts as a result. Outcomes have one history per output of
    /// the problem, see [`complete_outcomes`].
    pub fn with_results(
        problem: Problem,
        plan: Plan,
        outcomes: impl IntoIterator<Item = (Vec<f64>, ObservedOutcome)>,
    ) -> Self {
        let mut campaign = Self::new(problem, plan);
        let outcomes: Vec<(Vec<f64>, ObservedOutcome)> = outcomes.into_iter().collect();
        // The evaluations of each sample with a result, from that on: outliers have several.
        let mut results: HashMap<Vec<u64>, Vec<ObservedOutcome>> = HashMap::new();
        for (sample, outcome) in &outcomes {
            match results.entry(bits(sample)) {
                Entry::Vacant(_) if outcome.is_err() => {}
                entry => entry.or_default().push(outcome.clone()),
            }
        }
        let mut known: HashSet<Vec<u64>> = results.keys().cloned().collect();
        let mut points = Vec::with_capacity(outcomes.len());
        for (number, (sample, outcome)) in outcomes.into_iter().enumerate() {
            let z = campaign.problem.inputs.standardise(&sample);
            let all = if outcome.is_ok() { results.remove(&bits(&sample)) } else { None };
            let decides = all.is_some();
            match all.map_or(outcome, |all| decided(&all, campaign.plan.is_exact)) {
                Ok(observed) if decides => campaign.data.observations.add(&z, observed),
                // Neither a repetition that failed again, nor one that succeeded.
                Err(cause) if decides || known.insert(bits(&sample)) => {
                    let learning = number >= campaign.plan.settings.initial;
                    campaign.data.add_failed(z.clone(), cause, learning, false);
                }
                _ => {}
            }
            points.push(z);
        }
        campaign.data.observations.close_design();
        campaign.requests.begin_with_results(&points);
        campaign.requests.mark_known(&campaign.classified.population);
        campaign
    }

    /// Takes these surrogates, e.g. those of another population, instead of fitting new ones from several starts, if they are
    /// of the same results in the same coordinates. Those `of_others`, of other thresholds than the present ones, have their lengths
    /// fitted again from those they have.
    #[must_use]
    pub fn with_surrogates(mut self, surrogates: &[Surrogate], of_others: bool) -> Self {
        let n = self.data.observations.len();
        let points = self.data.observations.points();
        if surrogates.iter().all(|surrogate| surrogate.model.is_at(points.as_ref())) {
            self.surrogates.models = surrogates.to_vec();
            self.surrogates.record_fit(Effort::MultiStart, n);
            if of_others {
                self.surrogates.require_fit();
            }
        }
        self
    }

    /// Assesses the results once more if the budget ends learning after its first round and curves of the population are
    /// between 0 and 1 at checkpoints outside of those of the round, where no error is estimated: the round took the
    /// checkpoints from the results, and the population may fail earlier or later.
    pub(super) fn assess_missing_checkpoints(&mut self) -> Result<(), CampaignError> {
        let Some(assessment) = self.assessment.as_ref().filter(|_| self.rounds.len() == 1) else {
            return Ok(());
        };
        let (first, last) = (assessment.grid[0], assessment.grid[assessment.grid.len() - 1]);
        let is_missing = |(n, share): (usize, &f64)| !is_settled(*share) && !(first..=last).contains(&n);
        if !assessment.curves.iter().any(|curve| curve.iter().enumerate().any(is_missing)) {
            return Ok(());
        }
        self.surrogates.require_fit();
        let (assessment, _) = self.assess_until_fresh()?;
        self.add_round(&assessment);
        self.assessment = Some(assessment);
        Ok(())
    }
}

/// Stored outcomes of a scene in the form that a campaign receives: `(sample, outcome)`, where the outcome has also the
/// negatives of outputs that fail below a threshold.
pub fn complete_outcomes(scene: &Scene, stored: &[StoredOutcome]) -> Vec<(Vec<f64>, ObservedOutcome)> {
    let responses = ResponseLayout::from_scene(scene);
    let complete = |stored: &StoredOutcome| {
        (stored.sample.clone(), stored.outcome.clone().map(|observed| responses.complete(observed)))
    };
    stored.iter().map(complete).collect()
}

/// The campaign of a changed scene that begins with the results of a study of `studied`, with a budget of
/// `further` simulations beyond them.
///
/// `settings` are those of the study; `samples` is the size of the population, which stays as it is, or becomes conditional
/// ([`Settings::is_rare`]).
pub fn campaign_from_results(
    changed: &Scene,
    studied: &Scene,
    settings: &Settings,
    stored: &[StoredOutcome],
    further: usize,
) -> Campaign {
    let settings = Settings {
        method: Method::ActiveLearning,
        max_evaluations: stored.len() + further,
        larger_populations: vec![],
        ..settings.clone()
    };
    let present = settings.targets();
    let cov = if settings.is_rare { present.cov } else { f64::INFINITY };
    let targets = StoppingTargets { cov, ..present };
    let plan = Plan { targets, largest_population: settings.samples, ..Plan::new(&settings, changed) };
    let problem = Problem::of_changed_scene(changed, studied);
    Campaign::with_results(problem, plan, complete_outcomes(changed, stored))
}

/// Learns the changed scene from the results of a study of `studied`, without any simulation, see
/// [`campaign_from_results`].
///
/// # Errors
/// [`StudyError`].
pub fn learn_from_results(
    changed: &Scene,
    studied: &Scene,
    settings: &Settings,
    stored: &[StoredOutcome],
) -> Result<CampaignResult, StudyError> {
    learn_with_surrogates(changed, studied, settings, stored, None)
}

/// Does the same with the surrogates of another campaign of these results and the scene for whose limits that fitted them, see
/// [`Campaign::with_surrogates`]; fits them if there are none.
///
/// # Errors
/// [`StudyError`].
pub fn learn_with_surrogates(
    changed: &Scene,
    studied: &Scene,
    settings: &Settings,
    stored: &[StoredOutcome],
    fitted: Option<(&Scene, &[Surrogate])>,
) -> Result<CampaignResult, StudyError> {
    let mut campaign = campaign_from_results(changed, studied, settings, stored, 0);
    if let Some((scene, surrogates)) = fitted.filter(|(_, all)| all.len() == changed.limit_states.len()) {
        campaign = campaign.with_surrogates(surrogates, changed.limit_states != scene.limit_states);
    }
    let learned = campaign.learn_from(|_| unreachable!("a campaign without budget requests nothing"), |_| {});
    learned.map_err(|error| StudyError::from_campaign(error, changed))
}

/// The result of a campaign that began with results at the time `started`, without sensitivities, Sobol indices and
/// distributions of the outputs.
pub fn result_of(
    scene: &Scene,
    settings: &Settings,
    learned: &CampaignResult,
    started: Instant,
) -> StudyResult {
    let findings = curves_from_learning(scene, settings, learned);
    findings.result(scene, Timing { total: started.elapsed().as_secs_f64(), ..Timing::default() }, vec![])
}

/// A question about a finished study that may ask for further simulations.
#[derive(Debug, Clone, Copy)]
pub struct FurtherLearning<'a> {
    /// The changed scene.
    pub changed: &'a Scene,
    /// The scene of the study.
    pub studied: &'a Scene,
    /// Settings of the study; `samples` is the size of the population.
    pub settings: &'a Settings,
    /// Outcomes of all simulations so far.
    pub stored: &'a [StoredOutcome],
    /// Most simulations to add.
    pub further: usize,
    /// Correction of their results, as that of the stored ones.
    pub correction: Option<&'a Correction>,
}

impl FurtherLearning<'_> {
    /// Goes on learning with simulations by `evaluator`, which are recorded in `journal`: at most as many as allowed, fewer
    /// if a stopping rule is met before.
    ///
    /// # Errors
    /// [`StudyError`]; finished simulations are in the journal by then.
    pub fn learn(
        &self,
        evaluator: &mut dyn Evaluator,
        journal: &mut dyn Journal,
        observer: &mut dyn Observer,
    ) -> Result<CampaignResult, StudyError> {
        let Self { changed, studied, settings, stored, further, correction } = *self;
        let campaign = campaign_from_results(changed, studied, settings, stored, further);
        let mut campaign = PairedCampaign::new(changed, campaign, 0);
        let stricter = Settings { method: Method::ActiveLearning, ..settings.clone() }.stricter(changed);
        Dispatcher::new(changed, stricter, stored.len() + further, journal, observer)
            .going_on(stored.len() as u64, correction)
            .run(evaluator, &mut campaign)?;
        let (learned, ..) = campaign.finish().expect("a campaign that is done has a result");
        Ok(learned)
    }
}

/// Level of the first variant: those before it are levels of accuracy.
pub const FIRST_VARIANT: u8 = 16;

/// A finished study, as far as its variants need it.
#[derive(Debug, Clone, Copy)]
pub struct StudyOfVariants<'a> {
    /// Scene of the study.
    pub scene: &'a Scene,
    /// Settings of the study; `samples` is the size of the population.
    pub settings: &'a Settings,
    /// Outcomes of all simulations, corrected where a correction is known.
    pub stored: &'a [StoredOutcome],
    /// The correction to finer levels.
    pub correction: Option<&'a Correction>,
}

/// A variant learned from pairs: its result, `None` if too few pairs gave one; simulations of the variant, and those without a result.
pub type LearnedVariant = (Option<CampaignResult>, [usize; 2]);

impl StudyOfVariants<'_> {
    /// The study itself from its results, in the same way as its variants.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn base(&self) -> Result<CampaignResult, StudyError> {
        learn_from_results(self.scene, self.scene, self.settings, self.stored)
    }

    /// Learns a variant, whose simulations are made by `evaluator` and recorded in `journal` under this level.
    ///
    /// # Errors
    /// [`StudyError`]; finished simulations are in the journal by then.
    pub fn learn(
        &self,
        variant: &Scene,
        level: u8,
        evaluator: &mut dyn Evaluator,
        journal: &mut dyn Journal,
    ) -> Result<LearnedVariant, StudyError> {
        let Self { scene, settings, stored, correction } = *self;
        let campaign = campaign_from_results(scene, scene, settings, stored, 0);
        let mut paired =
            PairedCampaign::of_variant(scene, campaign, &complete_outcomes(scene, stored), level);
        Dispatcher::new(variant, None, stored.len(), journal, &mut Silent)
            .going_on(stored.len() as u64, correction)
            .run(evaluator, &mut paired)?;
        let (shift, evaluations) = paired.of_pairs();
        let shifted = shift.map(|shift| shift.correct_all(stored.to_vec()));
        let learned = shifted.map(|shifted| learn_from_results(scene, scene, settings, &shifted));
        Ok((learned.transpose()?, evaluations))
    }
}

/// A learner whose samples are given.
struct GivenSamples<'a> {
    /// The samples, until they are requested.
    samples: Option<&'a [SampleRequest]>,
    /// Their outcomes, once they are known.
    outcomes: Option<Vec<ObservedOutcome>>,
}

impl Learner for GivenSamples<'_> {
    fn next_step(&mut self) -> Result<Step, CampaignError> {
        let waits = if self.outcomes.is_some() { Step::Done } else { Step::Wait };
        Ok(self.samples.take().map_or(waits, |samples| Step::Evaluate(samples.to_vec())))
    }

    fn record(&mut self, outcomes: Vec<ObservedOutcome>) -> Result<(), CampaignError> {
        self.outcomes = Some(outcomes);
        Ok(())
    }

    fn purpose(&self) -> String {
        "given samples".to_owned()
    }
}

/// Outcomes of the requests in their order, complete in the sense of [`complete_outcomes`]. Requests are numbered
/// from `first` on; what the journal holds is not simulated again. Results are corrected where a `correction` is known.
///
/// # Errors
/// [`StudyError`]; finished simulations are in the journal by then.
pub fn simulate_samples(
    scene: &Scene,
    settings: &Settings,
    requests: &[SampleRequest],
    (first, correction): (u64, Option<&Correction>),
    evaluator: &mut dyn Evaluator,
    journal: &mut dyn Journal,
) -> Result<Vec<ObservedOutcome>, StudyError> {
    let mut given = GivenSamples { samples: Some(requests), outcomes: None };
    Dispatcher::new(scene, settings.stricter(scene), requests.len(), journal, &mut Silent)
        .going_on(first, correction)
        .run(evaluator, &mut given)?;
    Ok(given.outcomes.unwrap_or_default())
}
