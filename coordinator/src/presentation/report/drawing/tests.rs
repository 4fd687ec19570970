//! The drawing of a mechanism with every symbol.

use super::geometry::{DrawnMechanism, LoadSymbol};
use super::sheet::{length_in_words, sheet};
use super::*;
use crate::presentation::report::mechanism::Pose;
use common::scene::{Motion, Scene, SceneSource};

/// The scene with every word of the language, its bodies in their start positions, and as a second instant with the slider
/// 10 mm farther along its rail.
fn everything() -> (Scene, Vec<Vec<Pose>>) {
    let source = include_str!("../../../../../common/tests/scenes/everything.toml");
    let scene = SceneSource::parse(source, "everything").unwrap().nominal().clone();
    let pose = |body: &common::scene::Body| match &body.motion {
        Motion::Fixed => ([0.0; 2], 0.0),
        Motion::Driven { position, .. } => (*position, 0.5),
        Motion::Free { start_position, start_angle, .. } => (*start_position, *start_angle),
    };
    let start: Vec<Pose> = scene.bodies.iter().map(pose).collect();
    let mut later = start.clone();
    let (sin, cos) = 15f64.to_radians().sin_cos();
    let slider = scene.bodies.iter().position(|body| body.name == "slider").unwrap();
    later[slider].0[0] += 0.01 * cos;
    later[slider].0[1] += 0.01 * sin;
    (scene, vec![start, later])
}

#[test]
fn every_part_of_a_scene_is_drawn_and_named_without_overlap() {
    let (scene, cycle) = everything();
    let drawn = DrawnMechanism::new(&scene, &cycle, 0).unwrap();
    let sheet = sheet(&drawn);
    let svg = sheet.drawing.document(&maud::html! {});
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
    let names = scene.joints.iter().map(|joint| joint.name.as_str()).chain(["rod", "slider", "frame"]);
    for name in names {
        assert!(texts.contains(&name), "{name} in {texts:?}");
    }
    for said in ["weight 3 N", "brake 0.8 N m", "push 1 to 5.5 N", "motor 0.3 N m at rest", "lift 95 N/m"] {
        assert!(texts.contains(&said), "{said} in {texts:?}");
    }
    assert!(texts.contains(&"g = 9.81\u{a0}m/s²"), "{texts:?}");
    for (k, a) in sheet.labels.iter().enumerate() {
        assert!(sheet.labels[k + 1..].iter().all(|b| !a.area.overlaps(&b.area)), "{a:?}");
        assert!(sheet.area.contains(a.area.from) && sheet.area.contains(a.area.to), "{a:?}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn a_rail_is_the_way_of_its_slider() {
    let (scene, cycle) = everything();
    let drawn = DrawnMechanism::new(&scene, &cycle, 0).unwrap();
    let guide = drawn.joints.iter().find(|joint| joint.name == "guide").unwrap();
    let [from, to] = guide.rail_m.unwrap();
    assert!(((to[0] - from[0]).hypot(to[1] - from[1]) - 0.01).abs() < 1e-9, "{from:?} to {to:?}");
    assert!(guide.on_ground);
    let on_rails =
        |kind: &str| drawn.joints.iter().filter(|joint| joint.rail_m.is_some() && joint.kind == kind).count();
    assert_eq!((on_rails("prismatic"), on_rails("guide"), on_rails("slot")), (2, 1, 1));
    assert_eq!(drawn.joints.iter().filter(|joint| joint.rail_m.is_some()).count(), 4);
}

#[test]
fn loads_act_where_and_whither_the_scene_says() {
    let (scene, cycle) = everything();
    let drawn = DrawnMechanism::new(&scene, &cycle, 0).unwrap();
    let load = |name: &str| &drawn.loads.iter().find(|load| load.name == name).unwrap().symbol;
    let LoadSymbol::Arrow(at, direction) = load("weight") else { panic!() };
    assert!(
        (at[0] - 0.04).abs() < 1e-12 && direction[0] == 0.0 && direction[1] < 0.0,
        "{at:?} {direction:?}"
    );
    assert!(
        matches!(load("brake"), LoadSymbol::Turn(_, false))
            && matches!(load("twist"), LoadSymbol::Turn(_, true))
    );
    // A spring along +y from the far end of the rod ends at the height of its anchor, the origin.
    let LoadSymbol::Coil(from, to) = load("lift") else { panic!() };
    assert!(to[1].abs() < 1e-12 && (to[0] - from[0]).abs() < 1e-12 && from[1] > 0.01, "{from:?} {to:?}");
}

#[test]
fn a_mechanism_without_extent_or_with_unknown_poses_is_not_drawn() {
    let (mut scene, mut cycle) = everything();
    assert!(DrawnMechanism::new(&scene, &cycle, 2).is_none());
    cycle[0][5].0[0] = f64::NAN;
    assert!(DrawnMechanism::new(&scene, &cycle, 0).is_none());
    (scene.bodies, scene.joints, scene.loads) = (vec![], vec![], vec![]);
    assert!(DrawnMechanism::new(&scene, &[vec![]], 0).is_none());
}

#[test]
fn the_sketch_has_every_name() {
    let (scene, cycle) = everything();
    let text = sketch(&DrawnMechanism::new(&scene, &cycle, 0).unwrap());
    for said in [
        "hinge",
        "guide",
        "weld",
        "[rod]",
        "[slider]",
        "● hinge with clearance",
        "■ slider",
        "push: 1 to 5.5 N",
    ] {
        assert!(text.contains(said), "no {said} in\n{text}");
    }
}

#[test]
fn lengths_have_the_unit_that_suits_them() {
    let found = [2e-6, 0.02, 0.5, 1.0, 20.0].map(|length| length_in_words(length, "mm"));
    assert_eq!(found, ["2\u{a0}µm", "20\u{a0}mm", "500\u{a0}mm", "1\u{a0}m", "20\u{a0}m"]);
    assert_eq!(length_in_words(0.0508, "in"), "2\u{a0}in");
}
