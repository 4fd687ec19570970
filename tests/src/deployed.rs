//! The files of `deploy/` for tests: certificates made by its script, Zenoh settings with the paths of the test, and the
//! programs as processes.

use crate::{program, skipped};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;
use zenoh::Session;

/// Top folder of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests lie in the workspace").to_path_buf()
}

/// Text of a file of `deploy/`.
pub fn deployed(name: &str) -> String {
    std::fs::read_to_string(root().join("deploy").join(name)).expect("the file exists")
}

/// Output of a program that may not be installed; `None`, with a message, if it is not.
pub fn if_installed(what: &str, command: &mut Command) -> Option<Output> {
    match command.output() {
        Ok(output) => Some(output),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            skipped(what, &format!("{} is not installed", command.get_program().display()));
            None
        }
        Err(error) => panic!("{command:?}: {error}"),
    }
}

/// True if certificates can be made; prints a message if not.
pub fn has_openssl(what: &str) -> bool {
    if_installed(what, Command::new("openssl").arg("version")).is_some()
}

/// Runs `certificates.sh` for `host` (or `worker:NAME`); returns the folder of its files.
pub fn certificates(folder: &Path, host: &str) -> PathBuf {
    let mut script = Command::new("bash");
    script.arg(root().join("deploy/certificates.sh")).arg(folder).arg(host);
    let output = script.output().expect("bash starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let own = folder.join(host.trim_start_matches("worker:"));
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), own.to_str().expect("a plain path"));
    own
}

/// A Zenoh configuration of `deploy/` with the certificates and users in `own`, in a file there.
pub fn configuration(name: &str, own: &Path) -> PathBuf {
    changed_configuration(name, own, &[])
}

/// [`configuration`] with parts of its text replaced; each part must occur.
pub fn changed_configuration(name: &str, own: &Path, changes: &[(&str, &str)]) -> PathBuf {
    let mut text = deployed(name);
    let here = own.to_str().expect("a plain path");
    assert!(text.contains("\"/etc/hingewise/tls/"));
    text = text
        .replace("/etc/hingewise/tls", here)
        .replace("/etc/hingewise/users.txt", &format!("{here}/users.txt"));
    for (from, to) in changes {
        assert!(text.contains(from), "{name} has no {from}");
        text = text.replace(from, to);
    }
    let file = own.join(name);
    std::fs::write(&file, text).expect("the folder exists");
    file
}

/// The only host name in certificates of tests that accepts connections.
pub const HOST: &str = "127.0.0.1";

/// Names of permitted workers in `zenoh-tls-coordinator.json5`.
pub const NAMED: &str = "\"coordinator.example\", \"worker-1.example\", \"worker-2.example\"";

/// Makes the user dictionary and the certificate of a coordinator with passwords; returns their folder.
pub fn with_users(folder: &Path) -> PathBuf {
    let own = certificates(folder, HOST);
    std::fs::write(
        own.join("users.txt"),
        "local:change-me-too\nworker:change-me\nlooker:look\nvisitor:visit\n",
    )
    .unwrap();
    own
}

/// Zenoh settings of a user.
pub fn user(own: &Path, name: &str, password: &str) -> PathBuf {
    let folder = own.join(format!("{name}-{password}"));
    std::fs::create_dir_all(&folder).expect("it can be made");
    std::fs::copy(own.join("ca.pem"), folder.join("ca.pem")).expect("the file exists");
    let (name, password) = (format!("user: \"{name}\""), format!("password: \"{password}\""));
    let changes = [("user: \"worker\"", name.as_str()), ("password: \"change-me\"", password.as_str())];
    changed_configuration("zenoh-password-worker.json5", &folder, &changes)
}

/// A Zenoh client session without the protocol of this program.
pub fn session(config: &Path, endpoint: &str) -> Session {
    try_session(config, endpoint).expect("a coordinator listens there")
}

/// As [`session`], where the connection may fail.
///
/// # Errors
/// That of Zenoh.
pub fn try_session(config: &Path, endpoint: &str) -> zenoh::Result<Session> {
    let mut settings = sessions::configuration(Some(config)).expect("the configuration is valid");
    for (key, value) in [
        ("mode", "\"client\""),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("listen/endpoints", "[]"),
        ("connect/endpoints", &format!("[\"{endpoint}\"]")),
    ] {
        settings.insert_json5(key, value).expect("the key exists");
    }
    sessions::open(settings)
}

/// The scene `four-bar` with a study of at most `evaluations` evaluations.
pub fn small_scene(evaluations: usize) -> String {
    let scene = std::fs::read_to_string(root().join("common/scenes/four-bar.toml")).expect("it is built in");
    let (before, _) = scene.split_once("[study]").expect("it has a study");
    let (_, variables) = scene.split_once("seed = 1\n").expect("it has a seed");
    let study = format!(
        "[study]\npopulation = 1000\ninitial = 8\nbatch = 4\nmax_evaluations = {evaluations}\nseed = 1\n"
    );
    format!("{before}{study}{variables}")
}

/// The summary of a finished study without times and workers, which may differ between runs.
pub fn answer(study: &Path) -> Value {
    let text = std::fs::read_to_string(study.join("summary.json")).expect("the study has ended");
    let mut summary: Value = serde_json::from_str(&text).expect("it is JSON");
    let all = summary.as_object_mut().expect("it is an object");
    for differing in ["timing_s", "workers", "created"] {
        assert!(all.remove(differing).is_some(), "the summary has no {differing}");
    }
    let outliers = all.get_mut("outliers").and_then(Value::as_array_mut).into_iter().flatten();
    for evaluation in outliers.filter_map(|row| row["evaluations"].as_array_mut()).flatten() {
        evaluation["worker"] = Value::Null;
    }
    summary
}

/// A child process that is killed when dropped.
pub struct KilledOnDrop(pub Child);

impl Drop for KilledOnDrop {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A running program of the workspace with its standard error.
pub struct LoggedProcess {
    process: KilledOnDrop,
    log: Arc<(Mutex<String>, Condvar)>,
}

/// Longest wait for a log line; only a defect takes longer.
const PATIENCE: Duration = Duration::from_secs(25);

impl LoggedProcess {
    /// Starts a program; its standard output is not kept.
    pub fn start(name: &str, arguments: &[&str]) -> Self {
        Self::from_command(Command::new(program(name)).args(arguments))
    }

    /// Starts a command; its standard output is not kept.
    pub fn from_command(command: &mut Command) -> Self {
        command.stdout(Stdio::null()).stderr(Stdio::piped()).env_remove("RUST_LOG");
        let mut child = command.spawn().expect("the program starts");
        let lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
        let log = Arc::new((Mutex::new(String::new()), Condvar::new()));
        let recorded = Arc::clone(&log);
        std::thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                let mut text = recorded.0.lock().unwrap_or_else(PoisonError::into_inner);
                text.push_str(&line);
                text.push('\n');
                recorded.1.notify_all();
            }
        });
        LoggedProcess { process: KilledOnDrop(child), log }
    }

    /// The log so far.
    pub fn log(&self) -> String {
        self.log.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Waits for a log line that contains `part`; returns the rest of the line.
    pub fn wait_for(&self, part: &str) -> String {
        let found =
            |log: &str| log.lines().find_map(|line| line.split_once(part)).map(|(_, rest)| rest.to_owned());
        let (text, changed) = &*self.log;
        let text = text.lock().unwrap_or_else(PoisonError::into_inner);
        let (text, _) = changed
            .wait_timeout_while(text, PATIENCE, |log| found(log).is_none())
            .unwrap_or_else(PoisonError::into_inner);
        found(&text).unwrap_or_else(|| panic!("no line with \"{part}\" in:\n{text}"))
    }

    /// Waits for the exit of the process; returns its exit code.
    pub fn end(&mut self) -> Option<i32> {
        self.process.0.wait().expect("it can be waited for").code()
    }

    /// Exit code if the process has ended, -1 if a signal ended it.
    pub fn ended(&mut self) -> Option<i32> {
        let status = self.process.0.try_wait().expect("it can be waited for");
        status.map(|status| status.code().unwrap_or(-1))
    }

    /// Process number.
    pub fn id(&self) -> u32 {
        self.process.0.id()
    }
}
