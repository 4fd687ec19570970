//! What a study needs of its campaign file: every outcome durable before it counts, every finished evaluation
//! found again on `resume`. The study is deterministic, so a resumed study asks for the same requests by the
//! same numbers and only what is missing is evaluated.

use crate::farm::evaluate::{EvaluateError, Finished, Request};
use crate::results::summary::Round;

/// Durable memory of a campaign.
pub trait Journal {
    /// The recorded outcome of this request, if it was finished before. A recorded request with another sample
    /// under the same number is an error: the file belongs to another study.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if the file cannot be read or does not fit.
    fn finished(&self, request: &Request) -> Result<Option<Finished>, EvaluateError>;

    /// Makes an outcome durable.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if it cannot be written.
    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError>;

    /// Makes several outcomes durable, in less time than one by one where it can.
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if they cannot be written; some of them may be durable.
    fn record_all(&mut self, outcomes: &[(Request, Finished)]) -> Result<(), EvaluateError> {
        outcomes.iter().try_for_each(|(request, finished)| self.record(request, finished))
    }

    /// Notes a finished round of learning (for people who open the file; not needed to resume).
    ///
    /// # Errors
    /// [`EvaluateError::Record`] if it cannot be written.
    fn note_round(&mut self, round: &Round) -> Result<(), EvaluateError>;
}
