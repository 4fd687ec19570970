//! Every frame of the animated cycles, and the bores over life, as JSON for the script.

use super::drawing::{BORE, Layout, with_clearance};
use super::frames::AnimatedCycle;
use crate::presentation::report::mechanism::{Pose, eccentricity, place};
use common::outputs::WornLife;
use common::scene::{Motion, Scene};
use serde_json::{Value, json};

/// A JSON object: `cycles` with one entry per cycle, and `lives`, the lives at which bores are known with the depths of every joint with
/// clearance at equal angles, in drawing units, or `null`. An entry of a cycle has its name, whether the bores are worn, and per body that moves the numbers
/// (x, y, degrees) of every frame, per joint (x, y), per joint with clearance (x, y, degrees of the journal from the
/// bushing, degrees of the bushing), in drawing units.
pub fn json(scene: &Scene, layout: &Layout, shown: &[AnimatedCycle<'_>], lives: Option<&WornLife>) -> Value {
    let cycles: Value = shown.iter().map(|shown| cycle(scene, layout, shown)).collect();
    json!({ "cycles": cycles, "lives": lives.map(|worn| bores(scene, layout, worn)) })
}

/// Lives in cycles, and the depths of the bores at each.
fn bores(scene: &Scene, layout: &Layout, worn: &WornLife) -> Value {
    let magnified = |depth: &f64| rounded(layout.magnify([*depth, 0.0])[0]);
    let depths = |depths: &Vec<f64>| depths.iter().map(magnified).collect::<Value>();
    let life = |joints: &Vec<Vec<f64>>| -> Value {
        with_clearance(scene).map(|index| joints.get(index).map_or(json!([]), depths)).collect()
    };
    json!({ "cycles": worn.cycles, "bore": BORE, "bores": worn.wear_depth.iter().map(life).collect::<Value>() })
}

fn cycle(scene: &Scene, layout: &Layout, shown: &AnimatedCycle<'_>) -> Value {
    fn over<const N: usize>(shown: &AnimatedCycle<'_>, numbers: impl Fn(&[Pose]) -> [f64; N]) -> Value {
        shown.frames().flat_map(numbers).map(rounded).collect()
    }
    let moving = (0..scene.bodies.len()).filter(|body| scene.bodies[*body].motion != Motion::Fixed);
    let bodies = moving.map(|body| {
        over(shown, |poses| {
            let (position, angle) = poses[body];
            let [x, y] = layout.place(position);
            [x, y, -angle.to_degrees()]
        })
    });
    let joints = scene.joints.iter();
    let joints = joints.map(|joint| over(shown, |poses| layout.place(place(poses, &joint.journal))));
    let bores = with_clearance(scene).map(|index| {
        let joint = &scene.joints[index];
        over(shown, |poses| {
            let [x, y] = layout.magnify(eccentricity(poses, joint));
            let [bushing, journal] =
                [joint.bushing.body, joint.journal.body].map(|body| poses[body].1.to_degrees());
            [x, y, bushing - journal, -bushing]
        })
    });
    json!({ "name": shown.name, "worn": shown.worn, "bodies": bodies.collect::<Value>(),
            "joints": joints.collect::<Value>(), "bores": bores.collect::<Value>() })
}

/// A number with two decimals; 0 for one that is not finite.
fn rounded(value: f64) -> f64 {
    if value.is_finite() { (100.0 * value).round() / 100.0 } else { 0.0 }
}
