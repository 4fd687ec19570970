//! How studies end, are refused, read and gone on with, by the real `coordinator`. The simulators are programs in Python.

use crate::study_folder::{StudyFolder, said};
use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

const SCENE: &str = r#"
scene = { name = "strength" }
simulator = { program = ["python3", "model.py"], timeout = "20 s" }
outputs = [{ name = "margin", unit = "kN" }]
limit_states = [{ name = "broken", output = "margin", threshold = 0, fails = "below" }]
variables = [
  { name = "S", mean = 6, std = 1.2, truncation = 8 },
  { name = "R", mean = 10, std = 1, truncation = 8 },
]
study = { population = 20000, initial = 12, batch = 4, max_evaluations = 24 }
"#;

/// A bent margin, so that learning takes some rounds.
const RIGHT: &str = "answer(id, outputs=dict(margin=R - S + 0.3 * (R - 10) * (S - 6)))";

/// A model that notes every request in the file `asked` and then does `reply`.
fn model(reply: &str) -> String {
    format!(
        "import json, os, sys, time\n\
         def answer(id, **rest): print(json.dumps(dict(id=id, **rest)), flush=True)\n\
         for line in sys.stdin:\n    request = json.loads(line)\n    id = request['id']\n    \
         R, S = request['sample']['R'], request['sample']['S']\n    \
         open('asked', 'a').write(f'{{R}} {{S}}\\n')\n    {reply}\n"
    )
}

/// The study with a model; `None`, with a message, if Python is not installed.
fn study(reply: &str) -> Option<StudyFolder> {
    StudyFolder::new("ends of studies", SCENE, &model(reply))
}

impl StudyFolder {
    fn set_model(&self, reply: &str) {
        std::fs::write(self.file("model.py"), model(reply)).unwrap();
    }

    /// Samples the model was asked for since the last call, each once or more often.
    fn asked(&self) -> Vec<String> {
        let file = self.file("asked");
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let _ = std::fs::remove_file(file);
        text.lines().map(str::to_owned).collect()
    }

    fn samples(&self, dir: &str) -> Vec<String> {
        let text = std::fs::read_to_string(self.file(dir).join("samples.csv")).unwrap();
        // Without worker and time, which follow the failure.
        text.lines().map(|line| line.split(',').take(5).collect::<Vec<_>>().join(",")).collect()
    }
}

#[track_caller]
fn contains(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no \"{part}\" in: {text}");
    }
}

#[test]
fn issue_all_simulations_fail_and_no_command_says_why() {
    let Some(study) = study("answer(id, failure='no license')") else { return };
    for method in ["ak", "monte-carlo"] {
        let run = format!("run study.toml --method {method} --workers 2 --out {method} --quiet");
        let cause = "the nominal mechanism cannot be simulated: the simulator reports: no license";
        contains(&study.refused(&run, 1), &[cause, &format!("`coordinator resume {method}` tries again")]);
        // One evaluation was enough to find out.
        assert_eq!(study.asked().len(), 1);
        for command in ["report METHOD", "sensitivity METHOD", "compare METHOD METHOD --out c.html"] {
            contains(
                &study.refused(&command.replace("METHOD", method), 2),
                &["ended without a result", cause],
            );
        }
        contains(&study.done(&format!("status {method}")), &["ended without a result", cause]);
        contains(&study.refused(&format!("resume {method} --quiet"), 1), &[cause]);
        assert_eq!(study.asked().len(), 1);
    }
    // Put right, the study goes on.
    study.set_model(RIGHT);
    study.done("resume ak --workers 2 --quiet");
    assert_eq!(study.summary("ak")["evaluations"]["failed"], 0);
}

#[test]
fn issue_a_program_that_does_not_flush_was_found_out_after_the_initial_design() {
    let reply = "print(json.dumps(dict(id=id, outputs=dict(margin=1))))";
    let Some(study) = study(reply) else { return };
    std::fs::write(study.file("study.toml"), SCENE.replace("20 s", "1 s")).unwrap();
    let started = Instant::now();
    let said = study.refused("run study.toml --workers 1 --out out --quiet", 1);
    contains(&said, &["no answer within 1 s", "flush its output after every reply", "simulator.timeout"]);
    // None if Python takes that long to start.
    assert!(study.asked().len() <= 1);
    assert!(started.elapsed() < Duration::from_secs(60));
}

#[test]
fn too_few_results_are_told_with_their_cause_and_the_limit_state_by_name() {
    let nominal = format!("answer(id, failure='it diverged') if id > 0 else {RIGHT}");
    let Some(study) = study(&nominal) else { return };
    let said = study.refused("run study.toml --workers 2 --initial 6 --out few --quiet", 1);
    contains(&said, &["1 of 6 simulations gave a result", "5 failed like this", "it diverged"]);
    let said = study.refused("run study.toml --workers 2 --out many --quiet", 1);
    contains(&said, &["11 of 12 simulations failed, 11 of them like this", "it diverged"]);
}

#[test]
fn issue_too_many_failures_were_a_dead_end() {
    let reply = format!("answer(id, failure='too strong') if R > 10.5 else {RIGHT}");
    let Some(study) = study(&reply) else { return };
    let said = study.refused("run study.toml --workers 2 --seed 3 --out one --quiet", 1);
    let share = said.split("--max-failed ").nth(1).and_then(|rest| rest.strip_suffix("%`"));
    let share = share.unwrap_or_else(|| panic!("{said}"));
    contains(&said, &["simulations failed", "too strong", "`coordinator resume one --max-failed"]);
    contains(&study.refused("report one", 2), &["ended without a result", "--max-failed"]);
    study.done(&format!("resume one --workers 2 --max-failed {share}% --quiet"));
    study.done(&format!("run study.toml --workers 2 --seed 3 --max-failed {share}% --out two --quiet"));
    assert_eq!(study.summary("one"), study.summary("two"));
    assert_eq!(study.samples("one"), study.samples("two"));
}

#[test]
fn issue_a_study_could_not_be_extended() {
    let Some(study) = study(RIGHT) else { return };
    let run = "run study.toml --workers 2 --seed 3 --quiet --target-error 0.00001";
    let told = study.done(&format!("{run} --max-evaluations 16 --out legs"));
    contains(&told, &["ended before its targets were met", "`coordinator resume legs --max-evaluations 32`"]);
    let page = std::fs::read_to_string(study.file("legs/report.html")).unwrap();
    contains(&page, &["coordinator resume legs --max-evaluations 32"]);
    let first = study.asked();
    study.done("resume legs --workers 1 --max-evaluations 22 --quiet");
    study.done("resume legs --workers 2 --max-evaluations 32 --quiet");
    let later = study.asked();
    study.done(&format!("{run} --max-evaluations 32 --out once"));
    assert_eq!(study.summary("legs"), study.summary("once"));
    assert_eq!(study.samples("legs"), study.samples("once"));
    // Nothing was simulated twice.
    assert!(later.iter().all(|sample| !first.contains(sample)), "{later:?}");

    // Another target error; a smaller budget than what is done is refused.
    study.done("resume legs --target-error 50% --quiet");
    let easier = run.replace("0.00001", "50%");
    study.done(&format!("{easier} --max-evaluations 32 --out easier"));
    assert_eq!(study.summary("legs"), study.summary("easier"));
    contains(&study.refused("resume legs --max-evaluations 5", 2), &["--max-evaluations 5", "at least the"]);
    contains(&study.done("status legs"), &["strength: finished", "4 legs"]);
}

#[test]
fn more_samples_keep_all_results() {
    let Some(study) = study(RIGHT) else { return };
    let direct = "run study.toml --workers 2 --seed 3 --method monte-carlo --quiet";
    study.done(&format!("{direct} --samples 60 --out legs"));
    study.asked();
    study.done("resume legs --samples 100 --quiet");
    assert_eq!(study.asked().len(), 40);
    study.done(&format!("{direct} --samples 100 --out once"));
    assert_eq!(study.summary("legs"), study.summary("once"));
    contains(&study.refused("resume legs --samples 50", 2), &["--samples 50", "at least the 100"]);
    contains(&study.refused("resume legs --max-evaluations 500", 2), &["--max-evaluations", "--samples"]);

    study.done("run study.toml --workers 2 --seed 3 --quiet --out learned");
    let before = study.summary("learned");
    let known = study.samples("learned");
    study.asked();
    let output = study.command("resume learned --samples 300000 --max-evaluations 60").output().unwrap();
    contains(&String::from_utf8_lossy(&output.stderr), &["grows to 300000 points", "all results are used"]);
    let after = study.summary("learned");
    assert!(before["population"].as_u64() < Some(300_000), "{}", before["population"]);
    assert!(after["population"].as_u64() >= Some(300_000), "{}", after["population"]);
    // The first simulations are those of the smaller population, under their numbers.
    assert_eq!(study.samples("learned")[..20], known[..20]);
    let added =
        after["evaluations"]["total"].as_u64().unwrap() - before["evaluations"]["total"].as_u64().unwrap();
    assert!(study.asked().len() as u64 <= added);
}

/// A command as a user without rights; `None` if this process has none to give up.
fn unprivileged(mut command: Command) -> Option<Output> {
    const NOBODY: u32 = 65_534;
    // The owner of a new file is the user of this process.
    use std::os::unix::fs::MetadataExt;
    let own = tempfile::NamedTempFile::new().unwrap();
    if own.as_file().metadata().unwrap().uid() == 0 {
        command.uid(NOBODY);
    }
    command.output().ok()
}

fn set_mode(path: &Path, mode: u32) {
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
}

#[test]
fn issue_reading_needed_a_write_lock() {
    let Some(study) = study(RIGHT) else { return };
    study.done("run study.toml --workers 2 --quiet --out first");
    study.done("run study.toml --workers 2 --quiet --method monte-carlo --samples 60 --out direct");
    set_mode(study.folder.path(), 0o755);
    for dir in ["first", "direct"] {
        for entry in std::fs::read_dir(study.file(dir)).unwrap() {
            let path = entry.unwrap().path();
            set_mode(&path, if path.is_dir() { 0o555 } else { 0o444 });
        }
        set_mode(&study.file(dir), 0o555);
    }
    for (arguments, code, part) in [
        ("sensitivity first", 0, ""),
        ("status first", 0, ""),
        ("report first", 2, "no file can be written here"),
        ("resume first", 2, "ermission denied"),
        ("run study.toml --out first/inside", 2, "ermission denied"),
    ] {
        let Some(output) = unprivileged(study.command(arguments)) else { return };
        let message = said(&output, code, arguments);
        contains(&message, &[part]);
    }
    contains(&study.refused("report first --out study.toml", 2), &["study.toml"]);
    assert!(study.done("report first --out copy").ends_with("copy/report.html\n"));
    assert!(study.file("copy/figures").is_dir() && study.file("copy/samples.csv").is_file());
    for dir in ["first", "direct"] {
        set_mode(&study.file(dir), 0o755);
    }
}

#[test]
fn issue_one_cause_had_several_exit_codes() {
    let Some(study) = study(RIGHT) else { return };
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let four_bar = "run four-bar --workers 0 --out out";
    for arguments in [
        format!("{four_bar} --listen tcp/127.0.0.1:{port}"),
        format!("{four_bar} --live {port}"),
        "run four-bar --initial 1 --out out".to_owned(),
        "run four-bar --samples 5 --out out".to_owned(),
        "run study.toml --workers -1 --out out".to_owned(),
        "run study.toml --out study.toml/inside".to_owned(),
        "init press --out no/such/press.toml".to_owned(),
        "compare none none --out c.html".to_owned(),
    ] {
        study.refused(&arguments, 2);
        assert!(!study.file("out").exists(), "{arguments} left a folder");
    }
}

#[test]
fn check_sees_that_the_program_exists() {
    let Some(study) = study(RIGHT) else { return };
    study.done("check study.toml");
    std::fs::write(study.file("gone.toml"), SCENE.replace("python3", "./no-such-program")).unwrap();
    contains(
        &study.refused("check gone.toml", 2),
        &["simulator.program", "./no-such-program", "cannot be started"],
    );
}

#[test]
fn issue_a_closed_pipe_ended_a_study_with_a_panic() {
    let Some(study) = study(RIGHT) else { return };
    let run = |arguments: &str| {
        let mut command = study.command(arguments);
        // Both pipes are closed before anything is written to them.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        command.stdout(writer.try_clone().unwrap()).stderr(writer);
        command.status().unwrap().code()
    };
    assert_eq!(run("run study.toml --workers 2 --out study"), Some(0));
    assert!(study.file("study/report.html").is_file());
    contains(&study.done("status study"), &["strength: finished"]);
    for command in ["status study", "scenes", "sensitivity study", "resume study", "man", "schema"] {
        assert_eq!(run(command), Some(0), "{command}");
    }
    // An error keeps its exit code.
    assert_eq!(run("run study.toml --out study"), Some(2));
}

#[test]
fn issue_times_of_a_resumed_study_were_those_of_its_last_run() {
    let Some(study) = study(RIGHT) else { return };
    study.done("run study.toml --workers 2 --out study --quiet");
    let first = times(&study);
    study.done("resume study --workers 2 --target-error 1e-9 --max-evaluations 40 --quiet");
    let second = times(&study);
    let total = |times: &Value| times["total"].as_f64().unwrap();
    assert!(total(&second) > total(&first), "{first} {second}");
    assert_eq!([&first["runs"], &second["runs"]], [1, 2]);
    assert_eq!([&first["workers"], &second["workers"]], [2, 2]);
}

/// Times of the study in the folder `study`.
fn times(study: &StudyFolder) -> Value {
    let text = std::fs::read_to_string(study.file("study/summary.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["timing_s"].clone()
}
