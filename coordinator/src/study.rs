//! The campaign as one page: design, simulate, learn, and what follows for reliability and sensitivity.
//!
//! Requests are numbered in the order they are made, and the campaign file is asked first: a resumed study makes the
//! same requests, finds what was finished and simulates the rest. Outcomes are told in the order of their requests, and how far the
//! requests run ahead of them is fixed by the settings, so the answer depends on the scene, the settings and the seed
//! alone, and yet no worker waits for the slowest of a round.

mod campaign;
mod dispatching;
mod failures;
mod learned;
mod monte_carlo;
mod observations;
mod plan;
mod populations;
mod rare;
mod responses;
mod result;
mod round;
mod rows;
mod settings;
mod so_far;
mod step;
mod surprise;
mod surrogates;
mod thinking;
mod verification;

#[cfg(test)]
mod campaign_tests;
#[cfg(test)]
mod life_tests;

pub use campaign::Campaign;
pub use failures::{Failed, Feasibility};
pub use learned::Learned;
pub use observations::{Observations, Observed};
pub use plan::{Plan, Problem};
pub use populations::LookedAt;
pub use result::blank;
pub use result::{OutputHistory, StudyResult, SurrogateReport};
pub use round::Assessment;
pub use settings::{LARGEST_POPULATION, Method, SettingError, Settings, StudyAccuracy};
pub use step::{Ask, CampaignError, Step, Stop};
pub use surrogates::Surrogate;
pub use verification::{
    SimulatedPoint, Verification, Verified, VerifiedRow, completed, first_failures, verify,
};

use crate::farm::evaluate::{EvaluateError, Evaluator};
use crate::results::journal::Journal;
use crate::results::progress::{Observer, Progress};
use crate::results::summary::Round;
use crate::statistics::design::InputModel;
use common::scene::Scene;
use dispatching::{Dispatcher, Outcome};
use monte_carlo::DirectSimulation;
use responses::Responses;
use so_far::SoFar;
use std::time::Instant;
use thinking::Learner;
use thiserror::Error;

/// Why a study has no result.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The settings do not make a study.
    #[error(transparent)]
    Setting(#[from] SettingError),
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
    let stricter = settings.stricter(scene);
    let mut dispatcher = Dispatcher::new(scene, stricter, settings.budget(), evaluator, journal, observer);
    let mut result = match settings.method {
        Method::ActiveLearning => learn(scene, settings, problem.clone(), &mut dispatcher)?,
        Method::MonteCarlo | Method::LatinHypercube => {
            let mut direct = DirectSimulation::new(&problem, settings);
            dispatcher.run(&mut direct)?;
            dispatcher.notice(&Progress::Ending);
            direct.result(scene, settings)?
        }
    };
    let timing = &mut result.summary.timing_s;
    timing.total = started.elapsed().as_secs_f64();
    timing.simulation = dispatcher.simulation_seconds();
    let (thinking, idle) = dispatcher.thinking_seconds();
    timing.surrogate = thinking;
    timing.idle = idle;
    result.summary.workers = dispatcher.shares();
    Ok(result)
}

/// The scene as the statistics see it.
pub fn problem_of(scene: &Scene) -> Problem {
    let responses = Responses::of(scene);
    Problem {
        inputs: InputModel::of(scene),
        outputs: responses.count(),
        modes: responses.modes,
        checkpoints: scene.life.checkpoints(),
    }
}

impl Learner for Campaign {
    fn next_step(&mut self) -> Result<Step, CampaignError> {
        Campaign::next_step(self)
    }

    fn tell(&mut self, outcomes: Vec<Outcome>) -> Result<(), CampaignError> {
        Campaign::tell(self, outcomes)
    }

    fn rounds(&self) -> &[Round] {
        Campaign::rounds(self)
    }

    fn purpose(&self) -> String {
        match self.rounds().len() {
            0 => "initial design".to_owned(),
            round => format!("round {round}"),
        }
    }

    fn so_far(&self) -> Option<SoFar> {
        Campaign::so_far(self)
    }
}

/// Active learning to its end.
fn learn(
    scene: &Scene,
    settings: &Settings,
    problem: Problem,
    dispatcher: &mut Dispatcher<'_>,
) -> Result<StudyResult, StudyError> {
    let mut campaign = Campaign::new(problem, Plan::new(settings, scene));
    dispatcher.run(&mut campaign)?;
    dispatcher.notice(&Progress::Ending);
    let learned = campaign.finish().expect("a campaign that is done has learned something");
    let result = result::from_learning(scene, settings, &learned);
    if !result.summary.reliability.iter().any(|row| row.reliability["total"] < 1.0) {
        dispatcher.notice(&Progress::Warning(format!(
            "no failure was found among {} points of the population",
            learned.looked_at.population.len()
        )));
    }
    Ok(result)
}
