//! Campaigns at designs: what the targets need of a study, and its surrogates improved by simulations at a design.
//!
//! Only the limit states and the checkpoints of the targets are learned: a response over the life becomes its largest value
//! up to each of these checkpoints, so that simulations serve the targets alone.

use super::Simulate;
use super::problem::DesignProblem;
use crate::analyses::error::AnalysisError;
use crate::statistics::design::InputModel;
use crate::statistics::learning::{Mode, SURROGATE_SAFETY, StoppingTargets};
use crate::study::{
    Campaign, CampaignResult, LARGEST_POPULATION, Observed, ObservedOutcome, Plan, Problem, SampleRequest,
    Settings,
};
use std::collections::BTreeSet;

/// Surrogate error of the failure probability allowed by a target, over that probability [1]: an error of the reliability
/// index of 0.01 at 0.9987.
const RELATIVE_ERROR: f64 = 0.03;
/// Coefficient of variation of the failure probability of a target over the population [1].
const COV: f64 = 0.1;

/// Most points of a population, unless the study has more.
const MOST_SAMPLES: f64 = 400_000.0;

/// A finished study as an optimisation begins with it.
#[derive(Debug, Clone)]
pub struct StudyBasis {
    /// The reliability problem of the study.
    pub problem: Problem,
    /// Settings of the study.
    pub settings: Settings,
    /// All outcomes of its simulations, `(sample, outcome)`, complete in the sense of
    /// [`complete_outcomes`](crate::study::complete_outcomes).
    pub outcomes: Vec<(Vec<f64>, ObservedOutcome)>,
}

/// The part of a study that the targets need, with all simulations so far.
pub(super) struct TargetCampaign<'a> {
    study: &'a StudyBasis,
    /// Indices of the limit states, and of the checkpoints, that targets name, ascending.
    pub modes: Vec<usize>,
    pub checkpoints: Vec<usize>,
    /// Outcomes reduced to these.
    outcomes: Vec<(Vec<f64>, ObservedOutcome)>,
}

impl<'a> TargetCampaign<'a> {
    /// The part of `study` that the targets of `problem` need.
    pub fn new(study: &'a StudyBasis, problem: &DesignProblem) -> Self {
        let targets = problem.targets.iter();
        let named = |mode: &usize| {
            targets.clone().any(|target| target.limit_state.is_none_or(|named| named == *mode))
        };
        let modes: Vec<usize> = (0..study.problem.modes.len()).filter(named).collect();
        let checkpoints: BTreeSet<usize> = targets.clone().map(|target| target.checkpoint).collect();
        let checkpoints = checkpoints.into_iter().collect();
        let mut made = Self { study, modes, checkpoints, outcomes: vec![] };
        let reduced = |(sample, outcome): &(Vec<f64>, ObservedOutcome)| {
            (sample.clone(), outcome.clone().map(|observed| made.reduced(&observed)))
        };
        made.outcomes = study.outcomes.iter().map(reduced).collect();
        made
    }

    /// Number of simulations so far, failed ones included.
    pub fn simulations(&self) -> usize {
        self.outcomes.len()
    }

    /// The responses of the limit states up to the checkpoints.
    fn reduced(&self, observed: &Observed) -> Observed {
        let of_mode = |mode: &usize| -> (Vec<f64>, Vec<f64>) {
            let output = self.study.problem.modes[*mode].output;
            self.checkpoints.iter().map(|last| largest_until(observed, output, *last)).unzip()
        };
        let (histories, errors): (Vec<Vec<f64>>, Vec<Vec<f64>>) = self.modes.iter().map(of_mode).unzip();
        Observed { errors, ..Observed::exact(histories) }
    }

    /// The problem of the targets for these inputs.
    fn problem(&self, inputs: &InputModel) -> Problem {
        let of_study = &self.study.problem;
        let mode = |(output, mode): (usize, &usize)| Mode { output, ..of_study.modes[*mode] };
        Problem {
            inputs: inputs.clone(),
            outputs: self.modes.len(),
            modes: self.modes.iter().enumerate().map(mode).collect(),
            checkpoints: self.checkpoints.iter().map(|n| of_study.checkpoints[*n]).collect(),
        }
    }

    /// Standard errors of P_f by the stated numerical errors of the simulations `(curves)(columns,)` [1].
    pub fn numerical_errors(&self, learned: &CampaignResult) -> Vec<Vec<f64>> {
        learned.numerical_errors(&self.problem(&learned.classified.population.inputs))
    }

    /// Learns at the design with these inputs, with at most `count` further simulations; `pf` is the least failure
    /// probability that matters.
    pub fn learn(
        &mut self,
        inputs: &InputModel,
        count: usize,
        pf: f64,
        simulate: &mut Simulate<'_>,
    ) -> Result<CampaignResult, AnalysisError> {
        let study = self.study;
        let problem = self.problem(inputs);
        let default = StoppingTargets::default();
        let wanted = 1.1 / (pf * COV.powi(2));
        // Rarer failures are counted over conditional populations and judged by their relative error alone.
        let resolved = wanted <= LARGEST_POPULATION as f64;
        let of_study = study.settings.samples;
        let (samples, error, cov) = if resolved {
            let error = (RELATIVE_ERROR * pf).min(default.error);
            (of_study.max(wanted.min(MOST_SAMPLES).ceil() as usize), error, f64::INFINITY)
        } else {
            (of_study, default.error, COV)
        };
        let (max_evaluations, larger_populations) = (self.outcomes.len() + count, vec![]);
        let settings = Settings { samples, max_evaluations, larger_populations, ..study.settings.clone() };
        let plan = Plan {
            targets: StoppingTargets { error, relative_error: RELATIVE_ERROR, cov, ..default },
            largest_population: if resolved { samples } else { LARGEST_POPULATION },
            retry: false,
            is_exact: false,
            settings,
        };
        let mut campaign = Campaign::with_results(problem, plan, self.outcomes.iter().cloned());
        let simulated = |requests: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, AnalysisError> {
            let outcomes = simulate(requests)?.into_iter();
            let reduced: Vec<ObservedOutcome> =
                outcomes.map(|outcome| outcome.map(|observed| self.reduced(&observed))).collect();
            let pairs = requests.iter().zip(&reduced);
            self.outcomes.extend(pairs.map(|(request, outcome)| (request.sample.clone(), outcome.clone())));
            Ok(reduced)
        };
        campaign.run(simulated, |_| {})?;
        Ok(campaign.finish().expect("a campaign that is done has a result"))
    }

    /// Place of a target's curve among the curves of the campaign, and of its checkpoint among its columns.
    pub fn place(&self, limit_state: Option<usize>, checkpoint: usize) -> (usize, usize) {
        let curve = limit_state.map_or(self.modes.len(), |named| {
            self.modes.iter().position(|mode| *mode == named).expect("modes of all targets are learned")
        });
        let column = self.checkpoints.iter().position(|n| *n == checkpoint);
        (curve, column.expect("checkpoints of all targets are learned"))
    }

    /// Surrogate error of P_f of a curve at a column [1], as a study states it, numerical noise included.
    pub fn surrogate_error(learned: &CampaignResult, curve: usize, column: usize) -> f64 {
        let assessment = &learned.assessment;
        let Some(at) = assessment.grid.iter().position(|n| *n == column) else { return 0.0 };
        let error = SURROGATE_SAFETY * assessment.errors[curve][at];
        learned.classified.condition.probability * error.hypot(assessment.noise_shift[curve][at])
    }

    /// True if the surrogate error of a target with the failure probability `pf` is small enough.
    pub fn is_accurate(error: f64, pf: f64) -> bool {
        error <= SURROGATE_SAFETY * RELATIVE_ERROR * pf
    }
}

/// Largest value of an output from the start of life to checkpoint `last`, and its stated error [unit of the output]; the start has that
/// of the first checkpoint.
fn largest_until(observed: &Observed, output: usize, last: usize) -> (f64, f64) {
    let (history, errors) = (&observed.histories[output], &observed.errors[output]);
    let at_start = observed.start[output].map(|value| (value, errors[0]));
    let later = history.iter().copied().zip(errors.iter().copied()).take(last + 1);
    let all = at_start.into_iter().chain(later);
    all.reduce(|best, next| if next.0 > best.0 { next } else { best }).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_at_the_start_of_life_counts_at_every_checkpoint() {
        let mut observed = Observed::exact(vec![vec![1.0, 3.0, 2.0]]);
        observed.errors = vec![vec![0.1, 0.2, 0.3]];
        let largest = |observed: &Observed| [0, 1, 2].map(|last| largest_until(observed, 0, last));
        assert_eq!(largest(&observed), [(1.0, 0.1), (3.0, 0.2), (3.0, 0.2)]);
        observed.start = vec![Some(2.5)];
        assert_eq!(largest(&observed), [(2.5, 0.1), (3.0, 0.2), (3.0, 0.2)]);
    }
}
