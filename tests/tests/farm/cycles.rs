//! Lives around a program that gives cycles, whose worker and coordinator are killed: the cycles of this program's own four-bar.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use tests::deployed::deployed;
use tests::faults::{free_endpoint, same_results};
use tests::process::Process;
use tests::{program, within};

/// Time limit of the test, on a machine that does other work too.
const MINUTES: Duration = Duration::from_secs(240);

/// The scene of the four-bar in a folder with a journal, whose program notes its requests.
fn scene(folder: &Path) -> PathBuf {
    let served = format!("\"{}\" --serve-cycle four-bar", program("worker").display());
    let script = "while read -r line; do echo \"$line\" >>requests; echo \"$line\"; done | ";
    let command = format!("program = [\"sh\", \"-c\", '{script}{served}']\njournal = \"cycles\"");
    let text = deployed("python/examples/four-bar/mujoco.toml");
    let text = text.replace("program = [\"python3\", \"mujoco_cycle.py\"]", &command);
    let text = text.replace("tier = \"reaction\"", "tier = \"contact\"");
    assert!(text.contains("--serve-cycle") && text.contains("\"contact\""));
    let file = folder.join("scene.toml");
    std::fs::write(&file, text).unwrap();
    file
}

/// The requests that the program of a scene has noted, without the number of the evaluation.
fn requests(folder: &Path) -> Vec<String> {
    let noted = std::fs::read_to_string(folder.join("requests")).unwrap_or_default();
    noted.lines().filter_map(|line| line.split_once(',')).map(|(_, asked)| asked.to_owned()).collect()
}

fn coordinator(arguments: &[&str]) -> Process {
    Process::start(Command::new(program("coordinator")).arg("--quiet").args(arguments))
}

#[test]
fn a_worker_and_a_coordinator_that_are_killed_repeat_no_cycle_but_the_one_under_way() {
    within(MINUTES, || {
        let folder = tempfile::tempdir().unwrap();
        let scene = scene(folder.path()).display().to_string();
        let study = ["--method", "monte-carlo", "--samples", "4"];
        let [whole, killed] = ["whole", "killed"].map(|name| folder.path().join(name));
        let [out, again] = [&whole, &killed].map(|folder| folder.display().to_string());
        let options = ["run", &scene, "--workers", "1", "--out", &out];
        assert!(coordinator(&[&options[..], &study].concat()).end(MINUTES).success());
        let undisturbed = requests(folder.path());
        std::fs::remove_file(folder.path().join("requests")).unwrap();

        let endpoint = free_endpoint();
        let farm = ["--workers", "0", "--listen", &endpoint];
        let worker = || {
            let mut worker = Command::new(program("worker"));
            worker.args(["--connect", &endpoint, "--slots", "1", "--simulator", &scene]);
            Process::start(&mut worker)
        };
        let wait_for = |count: usize, process: &mut Process| {
            let begun = Instant::now();
            while requests(folder.path()).len() < count {
                assert!(
                    process.ended().is_none() && begun.elapsed() < MINUTES,
                    "{}",
                    requests(folder.path()).len()
                );
                std::thread::sleep(Duration::from_millis(5));
            }
        };
        let options = ["run", &scene, "--out", &again];
        let mut running = coordinator(&[&options[..], &study, &farm].concat());
        let mut first = worker();
        wait_for(undisturbed.len() / 5, &mut running);
        first.kill();
        let _second = worker();
        wait_for(undisturbed.len() * 3 / 5, &mut running);
        running.kill();
        let options = ["resume", &again];
        assert!(coordinator(&[&options[..], &farm].concat()).end(MINUTES).success());

        assert!(same_results(&whole, &killed));
        let summary = std::fs::read_to_string(whole.join("summary.json")).unwrap();
        assert!(summary.contains("\"accuracy\": \"draft around cycles of a program\""), "{summary}");
        let asked = requests(folder.path());
        let distinct = |all: &[String]| all.iter().cloned().collect::<BTreeSet<_>>();
        assert_eq!(distinct(&undisturbed).len(), undisturbed.len());
        assert_eq!(distinct(&asked), distinct(&undisturbed));
        let repeated = asked.len() - undisturbed.len();
        assert!(repeated <= 2, "{repeated} cycles were simulated again, at one kill each at most one");
        let journals = std::fs::read_dir(folder.path().join("cycles")).unwrap().count();
        assert_eq!(journals, 0, "of ended lives");
    });
}

#[test]
fn quantities_of_the_scene_around_a_program_can_be_set() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path());
    let simulate = |options: &[&str]| {
        let mut command = Command::new(program("coordinator"));
        command.args(["simulate", "--json"]).arg(&scene).args(options).output().unwrap()
    };
    let depth = |options: &[&str]| {
        let found: serde_json::Value = serde_json::from_slice(&simulate(options).stdout).unwrap();
        found["max_wear_depth_m"][7].as_f64().unwrap()
    };
    let closer = depth(&["--set", "parameters.clearance=20um"]);
    assert!(closer < 0.95 * depth(&[]), "{closer}");
    assert_eq!(closer, depth(&["--set", "parameters.clearance=20um", "--set", "load_torque=-0.8 N m"]));
    let refused = simulate(&["--accuracy", "reference"]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("of the wear is `accuracy` in [study]"), "{said}");
}
