//! Settings of one study: the scene's defaults, changed by the command line, checked here, and stored in the campaign
//! file, so that `resume` repeats the same study.
//!
//! The levels of accuracy that a study's settings name, for its scene.

use super::finer_levels::FinerLevels;
use crate::statistics::learning::{LearningFunction, StoppingTargets};
use crate::statistics::named::named;
use crate::statistics::surrogate::{FormSettings, StatedErrors};
use common::accuracy::{Accuracy, NamedAccuracy};
use common::scene::{Scene, StudySettings};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Largest Monte Carlo population: 480 MB at 30 variables.
pub const LARGEST_POPULATION: usize = 2_000_000;

/// Default memory for the population and its cached predictions [MB].
const MEMORY: usize = 2000;

/// Fewest evaluations from which a surrogate is fitted.
pub(super) const SMALLEST_DESIGN: usize = 3;

/// Most random variables, and most outputs: columns of a table of the campaign file, one or two of which are its own.
const MOST_COLUMNS: usize = 1998;

/// Default share of failed evaluations above which a study ends [1].
const MAX_FAILED: f64 = 0.2;

/// Factor by which the time steps of a second attempt are shorter [1].
const STRICTER: f64 = 1.5;

/// How the reliability is computed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Method {
    /// Surrogates and active learning over a Monte Carlo population.
    #[default]
    ActiveLearning,
    /// Active learning as published (AK-MCS), with none of the additions of this program.
    AkMcs,
    /// Direct simulation of every point of a Monte Carlo population.
    MonteCarlo,
    /// Direct simulation of every point of a Latin hypercube.
    LatinHypercube,
}

named!(Method { ActiveLearning = "ak", AkMcs = "ak-mcs", MonteCarlo = "monte-carlo", LatinHypercube = "latin-hypercube" });

impl Method {
    /// True if the method learns surrogates.
    pub fn learns(self) -> bool {
        matches!(self, Self::ActiveLearning | Self::AkMcs)
    }
}

/// Accuracy of a study's evaluations, and the error budget it was chosen for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyAccuracy {
    /// The accuracy, by name and with all its parameters.
    pub setting: NamedAccuracy,
    /// Error budget as a share of the limits [1]; `None` if the accuracy was given by name.
    pub max_error: Option<f64>,
}

/// Settings of one study; each of them may change its result. The fields are the keys of the campaign file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Method of the reliability analysis.
    pub method: Method,
    /// Accuracy of the evaluations.
    pub accuracy: StudyAccuracy,
    /// Points of the Monte Carlo population (active learning), or evaluations (the other methods).
    pub samples: usize,
    /// Evaluations of the initial design, the nominal point included.
    pub initial: usize,
    /// Evaluations under way at once after the initial design; half of them are proposed together, see
    /// [`Settings::chunk`].
    pub batch: usize,
    /// Budget of evaluations, failed ones included.
    pub max_evaluations: usize,
    /// Seed of every random draw.
    pub seed: u64,
    /// Use of the numerical errors that evaluations state.
    pub stated_errors: StatedErrors,
    /// Learning function of active learning.
    pub learning: LearningFunction,
    /// Kernel and trend of the surrogates, as far as they are fixed.
    #[serde(flatten)]
    pub forms: FormSettings,
    /// Share of failed evaluations above which the study ends [1].
    pub max_failed: f64,
    /// Half width of the whole 95 % interval of every R(n) at which a study may stop [1]; `None` for [`StoppingTargets::default`].
    pub target_error: Option<f64>,
    /// Memory for the population and its cached predictions [MB]. Predictions that do not fit are computed anew in every
    /// round, which changes their last bits.
    #[serde(default = "memory", skip_serializing_if = "is_default_memory")]
    pub memory: usize,
    /// Sizes to which the population of active learning grows, one after the other, each time learning has ended: those
    /// of later legs (`resume --samples`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub larger_populations: Vec<usize>,
    /// Samples of an own design of experiments `(initial - 1, d)` [SI], which take the place of the initial Latin hypercube; empty without one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub initial_samples: Vec<Vec<f64>>,
    /// Levels of accuracy finer than the working one (active learning). Campaign files written before this setting existed have none.
    #[serde(default, skip_serializing_if = "FinerLevels::is_none")]
    pub levels: FinerLevels,
    /// Whether results that exist are those of a study of rare failures: their population is conditional at once, if it has to be.
    #[serde(skip)]
    pub is_rare: bool,
}

fn memory() -> usize {
    MEMORY
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_default_memory(memory: &usize) -> bool {
    *memory == MEMORY
}

impl Default for Settings {
    /// Settings of a scene of few variables without a section `[study]`.
    fn default() -> Self {
        Self::from(StudySettings::for_variables(0))
    }
}

impl From<&Scene> for Settings {
    /// The defaults of a scene: active learning with its `[study]` and its accuracy.
    fn from(scene: &Scene) -> Self {
        let names = scene.simulator.as_ref().map_or(&[][..], |simulator| &simulator.levels);
        let (setting, levels) = if let [working, finer @ ..] = names {
            // Names alone: the numbers of the accuracy are those of the built-in simulator.
            let named = |name: &String| NamedAccuracy { name: name.clone(), ..scene.accuracy.clone() };
            (named(working), FinerLevels::Named(finer.iter().map(named).collect()))
        } else {
            // A checked scene without levels has the default ones.
            let levels = FinerLevels::of_names(&scene.levels);
            levels.unwrap_or_else(|_| (scene.accuracy.clone(), FinerLevels::Halved))
        };
        let accuracy = StudyAccuracy { setting, max_error: None };
        let settings = Self { accuracy, levels, ..Self::from(scene.study) };
        Self { stated_errors: settings.default_noise(scene), ..settings }
    }
}

impl From<StudySettings> for Settings {
    fn from(study: StudySettings) -> Self {
        Self {
            method: Method::default(),
            accuracy: StudyAccuracy::default(),
            samples: study.population,
            initial: study.initial,
            batch: study.batch,
            max_evaluations: study.max_evaluations,
            seed: study.seed,
            stated_errors: StatedErrors::default(),
            learning: LearningFunction::default(),
            forms: FormSettings::default(),
            max_failed: MAX_FAILED,
            target_error: None,
            memory: MEMORY,
            larger_populations: Vec::new(),
            initial_samples: Vec::new(),
            levels: FinerLevels::None,
            is_rare: false,
        }
    }
}

/// A setting that makes no study.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("study setting {key} = {value}: {allowed}")]
pub struct SettingError {
    /// Key of the setting, as in the campaign file.
    pub key: &'static str,
    /// Value of the setting.
    pub value: String,
    /// Allowed values, in words.
    pub allowed: String,
}

impl Settings {
    /// The settings stored in a campaign file.
    ///
    /// # Errors
    /// The error of a missing key or an unknown value.
    pub fn from_stored(stored: &serde_json::Value) -> serde_json::Result<Self> {
        Self::deserialize(stored)
    }

    /// Settings of a scene of `variables` random variables without a section `[study]`.
    pub fn for_variables(variables: usize) -> Self {
        Self::from(StudySettings::for_variables(variables))
    }

    /// Number of samples in the last leg: points of the population, or evaluations of direct simulation.
    pub fn population(&self) -> usize {
        self.larger_populations.last().copied().unwrap_or(self.samples)
    }

    /// Bounds of the stopping rules.
    pub fn targets(&self) -> StoppingTargets {
        self.target_error.map_or_else(StoppingTargets::default, StoppingTargets::from_half_width)
    }

    /// Points proposed together: half a batch, so that one half is simulated while the other is learned from.
    /// Chunk k + 2 is proposed from the outcomes up to chunk k and the points, not the outcomes, of chunk k + 1. This
    /// look-ahead is fixed by the settings, so the proposed points do not depend on the order of the outcomes.
    pub fn chunk(&self) -> usize {
        self.batch.div_ceil(2)
    }

    /// Accuracy at which a failed evaluation is repeated: time steps shorter by [`STRICTER`]. `None` with direct
    /// simulation and with a scene's own simulator, which has no such setting.
    pub(super) fn stricter(&self, scene: &Scene) -> Option<Accuracy> {
        let repeats = self.method.learns() && scene.simulator.is_none();
        repeats.then(|| self.evaluated(scene).refined(STRICTER))
    }

    /// Use of the stated errors unless one is asked for: none where finer levels measure the numerical error of a mechanism, nor as published.
    pub fn default_noise(&self, scene: &Scene) -> StatedErrors {
        let is_measured = scene.simulator.is_none() && !self.finer_levels(scene).is_empty();
        if is_measured || self.method == Method::AkMcs { StatedErrors::Ignored } else { StatedErrors::Fitted }
    }

    /// The working accuracy as the tasks have it: the error of wear and control points, a part of the work, is left to finer levels that
    /// measure it, unless it is used as noise.
    pub fn evaluated(&self, scene: &Scene) -> Accuracy {
        let wear_error = self.stated_errors != StatedErrors::Ignored || self.finer_levels(scene).is_empty();
        Accuracy { wear_error, ..self.accuracy.setting.accuracy }
    }

    /// Bound on evaluations; direct simulation adds the nominal point to its samples.
    pub(super) fn budget(&self) -> usize {
        match self.method {
            Method::ActiveLearning | Method::AkMcs => self.max_evaluations,
            Method::MonteCarlo | Method::LatinHypercube => self.samples + 1,
        }
    }

    /// Checks that the settings and the scene make a study.
    ///
    /// # Errors
    /// The first [`SettingError`].
    pub fn check(&self, scene: &Scene) -> Result<(), SettingError> {
        let refuse = |key, value: &dyn ToString, allowed: String| {
            Err(SettingError { key, value: value.to_string(), allowed })
        };
        if scene.limit_states.is_empty() || scene.variables.is_empty() {
            let value = format!("{} and {}", scene.limit_states.len(), scene.variables.len());
            let allowed = "a study needs at least one limit state and one random variable".to_owned();
            return refuse("limit_states and variables", &value, allowed);
        }
        for (key, count) in [("variables", scene.variables.len()), ("outputs", scene.outputs.len())] {
            if count > MOST_COLUMNS {
                return refuse(key, &count, format!("a campaign file holds at most {MOST_COLUMNS}"));
            }
        }
        if self.samples == 0 {
            return refuse("samples", &0, "at least 1".to_owned());
        }
        if !self.method.learns() {
            return Ok(());
        }
        if self.initial < SMALLEST_DESIGN {
            if let given @ 1.. = self.initial_samples.len() {
                let allowed = format!("at least {} samples", SMALLEST_DESIGN - 1);
                return refuse("initial_from", &given, allowed);
            }
            return refuse("initial", &self.initial, format!("at least {SMALLEST_DESIGN}"));
        }
        for (key, value) in [("samples", self.samples), ("max_evaluations", self.max_evaluations)] {
            if value < self.initial {
                let allowed = format!("at least the initial design, initial = {}", self.initial);
                return refuse(key, &value, allowed);
            }
        }
        if self.population() > LARGEST_POPULATION {
            return refuse("samples", &self.population(), format!("at most {LARGEST_POPULATION}"));
        }
        let functions = [LearningFunction::Coupled, LearningFunction::Gain];
        if self.learning == functions[usize::from(self.method == Method::AkMcs)] {
            let allowed = "gain or u with ak, u or coupled with ak-mcs".to_owned();
            return refuse("learning", &self.learning, allowed);
        }
        if self.batch == 0 {
            return refuse("batch", &0, "at least 1".to_owned());
        }
        Ok(())
    }

    /// The levels finer than the working accuracy, from the coarser to the finer: none with direct simulation, nor with a scene's own
    /// simulator that names none.
    pub fn finer_levels(&self, scene: &Scene) -> Vec<NamedAccuracy> {
        let has_none = scene.simulator.as_ref().is_some_and(|simulator| simulator.levels.is_empty());
        if self.method != Method::ActiveLearning || has_none {
            return vec![];
        }
        match &self.levels {
            FinerLevels::None => vec![],
            FinerLevels::Named(levels) => levels.clone(),
            FinerLevels::Halved => {
                let first = self.accuracy.setting.finer();
                let second = first.as_ref().and_then(NamedAccuracy::finer);
                first.into_iter().chain(second).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::surrogate::Kernel;
    use common::scene::SceneSource;

    /// Settings as campaign files have held them since target errors were introduced.
    const STORED: &str = r#"{"method":"ak","accuracy":ACCURACY,"samples":4000,"initial":16,"batch":12,"max_evaluations":40,"seed":3,"stated_errors":"ignored","learning":"gain","kernel":"matern52","trend":"auto","max_failed":0.2,"target_error":null,"levels":"halved"}"#;

    fn settings() -> Settings {
        let source = SceneSource::builtin("four-bar").unwrap();
        let mut settings = Settings::from(source.nominal());
        let setting = "draft+step-x1.41".parse().unwrap();
        settings.accuracy = StudyAccuracy { setting, max_error: Some(0.01) };
        (settings.samples, settings.initial, settings.max_evaluations) = (4000, 16, 40);
        (settings.batch, settings.seed, settings.forms.kernel) = (12, 3, Some(Kernel::Matern52));
        settings
    }

    fn read(text: &str) -> Settings {
        Settings::from_stored(&serde_json::from_str(text).unwrap()).unwrap()
    }

    #[test]
    fn stored_settings_are_read_to_the_last_bit() {
        let stored = serde_json::to_string(&settings()).unwrap();
        assert_eq!(read(&stored), settings());
        Method::ALL.iter().for_each(|method| assert_eq!(method.name().parse(), Ok(*method)));
        // A name that stands for another accuracy by now does not change a study.
        let other = read(&stored.replace("\"cycle_jump\":8000", "\"cycle_jump\":4001"));
        assert_eq!(other.accuracy.setting.accuracy.cycle_jump, 4001);
    }

    #[test]
    fn the_stored_form_does_not_change() {
        let settings = settings();
        let accuracy = serde_json::to_string(&settings.accuracy).unwrap();
        assert_eq!(serde_json::to_string(&settings).unwrap(), STORED.replace("ACCURACY", &accuracy));
    }

    #[test]
    fn budgets_below_the_initial_design_are_refused() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let refused = |settings: Settings| settings.check(source.nominal()).unwrap_err();
        let error = refused(Settings { initial: 200, ..settings() });
        assert_eq!((error.key, error.value.as_str()), ("max_evaluations", "40"));
        assert_eq!(refused(Settings { initial: 2, ..settings() }).key, "initial");
        assert_eq!(refused(Settings { batch: 0, ..settings() }).key, "batch");
        assert_eq!(refused(Settings { learning: LearningFunction::Coupled, ..settings() }).key, "learning");
        let direct = Settings { method: Method::MonteCarlo, samples: 5, ..settings() };
        assert_eq!(direct.check(source.nominal()), Ok(()));
        assert_eq!(refused(Settings { samples: 0, ..direct }).key, "samples");
    }

    #[test]
    fn issue_more_variables_than_a_campaign_file_holds_are_refused() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let mut scene = source.nominal().clone();
        scene.variables = vec![scene.variables[0].clone(); MOST_COLUMNS + 1];
        let error = settings().check(&scene).unwrap_err();
        assert_eq!(error.to_string(), "study setting variables = 1999: a campaign file holds at most 1998");
    }

    #[test]
    fn finer_levels_follow_the_working_accuracy_unless_they_are_named() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let scene = source.nominal();
        let mut settings = Settings::from(scene);
        settings.accuracy.setting = "draft".parse().unwrap();
        let [finer, finest] = &settings.finer_levels(scene)[..] else { panic!("two levels") };
        assert_eq!((finer.accuracy.cycle_jump, finer.accuracy.points), (4000, 2));
        assert!(!settings.evaluated(scene).wear_error);
        assert_eq!((finest.accuracy.cycle_jump, finest.accuracy.points), (2000, 4));
        let levels: [NamedAccuracy; 3] =
            ["draft", "balanced", "reference"].map(|name| name.parse().expect(name));
        let (working, finer) = FinerLevels::of_names(&levels).unwrap();
        let stored = serde_json::to_string(&finer).unwrap();
        assert_eq!(serde_json::from_str::<FinerLevels>(&stored).unwrap(), finer);
        settings.levels = finer;
        assert_eq!((working, settings.finer_levels(scene)), (levels[0].clone(), levels[1..].to_vec()));
        let (_, none) = FinerLevels::of_names(&levels[..1]).unwrap();
        assert!(none.is_none() && FinerLevels::of_names(&[]).is_err());
        settings.stated_errors = StatedErrors::Full;
        assert!(settings.evaluated(scene).wear_error);
        let direct = Settings { method: Method::MonteCarlo, ..settings };
        assert_eq!(direct.finer_levels(scene), []);
    }
}
