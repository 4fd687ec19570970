//! A study of a Python program in a folder of its own.

use serde_json::Value;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A folder with the scene `study.toml` and its program `model.py`.
pub struct StudyFolder {
    pub folder: tempfile::TempDir,
}

impl StudyFolder {
    /// `None`, with a message of `what` is not checked, if Python is not installed.
    pub fn new(what: &str, scene: &str, program: &str) -> Option<Self> {
        let python = Command::new("python3").arg("--version").output();
        if !python.is_ok_and(|output| output.status.success()) {
            let _ = writeln!(std::io::stderr(), "not checked: {what}: there is no python3");
            return None;
        }
        let study = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::write(study.file("study.toml"), scene).unwrap();
        std::fs::write(study.file("model.py"), program).unwrap();
        Some(study)
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `coordinator`, run in the folder: paths are as a user writes them.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_coordinator"));
        // With it, Python would write every reply at once.
        command.args(arguments.split(' ')).current_dir(self.folder.path()).env_remove("PYTHONUNBUFFERED");
        command
    }

    pub fn done(&self, arguments: &str) -> String {
        let output = self.command(arguments).output().unwrap();
        assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// The last line of a command that must fail.
    pub fn refused(&self, arguments: &str, code: i32) -> String {
        said(&self.command(arguments).output().unwrap(), code, arguments)
    }

    /// The summary without what may differ: times and who worked.
    pub fn summary(&self, dir: &str) -> Value {
        let text = std::fs::read_to_string(self.file(dir).join("summary.json")).unwrap();
        let mut summary: Value = serde_json::from_str(&text).unwrap();
        let all = summary.as_object_mut().unwrap();
        assert!(["timing_s", "workers", "created"].iter().all(|key| all.remove(*key).is_some()));
        summary
    }
}

/// The last line of the errors of a command that ended with this exit code.
#[track_caller]
pub fn said(output: &Output, code: i32, arguments: &str) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments}: {said}");
    said.lines().last().unwrap_or_default().to_owned()
}
