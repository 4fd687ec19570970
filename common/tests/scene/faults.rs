//! Every kind of fault a scene can have: found, named, all at once, never a panic.

use common::scene::SceneSource;
use proptest::prelude::*;

const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");

/// The faults of the four-bar after replacing one piece of its text.
fn faults(from: &str, to: &str) -> Vec<String> {
    assert!(FOUR_BAR.contains(from), "the scene has no {from}");
    match SceneSource::parse(&FOUR_BAR.replacen(from, to, 1), "my.toml") {
        Ok(_) => panic!("{to} was accepted"),
        Err(faults) => {
            assert!(faults.0.iter().all(|fault| fault.location.is_some()), "without a place: {faults}");
            faults.0.iter().map(ToString::to_string).collect()
        }
    }
}

#[track_caller]
fn one_fault(from: &str, to: &str, expected: &str) {
    let found = faults(from, to);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].contains(expected), "found    {}\nexpected {expected}", found[0]);
}

#[test]
fn every_row_of_the_table_is_one_fault() {
    for [from, to, expected] in crate::rows("one fault of the four-bar") {
        one_fault(from, to, expected);
    }
}

#[test]
fn ideal_joints_and_outputs() {
    let slider_crank = include_str!("../../scenes/slider-crank.toml");
    for [from, to, parts] in crate::rows("faults of the slider-crank") {
        assert!(slider_crank.contains(from), "{from}");
        let text = slider_crank.replacen(from, to, 1);
        let found = SceneSource::parse(&text, "my.toml").unwrap_err().to_string();
        for part in parts.split(" … ") {
            assert!(found.contains(part), "no \"{part}\" in: {found}");
        }
    }
}

#[test]
fn issue_a_missing_or_misplaced_unit_of_angle_was_taken_for_radians() {
    let found = faults("friction = 0.05", "friction = \"3 deg\"");
    assert_eq!(found.len(), 3, "{found:#?}");
    assert!(found[0].ends_with("\"friction\" has a unit of angle, expected a plain number"), "{}", found[0]);
    // The mean of a variable is written as the value that it changes.
    let variable = "\n[[variables]]\nname = \"start\"\nchanges = [\"bodies.coupler.start_angle\"]\nstd = \"1 deg\"\nmean = ";
    let with = |mean: &str| format!("{FOUR_BAR}{variable}\"{mean}\"\n");
    let refused = SceneSource::parse(&with("0.9"), "my.toml").unwrap_err().to_string();
    assert!(refused.contains("variables.start.mean: \"0.9\" has no unit of angle"), "{refused}");
    let source = SceneSource::parse(&with("53 deg"), "my.toml").unwrap();
    let set = |text: &str| source.parse_setting(text).map_err(|faults| faults.to_string());
    assert!(set("start=0.9").unwrap_err().contains("has no unit of angle"));
    assert!(set("parameters.friction=4deg").unwrap_err().contains("has a unit of angle"));
    assert!(set("start=0.9rad").is_ok() && set("parameters.friction=0.07").is_ok());
    // Calculations may have either.
    for (from, to) in [
        ("speed = \"900 r/min\"", "speed = \"2 * pi / 0.1 s\""),
        ("speed = \"900 r/min\"", "speed = \"1.2 m/s / crank_length\""),
        ("start_angle = \"0 deg\"", "start_angle = \"pi / 6\""),
        ("friction = 0.05", "friction = \"tan(3 deg)\""),
    ] {
        let text = FOUR_BAR.replacen(from, to, 1);
        assert!(SceneSource::parse(&text, "my.toml").is_ok(), "{to}");
    }
}

#[test]
fn ranges() {
    for [from, to, expected] in crate::rows("ranges") {
        let found = faults(from, to);
        assert!(found[0].contains(expected), "found    {}\nexpected {expected}", found[0]);
    }
    let smaller = faults("radial_clearance = \"clearance\"", "bushing_radius = \"3.9 mm\"");
    assert!(smaller[0].contains("joints.crank.bushing_radius: \"3.9 mm\""), "{smaller:?}");
    assert!(
        smaller[0].contains("allowed: larger than the journal and below twice that, journal_radius = 4 mm"),
        "{smaller:?}"
    );
}

#[test]
fn variables() {
    for [from, to, expected] in crate::rows("variables") {
        let found = faults(from, to);
        if expected == "is_there" {
            assert!(
                found.iter().any(|fault| fault.contains("already changed by the variable")),
                "{found:#?}"
            );
        } else {
            assert_eq!(found.len(), 1, "{found:#?}");
            assert!(found[0].contains(expected), "found    {}\nexpected {expected}", found[0]);
        }
    }
}

#[test]
fn all_faults_at_once() {
    let text = FOUR_BAR
        .replacen("elastic_modulus = \"206 GPa\"", "elastic_modulus = \"206 N\"", 1)
        .replacen("poisson_ratio = 0.34", "poison_ratio = 0.34", 1)
        .replacen("body = \"rocker\"\ntorque", "body = \"rokcer\"\ntorque", 1)
        .replacen("cycles = 8000", "cycles = -1", 1);
    let found = SceneSource::parse(&text, "my.toml").unwrap_err();
    let keys: Vec<_> = found.0.iter().map(|fault| fault.key.as_str()).collect();
    let expected = [
        "materials.bronze.poison_ratio",
        "materials.steel.elastic_modulus",
        "loads.work.body",
        "life.cycles",
    ];
    assert_eq!(keys, expected);
    assert_eq!(found.to_string().lines().count(), 1 + expected.len());
}

#[test]
fn scenes_by_name_and_file() {
    let found = SceneSource::load("flaping-wing").unwrap_err().to_string();
    assert!(found.contains("did you mean \"flapping-wing\"?") && found.contains("four-bar"), "{found}");
    let found = SceneSource::load("nowhere/scene.toml").unwrap_err().to_string();
    assert!(found.contains("nowhere/scene.toml: cannot be read"), "{found}");
    assert!(SceneSource::load("four-bar").is_ok());
}

#[test]
fn a_scene_extends_another() {
    let folder = std::env::temp_dir().join(format!("hingewise-extends-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    let load = |name: &str| SceneSource::load(folder.join(name).to_str().unwrap());
    write("base.toml", FOUR_BAR);
    write("longer.toml", "[scene]\nname = \"longer\"\nextends = \"base.toml\"\n[life]\ncycles = 12000\n");
    write("circle.toml", "[scene]\nname = \"circle\"\nextends = \"circle.toml\"\n");
    write("lost.toml", "[scene]\nname = \"lost\"\nextends = \"four-bra\"\n");
    write(
        "twice.toml",
        "[scene]\nname = \"twice\"\nextends = \"four-bar\"\n[[loads]]\nname = \"x\"\n[[loads]]\nname = \"x\"\n",
    );

    let longer = load("longer.toml").unwrap();
    assert_eq!((longer.nominal().name.as_str(), longer.nominal().life.cycles), ("longer", 12_000));
    assert_eq!(longer.nominal().bodies, SceneSource::builtin("four-bar").unwrap().nominal().bodies);
    // The text stands alone: the worker that receives it has no such file.
    assert_eq!(SceneSource::parse(longer.text(), "sent").unwrap().nominal(), longer.nominal());
    let fault = |name| load(name).unwrap_err().to_string();
    assert!(fault("circle.toml").contains("is it a circle?"));
    assert!(
        fault("lost.toml").contains("scene.extends")
            && fault("lost.toml").contains("did you mean \"four-bar\"")
    );
    assert!(fault("twice.toml").contains("the name \"x\" is taken"));
    std::fs::remove_dir_all(&folder).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_text_panics(text in "\\PC{0,200}") {
        let _ = SceneSource::parse(&text, "random");
    }

    /// Lines of a valid scene, shuffled and cut.
    #[test]
    fn no_mutilated_scene_panics(cut in 0usize..180, again in 0usize..180, chars in 0usize..4000) {
        let mut lines: Vec<&str> = FOUR_BAR.lines().collect();
        let (cut, again) = (cut.min(lines.len() - 1), again.min(lines.len() - 1));
        lines.swap(cut, again);
        lines.remove(cut);
        let text = lines.join("\n");
        let _ = SceneSource::parse(&text, "mutilated");
        let _ = SceneSource::parse(text.get(..chars).unwrap_or(&text), "mutilated");
    }
}

#[test]
fn a_faulty_field_does_not_hide_a_faulty_variable() {
    let text = SceneSource::builtin("four-bar").unwrap().text().to_owned();
    let std =
        text.lines().find(|line| line.starts_with("std = ")).expect("the four-bar has random variables");
    let text =
        text.replacen("poisson_ratio = 0.3", "poisson_ratio = 0.9", 1).replacen(std, "std = \"0 %\"", 1);
    let found = SceneSource::parse(&text, "my.toml").unwrap_err().to_string();
    assert!(found.contains("poisson_ratio") && found.contains(".std"), "{found}");
}

#[test]
fn a_clearance_as_large_as_its_journal_is_refused() {
    let found = faults("clearance = \"30 um\"", "clearance = \"30 mm\"").join("\n");
    assert!(
        found.contains("joints.crank.radial_clearance") && found.contains("smaller than journal_radius"),
        "{found}"
    );
}
