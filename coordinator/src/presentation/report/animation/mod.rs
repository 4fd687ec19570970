//! The nominal mechanism in motion, and below it every journal in its bore, magnified: the first frame as SVG, and the data
//! with which a script animates it.

mod drawing;

use super::format::count;
use super::mechanism::{self, Pose, eccentricity, place};
use super::{Figure, ReportInput, csv};
use crate::results::csv_table::number;
use common::outputs::WornLife;
use common::scene::{Motion, Scene};
use drawing::{AnimatedCycle, BORE, Layout, with_clearance};
use serde_json::{Value, json};

/// The script that animates the drawing.
pub const SCRIPT: &str = include_str!("play.js");

/// Name of the figure; the script finds the drawing by it.
pub const NAME: &str = "mechanism";

/// The drawing at the first instant; and the cycles with every frame and the bores over life, JSON for [`SCRIPT`]. `None` if the nominal
/// evaluation does not include the motion of every body.
pub fn animation(input: &ReportInput) -> Option<(Figure, String)> {
    let nominal = input.nominal.as_ref()?;
    let scene = &input.scene;
    let [last, first] = [input.last_cycle(), input.first_cycle()];
    let cycles = [("last cycle, worn", true, last), ("first cycle, unworn", false, first)];
    let shown: Vec<AnimatedCycle<'_>> = cycles
        .into_iter()
        .filter_map(|(name, worn, cycle)| {
            let poses = mechanism::poses(scene, cycle?)?;
            let is_known = |([x, y], angle): &Pose| x.is_finite() && y.is_finite() && angle.is_finite();
            let is_complete =
                poses.len() > 1 && !scene.joints.is_empty() && poses.iter().flatten().all(is_known);
            is_complete.then_some(AnimatedCycle { name, worn, cycle: cycle?, poses })
        })
        .collect();
    let first = shown.first()?;
    let wear: Vec<&[f64]> = nominal.joints.iter().map(|joint| joint.wear_depth.as_slice()).collect();
    let layout = drawing::Layout::new(scene, &shown, &wear)?;
    let has_bores = with_clearance(scene).next().is_some();
    let of_bores = format!(
        "Nominal mechanism. Top: true proportions. Bottom: every journal in its bore, oriented as in the mechanism, with \
         clearance and wear magnified {} times. {}",
        count(layout.magnification().round() as u64),
        if first.worn {
            let end = nominal.cycles.last().copied().unwrap_or(0);
            format!("Bores worn for {} cycles; thin circle: unworn bore.", count(end.into()))
        } else {
            "Bores unworn.".to_string()
        }
    );
    let caption = if has_bores { of_bores } else { "Nominal mechanism in true proportions.".to_owned() };
    let rows = shown.iter().flat_map(|shown| {
        shown.cycle.motion.iter().flat_map(move |motion| {
            let poses = shown.cycle.time.iter().zip(motion.position.iter().zip(&motion.angle));
            poses.map(move |(time, ([x, y], angle))| {
                let numbers = [1e3 * time, 1e3 * x, 1e3 * y, angle.to_degrees()].map(number);
                [shown.name.to_string(), motion.body.clone()].into_iter().chain(numbers)
            })
        })
    });
    let figure = Figure {
        name: NAME.into(),
        title: "The mechanism in motion".into(),
        caption,
        drawing: drawing::picture(scene, &layout, first, &wear),
        csv: csv(&["cycle", "body", "time [ms]", "x [mm]", "y [mm]", "angle [deg]"], rows),
    };
    let cycles: Value = shown.iter().map(|shown| cycle(scene, &layout, shown)).collect();
    let lives = input.worn().filter(|worn| has_bores && worn.cycles.len() > 1);
    let lives = lives.map(|worn| bores(scene, &layout, worn));
    Some((figure, json!({ "cycles": cycles, "lives": lives }).to_string()))
}

/// Lives in cycles at which bores are known, and at each the depths of every joint with clearance at equal angles, in drawing units.
fn bores(scene: &Scene, layout: &Layout, worn: &WornLife) -> Value {
    let magnified = |depth: &f64| rounded(layout.magnify([*depth, 0.0])[0]);
    let depths = |depths: &Vec<f64>| depths.iter().map(magnified).collect::<Value>();
    let life = |joints: &Vec<Vec<f64>>| -> Value {
        with_clearance(scene).map(|index| joints.get(index).map_or(json!([]), depths)).collect()
    };
    json!({ "cycles": worn.cycles, "bore": BORE, "bores": worn.wear_depth.iter().map(life).collect::<Value>() })
}

/// The name of a cycle, whether the bores are worn, and per body that moves the numbers (x, y, degrees) of every frame, per joint (x, y), per
/// joint with clearance (x, y, degrees of the journal from the bushing, degrees of the bushing), in drawing units.
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

#[cfg(test)]
mod tests {
    use super::drawing::FRAMES;
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn the_picture_has_every_body_and_joint_and_the_data_move_them() {
        let input = test_study::report_input();
        let (figure, data) = animation(&input).unwrap();
        let svg = figure.drawing.document(&maud::html! {});
        let document = roxmltree::Document::parse(&svg).unwrap();
        let with =
            |attribute: &str| document.descendants().filter(|node| node.has_attribute(attribute)).count();
        assert_eq!((with("data-body"), with("data-joint"), with("data-bore")), (2, 6, 6));
        let data: serde_json::Value = serde_json::from_str(&data).unwrap();
        let cycles = data["cycles"].as_array().unwrap();
        assert_eq!(cycles.len(), 2);
        for cycle in cycles {
            for (key, numbers) in [("bodies", 3), ("joints", 2), ("bores", 4)] {
                for of in cycle[key].as_array().unwrap() {
                    assert_eq!(of.as_array().unwrap().len(), numbers * FRAMES, "{key}");
                }
            }
        }
        // Bores over life: of the six joints, deepest at the end.
        let lives = &data["lives"];
        let ends = lives["cycles"].as_array().unwrap();
        assert_eq!(
            (ends.len(), ends.last().unwrap().as_u64()),
            (lives["bores"].as_array().unwrap().len(), Some(72_000))
        );
        let deepest = |life: usize| {
            let joints = lives["bores"][life].as_array().unwrap();
            assert_eq!(joints.len(), 6);
            joints[0].as_array().unwrap().iter().map(|depth| depth.as_f64().unwrap()).fold(0.0, f64::max)
        };
        assert!(deepest(0) < deepest(ends.len() - 1) && deepest(ends.len() - 1) > 1.0);
        // The rod turns once, its journals stay within the magnified clearance of the largest joint.
        let rod = cycles[1]["bodies"][1].as_array().unwrap();
        let half = rod[3 * (FRAMES / 2) + 2].as_f64().unwrap();
        assert!((half + 180.0).abs() < 2.0, "{half}");
        let bore = cycles[1]["bores"][0].as_array().unwrap();
        let far =
            bore.chunks(4).map(|f| f[0].as_f64().unwrap().hypot(f[1].as_f64().unwrap())).fold(0.0, f64::max);
        assert!(far > 1.0 && far < drawing::LARGEST_CLEARANCE, "{far}");
    }

    #[test]
    fn an_incomplete_motion_is_not_shown() {
        let mut input = test_study::report_input();
        input.nominal.as_mut().unwrap().worn = None;
        let (unworn, data) = animation(&input).unwrap();
        assert!(data.contains("\"lives\":null"));
        assert!(unworn.caption.ends_with("Bores unworn."));
        input.nominal.as_mut().unwrap().first_cycle.as_mut().unwrap().motion[1].angle[3] = f64::NAN;
        assert!(animation(&input).is_none());
    }
}
