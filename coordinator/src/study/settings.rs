//! What a study is asked to do.

use super::{Plan, StudyError};
use crate::statistics::learning::{LearningFunction, Targets};
use crate::statistics::surrogate::{FormSettings, StatedErrors};
use common::accuracy::{Accuracy, NamedAccuracy};
use common::scene::{Scene, StudySettings};

/// Most points of a population: 480 MB at 30 variables.
const LARGEST_POPULATION: usize = 2_000_000;

/// Share of failed simulations that ends a study unless it is told otherwise.
pub const FAILED_SHARE: f64 = 0.2;

/// Factor by which the time steps of a second attempt are shorter.
const STRICTER: f64 = 1.5;

/// How reliability is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Surrogates and active learning over a Monte Carlo population.
    ActiveLearning,
    /// Direct simulation of the population's first points.
    MonteCarlo {
        /// How many.
        samples: usize,
    },
    /// Direct simulation of a Latin hypercube.
    LatinHypercube {
        /// How many.
        samples: usize,
    },
}

impl Method {
    /// The name in the summary and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::ActiveLearning => "ak",
            Self::MonteCarlo { .. } => "monte-carlo",
            Self::LatinHypercube { .. } => "latin-hypercube",
        }
    }
}

/// Settings of one study.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Sizes and seed; defaults are the scene's.
    pub study: StudySettings,
    /// Method.
    pub method: Method,
    /// Accuracy of the evaluations, for the summary: whoever evaluates has it already.
    pub accuracy: NamedAccuracy,
    /// Error budget that the accuracy was found for, if it was, as a share of the limits [1].
    pub max_error: Option<f64>,
    /// Which points are the most wanted.
    pub learning: LearningFunction,
    /// Share of failed simulations above which the study ends [1].
    pub failed_share: f64,
    /// Stopping rules of active learning.
    pub targets: Targets,
    /// What is left open of the surrogates' form.
    pub forms: FormSettings,
    /// What the surrogates make of the numerical errors that simulations state.
    pub stated_errors: StatedErrors,
}

impl Settings {
    /// The scene's own defaults with active learning.
    pub fn of(scene: &Scene, accuracy: NamedAccuracy) -> Self {
        Self {
            study: scene.study,
            method: Method::ActiveLearning,
            accuracy,
            max_error: None,
            learning: LearningFunction::default(),
            failed_share: FAILED_SHARE,
            targets: Targets::default(),
            forms: FormSettings::default(),
            stated_errors: StatedErrors::default(),
        }
    }

    /// The plan of the campaign.
    pub fn plan(&self, scene: &Scene) -> Plan {
        Plan {
            population: self.study.population,
            largest_population: LARGEST_POPULATION,
            initial: self.study.initial,
            batch: self.study.batch,
            max_evaluations: self.study.max_evaluations,
            seed: self.study.seed,
            learning: self.learning,
            targets: self.targets,
            forms: self.forms,
            stated_errors: self.stated_errors,
            retry: self.stricter(scene).is_some(),
            failed_share: self.failed_share,
        }
    }

    /// Setting at which a failed simulation is repeated: time steps shorter by half. Simulators that a scene names have
    /// no settings.
    pub(super) fn stricter(&self, scene: &Scene) -> Option<Accuracy> {
        let repeats = self.method == Method::ActiveLearning && scene.simulator.is_none();
        repeats.then(|| self.accuracy.accuracy.refined(STRICTER))
    }

    /// Bound on evaluations.
    pub(super) fn budget(&self) -> usize {
        match self.method {
            Method::ActiveLearning => self.study.max_evaluations,
            Method::MonteCarlo { samples } | Method::LatinHypercube { samples } => samples + 1,
        }
    }

    /// Refuses settings that do not make a study.
    pub(super) fn check(&self, scene: &Scene) -> Result<(), StudyError> {
        let refuse = |key, value: usize, allowed: String| {
            Err(StudyError::Setting { key, value: value.to_string(), allowed })
        };
        let s = &self.study;
        if scene.limit_states.is_empty() || scene.variables.is_empty() {
            let value = format!("{} and {}", scene.limit_states.len(), scene.variables.len());
            let allowed = "a study needs at least one limit state and one random variable".to_owned();
            return Err(StudyError::Setting { key: "limit_states and variables", value, allowed });
        }
        if let Method::MonteCarlo { samples } | Method::LatinHypercube { samples } = self.method {
            return if samples == 0 { refuse("samples", 0, "at least 1".to_owned()) } else { Ok(()) };
        }
        if s.initial < 3 {
            return refuse("initial", s.initial, "at least 3".to_owned());
        }
        if s.population < s.initial {
            return refuse("population", s.population, format!("at least initial = {}", s.initial));
        }
        if s.population > LARGEST_POPULATION {
            return refuse("population", s.population, format!("at most {LARGEST_POPULATION}"));
        }
        if s.batch == 0 {
            return refuse("batch", 0, "at least 1".to_owned());
        }
        if s.max_evaluations < s.initial {
            return refuse("max_evaluations", s.max_evaluations, format!("at least initial = {}", s.initial));
        }
        Ok(())
    }
}
