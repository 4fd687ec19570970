//! The nominal mechanism in motion, and below it every journal in its bore, magnified: the first frame as SVG, and the data
//! with which a script animates it.

mod data;
mod drawing;
mod frames;

use super::figure::{Figure, csv};
use super::format::count;
use super::input::ReportInput;
use super::mechanism::{self, Pose};
use crate::results::csv_table::number;
use frames::AnimatedCycle;

/// The script that animates the drawing.
pub const SCRIPT: &str = include_str!("play.js");

/// Name of the figure; the script finds the drawing by it.
pub const NAME: &str = "mechanism";

/// A drawing and the data of its animation.
pub struct Animation {
    /// The drawing at the first instant.
    pub figure: Figure,
    /// Cycles with every frame, and the bores over life, JSON for [`SCRIPT`].
    pub data: String,
}

/// The animation; `None` if the nominal evaluation does not include the motion of every body.
pub fn animation(input: &ReportInput) -> Option<Animation> {
    let nominal = input.nominal.as_ref()?;
    let scene = &input.scene;
    let last = nominal.worn.as_ref().and_then(|worn| worn.last_cycle.as_ref());
    let cycles =
        [("last cycle, worn", true, last), ("first cycle, unworn", false, nominal.first_cycle.as_ref())];
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
    let caption = format!(
        "Nominal mechanism. Top: true proportions. Bottom: every journal in its bore, oriented as in the mechanism, with \
         clearance and wear magnified {} times. {}",
        count(layout.magnification().round() as u64),
        if first.worn {
            format!(
                "Bores worn for {} cycles; thin circle: unworn bore.",
                count(nominal.cycles.last().copied().unwrap_or(0).into())
            )
        } else {
            "Bores unworn.".to_string()
        }
    );
    let rows = shown.iter().flat_map(|shown| {
        shown.cycle.motion.iter().flat_map(move |motion| {
            shown.cycle.time.iter().zip(motion.position.iter().zip(&motion.angle)).map(
                move |(time, (position, angle))| {
                    vec![
                        shown.name.to_string(),
                        motion.body.clone(),
                        number(1e3 * time),
                        number(1e3 * position[0]),
                        number(1e3 * position[1]),
                        number(angle.to_degrees()),
                    ]
                },
            )
        })
    });
    let figure = Figure {
        name: NAME.into(),
        title: "The mechanism in motion".into(),
        caption,
        drawing: drawing::picture(scene, &layout, first, &wear),
        csv: csv(&["cycle", "body", "time [ms]", "x [mm]", "y [mm]", "angle [deg]"], rows),
    };
    let lives = nominal.worn.as_ref().filter(|worn| worn.cycles.len() > 1);
    Some(Animation { figure, data: data::json(scene, &layout, &shown, lives).to_string() })
}

#[cfg(test)]
mod tests {
    use super::frames::FRAMES;
    use super::*;
    use crate::test_study;

    #[test]
    fn the_picture_has_every_body_and_joint_and_the_data_move_them() {
        let input = test_study::report_input();
        let animation = animation(&input).unwrap();
        let svg = animation.figure.drawing.document(&maud::html! {});
        let document = roxmltree::Document::parse(&svg).unwrap();
        let with =
            |attribute: &str| document.descendants().filter(|node| node.has_attribute(attribute)).count();
        assert_eq!((with("data-body"), with("data-joint"), with("data-bore")), (2, 6, 6));
        let data: serde_json::Value = serde_json::from_str(&animation.data).unwrap();
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
        let unworn = animation(&input).unwrap();
        assert!(unworn.data.contains("\"lives\":null"));
        assert!(unworn.figure.caption.ends_with("Bores unworn."));
        input.nominal.as_mut().unwrap().first_cycle.as_mut().unwrap().motion[1].angle[3] = f64::NAN;
        assert!(animation(&input).is_none());
    }
}
