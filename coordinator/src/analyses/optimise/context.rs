//! The parts of an optimisation that are the same in every round: the places of its targets in the campaigns, and when designs are near
//! each other and accurate.

use super::campaign::{StudyBasis, TargetCampaign};
use super::problem::{DesignProblem, ReliabilityTarget};
use super::reliability::{Constraint, DesignReliability};
use super::solve::Solved;
use super::trust;
use crate::analyses::error::AnalysisError;
use crate::statistics::design::InputModel;
use crate::study::{CampaignResult, Surrogate};
use common::random::standard_normal_quantile;

/// Designs are next to each other if no mean differs by more than this [standard deviations] ...
const NEAR_MEAN: f64 = 0.3;
/// ... and no logarithm of a standard deviation by more than this [1].
const NEAR_SPREAD: f64 = 0.15;
/// Difference of two reliabilities in their standard errors up to which they agree [1].
const AGREE: f64 = 3.0;
/// Reserve of a constraint, least and most, beyond what the errors cost: more than what a search leaves unmet, little against the cost [1].
const RESERVE: (f64, f64) = (2e-4, 4e-3);

/// Reliability index of a failure probability, finite for any [1].
pub(super) fn index_of(pf: f64) -> f64 {
    -standard_normal_quantile(pf.clamp(1e-14, 1.0 - 1e-12))
}

/// A problem with the inputs of its study, and its targets as curves and columns of the campaigns and as constraints.
pub(super) struct Context<'a> {
    pub problem: &'a DesignProblem,
    /// Inputs of the study, in the coordinates of all campaigns.
    pub reference: InputModel,
    seed: u64,
    pub constraints: Vec<Constraint>,
}

impl<'a> Context<'a> {
    /// The context of a problem in the campaigns of a study.
    pub fn new(study: &'a StudyBasis, problem: &'a DesignProblem, campaign: &TargetCampaign<'_>) -> Self {
        let all = campaign.modes.len();
        let constraint = |target: &ReliabilityTarget| {
            let (curve, column) = campaign.place(target.limit_state, target.checkpoint);
            let modes = if curve == all { (0..all).collect() } else { vec![curve] };
            Constraint { modes, curve, column, beta: index_of(1.0 - target.reliability) }
        };
        let constraints = problem.targets.iter().map(constraint).collect();
        let reference = trust::with_scales(problem, &study.problem.inputs);
        Self { problem, reference, seed: study.settings.seed, constraints }
    }

    /// Reliability over designs with the surrogates of a campaign at the design y, its lines placed for it.
    pub fn reliability<'r>(&'r self, learned: &'r CampaignResult, y: &[f64]) -> DesignReliability<'r> {
        let modes = learned.assessment.modes.iter().zip(&learned.assessment.surrogates);
        let surrogates = modes.map(|(mode, Surrogate { model, .. })| (model, mode.threshold, model.dual()));
        let (surrogates, constraints) = (surrogates.collect(), self.constraints.clone());
        DesignReliability::new(self.problem, &self.reference, surrogates, constraints, self.seed, y)
    }

    /// Inputs of the design with these values of the quantities [SI].
    ///
    /// # Errors
    /// The design has a distribution that does not exist.
    pub fn inputs(&self, values: &[f64]) -> Result<InputModel, AnalysisError> {
        Ok(self.problem.inputs(&self.reference, values)?)
    }

    /// The design found, with its reliabilities by the surrogates of a campaign there.
    pub fn assessed(&self, solved: &Solved, learned: &CampaignResult) -> Solved {
        let values = self.reliability(learned, &solved.y).targets(&solved.y).unwrap_or_default();
        Solved { values, ..solved.clone() }
    }

    /// Lower bound of every target's R at a campaign's design, with its confidence `(targets,)` [1]; `None` without one.
    pub fn bounds(
        &self,
        solved: &Solved,
        learned: &CampaignResult,
        campaign: &TargetCampaign<'_>,
    ) -> Vec<Option<f64>> {
        let targets = &self.problem.targets;
        let is_asked = targets.iter().any(|target| target.confidence.is_some());
        let numerical = if is_asked { campaign.numerical_errors(learned) } else { vec![] };
        let bound = |i: usize| {
            let (Constraint { curve, column, .. }, found) =
                (&self.constraints[i], &solved.values[i].estimate);
            let reach = standard_normal_quantile(targets[i].confidence?);
            let surrogate = TargetCampaign::surrogate_error(learned, *curve, *column);
            let error = surrogate.hypot(found.standard_error).hypot(numerical[*curve][*column]);
            Some((1.0 - found.probability - reach * error).max(0.0))
        };
        (0..targets.len().min(solved.values.len())).map(bound).collect()
    }

    /// Raises the constraint of every target with a confidence by what the errors at a campaign's design cost there, the index of the
    /// estimate less that of its lower bound. True if no constraint had to move.
    pub fn reserve(&mut self, solved: &Solved, bounds: &[Option<f64>]) -> bool {
        let mut settled = true;
        for (i, bound) in bounds.iter().enumerate() {
            let Some(bound) = bound else { continue };
            let wanted = index_of(1.0 - self.problem.targets[i].reliability);
            let promised = index_of(1.0 - bound);
            let needed = wanted + solved.values[i].beta - promised;
            let constraint = &mut self.constraints[i].beta;
            let over = *constraint - needed;
            let holds = promised >= wanted;
            if !(holds && (over <= RESERVE.1 || self.problem.is_discrete())) {
                settled &= (RESERVE.0..=RESERVE.1).contains(&over);
                *constraint = needed + 0.5 * RESERVE.1;
            }
        }
        settled
    }

    /// True if two designs are next to each other.
    pub fn are_near(&self, a: &InputModel, b: &InputModel) -> bool {
        (0..a.dimension()).all(|k| {
            let [own, other] = [a, b].map(|inputs| &inputs.variables()[k]);
            if own.is_constant() || trust::spread_by(self.problem, b, k).is_some() {
                // A design variable, in standard deviations of its range; or a mean, in the scale of visits.
                let [own, other] =
                    [a, b].map(|inputs| inputs.standardised_value(k, inputs.variables()[k].parent_mean()));
                return (own - other).abs() <= NEAR_MEAN;
            }
            let shift = (own.parent_mean() - other.parent_mean()).abs() / other.parent_std();
            shift <= NEAR_MEAN && (own.parent_std() / other.parent_std()).ln().abs() <= NEAR_SPREAD
        })
    }

    /// True if at a campaign's design every surrogate error is small and line sampling agrees with counting.
    pub fn is_accurate(&self, solved: &Solved, learned: &CampaignResult) -> bool {
        let counted = learned.reliability();
        let mut targets = solved.values.iter().zip(&self.constraints).zip(&self.problem.targets);
        targets.all(|((value, Constraint { curve, column, .. }), target)| {
            let error = TargetCampaign::surrogate_error(learned, *curve, *column);
            let p = value.estimate.probability;
            let point = counted[*curve][*column];
            let both = point.standard_error.hypot(value.estimate.standard_error);
            let is_accurate = TargetCampaign::is_accurate(error, p.max(1.0 - target.reliability));
            is_accurate && (1.0 - point.reliability - p).abs() <= AGREE * both
        })
    }
}
