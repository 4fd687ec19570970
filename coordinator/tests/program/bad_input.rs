//! What the real `coordinator` answers to bad input: one clear message on standard error, the right exit code,
//! nothing on standard output.

use crate::{coordinator, refused};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const FOUR_BAR: &str = include_str!("../../../common/scenes/four-bar.toml");

/// Exactly one line that starts with `error:` and contains all of `parts`.
#[track_caller]
fn one_message(message: &str, parts: &[&str]) {
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("error: "), "{message}");
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

/// The same of a fault, whose place follows in further lines.
#[track_caller]
fn first_message(message: &str, parts: &[&str]) {
    one_message(message.lines().next().unwrap_or_default(), parts);
}

/// The four-bar with one piece of its text replaced, in a new file.
fn scene_file(folder: &Path, from: &str, to: &str) -> PathBuf {
    assert!(FOUR_BAR.contains(from));
    let path = folder.join("scene.toml");
    std::fs::write(&path, FOUR_BAR.replacen(from, to, 1)).unwrap();
    path
}

#[test]
fn faulty_scenes() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, parts) in [
        (
            "\nwidth = \"width\"",
            "\nwidht = \"1 mm\"\nwidth = \"width\"",
            &["joints.crank.widht", "unknown key, did you mean \"width\"?"][..],
        ),
        (
            "width = \"width\"",
            "width = \"1.5 N\"",
            &["joints.crank.width", "\"1.5 N\" is a force, expected a length (mm, um, m, ...)"],
        ),
        (
            "radial_clearance = \"clearance\"",
            "radial_clearance = \"-30 um\"",
            &["joints.crank.radial_clearance", "\"-30 um\"", "allowed: > 0"],
        ),
        (
            "radial_clearance = \"clearance\"",
            "bushing_radius = \"3.9 mm\"",
            &["joints.crank.bushing_radius", "\"3.9 mm\"", "larger than the journal", "4 mm"],
        ),
        ("std = \"5 %\"", "std = \"0 %\"", &["variables.wear_coefficient.std", "\"0 %\"", "allowed: > 0"]),
    ] {
        let file = scene_file(folder.path(), from, to);
        let file = file.to_str().unwrap();
        for command in ["check", "simulate", "run", "explain"] {
            let words: Vec<&str> = command.split(' ').chain([file]).collect();
            let message = refused(&words, 2);
            assert!(message.contains(file), "{message}");
            first_message(&message, parts);
        }
    }
}

#[test]
fn every_fault_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = scene_file(folder.path(), "\nwidth = \"width\"", "\nwidth = \"1 N\"\nfritcion = 3");
    let message = refused(&["check", file.to_str().unwrap()], 2);
    assert!(message.contains("2 faults"), "{message}");
    assert!(message.contains("joints.crank.width") && message.contains("joints.crank.fritcion"), "{message}");
}

#[test]
fn a_fault_is_shown_in_its_line_and_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = scene_file(folder.path(), "\nwidth = \"width\"", "\nwidth = \"20 mmm\"");
    let file = file.to_str().unwrap();
    let message = refused(&["check", file], 2);
    let lines: Vec<&str> = message.lines().collect();
    assert_eq!(lines[1], format!("  --> {file}:79:13"), "{message}");
    assert_eq!(lines[3..], ["79 | width = \"20 mmm\"", "   |             ^^^"], "{message}");

    let output = coordinator(&["check", file, "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&found["valid"], &found["file"]), (&false.into(), &file.into()));
    let fault = &found["faults"][0];
    assert_eq!(
        (&fault["line"], &fault["column"], &fault["end_column"]),
        (&79.into(), &13.into(), &16.into())
    );
    assert_eq!((&fault["file"], &fault["key"]), (&file.into(), &"joints.crank.width".into()));
    assert!(fault["message"].as_str().unwrap().contains("did you mean `mm`?"), "{found}");
    // Issue: a linkage that cannot be assembled had no line.
    let file = scene_file(folder.path(), "ground_length = \"70 mm\"", "ground_length = \"170 mm\"");
    let output = coordinator(&["check", file.to_str().unwrap(), "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let fault = &found["faults"][0];
    assert!(fault["message"].as_str().unwrap().contains("cannot be assembled"), "{found}");
    assert_eq!((&fault["key"], &fault["line"]), (&"joints.coupler".into(), &91.into()), "{found}");
}

#[test]
fn a_locked_linkage_names_joint_and_angle() {
    let folder = tempfile::tempdir().unwrap();
    // Grashof's condition fails: the crank is as long as the ground link lets it be only part of the way.
    let file = scene_file(folder.path(), "crank_length = \"20 mm\"", "crank_length = \"48 mm\"");
    let file = file.to_str().unwrap();
    for command in [&["check", file][..], &["simulate", file], &["run", file]] {
        let message = refused(command, 2);
        assert!(message.contains(&format!("{file}:91:")), "{message}");
        first_message(
            &message,
            &["linkage locks: joint coupler can follow", "than to crank angle 136.8 deg"],
        );
    }
}

#[test]
fn a_nominal_mechanism_that_cannot_be_simulated_does_not_pass_the_check() {
    let folder = tempfile::tempdir().unwrap();
    let file = scene_file(
        folder.path(),
        "\nfriction = \"friction\"",
        "\nwall = \"0.5 um\"\nfriction = \"friction\"",
    );
    let file = file.to_str().unwrap();
    let Output { status, stdout, stderr } = coordinator(&["check", file]);
    assert_eq!((status.code(), stdout.starts_with(format!("{file}: valid; ").as_bytes())), (Some(1), true));
    one_message(&String::from_utf8_lossy(&stderr), &[file, "the simulation failed", "crank", "worn through"]);
    let output = coordinator(&["check", file, "--json"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.status.code(), &found["valid"]), (Some(1), &serde_json::Value::Bool(false)));
}

#[test]
fn a_linkage_that_cannot_be_assembled_or_is_tied_twice_names_its_joint() {
    let folder = tempfile::tempdir().unwrap();
    // Coupler and rocker together are shorter than the way from the crank to the frame.
    let file = scene_file(folder.path(), "ground_length = \"70 mm\"", "ground_length = \"170 mm\"");
    let open = refused(&["check", file.to_str().unwrap()], 2);
    first_message(&open, &["cannot be assembled: the start positions contradict joint coupler most"]);
    // The same hinge twice, both ideal.
    let twin = "\n[[joints]]\nname = \"NAME\"\ntype = \"revolute\"\na = { body = \"rocker\", point = \"frame_pin\" }\n\
                b = { body = \"frame\", point = \"rocker_pin\" }\n";
    let twins = ["first", "second"].map(|name| twin.replace("NAME", name)).concat();
    let file = scene_file(folder.path(), "\n[[loads]]", &format!("{twins}\n[[loads]]"));
    let tied = refused(&["check", file.to_str().unwrap()], 2);
    first_message(&tied, &["over-constrained: joint second", "give one of the joints a clearance"]);
}

#[test]
fn a_study_of_nothing_random() {
    one_message(
        &refused(&["run", "pendulum"], 2),
        &["pendulum: a study needs at least one random variable and one limit state", "`simulate`"],
    );
}

#[test]
fn issue_a_missing_folder_was_found_out_after_the_computation() {
    let folder = tempfile::tempdir().unwrap();
    // A linkage that locks: the folder is looked at before the mechanism.
    let file = scene_file(folder.path(), "crank_length = \"20 mm\"", "crank_length = \"48 mm\"");
    let scene = file.to_str().unwrap();
    let missing = folder.path().join("no/such/folder");
    let out = missing.join("one.json");
    let message = refused(&["simulate", scene, "--out", out.to_str().unwrap()], 2);
    one_message(&message, &["--out", &format!("there is no folder {}", missing.display())]);
}

#[test]
fn pictures_and_files_that_are_no_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let message = refused(&["draw", "four-bar", "--out", &path("x.pdf")], 2);
    one_message(&message, &["--out", "x.pdf", "pictures are written as .svg or .dxf, not as .pdf"]);
    std::fs::write(path("campaign.db"), [0x53, 0xff, 0xfe, 0x00]).unwrap();
    let message = refused(&["check", &path("campaign.db")], 2);
    one_message(&message, &["campaign.db", "it is no text, expected the TOML file of a scene"]);
    one_message(&refused(&["check", &path("")], 2), &["it is a folder, expected the TOML file of a scene"]);
    one_message(&refused(&["check", &path("missing.toml")], 2), &["missing.toml", "there is no such file"]);
}

#[test]
fn unknown_scenes() {
    for command in [&["simulate", "flaping-wing"][..], &["check", "flaping-wing"], &["run", "flaping-wing"]] {
        one_message(
            &refused(command, 2),
            &["flaping-wing: no such scene or file", "did you mean \"flapping-wing\"?"],
        );
    }
    one_message(&refused(&["check", "no/such/file.toml"], 2), &["no/such/file.toml: cannot be read"]);
    one_message(&refused(&["scenes", "--show", "five-bar"], 2), &["did you mean \"four-bar\"?"]);
}

#[test]
fn bad_settings() {
    for (setting, parts) in [
        ("load_torqe=1 N m", &["no variable \"load_torqe\"", "did you mean \"load_torque\"?"][..]),
        ("load_torque=1 kg", &["\"1 kg\" is a mass, expected a torque (N m, N mm, ...)"]),
        ("load_torque", &["expected variable=value"]),
        ("life.cycles=100", &["life.cycles", "no random variable and no quantity", "`extends`"]),
        ("friction=-0.1", &["friction", "-0.1", "allowed: 0 to 2"]),
    ] {
        let message = refused(&["simulate", "four-bar", "--set", setting], 2);
        for part in parts {
            assert!(message.contains(part), "no \"{part}\" in: {message}");
        }
    }
    let twice = ["simulate", "four-bar", "--set", "friction=0.1", "--set", "friction=0.2"];
    one_message(&refused(&twice, 2), &["--set", "friction is set twice"]);
    let message = refused(&["simulate", "four-bar", "--set", "a=1", "--set", "friction=1 N"], 2);
    assert!(message.contains("2 faults"), "{message}");
}

#[test]
fn bad_options() {
    for (arguments, parts) in [
        (&["run", "--workers", "many"][..], &["--workers", "many", "auto"][..]),
        (&["run", "--accuracy", "exact"], &["--accuracy", "exact", "balanced"]),
        (&["run", "--max-error", "2"], &["--max-error", "2", "1%"]),
        (&["run", "--max-error", "1%", "--accuracy", "draft"], &["--max-error", "--accuracy"]),
        (&["simulate", "--accuracy", "draft+jump-0"], &["--accuracy", "jump-", "whole numbers"]),
        (&["--seed", "3", "scenes"], &["after `run`"]),
        (&["simulat"], &["simulat", "simulate"]),
    ] {
        let message = refused(arguments, 2);
        for part in parts {
            assert!(message.contains(part), "no \"{part}\" in: {message}");
        }
    }
}

#[test]
fn folders_that_hold_no_finished_study() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    for command in ["resume", "report", "sensitivity"] {
        one_message(&refused(&[command, dir], 2), &[dir, "holds no study"]);
    }
}

#[test]
fn addresses_that_cannot_be_listened_on() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let out = out.to_str().unwrap();
    let run = ["run", "four-bar", "--workers", "0", "--out", out];
    let with = |more: &[&'static str]| [&run[..], more].concat();
    one_message(&refused(&with(&["--listen", "tcp/0.0.0.0:0"]), 2), &["tcp/0.0.0.0:0", "--insecure"]);
    one_message(
        &refused(&with(&["--listen", "nowhere"]), 2),
        &["--listen nowhere", "e.g. tcp/127.0.0.1:7447"],
    );
    one_message(&refused(&with(&["--config", "no.json5"]), 2), &["no.json5"]);
    // No folder was created.
    assert!(!Path::new(out).exists());
}

/// A study that waits for workers, ended when the test ends, however it ends.
struct Waiting(std::process::Child);

impl Drop for Waiting {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn an_output_folder_in_use() {
    use std::io::{BufRead, BufReader};
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    let run = ["run", "four-bar", "--workers", "0", "--out", dir];
    let child = Command::new(env!("CARGO_BIN_EXE_coordinator"))
        .args(run)
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let mut waiting = Waiting(child);
    let mut lines = BufReader::new(waiting.0.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.starts_with("waiting for workers: worker --connect tcp/127.0.0.1:")));

    for command in [&run[..], &["resume", dir]] {
        one_message(&refused(command, 2), &[dir, "in use by another running coordinator"]);
    }
    // Reading takes no lock.
    one_message(&refused(&["report", dir], 2), &[dir, "not finished"]);
    let status = coordinator(&["status", dir]);
    assert!(String::from_utf8_lossy(&status.stdout).starts_with("four-bar: running"), "{status:?}");

    // Ctrl-C: everything done so far is saved, and the study can go on.
    let killed = Command::new("kill").args(["-INT", &waiting.0.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert!(lines.any(|line| line.starts_with("error: interrupted;") && line.contains("coordinator resume")));
    assert_eq!(waiting.0.wait().unwrap().code(), Some(130));
    for workers in ["0", "1"] {
        let again = ["run", "four-bar", "--workers", workers, "--out", dir];
        one_message(&refused(&again, 2), &[dir, "already holds a study", "coordinator resume"]);
    }
    one_message(&refused(&["report", dir], 2), &[dir, "not finished"]);
}
