//! A study as one page: design, evaluations, learning, reliability and sensitivities.
//!
//! Requests are numbered in the order they are made, and the journal is read first: a resumed study makes the same
//! requests, finds the finished ones in the journal, and simulates the rest. The learner receives outcomes in the order
//! of their requests, and the settings fix how far the requests run ahead. The result therefore depends on scene,
//! settings and seed alone, while no worker waits for the slowest evaluation of a round.
//!
//! # Example
//! The settings of a study are the scene's defaults, changed and checked:
//! ```
//! use common::scene::SceneSource;
//! use coordinator::study::{Method, Settings};
//!
//! let source = SceneSource::builtin("four-bar")?;
//! let scene = source.nominal();
//! let settings = Settings { seed: 7, max_evaluations: 60, ..Settings::from(scene) };
//! assert_eq!((settings.method, settings.check(scene)), (Method::ActiveLearning, Ok(())));
//!
//! let too_few = Settings { max_evaluations: 5, ..settings };
//! assert_eq!(too_few.check(scene).unwrap_err().key, "max_evaluations");
//! # Ok::<(), common::scene::Faults>(())
//! ```

mod as_published;
mod campaign;
mod campaign_data;
mod campaign_result;
mod classified_population;
mod correction;
mod dispatching;
mod error;
mod exploring;
mod failures;
mod finer_levels;
mod from_results;
mod interim;
mod learner;
mod life_model;
mod lives;
mod mode_results;
mod monte_carlo;
mod observations;
mod outliers;
mod pairs;
mod plan;
mod rare;
mod repetitions;
mod requests;
mod result;
mod round;
mod settings;
mod step;
mod stopped;
mod summary_rows;
mod surrogates;

#[cfg(test)]
mod campaign_tests;
#[cfg(test)]
mod from_results_tests;
#[cfg(test)]
mod interval_tests;
#[cfg(test)]
mod learning_tests;
#[cfg(test)]
mod life_tests;
#[cfg(test)]
mod lives_tests;
#[cfg(test)]
mod logarithm_tests;
#[cfg(test)]
mod pairs_tests;
#[cfg(test)]
mod two_sided_tests;
#[cfg(test)]
mod variants_tests;

pub use campaign::Campaign;
pub use campaign_result::CampaignResult;
pub use classified_population::ClassifiedPopulation;
pub use correction::{Correction, StoredOutcome};
pub use error::StudyError;
pub use failures::{Failed, Feasibility};
pub use finer_levels::FinerLevels;
pub use from_results::{
    FIRST_VARIANT, FurtherLearning, LearnedVariant, StudyOfVariants, campaign_from_results,
    complete_outcomes, learn_from_results, learn_with_surrogates, result_of, simulate_samples,
};
pub use life_model::{ExplicitLimitState, ExplicitModel, LifeModel, LifeResponses};
pub use lives::LEVELS;
pub use observations::{Observations, Observed, ObservedOutcome, Source};
pub use outliers::Outlier;
pub use plan::{Plan, Problem};
pub use result::{StudyResult, blank};
pub use round::Assessment;
pub use settings::{LARGEST_POPULATION, Method, SettingError, Settings, StudyAccuracy};
pub use step::{CampaignError, SampleRequest, Step, StopReason};
pub use surrogates::Surrogate;

use crate::farm::evaluate::Evaluator;
use crate::results::journal::Journal;
use crate::results::progress::{Observer, Progress};
use common::accuracy::Accuracy;
use common::scene::Scene;
use correction::add_levels;
use dispatching::Dispatcher;
use monte_carlo::DirectSimulation;
use pairs::PairedCampaign;
use result::from_learning;
use stopped::note_whole_interval;

/// Runs a study of `scene` to its end: evaluations by `evaluator`, recorded in `journal`, reported to `observer`.
///
/// Request 0 is the nominal point (the variables' means), with the first cycle; it belongs to the initial design.
///
/// # Errors
/// [`StudyError`]; finished evaluations are in the journal by then.
pub fn run(
    scene: &Scene,
    settings: &Settings,
    evaluator: &mut dyn Evaluator,
    journal: &mut dyn Journal,
    observer: &mut dyn Observer,
) -> Result<StudyResult, StudyError> {
    settings.check(scene)?;
    let problem = Problem::from_scene(scene);
    let stricter = settings.stricter(scene);
    let mut dispatcher = Dispatcher::new(scene, stricter, settings.budget(), journal, observer);
    let findings = match settings.method {
        Method::ActiveLearning | Method::AkMcs => {
            let campaign = Campaign::new(problem, Plan::new(settings, scene));
            let finer = settings.finer_levels(scene).into_iter();
            let wear_error = settings.evaluated(scene).wear_error;
            dispatcher.finer = finer.map(|level| Accuracy { wear_error, ..level.accuracy }).collect();
            let mut campaign = PairedCampaign::new(scene, campaign, dispatcher.finer.len());
            dispatcher.run(evaluator, &mut campaign)?;
            dispatcher.observer.notice(&Progress::Ending);
            let finished = campaign.finish();
            let (learned, correction, evaluations, failed) =
                finished.expect("a campaign that is done has learned something");
            let mut findings = from_learning(scene, settings, &learned);
            let (n, pairs) = (learned.assessment.governing, (correction.as_ref(), evaluations, &failed[..]));
            add_levels(&mut findings.summary, scene, settings, n, pairs);
            findings
        }
        Method::MonteCarlo | Method::LatinHypercube => {
            let mut direct = DirectSimulation::new(&problem, settings);
            dispatcher.run(evaluator, &mut direct)?;
            dispatcher.observer.notice(&Progress::Ending);
            direct.findings(scene, settings)?
        }
    };
    dispatcher.end()?;
    let mut result = findings.result(scene, dispatcher.timing(), dispatcher.shares());
    note_whole_interval(&mut result.summary, settings);
    let failures = result.summary.reliability.iter().any(|row| row.reliability["total"] < 1.0);
    if settings.method.learns() && !failures {
        dispatcher.observer.notice(&Progress::Warning(format!(
            "no failure was found among {} points of the population",
            result.summary.population
        )));
    }
    Ok(result)
}
