//! Simulation of samples that no campaign of a study has requested: each is looked up in the journal first, and recorded there.

use super::correction::Correction;
use super::dispatching::Dispatcher;
use super::learner::Learner;
use super::observations::ObservedOutcome;
use super::step::{CampaignError, SampleRequest, Step};
use super::{Settings, StudyError};
use crate::farm::evaluate::Evaluator;
use crate::results::journal::Journal;
use crate::results::progress::Silent;
use common::scene::Scene;

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

/// Outcomes of the requests in their order, complete in the sense of [`super::complete_outcomes`]. Requests are numbered
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
    Dispatcher::new(scene, settings.stricter(scene), requests.len(), evaluator, journal, &mut Silent)
        .going_on(first, correction)
        .run(&mut given)?;
    Ok(given.outcomes.unwrap_or_default())
}
