//! A panic outside of a simulation ends a program instead of leaving a process that waits for ever.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tests::deployed::KilledOnDrop;
use tests::program;

/// Time in which a program must have ended after a panic.
const PATIENCE: Duration = Duration::from_secs(10);

/// With a few files only, the messaging library panics, mostly in its own threads.
#[test]
fn issue_a_process_lived_on_after_a_panic_of_its_messaging() {
    let folder = tempfile::tempdir().unwrap();
    let mut ended = 0;
    for files in [16, 20, 30, 32, 34, 36] {
        let log = folder.path().join(format!("{files}.log"));
        let script = format!(
            "ulimit -n {files}; exec {} run four-bar --accuracy draft --method monte-carlo --samples 2 --workers 1 --out {}",
            program("coordinator").display(),
            folder.path().join(files.to_string()).display()
        );
        let mut command = Command::new("bash");
        let stderr = std::fs::File::create(&log).unwrap();
        command.args(["-c", &script]).stdout(Stdio::null()).stderr(stderr);
        let mut coordinator = KilledOnDrop(command.spawn().unwrap());
        let start = Instant::now();
        let status = loop {
            let status = coordinator.0.try_wait().unwrap();
            if status.is_some() || start.elapsed() > PATIENCE {
                break status;
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        let said = std::fs::read_to_string(&log).unwrap();
        if said.contains("panicked at") {
            assert_eq!(status.and_then(|status| status.code()), Some(1), "{files} files: {said}");
            assert!(said.contains("has panicked") && said.contains("coordinator resume"), "{said}");
            ended += 1;
        }
    }
    assert!(ended > 0, "the messaging library has done with a few files");
}
