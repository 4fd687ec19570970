//! The files of `deploy/` for clusters: Slurm, ssh. Scripts run with stand-ins for the commands of the batch system.

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use tests::command_line::objection;
use tests::deployed::{
    LoggedProcess, certificates, configuration, deployed, has_openssl, if_installed, root, small_scene,
};
use tests::{in_time, program};

/// Scripts of `deploy/`, and those that run the real services.
const SCRIPTS: [&str; 12] = [
    "certificates.sh",
    "ssh-workers.sh",
    "slurm/coordinator.sbatch",
    "slurm/workers.sbatch",
    "../tests/examples/peers/run.sh",
    "../tests/examples/real/checks.sh",
    "../tests/examples/real/hyperqueue_scale.sh",
    "../tests/examples/real/older_worker.sh",
    "../tests/examples/real/slurm.sh",
    "../tests/examples/real/slurm_scale.sh",
    "../tests/examples/real/systemd.sh",
    "../tests/examples/real/zenohd.sh",
];

#[test]
fn scripts_pass_bash_and_shellcheck() {
    for name in SCRIPTS {
        let script = root().join("deploy").join(name);
        let parsed = Command::new("bash").arg("-n").arg(&script).status().unwrap();
        assert!(parsed.success(), "{name}");
        assert!(deployed(name).contains("set -euo pipefail"), "{name} goes on after a failure");
    }
    let mut check = Command::new("shellcheck");
    check.args(SCRIPTS).current_dir(root().join("deploy"));
    let Some(output) = if_installed("scripts by shellcheck", &mut check) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

/// A stand-in for a command of the batch system: records its arguments and executes `prints`.
fn stand_in(folder: &Path, name: &str, prints: &str) {
    let file = folder.join(name);
    let noted = folder.join(format!("{name}.noted"));
    std::fs::write(&file, format!("#!/bin/sh\necho \"$@\" >> '{}'\n{prints}\n", noted.display())).unwrap();
    std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// Arguments recorded by a stand-in, one call per line.
fn noted(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(format!("{name}.noted"))).unwrap_or_default()
}

/// A Slurm script, run with the stand-ins first on its PATH.
fn batch(folder: &Path, script: &str) -> Command {
    let mut command = Command::new("bash");
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap());
    command.arg(root().join("deploy/slurm").join(script)).current_dir(folder).env("PATH", path);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

#[test]
fn a_worker_in_a_batch_job_gets_the_remaining_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("study.endpoint"), "tls/node-7.cluster:7447\n").unwrap();
    stand_in(path, "worker", "");
    for (left, walltime) in [("1-02:03:04", 93_724), ("03:59:50", 14_330), ("45:08", 2648), ("1:00", 54)] {
        stand_in(path, "squeue", &format!("echo {left}"));
        let mut job = batch(path, "workers.sbatch");
        job.envs([("SLURM_JOB_ID", "31"), ("SLURM_ARRAY_JOB_ID", "30"), ("SLURM_ARRAY_TASK_ID", "4")]);
        job.env("WORKER_OPTIONS", "--drain 5");
        let output = job.env("SLURM_CPUS_PER_TASK", "16").env("CONFIG", "worker.json5").output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let started = noted(path, "worker");
        let arguments: Vec<&str> = started.lines().last().unwrap().split(' ').collect();
        for (option, value) in [
            ("--connect", "tls/node-7.cluster:7447"),
            ("--slots", "16"),
            ("--name", "slurm-30_4"),
            ("--idle-timeout", "600"),
            ("--walltime", &walltime.to_string()),
            ("--drain", "5"),
        ] {
            let at = arguments.iter().position(|word| *word == option).unwrap();
            assert_eq!(arguments[at + 1], value, "{left}: {option}");
        }
        assert_eq!(objection(&program("worker"), &arguments), None);
    }
    assert!(noted(path, "squeue").lines().all(|line| line.contains("30_4")));
}

#[test]
fn a_coordinator_in_a_batch_job_is_queued_again_when_its_time_is_over() {
    if !has_openssl("the coordinator in a batch job") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        std::fs::write(path.join("small.toml"), small_scene(8)).unwrap();
        let config = configuration("zenoh-tls.json5", &certificates(&path.join("tls"), "127.0.0.1"));
        stand_in(path, "scontrol", "");
        stand_in(path, "hostname", "echo 127.0.0.1");
        std::os::unix::fs::symlink(program("coordinator"), path.join("coordinator")).unwrap();
        let free =
            std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port().to_string();
        let study = path.join("study");
        let job = || {
            let mut job = batch(path, "coordinator.sbatch");
            let endpoint = [("PORT", free.as_str()), ("SCENE", "small.toml"), ("SLURM_JOB_ID", "77")];
            job.envs(endpoint).env("STUDY", &study).env("CONFIG", &config);
            LoggedProcess::from_command(&mut job)
        };
        let mut first = job();
        first.wait_for("waiting for workers");
        let endpoint = std::fs::read_to_string(path.join("study.endpoint")).unwrap();
        assert_eq!(endpoint, format!("tls/127.0.0.1:{free}\n"));
        // As Slurm does two minutes before the end: a signal to the shell only.
        assert!(Command::new("kill").args(["-TERM", &first.id().to_string()]).status().unwrap().success());
        assert_eq!(first.end(), Some(130), "{}", first.log());
        assert_eq!(noted(path, "scontrol"), "requeue 77\n");
        assert!(!path.join("study.endpoint").exists());

        let mut second = job();
        second.wait_for("0 evaluations are done already");
        second.wait_for("waiting for workers");
        let config = config.to_str().unwrap();
        let mut worker = LoggedProcess::start("worker", &["--connect", endpoint.trim(), "--config", config]);
        assert_eq!((second.end(), worker.end()), (Some(0), Some(0)), "{}", second.log());
        assert!(study.join("report.html").is_file());
        assert_eq!(noted(path, "scontrol"), "requeue 77\n", "a finished study is not queued again");
    });
}
