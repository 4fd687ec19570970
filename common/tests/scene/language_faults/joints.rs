//! Faults of joints and of what dissipates in them.

use super::faults;

#[test]
fn joints() {
    let found = faults("name = \"hinge\"", "a = {", "journal = {");
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found[0].contains("joints.hinge.a: is missing, expected a place { body, point }"), "{found:?}");
    assert!(
        found[1].contains("joints.hinge.journal: unknown key; allowed here: name, type, a, b"),
        "{found:?}"
    );
    let found = faults("name = \"hinge\"", "pin_radius = \"5 mm\"", "guide_length = \"5 mm\"");
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found[0].contains("joints.hinge.pin_radius: is missing, expected a length"), "{found:?}");
    assert!(found[1].contains("joints.hinge.guide_length: unknown key"), "{found:?}");
}

#[test]
fn guides() {
    let found = faults("name = \"rail\"", "slider = {", "slide = {");
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].contains("joints.rail.slide: unknown key, did you mean \"slider\"?"), "{found:?}");
    assert!(!found[0].contains("journal_wear") && !found[0].contains("wall"), "{found:?}");
}

#[test]
fn wear_of_guides() {
    let found = faults("name = \"rail\"", "wears = \"both\"\n", "");
    assert_eq!(found.len(), 3, "{found:#?}");
    for key in ["wear_coefficient", "slider_wear_coefficient", "control_points"] {
        let fault = format!("joints.rail.{key}: needs wears = \"guide\", \"slider\" or \"both\"");
        assert!(found.iter().any(|found| found.contains(&fault)), "{key}: {found:#?}");
    }
}
