//! Every command of the tutorial runs, in its order, in one folder.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tests::program;

const TUTORIAL: &str = include_str!("../../../coordinator/doc/tutorial.md");

/// Commands of the blocks that show them, one a line or continued by a backslash.
fn commands() -> Vec<String> {
    let (mut inside, mut continued) = (false, false);
    let mut found: Vec<String> = Vec::new();
    for line in TUTORIAL.lines() {
        match line {
            "```sh" => inside = true,
            "```" => inside = false,
            line if inside => {
                match found.last_mut().filter(|_| continued) {
                    Some(command) => *command = format!("{command}\n{line}"),
                    None => found.push(line.to_owned()),
                }
                continued = line.ends_with('\\');
            }
            _ => {}
        }
    }
    found
}

/// The folder in which the tutorial was followed; what its commands printed is looked at by the tests.
pub fn followed() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        // Nothing static is ever dropped: a folder of the build's own, emptied at the next time.
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tutorial");
        if folder.exists() {
            std::fs::remove_dir_all(&folder).expect("the folder of the last time goes");
        }
        std::fs::create_dir_all(&folder).expect("a folder");
        let programs = program("coordinator").parent().expect("a folder").to_path_buf();
        let path = std::env::var_os("PATH").unwrap_or_default();
        let path = std::env::join_paths(std::iter::once(programs).chain(std::env::split_paths(&path)));
        let path = path.expect("a path of paths");
        for command in commands() {
            let output = Command::new("sh")
                .args(["-e", "-c", &command])
                .current_dir(&folder)
                .env("PATH", &path)
                .output()
                .expect("a shell");
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{command}\n{said}");
        }
        folder
    })
}

#[test]
fn every_command_runs_and_leaves_what_the_text_says() {
    let folder = followed();
    let shown = commands();
    for command in [
        "scenes",
        "simulate",
        "run",
        "sensitivity",
        "what-if",
        "designs",
        "replace",
        "update",
        "optimise",
        "init",
        "check",
        "explain",
        "compare",
        "report",
    ] {
        let starts = format!("coordinator {command}");
        assert!(shown.iter().any(|line| line.starts_with(&starts)), "the tutorial does not show {starts}");
    }
    for file in [
        "one.json",
        "first/report.html",
        "first/scene.toml",
        "first/figures/reliability.svg",
        "first/figures/reliability.csv",
        "clearances/designs/designs.html",
        "press.toml",
        "press/summary.json",
        "tight/report.html",
        "compare.html",
        "compare.csv",
    ] {
        assert!(folder.join(file).is_file(), "{file}");
        assert!(TUTORIAL.contains(file.rsplit('/').next().unwrap()), "the tutorial does not name {file}");
    }
    // The scene in the folder is the one studied.
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    assert_eq!(text("press/scene.toml"), text("press.toml"));
    assert!(text("tight.toml") != text("press.toml"));
}

/// The fleet has an origin: the program that the tutorial names prints the same file.
#[test]
fn the_fleet_is_that_of_its_program() {
    assert!(TUTORIAL.contains("--example fleet"));
    let made = Command::new(program("examples/fleet")).output().expect("the example runs");
    let shown = std::fs::read_to_string(followed().join("fleet.csv")).unwrap();
    assert_eq!(String::from_utf8_lossy(&made.stdout), shown);
}

/// The orbit in the report and the wear in the same report tell of the same bore.
#[test]
fn a_journal_reaches_into_the_bore_as_far_as_it_is_worn() {
    let file = followed().join("first/figures/orbit-rocker.csv");
    let orbit = std::fs::read_to_string(file).unwrap();
    let farthest = |cycle: &str| {
        let of_cycle = orbit.lines().filter(|line| line.starts_with(cycle));
        let far = of_cycle.map(|line| {
            let numbers: Vec<f64> = line.split(',').skip(2).map(|x| x.parse().unwrap()).collect();
            numbers[0].hypot(numbers[1])
        });
        far.fold(0.0, f64::max)
    };
    let bore = std::fs::read_to_string(followed().join("first/figures/bore-rocker.csv")).unwrap();
    let deepest = bore.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse::<f64>().unwrap());
    let deepest = deepest.fold(0.0, f64::max);
    // The clearance of 30 um and an elastic penetration of some micrometres; at the end of life also the wear.
    let (first, last) = (farthest("first"), farthest("last"));
    assert!((30.0..36.0).contains(&first), "{first} um");
    assert!(deepest > 1.0 && (last - first - deepest).abs() < 0.5 * deepest, "{first} {last} {deepest} um");
}

#[test]
fn a_scene_is_never_overwritten_and_its_name_is_checked() {
    let folder = tempfile::tempdir().unwrap();
    let init = |arguments: &[&str]| {
        let output = Command::new(program("coordinator"))
            .arg("init")
            .args(arguments)
            .current_dir(folder.path())
            .output();
        let output = output.unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(init(&["press"]).0, Some(0));
    std::fs::write(folder.path().join("press.toml"), "mine").unwrap();
    let (code, said) = init(&["press"]);
    assert!(code == Some(2) && said.contains("press.toml: file exists"), "{said}");
    assert_eq!(std::fs::read_to_string(folder.path().join("press.toml")).unwrap(), "mine");
    for name in ["", "a b", "../up", "four-bar"] {
        let (code, said) = init(&[name]);
        assert!(code == Some(2) && said.contains("allowed are letters"), "{name}: {said}");
    }
    let (code, said) = init(&["press", "--out", "nowhere/press.toml"]);
    assert!(code == Some(2) && said.contains("there is no folder nowhere"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn studies_that_do_not_match_are_not_compared() {
    let compare = |dirs: &[&str], out: &str| {
        let output = Command::new(program("coordinator"))
            .arg("compare")
            .args(dirs)
            .args(["--out", out])
            .current_dir(followed())
            .output();
        let output = output.unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, said) = compare(&["first", "press"], "none.html");
    assert!(
        code == Some(2) && said.contains("different limit states: wear against wear, precision"),
        "{said}"
    );
    let (code, said) = compare(&["press", "nothing"], "none.html");
    assert!(code == Some(2) && said.contains("nothing"), "{said}");
    let (code, said) = compare(&["press", "tight"], "same.csv");
    assert!(code == Some(2) && said.contains(".html"), "{said}");
    assert!(!followed().join("none.html").exists() && !followed().join("same.csv").exists());
}
