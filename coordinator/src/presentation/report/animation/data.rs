//! Every frame of the animated cycles, as JSON for the script.

use super::drawing::{Layout, with_clearance};
use super::frames::{AnimatedCycle, frames};
use crate::presentation::report::drawing::symbols::coordinate;
use crate::presentation::report::mechanism::Mechanism;
use common::scene::Motion;

/// A JSON list with one entry per cycle: its name, whether the bores are worn, and per body that moves the numbers
/// (x, y, degrees) of every frame, per joint (x, y), per joint with clearance (x, y, degrees of the journal from the
/// bushing, degrees of the bushing), in drawing units.
pub fn json(mechanism: &Mechanism, layout: &Layout, shown: &[AnimatedCycle<'_>]) -> String {
    let cycles: Vec<String> = shown.iter().map(|shown| cycle(mechanism, layout, shown)).collect();
    format!("[{}]", cycles.join(","))
}

fn cycle(mechanism: &Mechanism, layout: &Layout, shown: &AnimatedCycle<'_>) -> String {
    let over = |numbers: &dyn Fn(usize) -> Option<Vec<f64>>| {
        let all = frames(shown.cycle).filter_map(numbers).flatten().map(coordinate).collect::<Vec<_>>();
        format!("[{}]", all.join(","))
    };
    let moving = (0..mechanism.bodies.len()).filter(|body| mechanism.bodies[*body].motion != Motion::Fixed);
    let bodies: Vec<String> = moving
        .map(|body| {
            over(&|k| {
                let (position, angle) = mechanism.pose(shown.cycle, body, k)?;
                let [x, y] = layout.place(position);
                Some(vec![x, y, -angle.to_degrees()])
            })
        })
        .collect();
    let joints: Vec<String> = mechanism
        .joints
        .iter()
        .map(|joint| over(&|k| Some(layout.place(mechanism.place(shown.cycle, &joint.journal, k)?).to_vec())))
        .collect();
    let bores: Vec<String> = with_clearance(mechanism)
        .map(|index| {
            let joint = &mechanism.joints[index];
            over(&|k| {
                let [x, y] = layout.magnify(mechanism.orbit_at(shown.cycle, joint, k)?);
                let turned = |body: usize| Some(mechanism.pose(shown.cycle, body, k)?.1.to_degrees());
                let (bushing, journal) = (turned(joint.bushing.body)?, turned(joint.journal.body)?);
                Some(vec![x, y, bushing - journal, -bushing])
            })
        })
        .collect();
    format!(
        "{{\"name\":\"{}\",\"worn\":{},\"bodies\":[{}],\"joints\":[{}],\"bores\":[{}]}}",
        shown.name,
        shown.worn,
        bodies.join(","),
        joints.join(","),
        bores.join(",")
    )
}
