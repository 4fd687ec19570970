//! The levels of accuracy that a study's settings name, for its scene.

use super::finer_levels::FinerLevels;
use super::{Method, Settings};
use common::accuracy::{Accuracy, NamedAccuracy};
use common::scene::Scene;

impl Settings {
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
