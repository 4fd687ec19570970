//! Faults of operating conditions.

use super::{EVERYTHING, one_fault};
use common::scene::SceneSource;

#[test]
fn conditions() {
    one_fault(
        "full",
        "share = \"30 %\"",
        "share = \"31 %\"",
        "conditions: the shares add up to 1.01, not to 1",
    );
    one_fault(
        "full",
        "share = \"30 %\"",
        "share = 0",
        "conditions.full.share: 0 is out of range, allowed: > 0 and <= 1",
    );
    // Only of the wear, which is the same under all conditions, both ends are known.
    one_fault(
        "out_of_range",
        "output = \"all_wear\"\nlower = \"2 um\"\nupper = \"9 um\"",
        "output = \"hinge_force\"\nlower = \"20 N\"\nupper = \"2 kN\"",
        "limit_states.out_of_range: over several conditions an output of the motion is its largest or its smallest value",
    );
    one_fault(
        "too_weak",
        "output = \"hardest_blow\"\nthreshold = \"0.1 mJ\"",
        "output = \"torque\"\nthreshold = \"0.1 N m\"",
        "limit_states.too_weak: over several conditions an output of the motion is its largest or its smallest value",
    );
    one_fault("full", "share = \"30 %\"\n", "", "conditions.full.share: is missing");
    one_fault("full", "\"30 %\"", "\"30 s\"", "conditions.full.share: \"30 s\" is a time");
    one_fault("idle", "share", "part = 3\nshare", "conditions.idle.part: unknown key");
    one_fault("idle", "\"idle\"", "\"full\"", "full");
    one_fault(
        "full",
        "changes = {",
        "changes = 3 #",
        "conditions.full.changes: 3 is a number, expected a table",
    );
    let change = "\"loads.brake.torque\"";
    let brake = "conditions.full.changes.loads.brake.torque";
    one_fault(
        "full",
        "1.5 * full_torque",
        "1.5 N",
        &format!("{brake}: \"1.5 N\" is a force, expected a torque"),
    );
    one_fault(
        "full",
        "\"1.5 * full_torque\"",
        "[1]",
        &format!("{brake}: the value is a list, expected a torque"),
    );
    one_fault(
        "full",
        change,
        "\"loads.brake.torqe\"",
        "conditions.full.changes.loads.brake.torqe: there is no quantity \"loads.brake.torqe\", did you mean \"loads.brake.torque\"?",
    );
    // What is wrong only under the condition is stated at its change, also where that is a table in a table.
    one_fault(
        "full",
        "friction = 0.06",
        "friction = -0.06",
        "conditions.full.changes.joints.worn.friction: joints.worn.friction: -0.06 (set from outside) is out of range",
    );
    one_fault(
        "full",
        "friction = 0.06",
        "bushing_radius = \"4.3 mm\"",
        "conditions.full.changes: changes the bore of joint \"worn\", which all conditions share",
    );
    one_fault(
        "full",
        "friction = 0.06",
        "wear_coefficient = \"0 1/Pa\"",
        "conditions.full.changes: changes the bore of joint \"worn\"",
    );
    one_fault(
        "full",
        "worn = { friction = 0.06 }",
        "rail = { clearance = \"0.4 mm\" }",
        "conditions.full.changes: changes the faces of joint \"rail\", which all conditions share",
    );
    // Both surfaces of a joint wear under one history of contacts.
    one_fault(
        "full",
        "worn = { friction = 0.06 }",
        "undamped = { journal_wear_coefficient = \"9e-14 1/Pa\" }",
        "conditions.full.changes: changes the bore of joint \"undamped\", which all conditions share: of a joint they may change \
         friction, damping and, if it wears, the wear coefficient, of both surfaces by the same factor",
    );
    one_fault(
        "full",
        &format!("{change} = \"1.5 * full_torque\""),
        "\"limit_states.too_deep.threshold\" = \"6 um\"",
        "conditions.full.changes.limit_states.too_deep.threshold: conditions change what a cycle depends on",
    );
    one_fault(
        "full",
        &format!("{change} = \"1.5 * full_torque\""),
        "\"bodies.crank.speed\" = \"900 r/min\"",
        "conditions.full.changes: life.period: a cycle of 0.1 s is not a multiple of",
    );
}

#[test]
fn faults_of_conditions_are_where_they_are_written() {
    let text = EVERYTHING.replacen("1.5 * full_torque", "1.5 * full_torqe", 1);
    let found = SceneSource::parse(&text, "my.toml").unwrap_err();
    let place = found.0[0].location.clone().unwrap();
    assert!(place.text.contains("1.5 * full_torqe"), "{place:?}");
    assert!(found.0[0].to_string().contains("full_torqe"), "{found}");
}

#[test]
fn a_simulator_has_no_conditions() {
    let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\noutputs = [{ name = \"a\" }]\n\
                conditions = [{ name = \"a\", share = 1 }]";
    let found = SceneSource::parse(text, "s").unwrap_err().to_string();
    assert!(found.contains("conditions: unknown key"), "{found}");
}

#[test]
fn issue_a_variable_that_every_condition_overrides_was_dead_without_a_word() {
    let keys = |second: &str| -> Vec<String> {
        let text = format!(
            "[scene]\nname = \"t\"\nextends = \"four-bar\"\n\
             [[conditions]]\nname = \"full\"\nshare = 0.5\nchanges = {{ \"parameters.load_torque\" = \"-0.2 N m\" }}\n\
             [[conditions]]\nname = \"part\"\nshare = 0.5\nchanges = {{ {second} }}\n"
        );
        let source = SceneSource::parse(&text, "my.toml").unwrap_or_else(|faults| panic!("{faults}"));
        source.warnings().into_iter().map(|warning| warning.key).collect()
    };
    assert_eq!(keys("\"parameters.load_torque\" = \"-0.1 N m\""), ["variables.load_torque"]);
    assert_eq!(keys("\"joints.crank.friction\" = 0.06"), [""; 0]);
}
