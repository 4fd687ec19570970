//! The loop of an active-learning campaign whose simulations are made in place, for published problems, replays, designs and
//! tests; and the result of a campaign.

use super::interim::InterimResult;
use super::{
    Assessment, Campaign, CampaignError, ClassifiedPopulation, Failed, Method, Observations, ObservedOutcome,
    Outlier, SampleRequest, Step, StopReason,
};
use crate::results::reliability_summary::ReliabilityRange;
use crate::results::summary::Round;
use crate::statistics::learning::largest_gap;
use crate::statistics::reliability::CurvePoint;
use std::collections::VecDeque;

/// Result of an active-learning campaign.
#[derive(Debug)]
pub struct CampaignResult {
    /// The population classified in the last round, with the event it is conditional on.
    pub classified: ClassifiedPopulation,
    /// Results of all successful simulations that the surrogates use.
    pub observations: Observations,
    /// Standardised points `(d,)` of all other simulations.
    pub explored: Vec<Vec<f64>>,
    /// Surrogates and classification of the last round.
    pub assessment: Assessment,
    /// All rounds, in order.
    pub rounds: Vec<Round>,
    /// Method of the learning.
    pub method: Method,
    /// Number of evaluations, failed ones included.
    pub evaluations: usize,
    /// Simulations that failed for good.
    pub failed: Vec<Failed>,
    /// Results that were evaluated again.
    pub outliers: Vec<Outlier>,
    /// Reason for the end of learning.
    pub stop: StopReason,
    /// Failure shares with their errors.
    pub(super) shares: InterimResult,
}

impl CampaignResult {
    /// R(n) with its standard error, as a study states it, per curve `(limit states + 1)(m,)`, the system last.
    pub fn reliability(&self) -> Vec<Vec<CurvePoint>> {
        self.shares.curves()
    }

    /// 95 % interval of R(n) of the system as a study states it, besides the numerical error `(m,)`.
    pub fn intervals(&self) -> Vec<ReliabilityRange> {
        self.shares.intervals_of_system()
    }

    /// Share of the population in the largest ball without a simulation [1], see [`largest_gap`].
    pub fn largest_gap(&self) -> f64 {
        let known: Vec<&[f64]> =
            self.observations.standardised().chain(self.explored.iter().map(Vec::as_slice)).collect();
        largest_gap(self.classified.unconditional(), &known)
    }
}

impl Campaign {
    /// Runs the campaign to its end. Where it waits, `simulate` returns the outcomes of all samples requested since its last
    /// call, in their order; if it returns fewer, the campaign stays where they end. `observe` receives the campaign after each
    /// step.
    ///
    /// # Errors
    /// [`CampaignError`], or the error of `simulate`.
    pub fn run<E: From<CampaignError>>(
        &mut self,
        mut simulate: impl FnMut(&[SampleRequest]) -> Result<Vec<ObservedOutcome>, E>,
        mut observe: impl FnMut(&Self),
    ) -> Result<(), E> {
        let (mut requested, mut chunks, mut received) = (Vec::new(), VecDeque::new(), Vec::new());
        loop {
            let step = self.next_step()?;
            observe(self);
            match step {
                Step::Evaluate(requests) => {
                    chunks.push_back(requests.len());
                    requested.extend(requests);
                }
                Step::Wait => {
                    if !requested.is_empty() {
                        received.extend(simulate(&std::mem::take(&mut requested))?);
                    }
                    let oldest = chunks.pop_front().expect("a campaign waits for requested samples only");
                    if received.len() < oldest {
                        return Ok(());
                    }
                    self.record(received.drain(..oldest).collect())?;
                }
                Step::Done => return Ok(()),
            }
        }
    }

    /// Runs the campaign to its end with simulations made one by one, see [`Campaign::run`].
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn learn_from(
        mut self,
        mut simulate: impl FnMut(&[f64]) -> ObservedOutcome,
        observe: impl FnMut(&Self),
    ) -> Result<CampaignResult, CampaignError> {
        let each = |requests: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, CampaignError> {
            Ok(requests.iter().map(|request| simulate(&request.sample)).collect())
        };
        self.run(each, observe)?;
        Ok(self.finish().expect("a campaign that is done has a result"))
    }

    /// The result, once [`Step::Done`] has been returned.
    pub fn finish(mut self) -> Option<CampaignResult> {
        let stop = self.stop?;
        // Failures that the budget left no repetition for.
        let retries = self.requests.retries.drain(..);
        let failed = retries.map(|(pending, cause)| Failed { z: pending.z, cause, expected: false });
        self.data.failed.extend(failed);
        Some(CampaignResult {
            shares: self.interim()?,
            assessment: self.assessment?,
            method: self.plan.settings.method,
            classified: self.classified,
            explored: self.data.explored(),
            observations: self.data.observations,
            rounds: self.rounds,
            evaluations: self.requests.received,
            failed: self.data.failed,
            outliers: self.data.outliers,
            stop,
        })
    }
}
