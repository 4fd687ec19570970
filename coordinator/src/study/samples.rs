//! Simulation of samples that no campaign of a study has requested: each is looked up in the journal first, and recorded there.

use super::observations::ObservedOutcome;
use super::outcome_check::{check, observed, recalled};
use super::response_layout::ResponseLayout;
use super::step::SampleRequest;
use super::{Settings, StudyError};
use crate::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use crate::results::journal::Journal;
use common::evaluation_shape::EvaluationShape;
use common::scene::Scene;
use std::collections::BTreeMap;

/// Outcomes of the requests in their order, complete in the sense of [`super::complete_outcomes`]. Requests are numbered
/// from `first` on; what the journal holds is not simulated again.
///
/// # Errors
/// [`StudyError`]; finished simulations are in the journal by then.
pub fn simulate_samples(
    scene: &Scene,
    settings: &Settings,
    requests: &[SampleRequest],
    first: u64,
    evaluator: &mut dyn Evaluator,
    journal: &mut dyn Journal,
) -> Result<Vec<ObservedOutcome>, StudyError> {
    let stricter = settings.stricter(scene);
    let numbered = |(id, wanted): (u64, &SampleRequest)| Request {
        id,
        sample: wanted.sample.clone(),
        with_first_cycle: false,
        accuracy: stricter.filter(|_| wanted.stricter),
    };
    let requests: Vec<Request> = (first..).zip(requests).map(numbered).collect();
    let shape = EvaluationShape::of(scene);
    let (mut found, mut misfit): (BTreeMap<u64, Finished>, _) = (BTreeMap::new(), None);
    let mut missing = Vec::new();
    for request in &requests {
        match recalled(journal, request, &shape)? {
            Some(finished) => drop(found.insert(request.id, finished)),
            None => missing.push(request.clone()),
        }
    }
    let evaluated = evaluator.evaluate(&missing, &mut |finished| {
        if let Err(error) = check(&finished, &shape) {
            misfit = Some(error);
            return Err(EvaluateError::Interrupted);
        }
        let request = missing.iter().find(|request| request.id == finished.id);
        if let Some(request) = request {
            journal.record(request, &finished)?;
        }
        found.insert(finished.id, finished);
        Ok(())
    });
    misfit.map_or(Ok(()), Err)?;
    evaluated?;
    let responses = ResponseLayout::from_scene(scene);
    let outcome = |request: &Request| {
        let finished = found.remove(&request.id).ok_or(StudyError::Unanswered { id: request.id })?;
        Ok(observed(finished).map(|observed| responses.complete(observed)))
    };
    requests.iter().map(outcome).collect()
}
