//! Operating conditions of a scene: what each changes, and what may be set or random in them.

use common::scene::*;

const EVERYTHING: &str = include_str!("../scenes/everything.toml");

fn joint<'s>(scene: &'s Scene, name: &str) -> &'s Joint {
    scene.joints.iter().find(|joint| joint.name == name).unwrap()
}

#[test]
fn conditions() {
    let source = SceneSource::parse(EVERYTHING, "everything").unwrap();
    let friction = |scene: &Scene, name: &str| match &joint(scene, name).kind {
        JointKind::Clearance(clearance) => clearance.friction,
        _ => panic!("without clearance"),
    };
    let brake = |scene: &Scene| {
        scene.loads.iter().find_map(|load| match load {
            Load::ConstantTorque { torque, .. } => Some(*torque),
            _ => None,
        })
    };
    let summary = |scene: &Scene| -> Vec<(String, f64, f64, f64)> {
        let of =
            |c: &Condition| (c.name.clone(), c.share, brake(&c.scene).unwrap(), friction(&c.scene, "worn"));
        scene.conditions.iter().map(of).collect()
    };
    let scene = source.nominal();
    let friction_worn = friction(scene, "worn");
    let expected = [("full".to_owned(), 0.3, -1.5, 0.06), ("idle".to_owned(), 0.7, -0.8, friction_worn)];
    assert_eq!(summary(scene), expected);
    for condition in &scene.conditions {
        assert!(condition.scene.conditions.is_empty() && condition.scene.variables.is_empty());
        assert_eq!(condition.scene.bodies, scene.bodies);
    }
    // A parameter or a change may be set or be random like any other quantity; what a condition changes takes precedence.
    let set = |setting: &str| {
        let setting = source.parse_setting(setting).unwrap();
        summary(&source.resolve_with(&[setting]).unwrap())
    };
    assert_eq!(set("parameters.full_torque = -2 N m")[0].2, -3.0);
    assert_eq!(set("conditions.full.changes.loads.brake.torque = -7 N m")[0].2, -7.0);
    let braked = set("brake = -0.9 N m");
    assert_eq!((braked[0].2, braked[1].2), (-1.5, -0.9));
    let fault = source.resolve_with(&[("conditions.full.share".into(), 0.4)]).unwrap_err().to_string();
    assert!(
        fault.contains("the shares add up to 1.1, not to 1; shares that vary are written by a parameter p"),
        "{fault}"
    );
    let overridden = source.overridden_variables();
    let names = |(k, conditions): &(usize, Vec<&str>)| format!("{} {conditions:?}", scene.variables[*k].name);
    assert_eq!(
        overridden.iter().map(names).collect::<Vec<_>>(),
        ["brake [\"full\"]", "friction_worn [\"full\"]"]
    );
    // All conditions together are the whole text.
    let again = SceneSource::parse(source.text(), "again").unwrap();
    assert_eq!(again.nominal(), scene);
}

#[test]
fn issue_two_sided_limits_of_wear_outputs_were_refused_over_several_conditions() {
    for output in ["bushing_wear", "journal_wear", "growth"] {
        let limit = format!("output = \"{output}\"\nlower = \"2 um\"");
        let text = EVERYTHING.replace("output = \"all_wear\"\nlower = \"2 um\"", &limit);
        assert!(text.contains(&limit));
        let source = SceneSource::parse(&text, "everything").unwrap();
        assert!(source.nominal().conditions.len() > 1);
    }
}
