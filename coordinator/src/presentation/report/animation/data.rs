//! Every frame of the animated cycles, and the bores over life, as JSON for the script.

use super::drawing::{BORE, Layout, with_clearance};
use super::frames::{AnimatedCycle, frames};
use crate::presentation::report::drawing::symbols::coordinate;
use crate::presentation::report::mechanism::Mechanism;
use common::outputs::WornLife;
use common::scene::Motion;

/// A JSON object: `cycles` with one entry per cycle, and `lives`, the lives at which bores are known with the depths of every joint with
/// clearance at equal angles, in drawing units, or `null`. An entry of a cycle has its name, whether the bores are worn, and per body that moves the numbers
/// (x, y, degrees) of every frame, per joint (x, y), per joint with clearance (x, y, degrees of the journal from the
/// bushing, degrees of the bushing), in drawing units.
pub fn json(
    mechanism: &Mechanism,
    layout: &Layout,
    shown: &[AnimatedCycle<'_>],
    lives: Option<&WornLife>,
) -> String {
    let cycles: Vec<String> = shown.iter().map(|shown| cycle(mechanism, layout, shown)).collect();
    let lives = lives.map_or("null".to_owned(), |worn| bores(mechanism, layout, worn));
    format!("{{\"cycles\":[{}],\"lives\":{lives}}}", cycles.join(","))
}

/// Lives in cycles, and the depths of the bores at each.
fn bores(mechanism: &Mechanism, layout: &Layout, worn: &WornLife) -> String {
    let depths = |depths: &Vec<f64>| {
        let drawn = depths.iter().map(|depth| layout.magnify([*depth, 0.0])[0]);
        let drawn = drawn.map(|depth| coordinate(if depth.is_finite() { depth } else { 0.0 }));
        format!("[{}]", drawn.collect::<Vec<_>>().join(","))
    };
    let life = |joints: &Vec<Vec<f64>>| {
        let shown = with_clearance(mechanism).map(|index| joints.get(index).map_or("[]".to_owned(), depths));
        format!("[{}]", shown.collect::<Vec<_>>().join(","))
    };
    let cycles: Vec<String> = worn.cycles.iter().map(u32::to_string).collect();
    let all: Vec<String> = worn.wear_depth.iter().map(life).collect();
    format!(
        "{{\"cycles\":[{}],\"bore\":{},\"bores\":[{}]}}",
        cycles.join(","),
        coordinate(BORE),
        all.join(",")
    )
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
