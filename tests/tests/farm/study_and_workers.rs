//! A complete study with the real programs: two workers, one of which is killed and replaced, give the same answer as one
//! local worker.

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tests::deployed::{KilledOnDrop, answer};
use tests::program;

/// Time limit of the study.
const PATIENCE: Duration = Duration::from_secs(240);

fn study(workers: &str, dir: &str) -> Command {
    let mut command = Command::new(program("coordinator"));
    let study = "run four-bar --accuracy draft --samples 4000 --initial 16 --max-evaluations 40 --seed 3";
    command.args(study.split(' ')).args(["--workers", workers, "--out", dir]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn worker(endpoint: &str) -> KilledOnDrop {
    let mut command = Command::new(program("worker"));
    command.args(["--connect", endpoint, "--slots", "1", "--quiet"]);
    KilledOnDrop(command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap())
}

fn summary(dir: &str) -> Value {
    let text = std::fs::read_to_string(Path::new(dir).join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn recorded(dir: &str) -> i64 {
    let flags = rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY;
    rusqlite::Connection::open_with_flags(Path::new(dir).join("campaign.db"), flags)
        .and_then(|file| file.query_row("select count(*) from evaluation", [], |row| row.get(0)))
        .unwrap_or(0)
}

#[test]
fn a_killed_worker_does_not_change_the_answer() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (alone, farmed) = (at("alone"), at("farmed"));
    assert!(study("1", &alone).stderr(Stdio::null()).status().unwrap().success());

    let mut coordinator = KilledOnDrop(study("0", &farmed).spawn().unwrap());
    let start = Instant::now();
    let stderr = BufReader::new(coordinator.0.stderr.take().unwrap());
    let mut lines = stderr.lines().map(Result::unwrap);
    let endpoint = lines
        .find_map(|line| line.split("--connect ").nth(1).map(|rest| rest.trim().to_owned()))
        .expect("the coordinator prints its endpoint");
    // A full pipe would block the coordinator.
    let drained = std::thread::spawn(move || lines.for_each(drop));

    let mut doomed = worker(&endpoint);
    let mut others = vec![worker(&endpoint)];
    while recorded(&farmed) < 6 {
        assert!(start.elapsed() < PATIENCE, "no result arrives");
        std::thread::sleep(Duration::from_millis(5));
    }
    doomed.0.kill().unwrap();
    others.push(worker(&endpoint));
    while coordinator.0.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < PATIENCE, "the study does not end");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(coordinator.0.wait().unwrap().success());
    drained.join().unwrap();

    assert_eq!(answer(Path::new(&alone)), answer(Path::new(&farmed)));
    let workers = summary(&farmed)["workers"].as_array().unwrap().len();
    assert!(workers >= 2, "{workers} workers finished evaluations");
}

/// The worker prints its completions and its manual page without a coordinator.
#[test]
fn a_worker_has_completions_and_a_manual_page() {
    let printed = |arguments: &[&str]| {
        let output = Command::new(program("worker")).args(arguments).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        assert!(printed(&["--completions", shell]).contains("give-up-after"), "{shell}");
    }
    let page = printed(&["--man"]);
    assert!(page.contains(".SH SYNOPSIS") && page.contains("walltime"), "{page}");
    let refused = Command::new(program("worker")).args(["--completions", "tcsh"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
}
