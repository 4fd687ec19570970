//! The files of `deploy/`: tested with the real programs.

mod clusters;

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use tests::command_line::{objection, words};
use tests::deployed::{KilledOnDrop, certificates, configuration, deployed, if_installed, small_scene};
use tests::{in_time, program};

const UNITS: [&str; 2] = ["hingewise-coordinator.service", "hingewise-worker.service"];
const INSTALLED: &str = "/opt/hingewise/bin/";

/// Values of a key in a unit file, with continued lines joined.
fn values(unit: &str, key: &str) -> Vec<String> {
    let joined = unit.replace("\\\n", " ");
    joined.lines().filter_map(|line| line.strip_prefix(key)?.strip_prefix('=')).map(str::to_owned).collect()
}

#[track_caller]
fn assert_accepted(program_name: &str, arguments: &[String]) {
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    if let Some(said) = objection(&program(program_name), &arguments) {
        panic!("{said}");
    }
}

#[test]
fn the_programs_accept_the_command_lines_of_the_units() {
    for (name, lines) in UNITS.into_iter().zip([2, 1]) {
        let start = values(&deployed(name), "ExecStart").join(" ");
        // Variables of further options, as an administrator may set them.
        let start = start.replace("$${LICENCES:+--licences \"$$LICENCES\"}", "--licences 3");
        let start = start.replace("$WORKER_OPTIONS", "--simulator beam.toml --slots 2");
        let start = start.replace("$$OPTIONS", "--samples 1000");
        let start = start.replace("$$EVERY_START", "--live 9100");
        let shared = start.split("set -- ").nth(1).map_or("", |rest| rest.split(';').next().unwrap());
        let start = start.replace("\"$$@\"", shared);
        assert!(
            !start.contains("START") && !start.contains("OPTIONS") && !start.contains("LICENCES"),
            "{start}"
        );
        let commands: Vec<&str> = start.split(INSTALLED).skip(1).collect();
        assert_eq!(commands.len(), lines, "{name}: {start}");
        for command in commands {
            // A command in the shell script ends at its semicolon.
            let command = words(command.split(';').next().unwrap());
            assert_accepted(&command[0], &command[1..]);
        }
    }
}

#[test]
fn units_stop_by_sigterm_and_run_without_privileges() {
    for name in UNITS {
        let unit = deployed(name);
        let only = |key: &str| values(&unit, key).join(" ");
        assert_eq!(only("User"), "hingewise", "{name}");
        assert_eq!(only("KillSignal"), "SIGTERM", "{name}");
        assert!(only("TimeoutStopSec").parse::<u32>().unwrap() >= 10, "{name}");
        assert_eq!(only("RestartPreventExitStatus"), "2", "{name}: bad input needs a correction");
        assert_eq!(only("CapabilityBoundingSet"), "", "{name}");
        for on in ["NoNewPrivileges", "ProtectHome", "PrivateTmp", "MemoryDenyWriteExecute"] {
            assert_eq!(only(on), "yes", "{name}: {on}");
        }
    }
    // An interrupted study counts as stopped successfully.
    assert_eq!(values(&deployed(UNITS[0]), "SuccessExitStatus"), ["130"]);
    assert!(values(&deployed(UNITS[1]), "ExecStart")[0].ends_with("--give-up-after 0 $WORKER_OPTIONS"));
}

#[test]
fn systemd_reports_no_fault_of_the_units() {
    let folder = tempfile::tempdir().unwrap();
    let installed = program("coordinator").parent().unwrap().display().to_string() + "/";
    for name in UNITS {
        program(name.trim_start_matches("hingewise-").trim_end_matches(".service"));
        let file = folder.path().join(name);
        std::fs::write(&file, deployed(name).replace(INSTALLED, &installed)).unwrap();
        let mut verify = Command::new("systemd-analyze");
        verify.args(["verify", "--man=no"]).arg(&file);
        let Some(output) = if_installed("the systemd units", &mut verify) else { return };
        let said = String::from_utf8_lossy(&output.stderr);
        // systemd-analyze also reads the units of this machine, which may have faults.
        let about_ours: Vec<&str> = said.lines().filter(|line| line.contains("hingewise-")).collect();
        assert!(about_ours.is_empty(), "{about_ours:#?}");
    }
}

/// The coordinator as started by its unit, and the lines of its log.
fn start_unit(
    line: &str,
    folder: &Path,
    settings: &[(&str, &str)],
) -> (KilledOnDrop, impl Iterator<Item = String> + use<>) {
    let mut shell = Command::new("sh");
    shell.args(["-eu", "-c", line]).current_dir(folder).envs(settings.iter().copied());
    let mut child = shell.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let said = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    (KilledOnDrop(child), said)
}

#[test]
fn the_units_study_is_resumed_after_a_restart() {
    if if_installed("the coordinator's unit", Command::new("openssl").arg("version")).is_none() {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(&folder.path().join("tls"), "127.0.0.1");
        let config = configuration("zenoh-tls.json5", &own);
        std::fs::write(folder.path().join("small.toml"), small_scene(8)).unwrap();

        // The start command of the unit, with the programs and certificates of this test.
        let start = values(&deployed(UNITS[0]), "ExecStart").remove(0);
        let (_, line) = start.split_once("-c '").unwrap();
        let programs = program("coordinator").parent().unwrap().display().to_string() + "/";
        let line = line.trim_end_matches('\'').replace("$$", "$").replace(INSTALLED, &programs);
        let line = line.replace("/etc/hingewise/zenoh-tls.json5", config.to_str().unwrap());
        let listen = "tls/127.0.0.1:0";
        let settings = [
            ("SCENE", "small.toml"),
            ("STUDY", "study"),
            ("LISTEN", listen),
            ("OPTIONS", "--seed 7 --samples 3000"),
            ("EVERY_START", "--live 0"),
            ("LICENCES", ""),
        ];

        let (mut first, mut said) = start_unit(&line, folder.path(), &settings);
        assert!(said.any(|line| line.starts_with("waiting for workers")), "the study does not start");
        let stopped = Command::new("kill").args(["-TERM", &first.0.id().to_string()]).status().unwrap();
        assert!(stopped.success());
        assert_eq!(first.0.wait().unwrap().code(), Some(130));

        let (mut second, mut said) = start_unit(&line, folder.path(), &settings);
        assert!(said.any(|line| line.contains("0 evaluations are done already")), "it was not resumed");
        let waiting = "waiting for workers: worker --connect ";
        let endpoint = said.find_map(|line| line.strip_prefix(waiting).map(str::to_owned)).unwrap();
        let mut worker = Command::new(program("worker"));
        worker.args(["--quiet", "--connect", &endpoint, "--config"]).arg(&config);
        let mut worker = KilledOnDrop(worker.spawn().unwrap());
        // Read to the end: a full pipe would block the coordinator.
        let said: Vec<String> = said.collect();
        assert_eq!(second.0.wait().unwrap().code(), Some(0), "{said:#?}");
        assert_eq!(worker.0.wait().unwrap().code(), Some(0));
        assert!(folder.path().join("study/report.html").is_file());
        let summary = std::fs::read_to_string(folder.path().join("study/summary.json")).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&summary).unwrap()["seed"], 7, "of the unit's OPTIONS");
    });
}
