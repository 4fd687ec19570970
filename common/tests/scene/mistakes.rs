//! Mistakes that are often made: each is answered at its own place, with what to write instead, and nothing else is.

use common::scene::SceneSource;

const SCENE: &str = include_str!("../../scenes/four-bar.toml");

/// What is said of the scene after a change, as on a terminal.
fn said(change: impl FnOnce(&str) -> String) -> String {
    let text = change(SCENE);
    assert_ne!(text, SCENE);
    SceneSource::parse(&text, "my.toml").expect_err("a mistake").explained()
}

/// Number of the first line that contains a text.
fn line(text: &str, piece: &str) -> usize {
    1 + text.lines().position(|line| line.contains(piece)).unwrap_or_else(|| panic!("{piece}"))
}

#[test]
fn issue_a_key_given_twice_was_not_named_with_its_first_place() {
    let twice = SCENE.replacen("friction = 0.05", "friction = 0.05\nfriction = 0.06", 1);
    let found = said(|_| twice.clone());
    let (first, second) = (line(&twice, "friction = 0.05"), line(&twice, "friction = 0.06"));
    assert!(found.contains("`friction` is given twice"), "{found}");
    assert!(found.contains(&format!("my.toml:{second}:1")), "{found}");
    assert!(found.contains(&format!("first at my.toml:{first}:1: friction = 0.05")), "{found}");
    // A table twice, and a key of an inline table.
    let found = said(|text| format!("{text}\n[life]\ncycles = 3\n"));
    assert!(found.contains("`[life]` is given twice") && found.contains("first at"), "{found}");
    let found = said(|text| text.replacen("journal = { body", "journal = { body = \"crank\", body", 1));
    assert!(found.contains("`body` is given twice"), "{found}");
}

#[test]
fn issue_one_bracket_for_a_list_blamed_a_later_line() {
    for list in ["bodies", "joints", "variables"] {
        let wrong = SCENE.replacen(&format!("[[{list}]]"), &format!("[{list}]"), 1);
        let found = said(|_| wrong.clone());
        assert!(found.contains(&format!("begins with [[{list}]], in two brackets")), "{found}");
        assert!(found.contains(&format!("my.toml:{}:1", line(&wrong, &format!("[{list}]")))), "{found}");
    }
    let last = SCENE.rfind("[[variables]]").unwrap();
    let wrong = format!("{}[variables]{}", &SCENE[..last], &SCENE[last + "[[variables]]".len()..]);
    let found = said(|_| wrong);
    assert!(found.contains("begins with [[variables]], in two brackets"), "{found}");
    let found = said(|text| text.replace("[[bodies]]", "[[Bodies]]"));
    assert!(found.contains("begins with [[bodies]], in lower case"), "{found}");
}

#[test]
fn issue_a_name_given_twice_had_faults_of_its_followers() {
    let twice = SCENE.replacen("name = \"rocker\"\nmotion", "name = \"coupler\"\nmotion", 1);
    let found = said(|_| twice.clone());
    assert!(found.contains("bodies[4].name: the name \"coupler\" is taken"), "{found}");
    let first = line(&twice, "name = \"coupler\"");
    assert!(found.contains(&format!("first at my.toml:{first}:8: name = \"coupler\"")), "{found}");
    assert_eq!(found.matches("error:").count(), 1, "{found}");
}

#[test]
fn issue_a_mean_outside_of_the_bounds_pointed_to_the_name() {
    let changes = "changes = [\"parameters.friction\"]";
    let found = said(|text| text.replacen(changes, &format!("{changes}\nlower = 0.5\nupper = 0.6"), 1));
    assert!(found.contains("lower = 0.5") || found.contains("upper = 0.6"), "{found}");
    assert!(
        found.contains("do not enclose the mean") && found.contains(": move them, or the mean"),
        "{found}"
    );
}

#[test]
fn issue_a_third_coordinate_was_a_list_where_a_pair_was_expected() {
    let found = said(|text| text.replacen("[\"0 mm\", \"0 mm\"]", "[\"0 mm\", \"0 mm\", \"0 mm\"]", 1));
    assert!(found.contains("has 3 entries, expected a pair [x, y]: everything is planar"), "{found}");
}

#[test]
fn issue_a_separator_of_thousands_became_a_decimal_point() {
    for (written, says) in [
        ("9,000 N m", "write 9000 if it separates thousands, 9.000 if it is a decimal comma"),
        ("-1,234,567 N m", "digits have no separators: 1234567"),
        ("0,500 N m", "use a decimal point: 0.500"),
        ("9,05 N m", "use a decimal point: 9.05"),
        ("12345,678 N m", "use a decimal point: 12345.678"),
    ] {
        let found = said(|text| text.replacen("\"-0.8 N m\"", &format!("\"{written}\""), 1));
        assert!(found.contains(says), "{written}: {found}");
    }
    let found = said(|text| text.replacen("friction = 0.05", "friction = 9,000", 1));
    assert!(found.contains("write 9000 if it separates thousands"), "{found}");
}

/// The only fault after a change, which has this text and place.
#[track_caller]
fn only(from: &str, to: &str, says: &str) {
    let found = said(|text| text.replacen(from, to, 1));
    assert_eq!(found.matches("error: ").count(), 1, "{to}: {found}");
    assert!(found.contains(says), "{to}: {found}");
}

#[test]
fn issue_a_misspelt_key_was_missing_too() {
    for (from, to, says) in [
        (
            "friction_speed = \"friction_speed\"",
            "frction_speed = \"friction_speed\"",
            "frction_speed: unknown key, did you mean \"friction_speed\"?",
        ),
        // Of two keys of which one is needed, and one that decides about the others.
        ("radial_clearance = \"cl", "radial_clearence = \"cl", "did you mean \"radial_clearance\"?"),
        ("type = \"clearance\"", "tpye = \"clearance\"", "tpye: unknown key, did you mean \"type\"?"),
        (
            "name = \"rocker\"\nmotion",
            "nmae = \"rocker\"\nmotion",
            "nmae: unknown key, did you mean \"name\"?",
        ),
        ("[life]", "[lief]", "lief: unknown key, did you mean \"life\"?"),
        ("[parameters]", "[parametres]", "parametres: unknown key, did you mean \"parameters\"?"),
        ("checkpoint_every", "checkpoint-every", "did you mean \"checkpoint_every\"?"),
        ("[bodies.points]", "[bodies.point]", "did you mean \"points\"?"),
    ] {
        only(from, to, says);
    }
    // A default of joints, in the place of the keys of three joints.
    let text = SCENE.replace("width = \"width\"\n", "");
    let found = said(|_| format!("[joint_defaults]\nwdith = \"10 mm\"\n{text}"));
    assert_eq!(found.matches("error: ").count(), 1, "{found}");
    assert!(found.contains("joint_defaults.wdith: unknown key, did you mean \"width\"?"), "{found}");
}

#[test]
fn issue_a_table_for_a_list_was_missing_too() {
    only(
        "[[limit_states]]",
        "[limit_states.wear]",
        "expected a list of tables [[limit_states]]: each row begins with this head",
    );
    only("[bodies.points]", "[[bodies.points]]", "expected a table, whose head has one bracket on each side");
}

#[test]
fn issue_signs_of_other_languages_were_no_hint() {
    for (from, to, says) in [
        ("speed = \"900 r/min\"", "speed: \"900 r/min\"", "write speed = \"900 r/min\""),
        ("checkpoint_every =", "checkpoint every =", "a key has no spaces: checkpoint_every ="),
        ("cycles = 8000", "cycles = 8 000", "digits have no separators: 8000"),
        ("cycles = 8000", "cycles = 8'000", "digits have no separators: 8000"),
        ("cycles = 8000", "cycles = 8000;", "nothing follows a value: 8000"),
        ("cycles = 8000", "cycles = 8000 // of life", "a comment begins with #"),
        ("cycles = 8000", "cycles = 8e3", ": 8000 is written without point and exponent"),
        ("[\"parameters.friction\"]", "[\"friction\"]", "did you mean \"parameters.friction\"?"),
    ] {
        only(from, to, says);
    }
}

#[test]
fn issue_keys_in_whose_place_a_program_has_its_own_passed_without_a_word() {
    let cycle = include_str!("../scenes/cycle.toml");
    let keys = |text: &str| -> Vec<String> {
        let source = SceneSource::parse(text, "cycle.toml").unwrap_or_else(|faults| panic!("{faults}"));
        source.warnings().into_iter().map(|warning| warning.key).collect()
    };
    assert!(keys(cycle).is_empty());
    let own = "name = \"rail\"\naxis = \"90 deg\"\nangle = \"0 deg\"\nfriction = 0.1";
    let found = keys(&cycle.replacen("name = \"rail\"", own, 1));
    assert_eq!(found, ["joints.rail.axis", "joints.rail.angle", "joints.rail.friction"]);
}
