//! Faults of a farm, injected into real processes during a small study. Each function returns a [`Report`]: the study must
//! end with the answer of an undisturbed one and every evaluation recorded once. `tests/tests/farm/faults.rs` asserts this in
//! short runs, `tests/examples/faults.rs` in long ones.

mod chaos;
mod coordinators;
mod disk;
mod network;
mod routers;
pub(crate) mod soak;
mod workers;

pub use chaos::{ChaosStudy, Faults, chaos, same_results};
pub use coordinators::{killed_coordinator, stalled_coordinator};
pub use disk::{MOST_UNRECORDED, full_disk, slow_disk};
pub use network::cut_network;
pub use routers::killed_routers;
pub use soak::soak;
pub use workers::{frozen_worker, killed_workers};

use crate::practice_study::{PracticeStudy, recorded};
use crate::process::Process;
use crate::program;
use std::fmt;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Time limit of a study with faults.
pub const LONGEST: Duration = Duration::from_secs(600);

/// How a study with a fault ended.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// The answer is that of an undisturbed study.
    pub same_answer: bool,
    /// The campaign file has every evaluation exactly once.
    pub recorded_once: bool,
    /// Evaluations recorded before the fault that are missing or changed at the end.
    pub records_lost: usize,
    /// Evaluations recorded before the fault that were started again.
    pub records_repeated: usize,
    /// Evaluations started more than once.
    pub repeated: usize,
    /// Most simulations finished and not recorded at one time.
    pub unrecorded: usize,
    /// Times to detect the fault, or to recover from it.
    pub times: Vec<Duration>,
    /// Workers that finished evaluations, by name.
    pub workers: Vec<String>,
    /// Error message of the interrupted study.
    pub error: String,
    /// Measured values, in words.
    pub text: String,
}

impl Report {
    /// True if the fault changed neither the answer nor the records.
    pub fn is_undisturbed(&self) -> bool {
        self.same_answer && self.recorded_once && self.records_lost == 0 && self.records_repeated == 0
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let answer = if self.same_answer { "same answer" } else { "ANOTHER ANSWER" };
        let records = if self.recorded_once { "every evaluation recorded once" } else { "RECORDS WRONG" };
        write!(f, "{}; {answer}, {records}", self.text)
    }
}

/// An endpoint on a free port of this machine.
pub fn free_endpoint() -> String {
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

/// Waits for the end of a coordinator's process; reports answer and records.
fn report_end(coordinator: &mut Process, folder: &Path, samples: usize) -> Report {
    let answer = coordinator.line("answer", 1, LONGEST).expect("the study ends with an answer");
    assert!(coordinator.end(LONGEST).success());
    report(&answer, folder, samples)
}

/// Compares answer and records of a study with those of an undisturbed one.
fn report(answer: &str, folder: &Path, samples: usize) -> Report {
    Report {
        same_answer: answer == undisturbed(samples),
        recorded_once: all_recorded(folder, samples),
        ..Report::default()
    }
}

/// True if the campaign file has every evaluation once.
fn all_recorded(folder: &Path, samples: usize) -> bool {
    let numbers: Vec<i64> = recorded(folder).iter().map(|(id, _, _)| *id).collect();
    let expected = i64::try_from(samples).expect("it is small") + 1;
    numbers == (0..expected).collect::<Vec<_>>()
}

/// Number of earlier records, with their time stamps, that are missing now.
fn lost_records(folder: &Path, before: &[(i64, String, String)]) -> usize {
    let now = recorded(folder);
    before.iter().filter(|row| !now.contains(row)).count()
}

/// Waits until `count` evaluations are recorded.
fn wait_for_records(folder: &Path, count: usize) {
    let started = std::time::Instant::now();
    while recorded(folder).len() < count {
        assert!(started.elapsed() < LONGEST, "{count} evaluations are not recorded");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Answer of the study without faults.
fn undisturbed(samples: usize) -> String {
    PracticeStudy::monte_carlo(samples).alone()
}

/// Smallest, median and largest of some times, in words.
fn spread(times: &[Duration]) -> String {
    let mut times = times.to_vec();
    times.sort();
    let [first, middle, last] = [0, times.len() / 2, times.len() - 1].map(|k| 1e3 * times[k].as_secs_f64());
    format!("{first:.0} / {middle:.0} / {last:.0} ms (least, median, most)")
}
