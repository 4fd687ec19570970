//! Studies of external programs, by the real `coordinator` and real programs: the example of the document, a
//! problem with a known answer, and everything a program can do wrong. The programs are Python.

mod files;
mod levels;

use crate::study_folder::StudyFolder;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for anything: only a defect waits so long.
const PATIENCE: Duration = Duration::from_secs(120);

/// R - S, whose fall below 0 is failure: beta = 4 / sqrt(1 + 1.44).
const STRENGTH: &str = r#"
scene = { name = "strength" }
simulator = { program = ["python3", "model.py"], timeout = "TIMEOUT" }
outputs = [{ name = "margin", unit = "kN" }]
limit_states = [{ name = "broken", output = "margin", threshold = 0, fails = "below" }]
variables = [
  { name = "R", mean = 10, std = 1, truncation = 8, unit = "tons" },
  { name = "S", mean = 6, std = 1.2, truncation = 8 },
]
study = { population = 40000, initial = 12, batch = 4, max_evaluations = 60 }
"#;

/// A model that writes its process number to a file in its folder, does `first`, and then `reply` for every request, from `id`, `R` and `S`.
fn model(first: &str, reply: &str) -> String {
    format!(
        "import json, os, sys, time\n\
         open('started', 'a').write(f'{{os.getpid()}}\\n')\n\
         {first}\n\
         def answer(id, **rest): print(json.dumps(dict(id=id, **rest)), flush=True)\n\
         for line in sys.stdin:\n    request = json.loads(line)\n    id, cycles = request['id'], request['cycles']\n    \
         R, S = request['sample']['R'], request['sample']['S']\n    {reply}\n"
    )
}

const RIGHT: &str = "answer(id, outputs=dict(margin=R - S))";

/// The study with a program; `None`, with a message, if Python is not installed.
fn study(program: &str, timeout: &str) -> Option<StudyFolder> {
    StudyFolder::new("a program as simulator", &STRENGTH.replace("TIMEOUT", timeout), program)
}

impl StudyFolder {
    /// Processes that were started and are still there; those that wait to be collected are not.
    fn alive(&self) -> Vec<String> {
        let started = std::fs::read_to_string(self.file("started")).unwrap_or_default();
        let there = |process: &&str| {
            let line = std::fs::read(Path::new("/proc").join(process).join("cmdline"));
            line.is_ok_and(|line| !line.is_empty())
        };
        started.lines().filter(there).map(str::to_owned).collect()
    }
}

#[test]
fn the_example_of_the_document_runs() {
    let Some(study) = study("", "1 min") else { return };
    let text = include_str!("../../../doc/simulators.md");
    let block = |kind: &str| {
        let from = text.find(&format!("```{kind}\n")).unwrap() + kind.len() + 4;
        &text[from..from + text[from..].find("```").unwrap()]
    };
    std::fs::write(study.file("beam.toml"), block("toml")).unwrap();
    std::fs::write(study.file("beam.py"), block("python")).unwrap();
    assert!(
        study
            .done("check beam.toml")
            .contains("valid; 2 outputs, 6 random variables, 2 limit states, 10 checkpoints")
    );
    let explained = study.done("explain beam.toml");
    for part in ["program: python3 beam.py", "limit state yielding: failed from 0 MPa down", "corrosion"] {
        assert!(explained.contains(part), "{explained}");
    }

    // 4 F L^3 / (E b h^3) and 6 F L / (b h^2) of what is left after five years.
    let one: Value = serde_json::from_str(&study.done("simulate beam.toml --set load=600N")).unwrap();
    let (b, h) = (0.02 - 2e-4, 0.04 - 2e-4);
    let deflection = 1e3 * 4.0 * 600.0 / (206e9 * b * f64::powi(h, 3));
    let reserve = 140.0 - 6e-6 * 600.0 / (b * h * h);
    for (key, expected) in [("deflection_mm", deflection), ("reserve_MPa", reserve)] {
        let found = one[key][0].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-9 * expected, "{key}: {found}, not {expected}");
    }

    study.done("run beam.toml --workers 2 --out study --quiet");
    study.done("run beam.toml --workers 2 --method monte-carlo --samples 3000 --out direct --quiet");
    let (learned, direct) = (study.summary("study"), study.summary("direct"));
    assert!(learned["evaluations"]["total"].as_u64().unwrap() <= 60, "{}", learned["evaluations"]);
    for (a, b) in
        learned["reliability"].as_array().unwrap().iter().zip(direct["reliability"].as_array().unwrap())
    {
        for key in ["bent", "yielding", "total"] {
            let [r, s] = [a, b].map(|row| row[key].as_f64().unwrap());
            let error = |row: &Value| row["standard_error"][key].as_f64().unwrap();
            assert!((r - s).abs() <= 3.0 * error(a).hypot(error(b)) + 1e-3, "{key}: {a} {b}");
        }
    }
    let page = std::fs::read_to_string(study.file("study").join("report.html")).unwrap();
    assert!(page.contains("deflection reaching 10 mm"), "how it fails");
    for absent in ["Worn bores", "First cycle", "mechanism", "Newton"] {
        assert!(!page.contains(absent), "{absent}");
    }
}

#[test]
fn a_known_failure_probability_is_found_whatever_happens() {
    let Some(study) = study(&model("", RIGHT), "1 min") else { return };
    let told = study.done("run study.toml --workers 2 --seed 3 --out two --quiet --json");
    let told: Value = serde_json::from_str(&told).unwrap();
    let row = &told["reliability"][0];
    let (pf, error) =
        (1.0 - row["total"].as_f64().unwrap(), row["standard_error"]["total"].as_f64().unwrap());
    // Phi(-4 / sqrt(2.44)).
    let exact = 5.223_1e-3;
    assert!((pf - exact).abs() < 3.0 * error && error < 5e-4, "{pf} +- {error}");
    assert_eq!(
        (told["accuracy"].as_str(), &told["accuracy_settings"]),
        (Some("the simulator's own"), &Value::Null)
    );
    assert!(told["reliability"][0]["parts"]["total"]["numerical"] == 0.0);
    let header = std::fs::read_to_string(study.file("two").join("samples.csv")).unwrap();
    assert!(header.starts_with("id,R,S,margin_kN@1,failure,"), "{header}");
    let text = study.done("resume two");
    assert!(text.contains("P_f broken = 0.005"), "{text}");

    // Another number of slots, over messages, and with fewer licences than slots.
    study.done("run study.toml --workers 2 --listen tcp/127.0.0.1:0 --seed 3 --out farm --quiet");
    assert_eq!(study.summary("farm"), study.summary("two"));
    let before = std::fs::read_to_string(study.file("started")).unwrap().lines().count();
    study.done("run study.toml --workers 3 --licences 1 --seed 3 --out licensed --quiet");
    assert_eq!(study.summary("licensed"), study.summary("two"));
    let after = std::fs::read_to_string(study.file("started")).unwrap().lines().count();
    assert_eq!((after - before, study.alive().len()), (1, 0));

    // Another number of slots, and a study that is stopped in the middle of an evaluation.
    study.done("run study.toml --workers 1 --seed 3 --out one --quiet");
    assert_eq!(study.summary("one"), study.summary("two"));
    let slow = format!("time.sleep(600) if id == 14 and not os.path.exists('again') else {RIGHT}");
    std::fs::write(study.file("model.py"), model("", &slow)).unwrap();
    let mut child = study
        .command("run study.toml --workers 2 --seed 3 --out stopped --quiet")
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let recorded = || {
        let file = study.file("stopped").join("campaign.db");
        let flags = rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY;
        let file = rusqlite::Connection::open_with_flags(file, flags).ok()?;
        file.query_row("select count(*) from evaluation", [], |row| row.get::<_, i64>(0)).ok()
    };
    let start = Instant::now();
    while recorded().unwrap_or(0) < 15 {
        assert!(child.try_wait().unwrap().is_none() && start.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(study.alive().len(), 2);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(study.alive(), [""; 0], "Ctrl-C leaves orphans");
    std::fs::write(study.file("again"), "").unwrap();
    study.done("resume stopped --workers 1 --quiet");
    assert_eq!(study.summary("stopped"), study.summary("two"));
}

#[test]
fn a_second_signal_leaves_no_orphan_either() {
    // Two processes are at work once the nominal point, which is simulated alone, is answered.
    let reply = format!("time.sleep(600) if id > 0 else {RIGHT}");
    let Some(study) = study(&model("", &reply), "1 h") else { return };
    let mut child =
        study.command("run study.toml --workers 2 --out out --quiet").stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while study.alive().len() < 2 {
        assert!(child.try_wait().unwrap().is_none() && start.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(2));
    }
    for _ in 0..2 {
        assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
    while !study.alive().is_empty() {
        assert!(start.elapsed() < PATIENCE, "orphans: {:?}", study.alive());
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Each of these ends a study before anything is recorded, with the reason.
#[test]
fn what_is_no_answer_ends_the_study() {
    for (first, reply, parts) in [
        ("print('iteration 1')", RIGHT, &["to evaluation 0: ", "\"iteration 1\" is no JSON"][..]),
        ("", "answer(id, output=1)", &["neither \"outputs\" nor \"failure\""]),
        ("", "answer(id + 1, outputs=dict(margin=1))", &["its id is 1, expected 0"]),
        ("", "answer(id, outputs=dict(margins=1))", &["output \"margin\" is missing; found: margins"]),
        ("", "answer(id, outputs=dict(margin=[1, 2]))", &["output \"margin\" has 2 values, expected 1"]),
        ("", "answer(id, outputs=dict(margin='wide'))", &["has \"wide\" instead of a number"]),
        ("", "answer(id, outputs=[1])", &["\"outputs\" is [1], expected values by name"]),
        ("", "sys.exit('no license')", &["ended with exit status: 1 instead of answering: no license"]),
        ("import nothing_of_this_name", RIGHT, &["instead of answering", "ModuleNotFoundError"]),
    ] {
        let Some(study) = study(&model(first, reply), "1 min") else { return };
        let run = "run study.toml --workers 1 --samples 4000 --max-evaluations 12 --out out --quiet";
        let said = study.refused(run, 1);
        for part in ["python3 model.py"].iter().chain(parts) {
            assert!(said.contains(part), "no \"{part}\" in: {said}");
        }
        assert_eq!(study.alive(), [""; 0]);
        if !first.starts_with("import") {
            continue;
        }
        // Put right, the study goes on.
        std::fs::write(study.file("model.py"), model("", RIGHT)).unwrap();
        study.done("resume out --workers 2 --quiet");
        assert_eq!(study.summary("out")["evaluations"]["failed"], 0);
    }
}

/// Each of these is a failed simulation of one sample; the study goes on without it.
#[test]
fn a_sample_without_a_result_is_a_failed_simulation() {
    let causes = [
        ("answer(id, failure='it diverged')", "the simulator reports: it diverged"),
        ("answer(id, outputs=dict(margin=float('nan')))", "returned NaN for output margin at cycle 1"),
        ("os.abort()", "the simulator ended with signal: 6 (SIGABRT)"),
        ("sys.exit('singular matrix')", "the simulator ended with exit status: 1: singular matrix"),
        ("time.sleep(600)", "the simulator gave no answer within 5 s"),
    ];
    // The evaluations from 5 on have one each.
    let one =
        |reply, (k, (fault, _)): (usize, &(&str, &str))| format!("{fault} if id == {} else {reply}", 5 + k);
    let reply = causes.iter().enumerate().fold(RIGHT.to_owned(), one);
    let Some(study) = study(&model("", &reply), "5 s") else { return };
    study.done(
        "run study.toml --workers 2 --seed 3 --samples 4000 --initial 30 --max-evaluations 30 --out out --quiet",
    );
    assert_eq!(study.summary("out")["evaluations"]["failed"], causes.len());
    let samples = std::fs::read_to_string(study.file("out").join("samples.csv")).unwrap();
    for (k, (_, cause)) in causes.iter().enumerate() {
        let row = samples.lines().find(|line| line.starts_with(&format!("{},", 5 + k))).unwrap();
        assert!(row.contains(cause), "no \"{cause}\" in: {row}");
    }
    assert_eq!(study.alive(), [""; 0]);
}

#[test]
fn a_program_that_ends_once_is_asked_again() {
    let once = "os.path.exists('fell') or (open('fell', 'w'), sys.exit(1)) if id == 5 else None";
    let Some(study) = study(&model("", &format!("{once}\n    {RIGHT}")), "1 min") else { return };
    study.done("run study.toml --workers 1 --seed 3 --out out --quiet");
    assert_eq!(study.summary("out")["evaluations"]["failed"], 0);
    let started = std::fs::read_to_string(study.file("started")).unwrap();
    assert_eq!(started.lines().count(), 2, "one process, and one after it fell");
}

/// A program over messages ends a study with the same reason as one without, and is resumed like it.
#[test]
fn a_program_that_cannot_be_used_ends_a_study_with_remote_workers_too() {
    let Some(study) = study(&model("", "sys.exit('no license')"), "1 min") else { return };
    let said =
        study.refused("run study.toml --workers 1 --listen tcp/127.0.0.1:0 --samples 4000 --max-evaluations 12 --out out --quiet", 1);
    for part in ["evaluation 0 was given up: worker ", "python3 model.py", "instead of answering: no license"]
    {
        assert!(said.contains(part), "no \"{part}\" in: {said}");
    }
    assert_eq!(study.alive(), [""; 0]);
    std::fs::write(study.file("model.py"), model("", RIGHT)).unwrap();
    study.done("resume out --workers 1 --quiet");
    assert_eq!(study.summary("out")["evaluations"]["failed"], 0);
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_done() {
    let Some(study) = study(&model("", RIGHT), "1 min") else { return };
    for (arguments, parts) in [
        ("run study.toml --accuracy draft", &["--accuracy is not for study.toml"][..]),
        ("run study.toml --max-error 1%", &["--max-error is not for study.toml"]),
        ("run study.toml --listen tcp/0.0.0.0:0 --out out", &["clients are not authenticated"]),
        ("run four-bar --licences 2 --out out", &["--licences: for scenes that name their own simulator"]),
        ("simulate study.toml --accuracy draft", &["--accuracy is not for study.toml"]),
        ("simulate study.toml --set T=3", &["there is no variable \"T\"", "R, S"]),
        ("tradeoff study.toml --out t", &["study.toml", "this command is for mechanisms"]),
    ] {
        let said = study.refused(arguments, 2);
        for part in parts {
            assert!(said.contains(part), "no \"{part}\" in: {said}");
        }
    }
    let text = STRENGTH.replace("TIMEOUT", "1 min").replace("python3", "no-such-python");
    std::fs::write(study.file("study.toml"), text).unwrap();
    let said = study.refused("run study.toml --out out", 2);
    assert!(said.contains("simulator.program: \"no-such-python model.py\" cannot be started in"), "{said}");
    assert!(!study.file("out").exists() && study.alive().is_empty());
}
