//! The program `coordinator` from outside: its commands, files and words.

mod bad_input;
mod check;
mod command_line;
mod earlier_versions;
mod ends;
mod measured;
mod nonsense;
mod plans;
mod reader;
mod readme_picture;
#[path = "../../../common/tests/scene/rows.rs"]
mod rows;
mod schema;
mod simulators;
mod study;
mod study_folder;
mod terminal;
mod units_and_replacement;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

fn coordinator(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_coordinator")).args(arguments).output().unwrap()
}

/// Standard output of a command that succeeds.
#[track_caller]
fn printed(arguments: &[&str]) -> String {
    let output = coordinator(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[track_caller]
fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&printed(arguments)).unwrap()
}

/// Standard error of a command that fails with this exit code and without a result.
#[track_caller]
fn refused(arguments: &[&str], code: i32) -> String {
    let output = coordinator(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed a result");
    message
}

/// Two variants of the model of the four-bar, the second of which is the model itself.
const VARIANTS: &str = "[[variants]]\nname = \"film\"\nset = { \"parameters.film_damping\" = \"130 N s/m\" }\n\
    [[variants]]\nname = \"same\"\nset = { \"scene.title\" = \"another title\" }\n";

/// The folder of a finished study of the four-bar with these variants, which tests ask and do not change.
fn finished_study() -> &'static Path {
    static STUDY: OnceLock<PathBuf> = OnceLock::new();
    STUDY.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("finished-study");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("variants.toml"), VARIANTS).unwrap();
        let run = "run four-bar --accuracy draft --samples 4000 --initial 16 --max-evaluations 24 --quiet";
        let mut command = Command::new(env!("CARGO_BIN_EXE_coordinator"));
        command
            .args(run.split(' '))
            .args(["--variants", "variants.toml", "--out", "study"])
            .current_dir(&folder);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        folder.join("study")
    })
}

/// Its summary.
fn finished_summary() -> Value {
    let text = std::fs::read_to_string(finished_study().join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The rows of a section of `cases.txt`.
fn rows<const N: usize>(section: &str) -> Vec<[&'static str; N]> {
    rows::rows(include_str!("cases.txt"), section)
}
