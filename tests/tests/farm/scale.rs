//! Workers that the coordinator asks a batch system for, by a command of the user in the place of Slurm's.

use serde_json::Value;
use std::time::Duration;
use tests::deployed::{LoggedProcess, answer, small_scene};
use tests::{program, within};

#[test]
fn jobs_are_asked_for_a_rejected_one_again_and_the_study_has_the_bits_of_a_local_one() {
    within(Duration::from_secs(90), || {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        std::fs::write(path("scene.toml"), small_scene(16)).unwrap();
        let run = |out: &str, options: &[&str]| {
            let (scene, out) = (path("scene.toml"), path(out));
            let study = ["run", &scene, "--accuracy", "draft", "--out", &out, "-v"];
            LoggedProcess::start("coordinator", &[&study, options].concat())
        };
        assert_eq!(run("alone", &["--workers", "1"]).end(), Some(0));
        // The first job is rejected, as by a batch system that knows no such partition.
        let worker = program("worker");
        let command = format!(
            "case $WORKER_NAME in *-1) echo no such partition >&2; exit 1;; esac; exec '{}' --connect \"$CONNECT\" \
             --name \"$WORKER_NAME\" --idle-timeout \"$IDLE_TIMEOUT\" --slots 1 --give-up-after 10",
            worker.display()
        );
        let scale = ["--workers", "0", "--scale", &command, "--most", "2", "--idle", "5s"];
        let mut study = run("scaled", &scale);
        study.wait_for("failed: no such partition");
        assert_eq!(study.end(), Some(0), "{}", study.log());
        let [alone, scaled] = ["alone", "scaled"].map(|out| answer(&folder.path().join(out)));
        assert_eq!(scaled["reliability"], alone["reliability"]);
        let summary = std::fs::read_to_string(path("scaled/summary.json")).unwrap();
        let workers = serde_json::from_str::<Value>(&summary).unwrap()["workers"].clone();
        let names: Vec<String> = workers
            .as_array()
            .unwrap()
            .iter()
            .map(|worker| worker["name"].as_str().unwrap().to_owned())
            .collect();
        assert!(
            !names.is_empty() && names.iter().all(|name| name.starts_with("job-") && name.contains("-2/")),
            "{names:?}"
        );
    });
}
