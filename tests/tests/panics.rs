//! A panic outside of a simulation ends a program instead of leaving a process that waits for ever.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tests::deployed::KilledOnDrop;
use tests::program;

/// Time in which a program must have ended.
const PATIENCE: Duration = Duration::from_secs(60);

/// With a few files only, the messaging library panics in one of its own threads, or the program reports that it cannot go on.
#[test]
fn issue_a_process_without_files_for_its_messaging_waited_for_ever() {
    let folder = tempfile::tempdir().unwrap();
    for files in [16, 20, 24, 28, 32, 36] {
        let script = format!(
            "ulimit -n {files}; exec {} run --scene four-bar --accuracy draft --method monte-carlo --samples 2 --workers 1 --out {}",
            program("coordinator").display(),
            folder.path().join(files.to_string()).display()
        );
        let mut command = Command::new("bash");
        command.args(["-c", &script]).stdout(Stdio::null()).stderr(Stdio::null());
        let mut coordinator = KilledOnDrop(command.spawn().unwrap());
        let start = Instant::now();
        let status = loop {
            if let Some(status) = coordinator.0.try_wait().unwrap() {
                break status;
            }
            assert!(start.elapsed() < PATIENCE, "with {files} files it has not ended");
            std::thread::yield_now();
        };
        // It may have done without more files.
        assert!(matches!(status.code(), Some(0..=2)), "{files} files: {status}");
    }
}
