//! Options of a study, and the settings they make of a scene's defaults.

use super::learn::confidence as confidence_level;
use super::monitor::MonitorArguments;
use super::scene_options::SetArguments;
use super::shared::{ReportTexts, word, word_or_auto};
use super::{AccuracyArguments, FarmArguments, accuracy_name, positive, seed, share};
use clap::Args;
use common::accuracy::{LevelsError, NamedAccuracy};
use common::scene::Scene;
use coordinator::statistics::learning::LearningFunction;
use coordinator::statistics::surrogate::{Kernel, StatedErrors, Trend};
use coordinator::study::{FinerLevels, Method, SettingError, Settings};
use std::path::PathBuf;

/// A setting that may be left to the program: `None` for `auto`.
type OrAuto<T> = Option<T>;

/// Options of `coordinator run`.
#[derive(Debug, Clone, Default, Args, PartialEq)]
pub struct RunArguments {
    #[command(flatten)]
    pub values: SetArguments,
    /// Make a quantity, a mean, a spread or a threshold a design variable, e.g. parameters.clearance='18 um..30 um': the study
    /// then answers for every design within the range, see `designs`; up to three
    #[arg(long, value_name = "KEY=LOWER..UPPER", help_heading = "Scene")]
    pub design: Vec<String>,
    /// Variants of the model after the study, a TOML file of [[variants]] with `name`, `set` (keys of the scene with their values) and
    /// `accuracy`: each by its difference from the study at some of its samples (ak)
    #[arg(long, value_name = "FILE.toml", help_heading = "Scene")]
    pub variants: Option<PathBuf>,
    /// R and the lives at this confidence as well, with what the samples of measured variables leave open, in confidence.html
    #[arg(long, value_name = "SHARE", value_parser = confidence_level, help_heading = "Output")]
    pub confidence: Option<f64>,
    #[command(flatten)]
    pub method: MethodArguments,
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Levels of accuracy, e.g. draft,balanced+jump-2000,reference (ak): surrogates learn at the first one, pairs of evaluations at the
    /// same points correct their results to the second and third. One level alone: the errors that evaluations state remain [default: the
    /// scene's, else two levels beyond the accuracy, each with half of every length: `halved-1`, `halved-2`]
    #[arg(
        long,
        value_name = "A,B,C",
        value_delimiter = ',',
        value_parser = accuracy_name(),
        hide_possible_values = true,
        conflicts_with_all = ["accuracy", "max_error"],
        help_heading = "Accuracy"
    )]
    pub levels: Vec<NamedAccuracy>,
    #[command(flatten)]
    pub farm: FarmArguments,
    /// Folder for the results, created if missing [default: hingewise-SCENE, or the next free number after it]
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub texts: ReportTexts,
    #[command(flatten)]
    pub monitor: MonitorArguments,
}

/// Options of `coordinator resume`; those of the farm and of the monitor do not change the result of the study.
#[derive(Debug, Clone, Args, PartialEq)]
pub struct ResumeArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Repeat the evaluations of this worker, e.g. of a faulty machine
    #[arg(long, value_name = "WORKER")]
    pub distrust: Vec<String>,
    /// Variants of the model, in the place of those before, as with `run --variants`
    #[arg(long, value_name = "FILE.toml")]
    pub variants: Option<PathBuf>,
    #[command(flatten)]
    pub extension: ExtensionArguments,
    #[command(flatten)]
    pub farm: FarmArguments,
    #[command(flatten)]
    pub monitor: MonitorArguments,
}

/// Settings with which a study goes on; they start another leg of it.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Go on with other settings")]
pub struct ExtensionArguments {
    /// Most evaluations, more than before (ak)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub max_evaluations: Option<usize>,
    /// Points of a larger population (ak), or more evaluations (monte-carlo)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub samples: Option<usize>,
    /// Half width of the whole 95 % interval of every R(n) at which the study may stop (ak)
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub target_error: Option<f64>,
    /// Share of failed evaluations above which the study ends
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub max_failed: Option<f64>,
}

impl ExtensionArguments {
    /// The settings with which a study of these settings goes on after `done` evaluations.
    ///
    /// # Errors
    /// A setting that the study's method does not have, or one below what is done.
    pub fn extended(&self, settings: &Settings, done: usize) -> Result<Settings, SettingError> {
        let mut extended = settings.clone();
        replace(&mut extended.max_failed, self.max_failed);
        let refuse = |key, value: String, allowed: String| Err(SettingError { key, value, allowed });
        let (method, learns) = (settings.method, settings.method.learns());
        let budget = self.max_evaluations.filter(|_| !learns);
        let error = self.target_error.filter(|_| method != Method::ActiveLearning);
        let budget = budget.map(|budget| ("max_evaluations", budget.to_string()));
        let error = error.map(|error| ("target_error", error.to_string()));
        if let Some((key, value)) = budget.or(error) {
            return refuse(key, value, format!("none with --method {}; --samples extends it", method.name()));
        }
        if let Some(budget) = self.max_evaluations.filter(|budget| *budget < done) {
            return refuse(
                "max_evaluations",
                budget.to_string(),
                format!("at least the {done} that are done"),
            );
        }
        replace(&mut extended.max_evaluations, self.max_evaluations);
        extended.target_error = self.target_error.or(extended.target_error);
        let present = settings.population();
        match (self.samples.filter(|samples| *samples != present), method) {
            (None, _) => Ok(extended),
            (Some(samples), Method::LatinHypercube) => {
                let allowed =
                    format!("a Latin hypercube of {present} samples cannot be enlarged; start a new study");
                refuse("samples", samples.to_string(), allowed)
            }
            (Some(samples), _) if samples < present => {
                refuse("samples", samples.to_string(), format!("at least the {present} of the study"))
            }
            (Some(samples), Method::MonteCarlo) => Ok(Settings { samples, ..extended }),
            (Some(samples), Method::ActiveLearning | Method::AkMcs) => {
                extended.larger_populations.push(samples);
                Ok(extended)
            }
        }
    }
}

/// Method of a study and size of its samples.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Method")]
pub struct MethodArguments {
    /// `ak` learns surrogates by active learning, `ak-mcs` as published, with none of this program's additions; the others
    /// simulate every sample [default: ak]
    #[arg(long, value_parser = word::<Method>(Method::NAMES))]
    pub method: Option<Method>,
    /// Points of the Monte Carlo population that the surrogates classify (ak), or evaluations (the other methods)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub samples: Option<usize>,
    /// Seed of every random draw; the same seed gives the same result with any number of workers
    #[arg(long, value_name = "N", value_parser = seed)]
    pub seed: Option<u64>,
    /// Share of failed evaluations above which the study ends, e.g. 20% [default: 20%]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub max_failed: Option<f64>,
    /// Evaluations of the initial design (ak)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub initial: Option<usize>,
    /// Samples of an own design of experiments as initial design: a CSV file with a column for every variable under its name, with its unit in
    /// the head, e.g. `gap [um]`, or in SI (ak)
    #[arg(long, value_name = "FILE.csv", conflicts_with = "initial")]
    pub initial_from: Option<PathBuf>,
    /// Most evaluations; those at finer levels come on top (ak)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub max_evaluations: Option<usize>,
    /// Evaluations under way at once after the initial design, half of them proposed together (ak). It changes the
    /// result, so it does not follow the number of workers
    #[arg(long, value_name = "N", value_parser = positive)]
    pub batch: Option<usize>,
    /// Learning function: expected gain over all points (ak), U of one point, or U weighted by dominance (ak-mcs) [default: gain, or u]
    #[arg(long, value_parser = word::<LearningFunction>(LearningFunction::NAMES))]
    pub learning: Option<LearningFunction>,
    /// Half width of the whole 95 % interval of every R(n), numerical error included, at which the study may stop (ak) [default: a
    /// surrogate error of 0.006, and 2 % of P_f, and a numerical error no larger than that of the surrogates]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub target_error: Option<f64>,
    /// Correlation kernel of the surrogates (ak) [default: auto, by cross-validation]
    #[arg(long, value_parser = word_or_auto::<Kernel>(&Kernel::NAMES))]
    pub kernel: Option<OrAuto<Kernel>>,
    /// Trend of the surrogates (ak) [default: auto, by cross-validation]
    #[arg(long, value_parser = word_or_auto::<Trend>(&Trend::NAMES))]
    pub trend: Option<OrAuto<Trend>>,
    /// Noise of the surrogates from the stated numerical errors: ignored, their shape with a fitted level, or taken in
    /// full as standard deviations (ak) [default: ignored with levels, else fitted]
    #[arg(long, value_parser = word::<StatedErrors>(StatedErrors::NAMES))]
    pub stated_errors: Option<StatedErrors>,
    /// Memory for the population and its cached predictions [MB]; a smaller one costs time (ak) [default: 2000]
    #[arg(long, value_name = "MB", value_parser = positive)]
    pub memory: Option<usize>,
}

impl MethodArguments {
    /// The options given that the method does not have: those of surrogates, and of the additions of `ak` to the published method.
    pub fn without_effect(&self) -> Vec<&'static str> {
        let given = [
            ("--initial", self.initial.is_some()),
            ("--max-evaluations", self.max_evaluations.is_some()),
            ("--batch", self.batch.is_some()),
            ("--learning", self.learning.is_some()),
            ("--target-error", self.target_error.is_some()),
            ("--kernel", self.kernel.is_some()),
            ("--trend", self.trend.is_some()),
            ("--stated-errors", self.stated_errors.is_some()),
            ("--memory", self.memory.is_some()),
        ];
        let method = self.method.unwrap_or_default();
        let added = ["--batch", "--target-error", "--kernel", "--trend", "--stated-errors"];
        let has = |option| method == Method::ActiveLearning || method.learns() && !added.contains(&option);
        let idle = given.into_iter().filter(|(option, given)| *given && !has(*option));
        idle.map(|(option, _)| option).collect()
    }
}

impl RunArguments {
    /// Checks the levels, if any are given.
    ///
    /// # Errors
    /// [`SettingError`].
    pub fn check_levels(&self, scene: &Scene) -> Result<(), SettingError> {
        let refuse = |allowed: String| {
            let names: Vec<&str> = self.levels.iter().map(|level| level.name.as_str()).collect();
            Err(SettingError { key: "levels", value: names.join(","), allowed })
        };
        if self.levels.is_empty() {
            return Ok(());
        }
        if scene.simulator.is_some() {
            return refuse(
                "those of the simulator are `levels` of the scene's section [simulator]".to_owned(),
            );
        }
        match LevelsError::of(&self.levels) {
            Some(error) => refuse(error.to_string()),
            None if self.method.method.unwrap_or_default() != Method::ActiveLearning
                && self.levels.len() > 1 =>
            {
                refuse("one, unless surrogates learn from them with --method ak".to_owned())
            }
            None => Ok(()),
        }
    }

    /// Options on the accuracy of the surrogates' evaluations: those given, or the first of the levels.
    pub fn working_accuracy(&self) -> AccuracyArguments {
        let accuracy = self.levels.first().or(self.accuracy.accuracy.as_ref()).cloned();
        AccuracyArguments { accuracy, ..self.accuracy }
    }

    /// Settings of a study of `scene`: its defaults, changed by the options. An accuracy for an error budget is still
    /// to be found.
    pub fn settings(&self, scene: &Scene) -> Settings {
        let mut settings = Settings::from(scene);
        if self.accuracy != AccuracyArguments::default() {
            // The scene's levels begin at another accuracy.
            settings.levels = FinerLevels::Halved;
        }
        if let Ok((working, finer)) = FinerLevels::of_names(&self.levels) {
            (settings.accuracy.setting, settings.levels) = (working, finer);
        }
        replace(&mut settings.accuracy.setting, self.accuracy.accuracy.clone());
        settings.accuracy.max_error = self.accuracy.max_error;
        let mut method = self.method.clone();
        settings.method = method.method.unwrap_or_default();
        if settings.method != Method::ActiveLearning && self.levels.is_empty() {
            // Without levels the accuracy of single evaluations counts.
            settings.accuracy.setting =
                self.accuracy.accuracy.clone().unwrap_or_else(|| scene.accuracy.clone());
        }
        if settings.method == Method::AkMcs {
            settings.make_as_published();
            (method.batch, method.kernel, method.trend, method.stated_errors) = Default::default();
        }
        if !settings.method.learns() {
            // Simulating a whole population would take too long: the budget is the default.
            settings.samples = settings.max_evaluations;
        }
        replace(&mut settings.samples, method.samples);
        replace(&mut settings.seed, method.seed);
        replace(&mut settings.max_failed, method.max_failed);
        replace(&mut settings.initial, method.initial);
        replace(&mut settings.max_evaluations, method.max_evaluations);
        replace(&mut settings.batch, method.batch);
        replace(&mut settings.learning, method.learning);
        replace(&mut settings.forms.kernel, method.kernel);
        replace(&mut settings.forms.trend, method.trend);
        settings.stated_errors = method.stated_errors.unwrap_or_else(|| settings.default_noise(scene));
        replace(&mut settings.memory, method.memory);
        settings.target_error = method.target_error.or(settings.target_error);
        settings
    }
}

fn replace<T>(setting: &mut T, option: Option<T>) {
    if let Some(value) = option {
        *setting = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;
    use coordinator::statistics::learning::StoppingTargets;

    #[test]
    fn options_take_precedence_over_the_scene() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let scene = source.nominal();
        let method = MethodArguments {
            initial: Some(20),
            kernel: Some(Some(Kernel::Matern52)),
            target_error: Some(0.003),
            seed: Some(9),
            ..Default::default()
        };
        let found = RunArguments { method, ..Default::default() }.settings(scene);
        assert_eq!((found.initial, found.seed, found.samples), (20, 9, scene.study.population));
        assert_eq!(found.max_evaluations, scene.study.max_evaluations);
        assert_eq!((found.forms.kernel, found.forms.trend), (Some(Kernel::Matern52), None));
        assert_eq!(found.targets(), StoppingTargets::from_half_width(0.003));
    }

    #[test]
    fn levels_are_the_working_accuracy_and_finer_ones() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let scene = source.nominal();
        let arguments = |names: &[&str]| RunArguments {
            levels: names.iter().map(|name| name.parse().expect(name)).collect(),
            ..Default::default()
        };
        let given = arguments(&["draft", "balanced", "reference"]);
        let settings = given.settings(scene);
        let finer: Vec<String> = settings.finer_levels(scene).into_iter().map(|level| level.name).collect();
        assert_eq!((settings.accuracy.setting.name.as_str(), finer.len()), ("draft", 2));
        assert_eq!(finer, ["balanced", "reference"]);
        assert_eq!(given.working_accuracy().accuracy.unwrap().name, "draft");
        assert_eq!((given.check_levels(scene), arguments(&["draft"]).check_levels(scene)), (Ok(()), Ok(())));
        assert!(arguments(&["draft"]).settings(scene).finer_levels(scene).is_empty());
        let refused = arguments(&["reference", "draft"]).check_levels(scene).unwrap_err().to_string();
        assert!(refused.contains("levels = reference,draft") && refused.contains("not finer"), "{refused}");
    }

    #[test]
    fn issue_options_of_learning_did_nothing_in_silence() {
        let given = |method| MethodArguments {
            method: Some(method),
            initial: Some(20),
            batch: Some(2),
            seed: Some(2),
            ..MethodArguments::default()
        };
        assert_eq!(given(Method::MonteCarlo).without_effect(), ["--initial", "--batch"]);
        let of_error = MethodArguments { target_error: Some(0.01), ..given(Method::AkMcs) };
        assert_eq!(of_error.without_effect(), ["--batch", "--target-error"]);
    }

    #[test]
    fn an_extension_keeps_what_is_done() {
        let learning = Settings { samples: 4000, max_evaluations: 40, ..Settings::default() };
        let more =
            ExtensionArguments { max_evaluations: Some(60), samples: Some(9000), ..Default::default() };
        let extended = more.extended(&learning, 40).unwrap();
        assert_eq!((extended.samples, extended.population(), extended.max_evaluations), (4000, 9000, 60));
        assert_eq!(ExtensionArguments::default().extended(&learning, 40), Ok(learning.clone()));
        assert_eq!(more.extended(&extended, 60), Ok(extended.clone()));

        let refused = |arguments: &ExtensionArguments, settings: &Settings, key: &str| {
            assert_eq!(arguments.extended(settings, 50).unwrap_err().key, key);
        };
        let fewer = |samples| ExtensionArguments { samples: Some(samples), ..Default::default() };
        refused(
            &ExtensionArguments { max_evaluations: Some(49), ..Default::default() },
            &learning,
            "max_evaluations",
        );
        refused(&fewer(3999), &learning, "samples");
        let of_error = ExtensionArguments { target_error: Some(0.01), ..Default::default() };
        refused(&of_error, &Settings { method: Method::AkMcs, ..learning.clone() }, "target_error");
        let direct = Settings { method: Method::MonteCarlo, samples: 100, ..Settings::default() };
        assert_eq!(fewer(150).extended(&direct, 101).unwrap().samples, 150);
        refused(&fewer(99), &direct, "samples");
        refused(&more, &direct, "max_evaluations");
        refused(&fewer(150), &Settings { method: Method::LatinHypercube, ..direct }, "samples");
    }

    #[test]
    fn direct_simulation_takes_the_budget_for_its_samples() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let method = MethodArguments { method: Some(Method::MonteCarlo), ..Default::default() };
        let found = RunArguments { method, ..Default::default() }.settings(source.nominal()).samples;
        assert_eq!(found, source.nominal().study.max_evaluations);
    }
}
