//! What a study is run with: the scene's defaults, changed by the command line, checked, and kept in the campaign
//! file so that `resume` repeats exactly that.

use super::accuracy::Accepted;
use super::arguments::{MethodName, RunArguments, StatedErrorsName};
use super::error::CommandError;
use common::scene::{Scene, StudySettings};
use coordinator::learning::Targets;
use coordinator::study::{Method, Settings};
use coordinator::surrogate::StatedErrors;
use serde::{Deserialize, Serialize};

/// Settings of a study; each of them may change its result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyOptions {
    /// `ak` or `monte-carlo`.
    pub method: String,
    /// Accuracy of the evaluations, with every knob: what it was once, whatever its name stands for later.
    pub accuracy: Accepted,
    /// Points of the population (ak) or simulations (monte-carlo).
    pub samples: usize,
    /// Simulations of the initial design.
    pub initial: usize,
    /// Simulations per round.
    pub batch: usize,
    /// Budget of simulations.
    pub max_evaluations: usize,
    /// Seed.
    pub seed: u64,
    /// What the surrogates make of stated errors; campaigns begun before there was a choice ignored them.
    #[serde(default)]
    pub stated_errors: StatedErrorsName,
}

impl StudyOptions {
    /// Lays the command line over the scene's defaults. The accuracy for an error budget is still to be found.
    ///
    /// # Errors
    /// A combination that cannot be run.
    pub fn new(arguments: &RunArguments, scene: &Scene) -> Result<Self, CommandError> {
        let defaults = &scene.study;
        let monte_carlo = arguments.method == Some(MethodName::MonteCarlo);
        // Simulating a whole population is what nobody can wait for: the budget is the default there.
        let default_samples = if monte_carlo { defaults.max_evaluations } else { defaults.population };
        let samples = arguments.samples.unwrap_or(default_samples);
        let method = if monte_carlo { Method::MonteCarlo { samples } } else { Method::ActiveLearning };
        let options = StudyOptions {
            method: method.name().to_owned(),
            accuracy: Accepted {
                setting: arguments.accuracy.accuracy.clone().unwrap_or_default(),
                max_error: arguments.accuracy.max_error,
            },
            samples,
            initial: arguments.initial.unwrap_or(defaults.initial),
            batch: defaults.batch,
            max_evaluations: arguments.max_evaluations.unwrap_or(defaults.max_evaluations),
            seed: arguments.seed.unwrap_or(defaults.seed),
            stated_errors: arguments.stated_errors.unwrap_or(StatedErrorsName::Fitted),
        };
        if !monte_carlo {
            let at_least = format!("at least the initial design, --initial {}", options.initial);
            for (option, value) in
                [("--samples", options.samples), ("--max-evaluations", options.max_evaluations)]
            {
                if value < options.initial {
                    return Err(CommandError::Option { option, value, allowed: at_least });
                }
            }
        }
        Ok(options)
    }

    /// What the study is asked to do.
    pub fn settings(&self) -> Settings {
        let monte_carlo = self.method == Method::MonteCarlo { samples: 0 }.name();
        let method =
            if monte_carlo { Method::MonteCarlo { samples: self.samples } } else { Method::ActiveLearning };
        let study = StudySettings {
            population: self.samples,
            initial: self.initial,
            batch: self.batch,
            max_evaluations: self.max_evaluations,
            seed: self.seed,
        };
        let stated_errors = match self.stated_errors {
            StatedErrorsName::Ignored => StatedErrors::Ignored,
            StatedErrorsName::Fitted => StatedErrors::Fitted,
            StatedErrorsName::Full => StatedErrors::Full,
        };
        let Accepted { setting, max_error } = self.accuracy.clone();
        Settings { study, method, accuracy: setting, max_error, targets: Targets::default(), stated_errors }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    fn options(arguments: RunArguments) -> Result<StudyOptions, CommandError> {
        StudyOptions::new(&arguments, SceneSource::builtin("four-bar").unwrap().nominal())
    }

    #[test]
    fn the_command_line_goes_before_the_scene() {
        let scene = SceneSource::builtin("four-bar").unwrap().nominal().study;
        let found = options(RunArguments { initial: Some(20), seed: Some(9), ..Default::default() }).unwrap();
        assert_eq!((found.initial, found.seed, found.samples), (20, 9, scene.population));
        assert_eq!(found.settings().study.max_evaluations, scene.max_evaluations);
        let method = Some(MethodName::MonteCarlo);
        assert_eq!(
            options(RunArguments { method, ..Default::default() }).unwrap().samples,
            scene.max_evaluations
        );
    }

    #[test]
    fn a_resumed_study_reads_the_very_knobs_that_were_found() {
        let mut found = options(RunArguments::default()).unwrap();
        // JSON returns the tolerance of this one with another last bit.
        let setting = "draft+step-x1.41".parse().unwrap();
        found.accuracy = Accepted { setting, max_error: Some(0.01) };
        let kept = serde_json::to_string(&found).unwrap();
        let read = |text: &str| {
            let read: StudyOptions = serde_json::from_str(text).unwrap();
            StudyOptions { accuracy: read.accuracy.clone().exact(), ..read }
        };
        let resumed = read(&kept);
        assert_eq!(resumed, found);
        // A name that has come to stand for something else does not change a study.
        let other = read(&kept.replace("\"cycle_jump\":8000", "\"cycle_jump\":4001"));
        assert_eq!(other.accuracy.setting.accuracy.cycle_jump, 4001);
        let settings = resumed.settings();
        assert_eq!((settings.accuracy, settings.max_error), (found.accuracy.setting, Some(0.01)));
    }

    #[test]
    fn budgets_below_the_initial_design_are_refused() {
        let error = options(RunArguments { initial: Some(200), ..Default::default() }).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("--max-evaluations 120"), "{error}");
    }
}
