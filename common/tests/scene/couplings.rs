//! Ideal joints of one condition, end stops, and the defaults of joints, as scenes write them.

use crate::language::{body, joint, same, same_table, scene};
use common::scene::*;
use std::f64::consts::{PI, TAU};

#[test]
fn joints_of_one_condition_and_stops() {
    let scene = scene();
    assert_eq!(joint(&scene, "yoke").kind, JointKind::Slot { axis: 0.5 * PI });
    let JointKind::LinearDrive(Drive::Angle(stroke)) = &joint(&scene, "cylinder").kind else { panic!() };
    same_table(stroke, &[0.0, 0.05, 0.1], &[0.03, 0.034, 0.03], true);
    let mesh = |name: &str| match &joint(&scene, name).kind {
        JointKind::Mesh(mesh) => mesh.clone(),
        other => panic!("{other:?}"),
    };
    // Velocities of both pitch circles where they touch are equal along the line of action: outside, inside and by a strand.
    let (pair, ring, strap) = (mesh("pair"), mesh("ring"), mesh("strap"));
    let cos = (-PI / 7.2).cos();
    same(&pair.arms, &[0.015 * cos, 0.005 * cos]);
    same(&ring.arms, &[-0.015 * (PI / 9.0).cos(), 0.035 * (PI / 9.0).cos()]);
    same(&strap.arms, &[-0.005, 0.01]);
    // The slider lies below the axis of the rack, which is turned by 15 deg: it turns its wheel counter-clockwise against the axis.
    same(&mesh("toothed_rod").arms, &[0.0, 0.01035 * (PI / 9.0).cos()]);
    let JointKind::Cam { direction, lift } = &joint(&scene, "follower").kind else { panic!() };
    assert!(direction[0].abs() < 1e-15 && direction[1] == -1.0);
    same_table(lift, &[0.0, PI / 1.5, TAU], &[0.02, 0.025, 0.02], true);
    let stop = Load::AngleStop {
        name: "hinge_stop".to_owned(),
        a: body(&scene, "rod"),
        b: body(&scene, "frame"),
        lower: -PI / 1.8,
        upper: PI / 1.8,
        stiffness: 20.0,
        dissipation: 0.1,
    };
    assert_eq!(scene.loads.iter().find(|load| load.name() == "hinge_stop"), Some(&stop));
}

/// The scenes that show linear drives, gears, cams and stops; what they leave out is in their defaults.
#[test]
fn joints_have_the_defaults_of_their_scene() {
    let lift = SceneSource::parse(include_str!("../scenes/lift-table.toml"), "lift-table").unwrap();
    let JointKind::Clearance(pin) = &lift.nominal().joints[0].kind else { panic!() };
    same(&[pin.width, pin.film_damping, pin.radial_clearance()], &[0.04, 2000.0, pin.radial_clearance()]);
    assert!((pin.radial_clearance() - 6e-5).abs() < 1e-15);
    // A value of a joint takes precedence, and a quantity that is set is that of the joint.
    let changed = lift.resolve_with(&[("joints.pin.width".to_owned(), 0.05)]).unwrap();
    let JointKind::Clearance(pin) = &changed.joints[0].kind else { panic!() };
    same(&[pin.width], &[0.05]);
    let geared = include_str!("../scenes/geared-cam.toml");
    assert_eq!(SceneSource::parse(geared, "geared-cam").unwrap().nominal().joints.len(), 4);
    let wrong = geared.replace("[joint_defaults]", "[joint_defaults]\nwidht = \"2 mm\"");
    let faults = SceneSource::parse(&wrong, "geared-cam").unwrap_err().to_string();
    assert!(faults.contains("joint_defaults.widht"), "{faults}");
    for (from, to, key) in [
        (
            "[joint_defaults]",
            "[joint_defaults]\nguide_length = \"9 mm\"",
            "joint_defaults.guide_length: unknown key",
        ),
        ("[joint_defaults]", "[joint_defaults]\nname = \"pin\"", "joint_defaults.name: unknown key"),
        (
            "\"clearance\"\njournal = { body = \"camshaft\", point = \"centre\" }\nbushing",
            "\"revolute\"\na = { body = \"camshaft\", point = \"centre\" }\nb",
            "joint_defaults: no joint has type = \"clearance\"",
        ),
        (
            "\"gear\"\na = { body = \"pinion\", point = \"centre\" }\nb = { body = \"camshaft\", point = \"centre\" }\nradius_a = \"25 mm\"",
            "\"belt\"\na = { body = \"pinion\", point = \"centre\" }\nb = { body = \"camshaft\", point = \"centre\" }\nradius_a = \"125 mm\"",
            "joints.teeth: one pulley lies within the other",
        ),
    ] {
        assert!(geared.contains(from), "{from}");
        let faults = SceneSource::parse(&geared.replace(from, to), "geared-cam").unwrap_err().to_string();
        assert!(faults.contains(key), "{to}: {faults}");
    }
    let warnings = |text: &str| SceneSource::parse(text, "geared-cam").unwrap().warnings();
    assert_eq!(warnings(geared), []);
    let [warning] = &warnings(&geared.replace("\"50 mm\"", "\"60 mm\""))[..] else { panic!("one warning") };
    assert_eq!(warning.key, "joints.teeth.radius_a");
    assert!(warning.message.contains("overlap each other by 10.0000 mm"), "{warning}");
    // What else turns on a wheel that a fixed body bears is no bearing.
    let arm = "[[joints]]\nname = \"arm\"\ntype = \"revolute\"\na = { body = \"camshaft\", point = \"centre\" }\nb = { body = \"follower\", point = \"foot\" }\n";
    assert!(SceneSource::parse(&format!("{geared}\n{arm}"), "geared-cam").is_ok());
    let planet = geared.replace(
        "bushing = { body = \"frame\", point = \"shaft\" }",
        "bushing = { body = \"follower\", point = \"foot\" }",
    );
    let faults = SceneSource::parse(&planet, "geared-cam").unwrap_err().to_string();
    assert!(
        faults.contains("joints.teeth: the bearing of a wheel is on body \"follower\", which moves"),
        "{faults}"
    );
}

#[test]
fn issue_a_given_mass_had_the_inertia_of_another_one() {
    let lift = include_str!("../scenes/lift-table.toml");
    let arm = |mass: &str| {
        let text = lift.replace("name = \"arm\"\n", &format!("name = \"arm\"\n{mass}\n"));
        let source = SceneSource::parse(&text, "lift-table").unwrap_or_else(|faults| panic!("{faults}"));
        match source.nominal().bodies[body(source.nominal(), "arm")].motion {
            Motion::Free { mass, inertia, .. } => [mass, inertia],
            _ => panic!("free"),
        }
    };
    let ([own, of_own], [given, of_given]) = (arm(""), arm("mass = \"2 kg\""));
    assert!(given == 2.0 && own > 10.0, "{own}");
    same(&[of_given], &[of_own * (2.0 / own)]);
    same(&arm("mass = \"2 kg\"\ninertia = \"3 kg m^2\""), &[2.0, 3.0]);
}
