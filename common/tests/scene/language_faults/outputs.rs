//! Faults of outputs and limit states.

use super::{EVERYTHING, one_fault};
use common::scene::SceneSource;

#[test]
fn outputs() {
    one_fault(
        "wear",
        "joints = [\"worn\"]",
        "joints = [\"worn\", \"hinge\"]",
        "outputs.wear.joints: joint \"hinge\" is ideal and does not wear",
    );
    one_fault(
        "wear",
        "joints = [\"worn\"]",
        "joints = [\"held\"]",
        "joint \"held\" has wear = false and does not wear",
    );
    one_fault(
        "wear",
        "joints = [\"worn\"]",
        "joints = []",
        "outputs.wear.joints: is empty, expected at least one joint",
    );
    one_fault(
        "worn",
        "wear_coefficient = \"1e-13 1/Pa\"",
        "wear_coefficient = \"0 1/Pa\"",
        "outputs.wear.joints: every wear_coefficient of these joints is 0",
    );
    one_fault(
        "journal_wear",
        "type = \"journal-wear\"",
        "type = \"journal-wear\"\njoints = [\"worn\"]",
        "outputs.journal_wear.joints: joint \"worn\" has wears = \"bushing\"; there are: struck, undamped",
    );
    one_fault(
        "hinge_force",
        "\"worn\"]",
        "\"wron\"]",
        "outputs.hinge_force.joints: there is no joint \"wron\"",
    );
    one_fault(
        "error",
        "at = { body = \"slider\", point = \"pin\" }",
        "at = { body = \"crank\", point = \"pin\" }",
        "outputs.error.at: body \"crank\" is not free",
    );
    one_fault(
        "torque",
        "body = \"crank\"",
        "body = \"rod\"",
        "outputs.torque.body: body \"rod\" is not driven",
    );
    one_fault("angle", "sign = -1", "sign = 0", "outputs.angle.b.sign: 0 is out of range, allowed: 1 or -1");
    one_fault("speed", "type = \"angular-velocity-difference\"", "type = \"speed\"", "outputs.speed.type");
    for (limit, threshold, wrong, kind) in [
        ("too_askew", "3 deg", "3 mm", "an angle (deg, rad, ...)"),
        ("too_strong", "2 kN", "2 N m", "a force (N, mN, kN, ...)"),
        ("too_far", "0.5 mm", "0.5 N", "a length (mm, um, m, ...)"),
        ("too_hard", "4 N m", "4 N", "a torque (N m, N mm, ...)"),
    ] {
        let (threshold, wrong) = (format!("\"{threshold}\""), format!("\"{wrong}\""));
        one_fault(limit, &threshold, &wrong, kind);
    }
    for name in ["total", "cycles", "standard_error", "numerical"] {
        let expected =
            format!("limit_states.{name}.name: \"{name}\" cannot be a name: it is a column of result files");
        one_fault("too_deep", "name = \"too_deep\"", &format!("name = \"{name}\""), &expected);
    }
}

#[test]
fn wear_needs_a_joint_that_wears() {
    // Without largest-wear over a named joint, and with wear = false everywhere.
    let text = EVERYTHING
        .replace("wear_coefficient = \"1e-13 1/Pa\"\nwear = true", "wear = false")
        .replace("wear_coefficient = \"1e-13 1/Pa\"\ncontrol_points", "wear = false\ncontrol_points")
        .replace("wear_coefficient = \"1e-13 1/Pa\"\n\n", "wear = false\n\n")
        .replace("wears = \"both\"\nwear_coefficient = \"2e-13 1/Pa\"\nslider_wear_coefficient = \"6e-14 1/Pa\"\ncontrol_points = 50\n", "")
        .replace("joints = [\"worn\"]\n", "");
    let found = SceneSource::parse(&text, "my.toml").unwrap_err();
    assert_eq!(found.0.len(), 6, "{found}");
    for fault in &found.0 {
        assert!(fault.to_string().contains("there is no joint that wears"), "{fault}");
    }
}

#[test]
fn wear_may_be_set_to_zero_from_outside() {
    let four_bar = SceneSource::builtin("four-bar").unwrap();
    let setting = four_bar.parse_setting("wear_coefficient=0 1/Pa").unwrap();
    let scene = four_bar.resolve_with(&[setting]).unwrap();
    assert_eq!(scene.outputs, four_bar.nominal().outputs);
}
