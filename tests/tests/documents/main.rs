//! What the documents name exists: paths, links, and command lines that the programs take.

mod reproduction;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use tests::command_line::{objection, words};
use tests::program;

const DOCUMENTS: [&str; 14] = [
    "README.md",
    "deploy/README.md",
    "coordinator/doc/calibration.md",
    "coordinator/doc/farm.md",
    "coordinator/doc/reliability.md",
    "coordinator/doc/reproduction.md",
    "coordinator/doc/scenes.md",
    "coordinator/doc/simulators.md",
    "coordinator/doc/tradeoff.md",
    "coordinator/doc/tutorial.md",
    "worker/benches/README.md",
    "worker/benches/lsoda/README.md",
    "coordinator/benches/scikit/README.md",
    "CHANGELOG.md",
];

/// Folders whose files a document may name in backquotes.
const ROOMS: [&str; 6] = ["common/", "worker/", "coordinator/", "deploy/", "tests/", ".ci/"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

fn document(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap()
}

/// Lines of the blocks between ``` fences.
fn shown_lines(text: &str) -> Vec<&str> {
    let mut inside = false;
    text.lines()
        .filter(|line| {
            let fence = line.starts_with("```");
            inside ^= fence;
            inside && !fence
        })
        .collect()
}

/// What stands between backquotes, outside of blocks.
fn quoted(text: &str) -> Vec<&str> {
    let mut inside = false;
    let prose = text.lines().filter(move |line| {
        let fence = line.starts_with("```");
        inside ^= fence;
        !inside && !fence
    });
    prose.flat_map(|line| line.split('`').skip(1).step_by(2)).collect()
}

/// Targets of `[text](target)` and `![text](target)` that lie in the repository.
fn links(text: &str) -> Vec<&str> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .filter(|target| !target.contains("://") && !target.starts_with('#'))
        .collect()
}

#[track_caller]
fn none(found: &[String]) {
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn every_link_and_path_exists() {
    let mut missing = Vec::new();
    for name in DOCUMENTS {
        let text = document(name);
        let folder = root().join(name).parent().unwrap().to_path_buf();
        let linked = links(&text).into_iter().map(|target| (target, folder.join(target)));
        let named = quoted(&text)
            .into_iter()
            .filter(|word| ROOMS.iter().any(|room| word.starts_with(room)))
            .map(|word| (word, root().join(word)));
        missing.extend(
            linked
                .chain(named)
                .filter(|(_, path)| !path.exists())
                .map(|(target, _)| format!("{name}: {target} does not exist")),
        );
    }
    none(&missing);
}

/// The program and arguments of a line that starts one of ours, by `cargo run`, by name, or through Compose.
fn ours(line: &str) -> Option<(PathBuf, Vec<String>)> {
    let mut words = words(line.trim_start_matches("$ "));
    if words.starts_with(&["cargo".into(), "run".into()]) {
        let package = words.iter().position(|word| word == "-p").expect("cargo run names a package") + 1;
        if let Some(at) = words.iter().position(|word| word == "--example") {
            let example = format!("{}/examples/{}", words[package], words[at + 1]);
            let files = [format!("{example}.rs"), format!("{example}/main.rs")];
            assert!(files.iter().any(|file| root().join(file).is_file()), "{line}: there is no {example}");
            return None;
        }
        assert!(words.iter().any(|word| word == "--release"), "{line}: an unoptimised build takes for ever");
        let own = words.iter().position(|word| word == "--").map_or(words.len(), |at| at + 1);
        return Some((program(&words[package].clone()), words.split_off(own)));
    }
    if words.starts_with(&["docker".into(), "compose".into()]) {
        // The service, and then the command in it: both are called coordinator.
        let service = words.iter().position(|word| word == "coordinator")?;
        words.drain(..=service);
    }
    let first = words.first()?.clone();
    let known = ["coordinator", "worker"].contains(&first.as_str());
    known.then(|| (program(&first), words.split_off(1)))
}

#[test]
fn every_command_line_is_taken() {
    let mut found = Vec::new();
    let mut taken = BTreeSet::new();
    for name in DOCUMENTS {
        let text = document(name);
        let in_prose = quoted(&text).into_iter().filter(|span| span.contains(' '));
        for line in shown_lines(&text).into_iter().chain(in_prose) {
            let Some((program, arguments)) = ours(line) else { continue };
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            match objection(&program, &arguments) {
                None => _ = taken.insert(arguments.first().unwrap_or(&"").to_string()),
                Some(said) => found.push(format!("{name}: {line}\n{said}")),
            }
        }
    }
    none(&found);
    // Every command of the coordinator is shown somewhere.
    for command in [
        "run",
        "resume",
        "simulate",
        "extremes",
        "tradeoff",
        "sensitivity",
        "report",
        "status",
        "doctor",
        "scenes",
        "check",
        "explain",
        "compare",
        "init",
    ] {
        assert!(taken.contains(command), "no document shows `coordinator {command}`");
    }
}

#[test]
fn every_option_named_in_prose_exists() {
    let help = |program_name: &str, command: &[&str]| {
        let output = std::process::Command::new(program(program_name)).args(command).arg("--help").output();
        String::from_utf8(output.unwrap().stdout).unwrap()
    };
    let commands = ["run", "resume", "simulate", "tradeoff", "calibrate", "scenes", "status", "doctor"];
    let mut known: String = commands.iter().map(|command| help("coordinator", &[command])).collect();
    known += &help("worker", &[]);
    let known: BTreeSet<&str> = known
        .split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'))
        .filter(|w| w.starts_with("--"))
        .collect();
    let mut unknown = Vec::new();
    for name in DOCUMENTS {
        let text = document(name);
        for span in quoted(&text).into_iter().filter(|span| span.starts_with("--")) {
            let option = span.split([' ', '=']).next().unwrap();
            if !known.contains(option) {
                unknown.push(format!("{name}: {option} is an option of neither program"));
            }
        }
    }
    none(&unknown);
}

#[test]
fn the_readme_opens_with_its_two_commands_and_ci_runs_the_second() {
    let readme = document("README.md");
    let opening = readme.lines().take(40).collect::<Vec<_>>().join("\n");
    let shown = shown_lines(&opening);
    let main_job = "cargo run --release -p coordinator -- --workers auto";
    let tests = "cargo test --release --workspace";
    assert!(shown.contains(&main_job) && shown.contains(&tests), "{shown:?}");
    assert!(document(".ci/run").lines().any(|line| line == tests), ".ci/run does not run `{tests}`");
    assert!(opening.contains(".svg)") || opening.contains(".png)"), "no picture");
}

/// Each built-in scene has its section, and no other scene has one.
#[test]
fn every_built_in_scene_has_its_page() {
    let pages = document("coordinator/doc/scenes.md");
    let sections: Vec<&str> = pages.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let scenes = common::scene::SceneSource::builtin_names();
    assert_eq!(sections, scenes.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>());
    for (section, name) in pages.split("\n## ").skip(1).zip(&scenes) {
        let shown = shown_lines(section);
        assert!(
            shown.iter().any(|line| line.split(' ').any(|word| word == *name)),
            "{name}: no command to run"
        );
        assert!(section.contains("Reference values"), "{name}: nothing on its reference values");
    }
    assert!(document("README.md").contains("(coordinator/doc/scenes.md)"));
}
