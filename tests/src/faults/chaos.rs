//! Rounds of a real study with kills and stops of coordinator and workers at random, compared with an undisturbed run.

use super::soak::Random;
use super::{LONGEST, free_endpoint};
use crate::deployed::answer;
use crate::process::Process;
use crate::program;
use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Workers of a round, with one slot each.
const WORKERS: usize = 3;
/// Longest pause between two faults [ms].
const PAUSE: u64 = 1500;
/// Most ends of a round because workers were lost with the same evaluation.
const MOST_GIVEN_UP: usize = 10;
/// Time for which a process is stopped: longer than the lease of a worker.
const STOPPED: Duration = Duration::from_secs(3);

/// A study by scene file, with its options.
pub struct ChaosStudy<'a> {
    /// File of the scene.
    pub scene: &'a Path,
    /// Options of `coordinator run`, and those of `resume`.
    pub options: [&'a [&'a str]; 2],
    /// Options of the workers.
    pub of_workers: &'a [&'a str],
}

/// Number of faults of a round.
#[derive(Debug, Default, Clone, Copy)]
pub struct Faults {
    /// Number of workers killed.
    pub workers_killed: usize,
    /// Workers stopped for three seconds.
    pub workers_stopped: usize,
    /// Coordinators killed and resumed.
    pub coordinators_killed: usize,
    /// Coordinators stopped for three seconds.
    pub coordinators_stopped: usize,
    /// Ends because three workers were lost with the same evaluation, each resumed.
    pub given_up: usize,
}

/// Runs the study in `folder` with faults drawn from `seed`, none if it is zero, and returns their number.
///
/// # Panics
/// If the study fails or does not end.
pub fn chaos(study: &ChaosStudy<'_>, folder: &Path, seed: u64) -> Faults {
    let endpoint = free_endpoint();
    let log = folder.with_extension("log");
    let log = || File::options().create(true).append(true).open(&log).expect("there is room for a log");
    let quiet = |command: &mut Command| Process::start(command.stderr(log()));
    let worker = |k: usize| {
        let mut command = Command::new(program("worker"));
        command.args(["--connect", &endpoint, "--slots", "1", "--name", &format!("w{k}")]);
        quiet(command.args(study.of_workers))
    };
    let coordinator = || {
        let mut command = Command::new(program("coordinator"));
        let begun = folder.join("campaign.db").exists();
        match begun {
            true => command.arg("resume").arg(folder).args(study.options[1]),
            false => command.args(["run", "--out"]).arg(folder).arg(study.scene),
        };
        if !begun {
            command.args(study.options[0]);
        }
        quiet(command.args(["--quiet", "--workers", "0", "--listen", &endpoint]))
    };
    let mut workers: Vec<Process> = (0..WORKERS).map(worker).collect();
    let mut running = coordinator();
    let (mut random, mut faults, begun) = (Random(seed), Faults::default(), Instant::now());
    loop {
        assert!(begun.elapsed() < LONGEST, "the study does not end");
        std::thread::sleep(Duration::from_millis(50 + random.below(PAUSE)));
        if let Some(status) = running.ended() {
            if status.success() {
                return faults;
            }
            // Three workers were lost with the same evaluation.
            let log = std::fs::read_to_string(folder.with_extension("log")).unwrap_or_default();
            assert!(log.contains("was given up: ") && faults.given_up < MOST_GIVEN_UP, "{status}: {log}");
            running = coordinator();
            faults.given_up += 1;
        }
        if seed == 0 {
            continue;
        }
        let k = random.below(WORKERS as u64) as usize;
        let freeze = |process: &Process| {
            process.signal("STOP");
            std::thread::sleep(STOPPED);
            process.signal("CONT");
        };
        match random.below(10) {
            0..6 => {
                workers[k].kill();
                workers[k] = worker(k);
                faults.workers_killed += 1;
            }
            6 => {
                freeze(&workers[k]);
                faults.workers_stopped += 1;
            }
            7 => {
                freeze(&running);
                faults.coordinators_stopped += 1;
            }
            _ => {
                running.kill();
                running = coordinator();
                faults.coordinators_killed += 1;
            }
        }
    }
}

/// True if two finished studies have the same bytes of `reliability.csv` and the same `summary.json` but for times and workers.
pub fn same_results(one: &Path, other: &Path) -> bool {
    let curves = |folder: &Path| std::fs::read(folder.join("reliability.csv")).expect("the study has ended");
    curves(one) == curves(other) && answer(one) == answer(other)
}
