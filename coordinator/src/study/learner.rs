//! The part of a study that decides what is simulated. It runs in a thread of its own, where surrogates are fitted and the
//! population is classified, so that the study goes on recording results and serving workers meanwhile.

use super::interim::InterimResult;
use super::{CampaignError, ObservedOutcome, Step};
use crate::results::summary::Round;
use std::sync::mpsc::{Receiver, Sender};
use std::time::{Duration, Instant};

/// Decides what is simulated: an ask-and-tell interface over chunks of samples, in order.
pub(super) trait Learner: Send {
    /// Returns the next step, see [`Step`].
    fn next_step(&mut self) -> Result<Step, CampaignError>;
    /// Records the outcomes of the oldest chunk.
    fn record(&mut self, outcomes: Vec<ObservedOutcome>) -> Result<(), CampaignError>;
    /// The rounds so far.
    fn rounds(&self) -> &[Round] {
        &[]
    }
    /// The purpose of the next chunk in words, for progress messages.
    fn purpose(&self) -> String;
    /// The reliability after the last round, for progress messages; called when a round has ended.
    fn interim(&self) -> Option<InterimResult> {
        None
    }
    /// Indices of the limit states whose outputs were the same in every simulation so far.
    fn constant_limit_states(&self) -> Vec<usize> {
        vec![]
    }
}

/// One answer of the learner.
pub(super) struct LearnerStep {
    /// The next step.
    pub step: Step,
    /// Purpose of the step in words.
    pub purpose: String,
    /// Rounds finished since the last answer.
    pub rounds: Vec<Round>,
    /// The reliability after those rounds, if there were any.
    pub interim: Option<InterimResult>,
    /// Limit states whose outputs were the same in every simulation of the initial design.
    pub constant: Vec<usize>,
    /// Time the learner took.
    pub took: Duration,
}

/// Runs the learner until it is done, fails, or the receiver of `steps` is gone. Where it waits, it receives
/// the next chunk of `outcomes`.
///
/// After each chunk the learner returns all the steps it can before it receives the next chunk, so its steps
/// do not depend on which outcomes arrived together.
pub(super) fn run_learner(
    learner: &mut dyn Learner,
    outcomes: &Receiver<Vec<ObservedOutcome>>,
    steps: &Sender<Result<LearnerStep, CampaignError>>,
) {
    let mut reported = 0;
    loop {
        let started = Instant::now();
        let next = learner.next_step().map(|step| {
            let rounds = learner.rounds()[reported..].to_vec();
            let (has_news, is_first) = (!rounds.is_empty(), reported == 0);
            LearnerStep {
                step,
                purpose: learner.purpose(),
                rounds,
                interim: if has_news { learner.interim() } else { None },
                constant: if has_news && is_first { learner.constant_limit_states() } else { vec![] },
                took: started.elapsed(),
            }
        });
        reported = learner.rounds().len();
        let (ends, waits) = match &next {
            Ok(LearnerStep { step, .. }) => (*step == Step::Done, *step == Step::Wait),
            Err(_) => (true, false),
        };
        if steps.send(next).is_err() || ends {
            return;
        }
        if waits {
            let Ok(chunk) = outcomes.recv() else { return };
            if let Err(error) = learner.record(chunk) {
                // A study that has ended no longer receives the reason.
                let _ = steps.send(Err(error));
                return;
            }
        }
    }
}
