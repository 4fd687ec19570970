//! Whole studies with the real `coordinator`: its files, and the same answer whatever the workers and interruptions.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longest a small study may take before the test gives up.
const PATIENCE: Duration = Duration::from_secs(240);

fn coordinator(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_coordinator"));
    command.args(arguments);
    command
}

/// A small study of the four-bar in `dir`.
fn run<'a>(dir: &'a str, workers: &'a str) -> Vec<&'a str> {
    let study = "run four-bar --levels draft --samples 4000 --initial 12 --max-evaluations 24 --seed 3";
    study.split(' ').chain(["--workers", workers, "--out", dir]).collect()
}

fn done(arguments: &[&str]) -> String {
    let output = coordinator(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// `summary.json` without what may differ: times, and who worked.
fn answer(dir: &str) -> Value {
    let text = std::fs::read_to_string(Path::new(dir).join("summary.json")).unwrap();
    let mut summary: Value = serde_json::from_str(&text).unwrap();
    let all = summary.as_object_mut().unwrap();
    let differing = ["timing_s", "workers", "created"];
    assert!(differing.iter().all(|key| all.remove(*key).is_some()));
    summary
}

/// Starts a study and ends its process by `signal` once `evaluations` are recorded; the exit code.
fn interrupted(arguments: &[&str], dir: &str, evaluations: i64, signal: &str) -> Option<i32> {
    let mut child = coordinator(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    let recorded = || {
        let flags = rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY;
        let file = rusqlite::Connection::open_with_flags(Path::new(dir).join("campaign.db"), flags).ok()?;
        file.query_row("select count(*) from evaluation", [], |row| row.get::<_, i64>(0)).ok()
    };
    while recorded().unwrap_or(0) < evaluations {
        assert!(child.try_wait().unwrap().is_none(), "the study ended before it could be interrupted");
        assert!(start.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(2));
    }
    let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    child.wait().unwrap().code()
}

#[test]
fn a_study_gives_the_same_answer_whatever_happens_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let dirs = ["two", "one", "stopped", "killed"].map(|name| folder.path().join(name).display().to_string());
    let [two, one, stopped, killed] = dirs.each_ref().map(String::as_str);

    // Two workers: every file of the contract.
    let told = done(&run(two, "2"));
    assert!(told.contains("R wear") && told.contains("life at R = 0.9"), "{told}");
    for file in ["campaign.db", "summary.json", "reliability.csv", "samples.csv", "report.html"] {
        assert!(Path::new(two).join(file).metadata().unwrap().len() > 0, "{file}");
    }
    let expected = answer(two);
    assert_eq!(expected["scene"], "four-bar");
    let curve = expected["reliability"].as_array().unwrap();
    assert_eq!(curve.len(), 8);
    let r: Vec<f64> = curve.iter().map(|row| row["total"].as_f64().unwrap()).collect();
    assert!(r[0] == 1.0 && r[7] == 0.0 && r.is_sorted_by(|a, b| a >= b), "{r:?}");

    // One worker; every line of standard error is an object, for programs that collect logs.
    let logged = |arguments: &[&str]| {
        let output = coordinator(arguments).args(["--log-format", "json"]).output().unwrap();
        let lines = String::from_utf8(output.stderr).unwrap();
        lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect::<Vec<Value>>()
    };
    let lines = logged(&run(one, "1"));
    assert!(lines.iter().any(|line| line["message"].as_str().unwrap().starts_with("round 0: ")), "{lines:?}");
    assert_eq!(answer(one), expected);
    assert_eq!(logged(&["resume", "nowhere"])[0]["level"], "ERROR");

    // Ctrl-C, then resumed by other workers.
    assert_eq!(interrupted(&run(stopped, "1"), stopped, 5, "-INT"), Some(130));
    let resumed = coordinator(&["resume", stopped, "--workers", "2"]).output().unwrap();
    assert!(resumed.status.success());
    assert_eq!(answer(stopped), expected);
    // Its progress begins with what was done.
    let said = String::from_utf8(resumed.stderr).unwrap();
    let mut lines = said.lines();
    let before = lines.next().unwrap().strip_suffix(" evaluations are done already").unwrap();
    let first = lines.next().unwrap();
    assert!(first.starts_with(&format!("{before}/")), "{said}");
    assert!(
        first.contains(" evaluations, initial design, ")
            && first.ends_with(&format!("{before} from the campaign file")),
        "{said}"
    );

    // The same with kill -9.
    assert_eq!(interrupted(&run(killed, "2"), killed, 18, "-KILL"), None);
    done(&["resume", killed, "--workers", "1", "--quiet"]);
    assert_eq!(answer(killed), expected);

    // A finished study: printed again, without an evaluation.
    let summary: Value = serde_json::from_str(&done(&["resume", killed, "--json"])).unwrap();
    assert_eq!(summary["reliability"], expected["reliability"]);
    let mut rows: Value = serde_json::from_str(&done(&["sensitivity", two, "--json"])).unwrap();
    let mut with_sobol = 0;
    for row in rows.as_array_mut().unwrap() {
        with_sobol += usize::from(row.as_object_mut().unwrap().remove("sobol").is_some());
    }
    assert!(with_sobol > 0);
    assert_eq!(rows, expected["sensitivity"]);
    assert!(done(&["sensitivity", two]).contains("wear_coefficient"));
    std::fs::remove_file(Path::new(two).join("report.html")).unwrap();
    assert!(done(&["report", two]).trim_end().ends_with("report.html"));
    assert!(Path::new(two).join("report.html").exists());
    assert_eq!(answer(two), expected);
}

#[test]
fn direct_monte_carlo_counts() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().display().to_string();
    let study = "run four-bar --accuracy draft --method monte-carlo --samples 20 --seed 3 --quiet --json";
    let told = done(&study.split(' ').chain(["--workers", "2", "--out", &dir]).collect::<Vec<_>>());
    let summary: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(summary["method"], "monte-carlo");
    // The samples, and the nominal point for the report.
    assert_eq!(summary["evaluations"]["total"], 21);
    for row in summary["reliability"].as_array().unwrap() {
        let survivors = row["total"].as_f64().unwrap() * 20.0;
        assert!((survivors - survivors.round()).abs() < 1e-9, "{row}");
    }
}
