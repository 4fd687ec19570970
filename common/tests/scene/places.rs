//! Faults with the file, line and column that they are in, and what to write instead.

use common::scene::{Fault, SceneSource};

const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");

/// The faults of the four-bar after replacing one piece of its text, and the changed text.
fn faults(from: &str, to: &str) -> (Vec<Fault>, String) {
    assert!(FOUR_BAR.contains(from), "the scene has no {from}");
    let text = FOUR_BAR.replacen(from, to, 1);
    (SceneSource::parse(&text, "my.toml").expect_err(to).0, text)
}

/// The piece of the text that a fault points at.
fn piece(fault: &Fault) -> String {
    let place = fault.location.as_ref().unwrap_or_else(|| panic!("{fault} has no place"));
    place.text.chars().skip(place.column - 1).take(place.end_column - place.column).collect()
}

#[test]
fn a_fault_points_at_what_is_to_be_changed() {
    for [from, to, at, says] in crate::rows("a_fault_points_at_what_is_to_be_changed") {
        let (found, text) = faults(from, to);
        let fault = found.iter().find(|fault| fault.to_string().contains(says));
        let fault = fault.unwrap_or_else(|| panic!("{to}: {found:#?}"));
        assert_eq!(piece(fault).trim(), at.trim(), "{to}");
        let place = fault.location.as_ref().unwrap();
        assert_eq!(text.lines().nth(place.line - 1), Some(place.text.as_str()), "{to}");
        assert_eq!(place.file, "my.toml");
    }
}

#[test]
fn what_is_missing_at_the_top_belongs_at_the_end() {
    let faults = SceneSource::parse("[scene]\nname = \"empty\"\n\n", "my.toml").unwrap_err();
    let places: Vec<_> = faults.0.iter().map(|fault| fault.location.clone().unwrap()).collect();
    assert!(places.iter().all(|place| (place.line, place.column) == (2, 15)), "{places:?}");
}

#[test]
fn issue_a_faulty_parameter_was_blamed_where_it_is_used() {
    let (found, _) = faults("width = \"10 mm\"", "width = \"10 N\"");
    assert_eq!(found.len(), 3);
    for fault in &found {
        assert_eq!(piece(fault), "\"10 N\"");
        assert_eq!(fault.used_at.as_ref().unwrap().text, "width = \"width\"");
    }
    let shown = common::scene::Faults(found).explained();
    // One message, and where the parameter is used.
    assert_eq!(shown.matches("error: ").count(), 1, "{shown}");
    assert_eq!(shown.matches(" = used at my.toml:").count(), 3, "{shown}");
    assert!(shown.contains("joints.rocker.width: width = \"width\""), "{shown}");
    // Through a parameter that is another one.
    let (found, _) = faults("width = \"10 mm\"", "width = \"load_torque\"");
    assert!(piece(&found[0]).contains("N m"), "{found:?}");
}

#[test]
fn a_fault_is_in_the_file_that_has_the_value() {
    let folder = std::env::temp_dir().join(format!("hingewise-places-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let base = FOUR_BAR.replacen("friction_speed = \"friction_speed\"", "friction_speed = \"1 mm\"", 1);
    std::fs::write(folder.join("base.toml"), base).unwrap();
    let own = "[scene]\nname = \"own\"\nextends = \"base.toml\"\n[[joints]]\nname = \"crank\"\nwidth = \"1 N\"\n\
               [[bodies]]\nname = \"new\"\n";
    std::fs::write(folder.join("own.toml"), own).unwrap();
    let faults = SceneSource::load(folder.join("own.toml").to_str().unwrap()).unwrap_err();
    let places: Vec<_> = faults
        .0
        .iter()
        .map(|fault| {
            let place = fault.location.as_ref().unwrap();
            assert_eq!(fault.file, place.file);
            let file = place.file.rsplit(['/', '\\']).next().unwrap().to_owned();
            (fault.key.as_str(), file, place.text.clone())
        })
        .collect();
    let expected = [
        ("bodies.new.motion", "own.toml", "name = \"new\""),
        ("joints.crank.width", "own.toml", "width = \"1 N\""),
        ("joints.crank.friction_speed", "base.toml", "friction_speed = \"1 mm\""),
    ]
    .map(|(key, file, text)| (key, file.to_owned(), text.to_owned()));
    assert_eq!(places, expected);

    std::fs::write(folder.join("base.toml"), "[scene]\nname = 'base'\nextends = \"four-bra\"\n").unwrap();
    let faults = SceneSource::load(folder.join("own.toml").to_str().unwrap()).unwrap_err();
    assert_eq!(piece(&faults.0[0]), "\"four-bra\"");
    assert!(faults.0[0].file.ends_with("base.toml"), "{faults}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn warnings_have_a_place_too() {
    let source = SceneSource::parse(FOUR_BAR, "my.toml").unwrap();
    let place = source.location("limit_states.wear").unwrap();
    assert_eq!(place.text, "name = \"wear\"");
    assert!(source.location("no.such.key").is_none());
}
