//! Faults of joints and of what dissipates in them.

use super::{faults, one_fault};

#[test]
fn joints() {
    one_fault(
        "hinge",
        "type = \"revolute\"",
        "type = \"ideal\"",
        "joints.hinge.type: \"ideal\" is unknown; allowed: revolute, prismatic, fixed, clearance",
    );
    one_fault(
        "hinge",
        "b = { body = \"crank\", point = \"pin\" }",
        "b = { body = \"rod\", point = \"far\" }",
        "joints.hinge: a and b are on the same body",
    );
    one_fault(
        "worn",
        "bushing = { body = \"slider\", point = \"pin\" }",
        "bushing = { body = \"rod\", point = \"near\" }",
        "joints.worn: journal and bushing are on the same body",
    );
    let found = faults("name = \"hinge\"", "a = {", "journal = {");
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found[0].contains("joints.hinge.a: is missing, expected a place { body, point }"), "{found:?}");
    assert!(
        found[1].contains("joints.hinge.journal: unknown key; allowed here: name, type, a, b"),
        "{found:?}"
    );
    one_fault("guide", "axis = \"15 deg\"", "axis = \"15 mm\"", "joints.guide.axis: \"15 mm\" is a length");
    one_fault("weld", "angle = \"90 deg\"", "axis = \"9 deg\"", "joints.weld.axis: unknown key");
    one_fault("weld", "angle = \"90 deg\"", "friction = 0.1", "joints.weld.friction: unknown key");
    one_fault(
        "hinge",
        "friction = 0.1",
        "friction = -0.1",
        "joints.hinge.friction: -0.1 is out of range, allowed: 0 to 2",
    );
    one_fault("hinge", "friction = 0.1\n", "", "joints.hinge.friction: is missing, expected a plain number");
    one_fault(
        "guide",
        "friction_speed = \"2 mm/s\"\n",
        "",
        "joints.guide.friction_speed: is missing, expected a speed",
    );
    one_fault(
        "guide",
        "guide_length = \"arm / 2\"\n",
        "",
        "joints.guide.guide_length: is missing, expected a length",
    );
    one_fault(
        "guide",
        "\"arm / 2\"",
        "\"-arm\"",
        "joints.guide.guide_length: \"-arm\" = -20 mm is out of range, allowed: > 0",
    );
    let found = faults("name = \"hinge\"", "pin_radius = \"5 mm\"", "guide_length = \"5 mm\"");
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found[0].contains("joints.hinge.pin_radius: is missing, expected a length"), "{found:?}");
    assert!(found[1].contains("joints.hinge.guide_length: unknown key"), "{found:?}");
    one_fault("weld", "name = \"weld\"", "name = \"guide\"", "the name \"guide\" is taken");
    one_fault(
        "unworn",
        "wear = false",
        "wear = \"no\"",
        "joints.unworn.wear: \"no\" is a text, expected true or",
    );
    one_fault("worn", "wear_coefficient = \"1e-13 1/Pa\"\n", "", "joints.worn.wear_coefficient: is missing");
    one_fault(
        "held",
        "\"1e-13 1/Pa\"",
        "\"-1e-13 1/Pa\"",
        "joints.held.wear_coefficient: \"-1e-13 1/Pa\" is out",
    );
    one_fault(
        "worn",
        "wall = \"1 mm\"",
        "wall = \"0 mm\"",
        "joints.worn.wall: \"0 mm\" is out of range, allowed: > 0",
    );
    one_fault(
        "struck",
        "wears = \"journal\"",
        "wears = \"pin\"",
        "joints.struck.wears: \"pin\" is unknown; allowed: bushing, journal, both",
    );
    one_fault(
        "undamped",
        "wears = \"both\"\n",
        "",
        "joints.undamped.journal_wear_coefficient: needs wears = \"both\"",
    );
    one_fault(
        "undamped",
        "\"5e-14 1/Pa\"",
        "\"-5e-14 1/Pa\"",
        "joints.undamped.journal_wear_coefficient: \"-5e-14 1/Pa\" is out of range, allowed: >= 0",
    );
}

#[test]
fn damping() {
    let law = "law = \"lankarani-nikravesh\"";
    one_fault(
        "unworn",
        law,
        "law = \"lankarani-nikraves\"",
        "contact_damping.law: \"lankarani-nikraves\" is unknown, did you mean \"lankarani-nikravesh\"?; allowed: lank",
    );
    for value in ["0", "1.01", "-0.5"] {
        one_fault(
            "unworn",
            "restitution = 0.9",
            &format!("restitution = {value}"),
            &format!("damping.restitution: {value} is out of range, allowed: > 0 and <= 1"),
        );
    }
    one_fault("unworn", "restitution = 0.9, ", "", "contact_damping.restitution: is missing");
    one_fault(
        "unworn",
        "\"2 mm/s\"",
        "\"0 mm/s\"",
        "contact_damping.least_speed: \"0 mm/s\" is out of range",
    );
    one_fault(
        "unworn",
        law,
        &format!("{law}, hunt_crossley = \"1 s/m\""),
        "joints.unworn.contact_damping: give either hunt_crossley or law, not both",
    );
    one_fault(
        "worn",
        "{ hunt_crossley = \"7.5 s/m\" }",
        "{ }",
        "contact_damping.hunt_crossley: is missing, expected an inverse speed (s/m, ...), or law with restitution",
    );
    one_fault(
        "worn",
        "{ hunt_crossley = \"7.5 s/m\" }",
        "7.5",
        "contact_damping: 7.5 is a number, expected \"none\"",
    );
}

#[test]
fn guides() {
    one_fault("rail", "\"50 mm\"", "\"0 mm\"", "joints.rail.length: \"0 mm\" is out of range, allowed: > 0");
    one_fault(
        "rail",
        "\"0.5 mm\"",
        "\"31 mm\"",
        "joints.rail.clearance: \"31 mm\" is out of range, allowed: smaller than height = 30 mm",
    );
    one_fault(
        "rail",
        "\"4 * arm\"",
        "\"30 mm\"",
        "joints.rail.guide_end: leaves no room for the slider, whose length is 50 mm",
    );
    one_fault(
        "rail",
        "guide_start = \"-20 mm\"\n",
        "",
        "joints.rail.guide_start: is missing, expected a length",
    );
    one_fault(
        "rail",
        "slider_material = \"steel\"",
        "slider_material = \"stel\"",
        "joints.rail.slider_material",
    );
    let found = faults("name = \"rail\"", "slider = {", "slide = {");
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found[0].contains("joints.rail.slider: is missing, expected a place"), "{found:?}");
    assert!(found[1].contains("joints.rail.slide: unknown key, did you mean \"slider\"?"), "{found:?}");
    assert!(!found[1].contains("journal_wear") && !found[1].contains("wall"), "{found:?}");
}

#[test]
fn wear_of_guides() {
    one_fault(
        "rail",
        "wears = \"both\"",
        "wears = \"bushing\"",
        "joints.rail.wears: \"bushing\" is unknown; allowed: guide, slider, both",
    );
    one_fault(
        "rail",
        "wears = \"both\"",
        "wears = \"slider\"",
        "joints.rail.slider_wear_coefficient: needs wears = \"both\"; a single surface",
    );
    one_fault(
        "rail",
        "wear_coefficient = \"2e-13 1/Pa\"\n",
        "",
        "joints.rail.wear_coefficient: is missing, expected an inverse pressure",
    );
    one_fault(
        "rail",
        "\"6e-14 1/Pa\"",
        "\"-6e-14 1/Pa\"",
        "joints.rail.slider_wear_coefficient: \"-6e-14 1/Pa\" is out of range, allowed: >= 0",
    );
    one_fault(
        "rail",
        "control_points = 50",
        "control_points = 7",
        "joints.rail.control_points: 7 is out of range",
    );
    let found = faults("name = \"rail\"", "wears = \"both\"\n", "");
    assert_eq!(found.len(), 3, "{found:#?}");
    for key in ["wear_coefficient", "slider_wear_coefficient", "control_points"] {
        let fault = format!("joints.rail.{key}: needs wears = \"guide\", \"slider\" or \"both\"");
        assert!(found.iter().any(|found| found.contains(&fault)), "{key}: {found:#?}");
    }
    for (key, value, message) in [
        ("wall", "\"2 mm\"", "a guide is not worn through"),
        ("wear", "true", "a guide wears where it has wears ="),
        ("journal_wear_coefficient", "\"1e-13 1/Pa\"", "the second surface of a guide is its slider"),
    ] {
        let more = format!("friction = 0.1\n{key} = {value}");
        one_fault("rail", "friction = 0.1", &more, &format!("joints.rail.{key}: {message}"));
    }
}
