//! The files of `deploy/` for clusters: Slurm, ssh, Kubernetes. Scripts run with stand-ins for the commands of the batch
//! system; manifests are validated.

use serde_json::Value;
use std::collections::BTreeSet;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use tests::command_line::objection;
use tests::deployed::{
    LoggedProcess, certificates, configuration, deployed, has_openssl, if_installed, root, small_scene,
};
use tests::{in_time, program};

/// Scripts of `deploy/`, and those that run the real services.
const SCRIPTS: [&str; 9] = [
    "certificates.sh",
    "ssh-workers.sh",
    "slurm/coordinator.sbatch",
    "slurm/workers.sbatch",
    "../tests/examples/real/rootfs.sh",
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

/// Every object of the manifests, by kind and name.
fn manifests() -> Vec<Value> {
    serde_saphyr::from_multiple(&deployed("kubernetes/hingewise.yaml")).unwrap()
}

fn object<'m>(all: &'m [Value], kind: &str, name: &str) -> &'m Value {
    let matches = |value: &&Value| value["kind"] == kind && value["metadata"]["name"] == name;
    all.iter().find(matches).unwrap_or_else(|| panic!("no {kind} {name}"))
}

fn texts(value: &Value) -> Vec<String> {
    value.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

#[test]
fn kubernetes_objects_fit_each_other_and_the_programs() {
    let all = manifests();
    for part in &all {
        for key in ["apiVersion", "kind"] {
            assert!(part[key].is_string());
        }
        let elsewhere = part["kind"] != "Namespace" && part["metadata"]["namespace"] != "hingewise";
        assert!(!elsewhere, "{part:?} is outside of the namespace");
    }
    let set = object(&all, "StatefulSet", "coordinator");
    let workers = object(&all, "Deployment", "worker");
    let service = object(&all, "Service", "coordinator");
    assert_eq!(set["spec"]["serviceName"], "coordinator");
    assert_eq!(set["spec"]["replicas"], 1);
    for owner in [set, workers] {
        let template = &owner["spec"]["template"];
        assert_eq!(owner["spec"]["selector"]["matchLabels"], template["metadata"]["labels"]);
        let pod = &template["spec"];
        assert_eq!(pod["securityContext"]["runAsNonRoot"], true);
        assert_eq!(pod["automountServiceAccountToken"], false);
        let container = &pod["containers"][0];
        let context = &container["securityContext"];
        assert_eq!(context["allowPrivilegeEscalation"], false);
        assert_eq!(context["readOnlyRootFilesystem"], true);
        assert_eq!(texts(&context["capabilities"]["drop"]), ["ALL"]);
        // Every mounted volume is declared: as a volume of the pod, or as a claim of the set.
        let named = |list: &Value, name: &dyn Fn(&Value) -> Value| -> BTreeSet<String> {
            let list = list.as_array().cloned().unwrap_or_default();
            list.iter().map(|part| name(part).as_str().unwrap().to_owned()).collect()
        };
        let mut declared = named(&pod["volumes"], &|volume| volume["name"].clone());
        declared.extend(named(&owner["spec"]["volumeClaimTemplates"], &|claim| {
            claim["metadata"]["name"].clone()
        }));
        assert_eq!(named(&container["volumeMounts"], &|mount| mount["name"].clone()), declared);
    }
    let labels = &set["spec"]["template"]["metadata"]["labels"];
    assert_eq!(&service["spec"]["selector"], labels);
    let port = &service["spec"]["ports"][0]["port"];
    assert_eq!(port, &set["spec"]["template"]["spec"]["containers"][0]["ports"][0]["containerPort"]);

    // Traffic is denied by default; workers may reach the coordinator on its port, and the cluster's DNS.
    assert!(object(&all, "NetworkPolicy", "deny-all")["spec"]["podSelector"].as_object().unwrap().is_empty());
    let guard = &object(&all, "NetworkPolicy", "coordinator")["spec"];
    assert_eq!(&guard["podSelector"]["matchLabels"], labels);
    let from = &guard["ingress"][0]["from"][0]["podSelector"]["matchLabels"];
    assert_eq!(from, &workers["spec"]["template"]["metadata"]["labels"]);
    assert_eq!(&guard["ingress"][0]["ports"][0]["port"], port);
    let way = &object(&all, "NetworkPolicy", "worker")["spec"]["egress"][0];
    assert_eq!((&way["to"][0]["podSelector"]["matchLabels"], &way["ports"][0]["port"]), (labels, port));

    let command = texts(&workers["spec"]["template"]["spec"]["containers"][0]["command"]);
    let arguments: Vec<&str> = command[1..].iter().map(String::as_str).collect();
    assert_eq!(objection(&program(&command[0]), &arguments), None);
    let connect = format!("--connect=tls/coordinator.hingewise.svc:{}", port.as_u64().unwrap());
    assert!(command.contains(&connect));

    // The command of the coordinator is a shell script: it runs with stand-ins for the programs.
    let container = &set["spec"]["template"]["spec"]["containers"][0];
    let command = texts(&container["command"]);
    assert_eq!(command[..2], ["/bin/sh", "-euc"]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let results = path.join("study");
    let line = command[2].replace("/results/study", results.to_str().unwrap());
    stand_in(path, "coordinator", "");
    stand_in(path, "sleep", "");
    let begin = || {
        let mut shell = Command::new(&command[0]);
        shell.args([&command[1], &line]).env("SCENE", "four-bar").env("LISTEN", "tls/0.0.0.0:7447");
        let path = format!("{}:{}", path.display(), std::env::var("PATH").unwrap());
        assert!(shell.env("PATH", path).status().unwrap().success());
    };
    begin();
    std::fs::create_dir_all(&results).unwrap();
    std::fs::write(results.join("campaign.db"), "begun").unwrap();
    begin();
    let started = noted(path, "coordinator");
    let started: Vec<Vec<&str>> = started.lines().map(|line| line.split(' ').collect()).collect();
    assert_eq!([started[0][0], started[1][0]], ["run", "resume"]);
    for arguments in &started {
        assert_eq!(objection(&program("coordinator"), arguments), None);
    }
    // A finished study is not started again.
    std::fs::write(results.join("report.html"), "done").unwrap();
    stand_in(path, "sleep", "exit 0");
    let mut shell = Command::new(&command[0]);
    let path_variable = format!("{}:{}", path.display(), std::env::var("PATH").unwrap());
    shell.args([&command[1], &line]).env("PATH", path_variable).env("SCENE", "x").env("LISTEN", "x");
    shell.status().unwrap();
    assert_eq!(noted(path, "sleep"), "infinity\n");
}
