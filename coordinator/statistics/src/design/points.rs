//! The nominal point of a scene and a few random points, for measurements outside of a study.

use super::{InputModel, Population};
use common::scene::Scene;

/// The nominal point of a scene (its variables' means), then `random` points of the population of this seed:
/// `(1 + random)(d,)` [SI]. A scene without random variables has only the first, which is empty.
pub fn nominal_and_random(scene: &Scene, seed: u64, random: usize) -> Vec<Vec<f64>> {
    let inputs = InputModel::from_scene(scene);
    let mut points = vec![inputs.means()];
    if inputs.dimension() > 0 {
        let population = Population::draw(&inputs, random, seed);
        points.extend((0..random).map(|j| population.physical(j)));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn more_points_begin_with_the_same() {
        let source = SceneSource::builtin("four-bar").expect("built in");
        let (few, many) =
            (nominal_and_random(source.nominal(), 1, 2), nominal_and_random(source.nominal(), 1, 9));
        assert_eq!((few.len(), many.len()), (3, 10));
        assert_eq!(few[..], many[..3]);
        assert_ne!(many[1], many[2]);
        let means = source.nominal().variables.iter().map(|v| v.distribution.mean());
        assert_eq!(few[0], means.collect::<Vec<_>>());
        let ideal = SceneSource::builtin("pendulum").expect("built in");
        assert_eq!(nominal_and_random(ideal.nominal(), 1, 5), [[0.0; 0]]);
    }
}
