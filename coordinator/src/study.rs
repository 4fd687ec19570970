//! The campaign as one page: design, simulate, learn, and what follows for reliability and sensitivity.
//!
//! Requests are numbered in the order they are made, and the campaign file is asked first: a resumed study makes the
//! same requests, finds what was finished and simulates the rest. Outcomes are sorted by number before use, so the
//! answer depends on the scene, the settings and the seed alone.

mod campaign;
mod dispatching;
mod monte_carlo;
mod observations;
mod responses;
mod result;
mod round;
mod settings;

#[cfg(test)]
mod campaign_tests;
#[cfg(test)]
mod life_tests;

pub use campaign::{Campaign, CampaignError, Learned, Plan, Problem, Step, Stop};
pub use observations::{Observations, Observed};
pub use result::{OutputHistory, StudyResult, SurrogateReport};
pub use round::{Assessment, Surrogate};
pub use settings::{Method, Settings};

use crate::evaluate::{EvaluateError, Evaluator};
use crate::journal::Journal;
use crate::progress::{Observer, Progress};
use common::scene::Scene;
use dispatching::Dispatcher;
use responses::Responses;
use std::time::Instant;
use thiserror::Error;

/// Why a study has no result.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The settings do not make a study.
    #[error("study setting {key} = {value}: {allowed}")]
    Setting {
        /// Which.
        key: &'static str,
        /// What it is.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// An evaluation could not be had or recorded.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Learning cannot go on.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// An evaluator ended without the outcome of a request.
    #[error("evaluation {id} was asked for and never answered")]
    Unanswered {
        /// Number of the request.
        id: u64,
    },
    /// An outcome does not have the shape of the scene, or a value that is not finite.
    #[error("evaluation {id} by {worker} does not fit the scene: {what}")]
    Malformed {
        /// Number of the request.
        id: u64,
        /// Who answered.
        worker: String,
        /// What is wrong.
        what: String,
    },
}

/// Runs a study to its end.
///
/// Request 0 is the nominal point (the variables' means), with the first cycle; it belongs to the initial design.
///
/// # Errors
/// [`StudyError`]; whatever was evaluated is in the journal by then.
pub fn run(
    scene: &Scene,
    settings: &Settings,
    evaluator: &mut dyn Evaluator,
    journal: &mut dyn Journal,
    observer: &mut dyn Observer,
) -> Result<StudyResult, StudyError> {
    settings.check(scene)?;
    let started = Instant::now();
    let problem = problem_of(scene);
    let mut dispatcher = Dispatcher::new(scene, evaluator, journal, observer);
    let mut result = match settings.method {
        Method::ActiveLearning => learn(scene, settings, problem.clone(), &mut dispatcher)?,
        Method::MonteCarlo { samples } => {
            monte_carlo::run(scene, settings, &problem, samples, &mut dispatcher)?
        }
    };
    let timing = &mut result.summary.timing_s;
    timing.total = started.elapsed().as_secs_f64();
    timing.simulation = dispatcher.simulation_seconds();
    timing.surrogate = timing.total - dispatcher.waiting_seconds();
    result.summary.workers = dispatcher.shares();
    Ok(result)
}

/// The scene as the statistics see it.
fn problem_of(scene: &Scene) -> Problem {
    let responses = Responses::of(scene);
    Problem {
        variables: scene.variables.iter().map(|variable| variable.distribution).collect(),
        outputs: responses.count(),
        modes: responses.modes,
        checkpoints: scene.life.checkpoints(),
    }
}

/// Active learning to its end.
fn learn(
    scene: &Scene,
    settings: &Settings,
    problem: Problem,
    dispatcher: &mut Dispatcher<'_>,
) -> Result<StudyResult, StudyError> {
    let mut campaign = Campaign::new(problem, settings.plan());
    let mut noted = 0;
    loop {
        let step = campaign.next_step()?;
        for round in &campaign.rounds()[noted..] {
            dispatcher.note_round(round)?;
        }
        noted = campaign.rounds().len();
        let Step::Evaluate(samples) = step else { break };
        let purpose = if noted == 0 { "initial design".to_owned() } else { format!("round {noted}") };
        let outcomes = dispatcher.evaluate(samples, &purpose, settings.study.max_evaluations)?;
        campaign.tell(outcomes)?;
    }
    let learned = campaign.finish().expect("a campaign that is done has learned something");
    let result = result::from_learning(scene, settings, &learned);
    if !result.summary.reliability.iter().any(|row| row.reliability["total"] < 1.0) {
        dispatcher.notice(&Progress::Warning(format!(
            "no failure was found among {} points of the population",
            learned.population.len()
        )));
    }
    Ok(result)
}
