//! What the real `coordinator` answers to bad input: one clear message on standard error, the right exit code,
//! nothing on standard output.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const FOUR_BAR: &str = include_str!("../../common/scenes/four-bar.toml");

fn coordinator(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_coordinator")).args(arguments).output().unwrap()
}

/// Exit code and standard error of a command that must fail.
#[track_caller]
fn refused(arguments: &[&str], code: i32) -> String {
    let output = coordinator(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed a result");
    message
}

/// Exactly one line that starts with `error:` and says all of `parts`.
#[track_caller]
fn one_message(message: &str, parts: &[&str]) {
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("error: "), "{message}");
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

/// The four-bar with one piece of its text replaced, in a file of its own.
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
        for command in [
            &["check", file][..],
            &["simulate", "--scene", file],
            &["run", "--scene", file],
            &["explain", "--scene", file],
        ] {
            let message = refused(command, 2);
            assert!(message.contains(file), "{message}");
            let first = message.lines().next().unwrap_or_default();
            one_message(first, parts);
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
fn a_locked_linkage_names_joint_and_angle() {
    let folder = tempfile::tempdir().unwrap();
    // Grashof's condition fails: the crank is as long as the ground link lets it be only part of the way.
    let file = scene_file(folder.path(), "crank_length = \"20 mm\"", "crank_length = \"48 mm\"");
    let file = file.to_str().unwrap();
    for command in [&["check", file][..], &["simulate", "--scene", file], &["run", "--scene", file]] {
        one_message(&refused(command, 2), &[file, "the linkage locks", "joint", "crank angle", "deg", "gap"]);
    }
}

#[test]
fn unknown_scenes() {
    for command in [
        &["simulate", "--scene", "flaping-wing"][..],
        &["check", "flaping-wing"],
        &["run", "--scene", "flaping-wing"],
    ] {
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
        ("friction=-0.1", &["friction", "-0.1", "allowed: >= 0"]),
    ] {
        let message = refused(&["simulate", "--scene", "four-bar", "--set", setting], 2);
        for part in parts {
            assert!(message.contains(part), "no \"{part}\" in: {message}");
        }
    }
    let message = refused(&["simulate", "--scene", "four-bar", "--set", "a=1", "--set", "friction=1 N"], 2);
    assert!(message.contains("2 faults"), "{message}");
}

#[test]
fn bad_options() {
    for (arguments, parts) in [
        (&["run", "--workers", "many"][..], &["--workers", "many", "auto"][..]),
        (&["run", "--accuracy", "exact"], &["--accuracy", "exact", "balanced"]),
        (&["--seed", "3", "scenes"], &["after `run`"]),
        (&["simulat"], &["simulat", "simulate"]),
    ] {
        let message = refused(arguments, 2);
        for part in parts {
            assert!(message.contains(part), "no \"{part}\" in: {message}");
        }
    }
}
