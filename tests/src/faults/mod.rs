//! What can befall a farm, done to real processes in a practice study: in each case the study must come to the answer it
//! has without it, with each evaluation recorded once. The functions panic where it does not, and return what was measured.
//! `tests/tests/faults.rs` runs them in short, `tests/examples/faults.rs` in full.

mod coordinators;
mod disk;
mod network;
mod soak;
mod workers;

pub use coordinators::{killed_coordinator, stalled_coordinator};
pub use disk::{full_disk, slow_disk};
pub use network::cut_network;
pub use soak::soak;
pub use workers::{frozen_worker, killed_workers};

use crate::practice_study::{PracticeStudy, recorded};
use crate::process::Process;
use crate::program;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Longest a study may take with all that befalls it.
pub const LONGEST: Duration = Duration::from_secs(600);

/// An address of this machine that is free now.
fn free_endpoint() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port is free");
    format!("tcp/{}", listener.local_addr().expect("it is bound"))
}

fn coordinator(folder: &Path, endpoint: &str, samples: usize) -> Command {
    let mut command = Command::new(program("practice_study"));
    command.arg("coordinator").arg(folder).args([endpoint, &samples.to_string()]);
    command
}

fn worker(endpoint: &str, name: &str, takes: Duration) -> Command {
    let mut command = Command::new(program("practice_study"));
    command.args(["worker", endpoint, name, &takes.as_millis().to_string()]);
    command
}

/// The end of a coordinator's process: the answer is that of an undisturbed study, with every evaluation recorded once.
fn check_end(coordinator: &mut Process, folder: &Path, samples: usize) {
    let answer = coordinator.line("answer", 1, LONGEST).expect("the study ends with an answer");
    assert!(coordinator.end(LONGEST).success());
    all_recorded(folder, samples);
    assert!(answer == undisturbed(samples), "the answer is another one");
}

/// Every evaluation stands in the campaign file; its key allows each but once.
fn all_recorded(folder: &Path, samples: usize) {
    let numbers: Vec<i64> = recorded(folder).iter().map(|(id, _, _)| *id).collect();
    let expected = i64::try_from(samples).expect("it is small") + 1;
    assert_eq!(numbers, (0..expected).collect::<Vec<_>>());
}

/// What was recorded before is so still, to the moment.
fn all_kept(folder: &Path, before: &[(i64, String, String)]) {
    let now = recorded(folder);
    assert!(before.iter().all(|row| now.contains(row)), "what was recorded has changed");
}

/// Waits until so many evaluations are recorded.
fn wait_for_records(folder: &Path, count: usize) {
    let started = std::time::Instant::now();
    while recorded(folder).len() < count {
        assert!(started.elapsed() < LONGEST, "{count} evaluations are not recorded");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// What the study comes to when nothing befalls it.
fn undisturbed(samples: usize) -> String {
    PracticeStudy::monte_carlo(samples).alone()
}

/// Least, median and largest of some times, for people.
fn spread(times: &mut [Duration]) -> String {
    times.sort();
    let [first, middle, last] = [0, times.len() / 2, times.len() - 1].map(|k| 1e3 * times[k].as_secs_f64());
    format!("{first:.0} / {middle:.0} / {last:.0} ms (least, median, most)")
}
