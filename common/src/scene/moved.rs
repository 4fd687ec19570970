//! A scene at another place.

use super::key_table::Value;
use super::model::{Motion, Scene};
use super::output::OutputKind;
use super::output_values::Attachment;

impl Scene {
    /// The scene with its mechanism moved by `by` `(2,)` [m] as a whole: fixed points, axes of drives, start positions and wanted
    /// coordinates. The operating
    /// conditions are moved with it.
    pub fn moved(&self, by: [f64; 2]) -> Scene {
        let mut scene = self.clone();
        let shift = |position: &mut [f64; 2]| (0..2).for_each(|k| position[k] += by[k]);
        let mut fixed = Vec::with_capacity(scene.bodies.len());
        for body in &mut scene.bodies {
            fixed.push(body.motion == Motion::Fixed);
            match &mut body.motion {
                Motion::Fixed => body.points.iter_mut().for_each(|point| shift(&mut point.position)),
                Motion::Driven { position, .. } | Motion::Free { start_position: position, .. } => {
                    shift(position)
                }
            }
        }
        let place = |at: &mut Attachment| {
            if fixed[at.body] {
                shift(&mut at.position);
            }
        };
        for joint in &mut scene.joints {
            place(&mut joint.journal);
            place(&mut joint.bushing);
        }
        for load in &mut scene.loads {
            load.change(|value| {
                if let Value::Place(at) = value {
                    place(at);
                }
            });
        }
        for output in &mut scene.outputs {
            if let OutputKind::PositionError { wanted, .. } = &mut output.kind {
                for (curve, by) in wanted.iter_mut().zip(by) {
                    curve.iter_mut().flat_map(|curve| &mut curve.table.value).for_each(|value| *value += by);
                }
            }
        }
        for condition in &mut scene.conditions {
            condition.scene = condition.scene.moved(by);
        }
        scene
    }
}
