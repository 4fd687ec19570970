//! Levels of accuracy of a study: the working accuracy, at which the surrogates learn, and finer ones for pairs.

use super::{Method, Settings};
use common::accuracy::{Accuracy, LevelsError, NamedAccuracy};
use common::scene::Scene;
use serde::{Deserialize, Serialize};

/// Levels of a study finer than its working accuracy.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FinerLevels {
    /// None: the errors that the simulations state are all that is known of their numerical error.
    #[default]
    None,
    /// Two, each with time steps and blocks of half the length, and twice the control points.
    Halved,
    /// These, from the coarser to the finer.
    Named(Vec<NamedAccuracy>),
}

impl FinerLevels {
    /// Working accuracy and finer levels by the names of all levels, the working accuracy first.
    ///
    /// # Errors
    /// [`LevelsError`].
    pub fn of_names(levels: &[NamedAccuracy]) -> Result<(NamedAccuracy, Self), LevelsError> {
        match (LevelsError::of(levels), levels) {
            (None, [working]) => Ok((working.clone(), Self::None)),
            (None, [working, finer @ ..]) => Ok((working.clone(), Self::Named(finer.to_vec()))),
            (Some(error), _) => Err(error),
            (None, []) => Err(LevelsError::Count { count: 0 }),
        }
    }

    /// True if there is none; for the stored form, where they are left out then.
    pub(super) fn is_none(&self) -> bool {
        *self == Self::None
    }
}

impl Settings {
    /// The levels finer than the working accuracy, from the coarser to the finer: none with direct simulation, nor with a scene's own
    /// simulator, which has no such setting.
    pub fn finer_levels(&self, scene: &Scene) -> Vec<NamedAccuracy> {
        if self.method != Method::ActiveLearning || scene.simulator.is_some() {
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

    /// Their numerical settings.
    pub(super) fn finer_accuracies(&self, scene: &Scene) -> Vec<Accuracy> {
        self.finer_levels(scene).into_iter().map(|level| level.accuracy).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    fn named(names: &[&str]) -> Vec<NamedAccuracy> {
        names.iter().map(|name| name.parse().expect(name)).collect()
    }

    #[test]
    fn finer_levels_follow_the_working_accuracy_unless_they_are_named() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let scene = source.nominal();
        let mut settings = Settings::from(scene);
        settings.accuracy.setting = "draft".parse().unwrap();
        let [finer, finest] = &settings.finer_levels(scene)[..] else { panic!("two levels") };
        assert_eq!((finer.accuracy.cycle_jump, finer.accuracy.points), (4000, 2));
        assert_eq!((finest.accuracy.cycle_jump, finest.accuracy.points), (2000, 4));
        let levels = named(&["draft", "balanced", "reference"]);
        let (working, finer) = FinerLevels::of_names(&levels).unwrap();
        let stored = serde_json::to_string(&finer).unwrap();
        assert_eq!(serde_json::from_str::<FinerLevels>(&stored).unwrap(), finer);
        settings.levels = finer;
        assert_eq!((working, settings.finer_levels(scene)), (levels[0].clone(), levels[1..].to_vec()));
        let (_, none) = FinerLevels::of_names(&levels[..1]).unwrap();
        assert!(none.is_none() && FinerLevels::of_names(&[]).is_err());
        let direct = Settings { method: Method::MonteCarlo, ..settings };
        assert_eq!(direct.finer_levels(scene), []);
    }
}
