//! The journal of a study: every outcome is recorded before it is used, and found again on `resume`. The study is
//! deterministic: a resumed study makes the same requests under the same numbers, and only those without a recorded
//! outcome are evaluated.

use crate::farm::evaluate::{EvaluateError, Finished, Request};
use crate::results::summary::Round;
use crate::results::timing::Timing;
use std::collections::BTreeMap;

/// Record of the evaluations of a study.
pub trait Journal {
    /// The recorded outcome of this request, if it was finished before. A study whose settings were changed makes other
    /// requests: a journal may return the outcome of the same sample under another number, and then keeps it under this
    /// one. Requests are looked up in the order of their numbers.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if the journal cannot be read or belongs to another study.
    fn finished(&mut self, request: &Request) -> Result<Option<Finished>, EvaluateError>;

    /// Records an outcome; it is durable when this returns.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if it cannot be written.
    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError>;

    /// Records several outcomes, if possible in less time than one by one.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if they cannot be written; some of them may be durable.
    fn record_all(&mut self, outcomes: &[(Request, Finished)]) -> Result<(), EvaluateError> {
        outcomes.iter().try_for_each(|(request, finished)| self.record(request, finished))
    }

    /// Sets a recorded outcome that cannot be used aside, for this reason: the request has no outcome from then on.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if it cannot be written.
    fn set_aside(&mut self, id: u64, reason: &str) -> Result<(), EvaluateError>;

    /// Notes that the study has ended after this number of requests: recorded evaluations beyond it are no part of its
    /// result.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if it cannot be written.
    fn ended(&mut self, _requests: u64) -> Result<(), EvaluateError> {
        Ok(())
    }

    /// Records a finished round of learning. `resume` does not need it.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if it cannot be written.
    fn note_round(&mut self, _round: &Round) -> Result<(), EvaluateError> {
        Ok(())
    }

    /// Times of the study so far, as noted by its earlier runs; all zero before the first one.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if they cannot be read.
    fn times(&self) -> Result<Timing, EvaluateError> {
        Ok(Timing::default())
    }

    /// Notes the times of the study so far, the run in progress included.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if they cannot be written.
    fn note_times(&mut self, _times: &Timing) -> Result<(), EvaluateError> {
        Ok(())
    }
}

/// A journal without a file: for studies that need not be resumed after the process has ended, and for tests.
#[derive(Debug, Clone, Default)]
pub struct InMemoryJournal {
    /// Sample and outcome by the number of the request.
    outcomes: BTreeMap<u64, (Vec<f64>, Finished)>,
    times: Timing,
}

impl InMemoryJournal {
    /// Sample `(d,)` and outcome of every recorded evaluation, by the number of its request.
    pub fn outcomes(&self) -> &BTreeMap<u64, (Vec<f64>, Finished)> {
        &self.outcomes
    }
}

impl Journal for InMemoryJournal {
    fn finished(&mut self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
        match self.outcomes.get(&request.id) {
            Some((sample, _)) if *sample != request.sample => {
                Err(EvaluateError::Record(format!("evaluation {} has another sample", request.id).into()))
            }
            known => Ok(known.map(|(_, finished)| finished.clone())),
        }
    }

    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        let entry = (request.sample.clone(), finished.clone());
        let twice =
            |_| EvaluateError::Record(format!("evaluation {} was recorded before", request.id).into());
        self.outcomes.insert(request.id, entry).map_or(Ok(()), |known| Err(twice(known)))
    }

    fn set_aside(&mut self, id: u64, _reason: &str) -> Result<(), EvaluateError> {
        self.outcomes.remove(&id);
        Ok(())
    }

    fn ended(&mut self, requests: u64) -> Result<(), EvaluateError> {
        self.outcomes.retain(|id, _| *id < requests);
        Ok(())
    }

    fn times(&self) -> Result<Timing, EvaluateError> {
        Ok(self.times)
    }

    fn note_times(&mut self, times: &Timing) -> Result<(), EvaluateError> {
        self.times = *times;
        Ok(())
    }
}
