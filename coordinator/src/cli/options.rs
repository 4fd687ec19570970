//! What a study is run with: the scene's defaults, changed by the command line, checked, and kept in the campaign
//! file so that `resume` repeats exactly that.

use super::accuracy::Accepted;
use super::arguments::RunArguments;
use super::error::CommandError;
use super::names::{KernelName, LearningName, MethodName, StatedErrorsName, TrendName};
use common::scene::{Scene, StudySettings};
use coordinator::statistics::learning::{LearningFunction, Targets};
use coordinator::statistics::surrogate::{FormSettings, Kernel, StatedErrors, Trend};
use coordinator::study::{FAILED_SHARE, Method, Settings};
use serde::{Deserialize, Serialize};

/// Settings of a study; each of them may change its result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyOptions {
    /// `ak`, `monte-carlo` or `latin-hypercube`.
    pub method: String,
    /// Accuracy of the evaluations, with every knob: what it was once, whatever its name stands for later.
    pub accuracy: Accepted,
    /// Points of the population (ak) or simulations (monte-carlo).
    pub samples: usize,
    /// Simulations of the initial design.
    pub initial: usize,
    /// Simulations under way at once.
    pub batch: usize,
    /// Budget of simulations.
    pub max_evaluations: usize,
    /// Seed.
    pub seed: u64,
    /// What the surrogates make of stated errors; campaigns begun before there was a choice ignored them.
    #[serde(default)]
    pub stated_errors: StatedErrorsName,
    /// Which points are simulated next.
    #[serde(default)]
    pub learning: LearningName,
    /// Kernel of the surrogates.
    #[serde(default)]
    pub kernel: KernelName,
    /// Trend of the surrogates.
    #[serde(default)]
    pub trend: TrendName,
    /// Share of failed simulations above which the study ends [1].
    #[serde(default = "default_failed_share")]
    pub max_failed: f64,
    /// Surrogate error at which learning may stop [1]; campaigns begun before there was a choice have the default.
    #[serde(default)]
    pub target_error: Option<f64>,
}

fn default_failed_share() -> f64 {
    FAILED_SHARE
}

impl StudyOptions {
    /// Lays the command line over the scene's defaults. The accuracy for an error budget is still to be found.
    ///
    /// # Errors
    /// A combination that cannot be run.
    pub fn new(arguments: &RunArguments, scene: &Scene) -> Result<Self, CommandError> {
        let defaults = &scene.study;
        let direct = matches!(arguments.method, Some(MethodName::MonteCarlo | MethodName::LatinHypercube));
        // Simulating a whole population is what nobody can wait for: the budget is the default there.
        let default_samples = if direct { defaults.max_evaluations } else { defaults.population };
        let samples = arguments.samples.unwrap_or(default_samples);
        let method = match arguments.method {
            Some(MethodName::MonteCarlo) => Method::MonteCarlo { samples },
            Some(MethodName::LatinHypercube) => Method::LatinHypercube { samples },
            Some(MethodName::Ak) | None => Method::ActiveLearning,
        };
        let options = StudyOptions {
            method: method.name().to_owned(),
            accuracy: Accepted {
                setting: arguments.accuracy.accuracy.clone().unwrap_or_else(|| scene.accuracy.clone()),
                max_error: arguments.accuracy.max_error,
            },
            samples,
            initial: arguments.initial.unwrap_or(defaults.initial),
            batch: arguments.batch.unwrap_or(defaults.batch),
            max_evaluations: arguments.max_evaluations.unwrap_or(defaults.max_evaluations),
            seed: arguments.seed.unwrap_or(defaults.seed),
            stated_errors: arguments.stated_errors.unwrap_or(StatedErrorsName::Fitted),
            learning: arguments.learning.unwrap_or_default(),
            kernel: arguments.kernel.unwrap_or_default(),
            trend: arguments.trend.unwrap_or_default(),
            max_failed: arguments.max_failed.unwrap_or(FAILED_SHARE),
            target_error: arguments.target_error,
        };
        if !direct {
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
        let samples = self.samples;
        let direct = [Method::MonteCarlo { samples }, Method::LatinHypercube { samples }];
        let method =
            direct.into_iter().find(|method| method.name() == self.method).unwrap_or(Method::ActiveLearning);
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
        let learning = learning_function(self.learning);
        let Accepted { setting, max_error } = self.accuracy.clone();
        Settings {
            study,
            method,
            accuracy: setting,
            max_error,
            learning,
            failed_share: self.max_failed,
            targets: targets(self.target_error),
            forms: forms(self.kernel, self.trend),
            stated_errors,
        }
    }
}

/// Stopping rules for this surrogate error, the usual ones for none.
pub fn targets(error: Option<f64>) -> Targets {
    error.map_or_else(Targets::default, Targets::of_error)
}

/// What these names leave open of a surrogate's form.
pub fn forms(kernel: KernelName, trend: TrendName) -> FormSettings {
    let kernel = match kernel {
        KernelName::Auto => None,
        KernelName::Gaussian => Some(Kernel::Gaussian),
        KernelName::Matern52 => Some(Kernel::Matern52),
        KernelName::Matern32 => Some(Kernel::Matern32),
    };
    let trend = match trend {
        TrendName::Auto => None,
        TrendName::Constant => Some(Trend::Constant),
        TrendName::Linear => Some(Trend::Linear),
    };
    FormSettings { kernel, trend }
}

/// The learning function of a name.
pub fn learning_function(name: LearningName) -> LearningFunction {
    match name {
        LearningName::Gain => LearningFunction::Gain,
        LearningName::U => LearningFunction::U,
        LearningName::Eff => LearningFunction::Eff,
        LearningName::H => LearningFunction::H,
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
        let found = options(RunArguments { target_error: Some(0.003), ..Default::default() }).unwrap();
        assert_eq!(found.settings().targets.relative_error, 0.01);
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
