//! A design as changes of a scene, in the form of `what-if --set`.

use super::problem::DesignProblem;
use crate::statistics::design::InputModel;
use common::random::LawError;
use common::scene::Scene;
use common::scene::expression::read_unit;

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
            let written = match read_unit(&variable.unit) {
                Ok(read) if variable.unit != "1" => {
                    format!("{:e} {}", value * read.divide / read.multiply, variable.unit)
                }
                // A plain number, or a unit of the simulator, which is only displayed.
                _ => format!("{value:e}"),
            };
            format!("{}.{key}={written}", variable.name)
        };
        let mean = setting("mean", law.parent_mean());
        let std = (!law.is_constant()).then(|| setting("std", law.given_std()));
        std::iter::once(mean).chain(std).collect::<Vec<_>>()
    });
    Ok(settings.collect())
}
