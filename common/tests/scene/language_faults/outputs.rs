//! Faults of outputs and limit states.

use super::EVERYTHING;
use common::scene::SceneSource;

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
