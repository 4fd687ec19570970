//! The result of an active-learning campaign.

use super::campaign::Campaign;
use super::classified_population::ClassifiedPopulation;
use super::failures::Failed;
use super::interim::InterimResult;
use super::observations::Observations;
use super::round::Assessment;
use super::step::StopReason;
use super::untested::Untested;
use crate::results::summary::Round;
use crate::statistics::reliability::CurvePoint;

/// Result of an active-learning campaign.
#[derive(Debug)]
pub struct CampaignResult {
    /// The population classified in the last round, with the event it is conditional on.
    pub classified: ClassifiedPopulation,
    /// Results of all successful simulations that the surrogates use.
    pub observations: Observations,
    /// Surrogates and classification of the last round.
    pub assessment: Assessment,
    /// All rounds, in order.
    pub rounds: Vec<Round>,
    /// Number of evaluations, failed ones included.
    pub evaluations: usize,
    /// Simulations that failed for good.
    pub failed: Vec<Failed>,
    /// Reason for the end of learning.
    pub stop: StopReason,
    /// Curves whose failures no simulation has tested.
    pub(super) untested: Untested,
}

impl CampaignResult {
    /// R(n) with its standard error, as a study states it, per curve `(limit states + 1)(m,)`, the system last.
    pub fn reliability(&self) -> Vec<Vec<CurvePoint>> {
        self.shares().curves()
    }

    /// Share of the population that cannot be simulated, as far as the failed simulations tell [1].
    pub(super) fn barred_share(&self) -> f64 {
        self.assessment.feasibility.barred_share(self.classified.unconditional())
    }

    /// Failure shares with their errors.
    pub(super) fn shares(&self) -> InterimResult {
        InterimResult {
            failed: self.assessment.curves.clone(),
            points: self.classified.population.len(),
            missing: self.barred_share(),
            surrogate: self.assessment.combined_errors(),
            condition: self.classified.condition,
            untested: self.untested.clone(),
        }
    }
}

impl Campaign {
    /// The result, once [`Step::Done`](super::step::Step::Done) has been returned.
    pub fn finish(mut self) -> Option<CampaignResult> {
        let stop = self.progress.stop?;
        // Failures that the budget left no repetition for.
        let retries = self.requests.retries.drain(..).map(|(pending, cause)| Failed {
            z: pending.z,
            cause,
            expected: false,
        });
        self.data.failed.extend(retries);
        let assessment = self.progress.assessment.take()?;
        Some(CampaignResult {
            untested: self.untested(&assessment),
            classified: self.classified,
            observations: self.data.observations,
            assessment,
            rounds: self.progress.rounds,
            evaluations: self.requests.received,
            failed: self.data.failed,
            stop,
        })
    }
}
