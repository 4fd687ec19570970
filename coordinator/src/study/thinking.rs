//! The thread on which a study thinks: the learner is asked and told there, so that outcomes are recorded, and workers
//! served, while it fits and classifies.

use super::dispatching::Outcome;
use super::so_far::SoFar;
use super::{CampaignError, Step};
use crate::results::summary::Round;
use std::sync::mpsc::{Receiver, Sender};
use std::time::{Duration, Instant};

/// Who decides what is simulated: asks and is told, chunk by chunk, in order.
pub(super) trait Learner: Send {
    /// What it wants next; see [`Step`].
    fn next_step(&mut self) -> Result<Step, CampaignError>;
    /// The outcomes of its oldest chunk.
    fn tell(&mut self, outcomes: Vec<Outcome>) -> Result<(), CampaignError>;
    /// The rounds so far.
    fn rounds(&self) -> &[Round];
    /// What its next chunk is for, in words.
    fn purpose(&self) -> String;
    /// What is known after the last round, for people who watch; asked when a round has ended.
    fn so_far(&self) -> Option<SoFar>;
}

/// What a learner came to.
pub(super) struct Thought {
    /// What it wants.
    pub step: Step,
    /// What that is for, in words.
    pub purpose: String,
    /// Rounds finished on the way.
    pub rounds: Vec<Round>,
    /// What is known after them, if there were any.
    pub so_far: Option<SoFar>,
    /// How long it took.
    pub took: Duration,
}

/// Asks the learner until it is done, fails, or nobody listens; where it waits, it is told the next chunk of `told`.
///
/// After each chunk it is asked before it is told the next one, so its questions do not depend on which outcomes came together.
pub(super) fn think(
    learner: &mut dyn Learner,
    told: &Receiver<Vec<Outcome>>,
    thoughts: &Sender<Result<Thought, CampaignError>>,
) {
    let mut noted = 0;
    loop {
        let started = Instant::now();
        let thought = learner.next_step().map(|step| Thought {
            step,
            purpose: learner.purpose(),
            rounds: learner.rounds()[noted..].to_vec(),
            so_far: if learner.rounds().len() > noted { learner.so_far() } else { None },
            took: started.elapsed(),
        });
        noted = learner.rounds().len();
        let (ends, waits) = match &thought {
            Ok(Thought { step, .. }) => (*step == Step::Done, *step == Step::Wait),
            Err(_) => (true, false),
        };
        if thoughts.send(thought).is_err() || ends {
            return;
        }
        if waits {
            let Ok(outcomes) = told.recv() else { return };
            if let Err(error) = learner.tell(outcomes) {
                // Whoever no longer listens needs no reason.
                let _ = thoughts.send(Err(error));
                return;
            }
        }
    }
}
