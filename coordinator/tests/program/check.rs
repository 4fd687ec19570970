//! `coordinator check`, and messages about files and folders that are not what a command expects.

use crate::{coordinator, printed};
use common::scene::SceneSource;

#[test]
fn issue_a_check_could_not_be_had_without_a_simulation() {
    let quick = printed(&["check", "four-bar", "--quick"]);
    assert!(quick.starts_with("four-bar: valid; 4 bodies"), "{quick}");
    assert!(quick.contains("not simulated (--quick)") && !quick.contains("nominal"), "{quick}");
    let json: serde_json::Value =
        serde_json::from_str(&printed(&["check", "four-bar", "--quick", "--json"])).unwrap();
    assert_eq!(json["nominal"], serde_json::json!([]));
    let named = printed(&["check", "four-bar", "--accuracy", "balanced"]);
    assert!(named.contains("nominal wear: 9.96 µm after 8 000 cycles"), "{named}");
    assert_eq!(coordinator(&["check", "four-bar", "--quick", "--accuracy", "draft"]).status.code(), Some(2));
}

#[test]
fn issue_nothing_showed_the_crank_angle_at_which_a_load_acts() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let text = "[scene]\nname = \"carded\"\nextends = \"four-bar\"\n[[loads]]\nname = \"card\"\ntype = \"torque\"\n\
                body = \"rocker\"\ntorque = { over = { angle = \"crank\" }, at = { unit = \"deg\", values = [0, 90, 360] }, \
                value = { unit = \"N m\", values = [0, -0.2, 0] } }\n";
    std::fs::write(path("carded.toml"), text).unwrap();
    let found = printed(&["check", &path("carded.toml"), "--draw", &path("drawn.svg")]);
    let line = found.lines().find(|line| line.starts_with("load card: ")).expect("a line about the load");
    assert!(line.contains("largest at 90 deg, angle of crank"), "{line}");
    let cost = found.lines().position(|line| line.starts_with("cost: about ")).expect("a cost");
    assert!(cost < found.lines().position(|line| line.starts_with("nominal wear")).expect("a life"));
    let figure = std::fs::read_to_string(path("drawn-loads.svg")).unwrap();
    assert!(figure.contains("angle of crank [deg]") && figure.contains("N m"), "{figure}");
    // A value that is set is that of the mechanism looked at.
    let set = |width: &str| printed(&["check", "four-bar", "--set", &format!("parameters.width={width}")]);
    assert_ne!(set("10 mm").lines().last(), None);
    let life = |text: String| text.lines().find(|line| line.starts_with("nominal wear")).unwrap().to_owned();
    assert_ne!(life(set("10 mm")), life(set("20 mm")));
    assert!(printed(&["draw", "four-bar", "--set", "parameters.crank_length=25 mm"]).contains("four-bar"));
}

#[test]
fn issue_a_scene_that_fails_unworn_was_valid_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("low.toml");
    let text = "[scene]\nname = \"low\"\nextends = \"four-bar\"\n[[limit_states]]\nname = \"speed\"\n\
                output = \"coupler_joint_speed\"\nthreshold = \"100 r/min\"\n";
    std::fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let found = printed(&["check", file]);
    let (verdict, rest) = found.split_once('\n').unwrap();
    assert!(verdict.starts_with(&format!("{file}: valid; ")), "{found}");
    assert!(rest.contains("\nthe nominal mechanism fails unworn by speed\n"), "{found}");
    // As compilers print them, with the place first.
    let warning = rest.lines().find(|line| line.contains("has failed from the start")).expect("a warning");
    assert!(
        warning.starts_with(&format!("{file}:")) && warning.contains(": warning: limit_states.speed: "),
        "{warning}"
    );
}

#[test]
fn issue_what_is_no_study_was_called_by_names_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    let said = |arguments: &[&str]| {
        let output = coordinator(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(said(&["status", "nofolder"]).contains("nofolder: there is no such folder"));
    assert!(said(&["status", dir]).contains("holds no study"));
    assert!(said(&["run", "--accuracy", "exact", "--out", dir]).contains("nor a change of one"));
}

#[test]
fn issue_a_changed_scene_was_written_without_its_comments() {
    let source = SceneSource::builtin("four-bar").unwrap();
    let comments = |text: &str| text.lines().filter(|line| line.trim_start().starts_with('#')).count();
    assert!(comments(source.text()) > 0);
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("study");
    let small = ["--method", "monte-carlo", "--samples", "2", "--accuracy", "draft", "-q"];
    let set = ["run", "four-bar", "--set", "friction=0.06", "--set", "parameters.width=11 mm", "--out"];
    printed(&[&set[..], &[study.to_str().unwrap()], &small].concat());
    let stored = std::fs::read_to_string(study.join("scene.toml")).unwrap();
    assert_eq!(comments(&stored), comments(source.text()));
    let differ = stored.lines().zip(source.text().lines()).filter(|(a, b)| a != b).count();
    assert!(differ <= 3 && stored.contains("width = \"11 mm\""), "{differ}\n{stored}");
}

#[test]
fn every_coupling_rope_and_stop_is_shown_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["drive-train", "feeder", "flap", "roller-cam"] {
        let file = format!("{}/../common/tests/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let drawing = folder.path().join(format!("{name}.svg"));
        printed(&["draw", &file, "--out", drawing.to_str().unwrap()]);
        assert!(std::fs::read_to_string(&drawing).unwrap().contains("</svg>"));
        let found = printed(&["check", &file]);
        assert!(found.contains("\nnominal worn: ") && !found.contains("pulls"), "{found}");
        // A rack to and fro, and a cam that drives its motor on the way down.
        let both_flanks = ["feeder", "roller-cam"].contains(&name);
        assert_eq!(found.contains("the teeth of teeth are loaded on the flank"), both_flanks, "{found}");
    }
}

#[test]
fn issue_a_cam_that_has_to_pull_its_follower_passed_without_a_word() {
    let cam = format!("{}/../common/tests/scenes/roller-cam.toml", env!("CARGO_MANIFEST_DIR"));
    let fast = ["--set", "bodies.motor.speed=-600 r/min", "--set", "loads.spring.stiffness=0.5 N/mm"];
    let found = printed(&[&["check", &cam], &fast[..]].concat());
    let warning = found.lines().find(|line| line.contains("warning: joints.roller: ")).expect("a warning");
    // k (y - 20 mm) + m (g + y''), at three quarters of the rise or a quarter of the fall.
    assert!(warning.contains("the cam roller pulls its follower with up to 13."), "{warning}");
    assert!(
        warning.contains(" N, at 90 deg of cam") || warning.contains(" N, at 210 deg of cam"),
        "{warning}"
    );
}
