//! Accuracy of a command's evaluations: by name, or the cheapest within an error budget.

use super::{Done, accuracy_name, share};
use clap::Args;
use common::accuracy::NamedAccuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Faults, Scene, SceneSource};
use coordinator::analyses::budget::{LADDER, RANDOM_POINTS, TriedSetting, choose_setting};
use coordinator::farm::evaluate::local::LocalEvaluator;
use coordinator::farm::evaluate::{Evaluator, Request};
use coordinator::presentation::report::format::short_percent;
use coordinator::presentation::terminal::print_message;
use coordinator::statistics::design::nominal_and_random;
use coordinator::study::StudyAccuracy;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use worker::simulate::{SimulateOptions, simulate};

/// Options on accuracy.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Accuracy")]
pub struct AccuracyArguments {
    /// Accuracy of the evaluations: draft, balanced, reference, or a preset with changed parameters, e.g.
    /// draft+step-x0.71+jump-4000 (see `tradeoff`) [default: that of the scene, else balanced]
    #[arg(long, value_name = "draft|balanced|reference|NAME", value_parser = accuracy_name(), hide_possible_values = true)]
    pub accuracy: Option<NamedAccuracy>,
    /// Choose the cheapest accuracy whose stated errors stay below this share of the limit, for every output with a limit
    /// state, e.g. 1%
    #[arg(long, value_name = "SHARE", value_parser = share, conflicts_with = "accuracy")]
    pub max_error: Option<f64>,
}

impl AccuracyArguments {
    /// Accuracy of a study: the named one, or one chosen at the nominal point and at [`RANDOM_POINTS`] others, which
    /// depend on the seed alone.
    ///
    /// # Errors
    /// [`super::CommandError::Budget`] if no setting keeps the error budget.
    pub fn for_study(
        &self,
        source: &SceneSource,
        seed: u64,
        threads: usize,
        quiet: bool,
        interrupted: Arc<AtomicBool>,
    ) -> Done<StudyAccuracy> {
        let evaluate = |request: &Request| {
            let invalid = |faults: Faults| SimulationFailure::InvalidSample { faults: faults.to_string() };
            evaluated(&source.resolve_sample(&request.sample).map_err(invalid)?, request)
        };
        let evaluator = LocalEvaluator::new(threads, evaluate).interrupted_by(interrupted);
        let scene = source.nominal();
        self.choose(scene, &nominal_and_random(scene, seed, RANDOM_POINTS), quiet, evaluator)
    }

    /// Accuracy of one evaluation of a scene: the named one, or one chosen for it.
    ///
    /// # Errors
    /// [`super::CommandError::Budget`] if no setting keeps the error budget.
    pub fn for_one(&self, scene: &Scene, quiet: bool) -> Done<StudyAccuracy> {
        let evaluator = LocalEvaluator::new(1, |request: &Request| evaluated(scene, request));
        self.choose(scene, &[vec![]], quiet, evaluator)
    }

    fn choose(
        &self,
        scene: &Scene,
        points: &[Vec<f64>],
        quiet: bool,
        mut evaluator: impl Evaluator,
    ) -> Done<StudyAccuracy> {
        let Some(budget) = self.max_error else {
            let setting = self.accuracy.clone().unwrap_or_else(|| scene.accuracy.clone());
            return Ok(StudyAccuracy { setting, max_error: None });
        };
        let setting = choose_setting(scene, budget, &LADDER, points, &mut evaluator, &mut |attempt| {
            if !quiet {
                print_message(attempt_text(attempt, budget));
            }
        })?;
        if !quiet {
            let (name, below, points) = (&setting.name, short_percent(budget), points.len());
            let at = if points == 1 { "this point".to_owned() } else { format!("{points} points") };
            print_message(format_args!(
                "accuracy {name}: the cheapest tried that states errors below {below} at {at}"
            ));
        }
        Ok(StudyAccuracy { setting, max_error: Some(budget) })
    }
}

/// Simulates a scene as requested.
fn evaluated(scene: &Scene, request: &Request) -> Result<Evaluation, SimulationFailure> {
    let options = SimulateOptions { first_cycle: request.with_first_cycle };
    simulate(scene, &request.accuracy.unwrap_or_default(), options)
}

fn attempt_text(attempt: &TriedSetting, budget: f64) -> String {
    let name = &attempt.setting.name;
    match &attempt.worst {
        Ok(worst) => {
            let verdict = if worst.error <= budget { "within" } else { "over" };
            let [error, budget] = [worst.error, budget].map(short_percent);
            format!("tried {name}: {error} of {}, {verdict} {budget}", worst.output)
        }
        Err(failure) => format!("tried {name}: {failure}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_budget_nothing_is_tried() {
        let source = SceneSource::builtin("four-bar").expect("built in");
        let named = AccuracyArguments { accuracy: "draft+jump-500".parse().ok(), max_error: None };
        let found = named.for_one(source.nominal(), true).expect("nothing to try");
        assert_eq!((found.setting.accuracy.cycle_jump, found.max_error), (500, None));
        let none = AccuracyArguments::default().for_study(&source, 1, 1, true, Arc::default());
        assert_eq!(none.expect("nothing to try"), StudyAccuracy::default());
    }
}
