//! Faults of operating conditions.

use super::EVERYTHING;
use common::scene::SceneSource;

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
