//! Campaign files of earlier versions, kept in `campaigns/VERSION`: this version reads them and goes on with them without
//! running a finished evaluation again. Files that it cannot read are refused with both versions and stay as they are.
//!
//! A version that changes the layout raises `SCHEMA_VERSION` and migrates; one that is released adds its own file, written
//! by `cargo test --release -p coordinator --test earlier_versions -- --ignored`.

use ciborium::Value as Cbor;
use common::scene::SceneSource;
use coordinator::results::store::{CampaignFile, CampaignMeta};
use rusqlite::Connection;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Version of this program.
const OURS: &str = env!("CARGO_PKG_VERSION");

/// Study of the kept files: an initial design, and some rounds of learning.
const STUDY: &str =
    "run --accuracy draft --samples 2000 --initial 12 --max-evaluations 20 --seed 3 --workers 2 --out";

/// Evaluations of the kept files, and those of the continued study.
const EVALUATIONS: [usize; 2] = [20, 23];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/campaigns")
}

/// Versions whose files are kept.
fn versions() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert!(!names.is_empty());
    names
}

/// The latest version with a kept file.
fn latest() -> String {
    let number = |name: &String| -> Vec<u32> { name.split('.').map(|part| part.parse().unwrap()).collect() };
    versions().into_iter().max_by_key(number).unwrap()
}

/// A folder with a copy of the file of a version.
fn copy(version: &str) -> TempDir {
    let copy = tempfile::tempdir().unwrap();
    std::fs::copy(folder().join(version).join("campaign.db"), file(&copy)).unwrap();
    copy
}

fn file(dir: &TempDir) -> PathBuf {
    dir.path().join("campaign.db")
}

fn coordinator(command: &str, dir: &TempDir) -> Output {
    let mut words = command.split(' ');
    let mut program = Command::new(env!("CARGO_BIN_EXE_coordinator"));
    program.arg(words.next().unwrap()).arg(dir.path()).args(words).env_remove("RUST_LOG");
    program.output().unwrap()
}

/// Standard error of a command that succeeds.
#[track_caller]
fn done(command: &str, dir: &TempDir) -> String {
    let output = coordinator(command, dir);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{command}: {said}");
    said
}

/// Standard error of a command that is refused as bad input, and leaves the file as it is.
#[track_caller]
fn refused(command: &str, dir: &TempDir) -> String {
    let before = std::fs::read(file(dir)).unwrap();
    let output = coordinator(command, dir);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{command}: {said}");
    assert!(std::fs::read(file(dir)).unwrap() == before, "{command}: the file was changed");
    said
}

/// What was recorded of every sample: the outcome, and when.
fn recorded(dir: &TempDir) -> BTreeMap<Vec<u8>, Vec<(Vec<u8>, String)>> {
    let connection = Connection::open(file(dir)).unwrap();
    let mut statement = connection.prepare("SELECT sample, outcome, finished_at FROM evaluation").unwrap();
    let rows = statement.query_map([], |row| Ok((row.get(0)?, (row.get(1)?, row.get(2)?)))).unwrap();
    let mut found = BTreeMap::<_, Vec<_>>::new();
    for (sample, outcome) in rows.map(Result::unwrap) {
        found.entry(sample).or_default().push(outcome);
    }
    found
}

fn execute(dir: &TempDir, sql: &str) {
    Connection::open(file(dir)).unwrap().execute_batch(sql).unwrap();
}

/// The summary in the file, without what tells the time.
fn summary(dir: &TempDir) -> Value {
    let sql = "SELECT json FROM document WHERE name = 'summary'";
    let text: String = Connection::open(file(dir)).unwrap().query_row(sql, [], |row| row.get(0)).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn finished_studies_of_every_version_are_read() {
    for version in versions() {
        let dir = copy(&version);
        done("report", &dir);
        done("sensitivity --json", &dir);
        done("status --json", &dir);
        let text = std::fs::read_to_string(dir.path().join("summary.json")).unwrap();
        let written: Value = serde_json::from_str(&text).unwrap();
        let stored = summary(&dir);
        assert_eq!(written["evaluations"]["total"], json!(EVALUATIONS[0]), "{version}");
        assert_eq!(written["version"], json!(version));
        for key in ["reliability", "lives", "moments", "sensitivity"] {
            assert_eq!(written[key], stored[key], "{version}: {key}");
        }
        let samples = std::fs::read_to_string(dir.path().join("samples.csv")).unwrap();
        assert_eq!(samples.lines().count(), EVALUATIONS[0] + 1, "{version}");
    }
}

#[test]
fn studies_of_every_version_go_on_without_running_an_evaluation_again() {
    for version in versions() {
        let finished = copy(&version);
        let before = recorded(&finished);
        assert_eq!(before.len(), EVALUATIONS[0], "{version}: samples");
        let said = done("resume", &finished);
        assert!(said.contains("this study is finished"), "{version}: {said}");
        assert_eq!(recorded(&finished), before, "{version}");

        // A program that goes on with the study of another one says so.
        let extended = copy(&version);
        execute(&extended, "UPDATE campaign SET value = '0.0.9' WHERE key = 'version'");
        let said = done(&format!("resume --max-evaluations {} --workers 2", EVALUATIONS[1]), &extended);
        assert!(said.contains("they are by version 0.0.9") && said.contains(OURS), "{said}");
        let after = recorded(&extended);
        for (sample, outcomes) in &after {
            assert_eq!(outcomes.len(), 1, "{version}: a sample was simulated twice");
            assert!(
                before.get(sample).is_none_or(|known| known == outcomes),
                "{version}: was simulated again"
            );
        }
        assert!(before.keys().all(|sample| after.contains_key(sample)), "{version}: an evaluation is lost");
        assert_eq!(summary(&extended)["evaluations"]["total"], json!(EVALUATIONS[1]), "{version}");
    }
}

/// A study that was killed in the middle: what it had recorded is used.
#[test]
fn a_killed_study_repeats_nothing() {
    let dir = copy(&latest());
    execute(
        &dir,
        "DELETE FROM document; DELETE FROM learning_round WHERE round > 0;
         DELETE FROM output_error WHERE evaluation > 15; DELETE FROM output WHERE evaluation > 15;
         DELETE FROM input WHERE evaluation > 15; DELETE FROM evaluation WHERE id > 15;",
    );
    let kept = recorded(&dir);
    assert_eq!(kept.len(), 16);
    let said = done("resume --workers 2", &dir);
    assert!(said.contains("16 evaluations are done already"), "{said}");
    let after = recorded(&dir);
    assert!(kept.iter().all(|(sample, outcome)| after.get(sample) == Some(outcome)));
    assert!(after.values().all(|outcomes| outcomes.len() == 1), "a sample was simulated twice");
    assert_eq!(summary(&dir)["evaluations"]["total"], json!(EVALUATIONS[0]));
}

#[test]
fn a_layout_of_a_later_version_is_refused_by_name() {
    let dir = copy(&latest());
    execute(&dir, "PRAGMA user_version = 99; UPDATE campaign SET value = '9.8.7' WHERE key = 'version'");
    for command in [
        "resume",
        "report",
        "sensitivity",
        "status",
        "what-if --set friction.mean=0.1",
        "replace --failure-cost 10",
    ] {
        let said = refused(command, &dir);
        for part in ["campaign.db", "schema version 99", "version 9.8.7", OURS, "reads versions 3 to "] {
            assert!(said.contains(part), "{command}: no {part} in {said}");
        }
    }
    // A layout that does not even say which program wrote it.
    execute(&dir, "DROP TABLE campaign");
    let said = refused("resume", &dir);
    assert!(said.contains("schema version 99") && !said.contains("9.8.7"), "{said}");
}

#[test]
fn what_a_known_layout_holds_of_another_version_is_refused_by_name() {
    let other = "UPDATE campaign SET value = '0.9.1' WHERE key = 'version'";
    for (change, parts) in [
        (
            "UPDATE campaign SET value = replace(value, '[study]', '[tuning]') WHERE key = 'scene_source'",
            ["the scene of this study is not accepted", "tuning"],
        ),
        (
            "UPDATE campaign SET value = replace(value, '\"ak\"', '\"oracle\"') WHERE key = 'settings'",
            ["the settings of this study cannot be read", "oracle"],
        ),
    ] {
        let dir = copy(&latest());
        // The kept file would first have to be brought up to the present layout.
        execute(&dir, &format!("{other}; {change}"));
        let said = refused("resume --max-evaluations 30", &dir);
        for part in parts.into_iter().chain(["campaign.db", "version 0.9.1", OURS]) {
            assert!(said.contains(part), "no {part} in {said}");
        }
    }
    let dir = copy(&latest());
    execute(&dir, &format!("{other}; UPDATE evaluation SET outcome = x'A162' WHERE id = 3"));
    let said = refused("report", &dir);
    for part in ["campaign.db", "outcome of evaluation 3", "version 0.9.1", OURS, "start a new study"] {
        assert!(said.contains(part), "no {part} in {said}");
    }
}

/// The layout of new files is that of the kept one; another layout needs another number.
#[test]
fn the_layout_belongs_to_its_schema_version() {
    let layout = |dir: &TempDir| -> (i64, BTreeMap<String, Option<String>>) {
        let connection = Connection::open(file(dir)).unwrap();
        let version = connection.query_row("PRAGMA user_version", [], |row| row.get(0)).unwrap();
        let mut statement = connection.prepare("SELECT name, sql FROM sqlite_schema").unwrap();
        let tables = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
        (version, tables.map(Result::unwrap).collect())
    };
    let (kept, new) = (copy(&latest()), tempfile::tempdir().unwrap());
    let source: String = Connection::open(file(&kept))
        .unwrap()
        .query_row("SELECT value FROM campaign WHERE key = 'scene_source'", [], |row| row.get(0))
        .unwrap();
    let scene = SceneSource::parse(&source, "kept").unwrap();
    let meta = CampaignMeta {
        scene: "kept".into(),
        scene_source: source,
        settings: json!({}),
        command: String::new(),
        version: OURS.into(),
    };
    drop(CampaignFile::create(new.path(), &meta, scene.nominal()).unwrap());
    let ((kept_version, kept), (new_version, new)) = (layout(&kept), layout(&new));
    assert!(kept_version <= new_version);
    if kept_version == new_version {
        assert_eq!(kept, new, "another layout under the same number: raise SCHEMA_VERSION");
    }
}

/// Every tenth entry of the long lists in a value: those of the recorded cycles, which are nine tenths of a file.
fn thinned(value: Cbor) -> Cbor {
    match value {
        Cbor::Array(list) if list.len() > 100 => {
            Cbor::Array(list.into_iter().step_by(10).map(thinned).collect())
        }
        Cbor::Array(list) => Cbor::Array(list.into_iter().map(thinned).collect()),
        Cbor::Map(entries) => {
            Cbor::Map(entries.into_iter().map(|(key, value)| (key, thinned(value))).collect())
        }
        other => other,
    }
}

#[test]
#[ignore = "writes the file of this version"]
fn write_the_file_of_this_version() {
    let made = tempfile::tempdir().unwrap();
    let scene = SceneSource::builtin("four-bar").unwrap();
    // Half the checkpoints, and no comments: a small file.
    let lines = scene.text().lines().filter(|line| !line.starts_with('#'));
    let text =
        lines.collect::<Vec<_>>().join("\n").replace("checkpoint_every = 1000", "checkpoint_every = 2000");
    assert!(text.contains("checkpoint_every = 2000"));
    std::fs::write(made.path().join("four-bar.toml"), text).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_coordinator"));
    program.args(STUDY.split(' ')).args(["study", "four-bar.toml"]).current_dir(made.path());
    let output = program.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let from = made.path().join("study/campaign.db");
    let connection = Connection::open(&from).unwrap();
    let nominal = "SELECT outcome FROM evaluation WHERE id = 0";
    let outcome: Vec<u8> = connection.query_row(nominal, [], |row| row.get(0)).unwrap();
    let outcome = thinned(ciborium::from_reader(outcome.as_slice()).unwrap());
    let mut bytes = Vec::new();
    ciborium::into_writer(&outcome, &mut bytes).unwrap();
    connection.execute("UPDATE evaluation SET outcome = ?1 WHERE id = 0", [bytes]).unwrap();
    // No path and no name of the machine that wrote it, and no second copy of the rows in a log.
    let strip = "UPDATE campaign SET value = 'coordinator run' WHERE key = 'command';
                 UPDATE leg SET command = 'coordinator run'; UPDATE evaluation SET worker = 'local';
                 PRAGMA journal_mode = DELETE; VACUUM;";
    connection.execute_batch(strip).unwrap();
    drop(connection);
    let target = folder().join(OURS);
    std::fs::create_dir_all(&target).unwrap();
    std::fs::copy(from, target.join("campaign.db")).unwrap();
}
