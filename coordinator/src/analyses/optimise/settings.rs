//! A design as changes of a scene, in the form of `what-if --set`.

use super::problem::DesignProblem;
use crate::analyses::scene_settings::written_value;
use crate::statistics::design::InputModel;
use common::random::LawError;
use common::scene::Scene;

/// The changes `VARIABLE.mean=VALUE` and `VARIABLE.std=VALUE` that make the design `values` `(q,)` [SI] of a scene.
///
/// # Errors
/// [`LawError`] if a distribution of the design does not exist.
pub fn design_settings(
    problem: &DesignProblem,
    scene: &Scene,
    values: &[f64],
) -> Result<Vec<String>, LawError> {
    let laws = problem.variables(&InputModel::from_scene(scene), values)?;
    let settings = problem.changed_variables().into_iter().flat_map(|k| {
        let (variable, law) = (&scene.variables[k], &laws[k]);
        let setting = |key: &str, value: f64| {
            format!("{}.{key}={}", variable.name, written_value(value, &variable.unit))
        };
        let mean = setting("mean", law.parent_mean());
        let std = (!law.is_constant()).then(|| setting("std", law.given_std()));
        std::iter::once(mean).chain(std).collect::<Vec<_>>()
    });
    Ok(settings.collect())
}
