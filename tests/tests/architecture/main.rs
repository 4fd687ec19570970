//! The one way data flows, and the rooms of the house: who may name whom. A back reference fails here with its
//! file and line.

mod documentation;
mod graph;
mod names;
mod paths;

use graph::FileGraph;
use paths::{Named, SourceFile, module_of, read};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::skipped;

/// A later layer of the worker may use an earlier one, never the reverse. A layer is a module, or a name that a
/// module exports with the file that defines it, where that stands lower than the rest of its module.
const WORKER: [&str; 24] = [
    "log",
    "extremum",
    "interpolate",
    "lanes",
    "plane",
    "bore",
    "rail",
    "contact",
    "integrate",
    "wear",
    "mechanism",
    "quasi_static",
    "outputs",
    "simulate",
    "build",
    "service",
    "evaluation_slots",
    "own_simulators",
    "simulator",
    "serve_cycle",
    "umbridge",
    "shell",
    "signals",
    "main",
];

/// The layers of the coordinator's library, the crate `statistics` first; `cli` and `main` belong to its binary.
const COORDINATOR: [&str; 8] =
    ["statistics", "farm", "results", "study", "presentation", "analyses", "cli", "main"];

/// The layers of its statistics, a crate of their own.
const STATISTICS: [&str; 13] = [
    "named",
    "goodness_of_fit",
    "design",
    "surrogate",
    "reliability",
    "levels",
    "learning",
    "sensitivity",
    "replacement",
    "life_data",
    "updating",
    "test_plan",
    "optimisation",
];

/// The crates of the product.
const CRATES: [&str; 4] = ["common", "worker", "coordinator/statistics", "coordinator"];

/// And of what both share.
const COMMON: [&str; 13] = [
    "random",
    "accuracy",
    "build",
    "text_file",
    "scene",
    "failure",
    "outputs",
    "evaluation_shape",
    "umbridge",
    "locks",
    "external",
    "panics",
    "wire",
];

/// Longest source file [lines].
const LONGEST: usize = 400;

/// Crates that only the named places of a crate's sources may use.
const KEPT_TO: [(&str, &str, &[&str]); 14] = [
    ("zenoh", "common/sessions", &["lib.rs"]),
    ("zenoh", "worker", &["service/link.rs"]),
    ("zenoh", "coordinator", &["farm/dispatch/transport/"]),
    ("bincode", "common", &["wire/codec.rs"]),
    ("rusqlite", "coordinator", &["results/store/"]),
    ("worker", "coordinator", &["cli/", "main.rs"]),
    ("rustix", "common", &["external/guard.rs", "external/process.rs"]),
    ("rustix", "coordinator", &["farm/allocation/jobs.rs", "farm/dispatch/transport/settings.rs"]),
    ("rustix", "worker", &["service/slots.rs"]),
    ("ureq", "common", &["external/umbridge.rs"]),
    ("axum", "worker", &["umbridge/"]),
    ("axum", "coordinator", &["presentation/monitor/server.rs"]),
    ("clap", "coordinator", &["cli/"]),
    ("pulp", "worker", &["lanes/", "simulate/side_by_side/"]),
];

/// Crates that a crate does not depend on, not even for its tests.
const BARRED: [(&str, &[&str]); 5] = [
    ("common", &["worker", "coordinator", "tests", "zenoh", "tokio", "nalgebra", "faer"]),
    ("common/sessions", &["common", "worker", "coordinator", "tests"]),
    ("worker", &["coordinator", "tests", "bincode", "rusqlite"]),
    ("coordinator/statistics", &["worker", "coordinator", "tests", "zenoh", "tokio"]),
    ("coordinator", &["tests", "bincode"]),
];

/// What the user wants to see at the top; dot-files besides.
const TOP: [&str; 11] = [
    "Cargo.lock",
    "Cargo.toml",
    "CHANGELOG.md",
    "LICENSE",
    "README.md",
    "common",
    "coordinator",
    "deploy",
    "rustfmt.toml",
    "tests",
    "worker",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// Source files below `folder`, relative to it, in a fixed order.
fn sources(folder: &Path) -> Vec<PathBuf> {
    fn collect(folder: &Path, base: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, base, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(path.strip_prefix(base).unwrap().to_path_buf());
            }
        }
    }
    let mut found = Vec::new();
    collect(folder, folder, &mut found);
    found.sort();
    assert!(!found.is_empty(), "{} has no sources", folder.display());
    found
}

/// The sources of a crate's library and binary, by file; those that exist only for tests are left out.
fn crate_sources(name: &str) -> BTreeMap<PathBuf, SourceFile> {
    let folder = root().join(name).join("src");
    let mut files: BTreeMap<PathBuf, SourceFile> = sources(&folder)
        .into_iter()
        .map(|file| {
            let text = std::fs::read_to_string(folder.join(&file)).unwrap();
            let source = read(&text, &module_of(&file));
            (file, source)
        })
        .collect();
    let for_tests: BTreeSet<Vec<String>> = files
        .iter()
        .flat_map(|(file, source)| {
            source.test_modules.iter().map(|name| [module_of(file), vec![name.clone()]].concat())
        })
        .collect();
    files.retain(|file, _| {
        let module = module_of(file);
        let named_tests = module.last().is_some_and(|name| name.ends_with("_tests"));
        !named_tests && !(1..=module.len()).any(|length| for_tests.contains(&module[..length]))
    });
    files
}

/// Number of the layer a file belongs to.
fn layer_of_file(layers: &[&str], file: &Path) -> Option<usize> {
    let file_text = file.to_string_lossy();
    let exactly = layers.iter().position(|layer| layer.split_once(" = ").is_some_and(|l| l.1 == file_text));
    let first = file.components().next()?.as_os_str().to_string_lossy().into_owned();
    let module = first.trim_end_matches(".rs");
    exactly.or_else(|| layers.iter().position(|layer| *layer == module))
}

/// Number of the layer a path into the own crate leads to.
fn layer_of_path(layers: &[&str], segments: &[String]) -> Option<usize> {
    let [module, rest @ ..] = segments else { return None };
    let named = |layer: &&str| layer.split_once(" = ").map(|(path, _)| path.to_owned());
    let exactly = rest.first().and_then(|item| {
        let path = format!("{module}::{item}");
        layers.iter().position(|layer| named(layer).as_deref() == Some(path.as_str()))
    });
    exactly.or_else(|| layers.iter().position(|layer| layer == module))
}

fn joined(path: &Named) -> String {
    path.segments.join("::")
}

/// What a crate's sources name against the order of its layers.
fn back_references(name: &str, layers: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    let mut looked_at = 0;
    for (file, source) in crate_sources(name) {
        if file == Path::new("lib.rs") {
            continue;
        }
        let Some(own) = layer_of_file(layers, &file) else {
            found.push(format!("{name}/src/{}: no layer of this test", file.display()));
            continue;
        };
        for path in &source.paths {
            // The binary names its own library by the crate's name.
            let inside = path.segments[0] == "crate" || path.segments[0] == name;
            if !inside || path.segments.len() < 2 {
                continue;
            }
            looked_at += 1;
            match layer_of_path(layers, &path.segments[1..]) {
                Some(used) if used <= own => {}
                Some(used) => found.push(format!(
                    "{name}/src/{}:{}: {} (layer {}) from layer {}",
                    file.display(),
                    path.line,
                    joined(path),
                    layers[used],
                    layers[own]
                )),
                None => {
                    found.push(format!(
                        "{name}/src/{}:{}: {}: no layer",
                        file.display(),
                        path.line,
                        joined(path)
                    ));
                }
            }
        }
    }
    assert!(looked_at > 0, "{name}: no path was read");
    found
}

#[track_caller]
fn none(found: &[String]) {
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn paths_are_read_from_tokens() {
    let text = r#"
        //! crate::comment
        use super::{ContactHistory, archard::{self, Rate as R}};
        use zenoh;
        fn f() { let s = "crate::text"; crate::contact::law(s); select! { _ = tokio::time::now() => {} } }
        #[cfg(test)] pub(crate) mod synthetic;
        #[cfg(test)]
        mod tests { use super::*; fn g() { crate::late::h(); } }
        use crate::integrate::*;
    "#;
    let module = ["wear".to_owned(), "step".to_owned()];
    let source = read(text, &module);
    let found: Vec<String> = source.paths.iter().map(joined).collect();
    assert_eq!(
        found,
        [
            "crate::wear::ContactHistory",
            "crate::wear::archard",
            "crate::wear::archard::Rate",
            "zenoh",
            "crate::contact::law",
            "tokio::time::now",
            "crate::integrate::*"
        ]
    );
    assert_eq!(source.paths[4].line, 5);
    let found: Vec<String> = source.test_paths.iter().map(joined).collect();
    assert_eq!(found, ["crate::wear::step::*", "crate::late::h"]);
    assert_eq!(source.test_modules, ["synthetic"]);
}

#[test]
fn data_flows_one_way() {
    let mut found = back_references("common", &COMMON);
    found.extend(back_references("worker", &WORKER));
    found.extend(back_references("coordinator/statistics", &STATISTICS));
    found.extend(back_references("coordinator", &COORDINATOR));
    none(&found);
}

/// The files of a crate use each other in one direction only: a circle of files is one concept cut in pieces, or
/// two that hide in one file.
#[test]
fn files_use_each_other_one_way() {
    let mut found = Vec::new();
    for name in CRATES {
        let files = crate_sources(name);
        let graph = FileGraph::new(&files);
        let uses: usize = graph.uses().values().map(BTreeSet::len).sum();
        assert!(uses > files.len(), "{name}: {uses} uses read between {} files", files.len());
        for circle in graph.circles() {
            let names: Vec<_> = circle.iter().map(|file| file.display().to_string()).collect();
            found.push(format!("{name}/src: {}", names.join(", ")));
        }
    }
    none(&found);
}

#[test]
fn crates_are_kept_to_their_places() {
    let mut found = Vec::new();
    for (kept, name, places) in KEPT_TO {
        let mut in_place = 0;
        for (file, source) in crate_sources(name) {
            let at_home = places.iter().any(|place| file.to_string_lossy().starts_with(place));
            for path in source.paths.iter().chain(&source.test_paths).filter(|p| p.segments[0] == kept) {
                if at_home {
                    in_place += 1;
                } else {
                    found.push(format!("{name}/src/{}:{}: {}", file.display(), path.line, joined(path)));
                }
            }
        }
        assert!(
            in_place > 0,
            "{kept} is not used in {places:?} of {name}: this rule looks at the wrong place"
        );
    }
    none(&found);
}

#[test]
fn crates_depend_one_way() {
    let mut found = Vec::new();
    for (name, barred) in BARRED {
        let text = std::fs::read_to_string(root().join(name).join("Cargo.toml")).unwrap();
        let manifest: toml::Table = text.parse().unwrap();
        let dependencies: Vec<&String> = ["dependencies", "dev-dependencies", "build-dependencies"]
            .into_iter()
            .filter_map(|section| manifest.get(section)?.as_table())
            .flat_map(|section| section.keys())
            .collect();
        assert!(!dependencies.is_empty(), "{name}: no dependency was read");
        found.extend(
            dependencies
                .iter()
                .filter(|d| barred.contains(&d.as_str()))
                .map(|d| format!("{name} depends on {d}")),
        );
    }
    none(&found);
}

#[test]
fn the_top_level_holds_what_the_user_fixed() {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    // In an unpacked archive nobody knows what belongs to the project and what a study left behind.
    let Some(listed) = listed.ok().filter(|output| output.status.success()) else {
        skipped("the top level", "this is no git checkout");
        return;
    };
    let files = String::from_utf8(listed.stdout).unwrap();
    let top: BTreeSet<&str> = files
        .split('\0')
        .filter(|file| !file.is_empty())
        .map(|file| file.split('/').next().unwrap())
        .collect();
    let extra: Vec<String> = top
        .iter()
        .filter(|entry| !entry.starts_with('.') && !TOP.contains(entry))
        .map(|entry| format!("{entry} at the top level"))
        .collect();
    none(&extra);
    let missing: Vec<String> =
        TOP.iter().filter(|entry| !top.contains(*entry)).map(|entry| format!("{entry} is missing")).collect();
    none(&missing);
}

#[test]
fn source_files_hold_one_concept() {
    let mut found = Vec::new();
    for name in ["common", "worker", "coordinator", "tests"] {
        let folder = root().join(name);
        for file in sources(&folder) {
            let lines = std::fs::read_to_string(folder.join(&file)).unwrap().lines().count();
            if lines > LONGEST {
                found.push(format!("{name}/{}: {lines} lines, at most {LONGEST}", file.display()));
            }
        }
    }
    none(&found);
}
