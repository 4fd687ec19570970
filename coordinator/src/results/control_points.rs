//! What more control points on the worn surfaces change in the nominal mechanism, as `summary.json` has it.

use common::outputs::{Diagnostics, PointsError};
use common::scene::Scene;
use serde::{Deserialize, Serialize};

/// An output of the motion on surfaces with the scene's, twice and four times the control points, at the life where they change it most.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ControlPointsRow {
    /// Name of the output.
    pub output: String,
    /// Unit of the values; may be empty.
    pub unit: String,
    /// Simulated life [cycles].
    pub cycles: u32,
    /// Value with the scene's control points.
    pub value: f64,
    /// Value with twice as many.
    pub with_twice: f64,
    /// Value with four times as many.
    pub with_four_times: f64,
    /// Estimated error due to their number.
    pub error: f64,
    /// False if the value does not converge with the points.
    pub converges: bool,
    /// True if the stated errors contain this one; false if the scene declares its points a part of its model.
    pub stated: bool,
}

/// The rows of an evaluation of `scene` with these `diagnostics`; none where the points were not compared.
pub fn control_points_rows(scene: &Scene, diagnostics: &Diagnostics) -> Vec<ControlPointsRow> {
    let row = |found: &PointsError| {
        let unit = scene.unit_of(scene.outputs.iter().find(|output| output.name == found.output)?);
        let [value, with_twice, with_four_times] = found.values.map(|value| unit.to_shown(value));
        Some(ControlPointsRow {
            output: found.output.clone(),
            unit: unit.symbol().to_owned(),
            cycles: found.cycles,
            value,
            with_twice,
            with_four_times,
            error: unit.to_shown(found.error),
            converges: found.converges,
            stated: found.stated,
        })
    };
    diagnostics.control_points.iter().filter_map(row).collect()
}
