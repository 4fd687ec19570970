//! The study of the front page, run once for all tests of this program.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tests::program;

/// Arguments of the coordinator, as the front page shows them.
pub const COMMAND: [&str; 6] = ["run", "four-bar", "--accuracy", "draft", "--out", "study"];

/// A finished study.
pub struct QuickStudy {
    /// Its folder.
    pub folder: PathBuf,
    /// What the command printed on standard output.
    pub printed: String,
}

/// The study; the first call runs it.
pub fn followed() -> &'static QuickStudy {
    static STUDY: OnceLock<QuickStudy> = OnceLock::new();
    STUDY.get_or_init(|| {
        // Statics are never dropped: a folder inside the build's, emptied by the next run.
        let parent = Path::new(env!("CARGO_TARGET_TMPDIR")).join("quick-study");
        if parent.exists() {
            std::fs::remove_dir_all(&parent).expect("the folder of the run before is removed");
        }
        std::fs::create_dir_all(&parent).expect("a folder");
        let output =
            Command::new(program("coordinator")).args(COMMAND).current_dir(&parent).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let printed = String::from_utf8(output.stdout).expect("UTF-8");
        QuickStudy { folder: parent.join("study"), printed }
    })
}
