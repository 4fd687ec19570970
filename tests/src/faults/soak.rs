//! A long study with random faults.

use super::{LONGEST, Report, coordinator, free_endpoint, report_end, worker};
use crate::practice_study::count_recorded;
use crate::process::Process;
use std::fmt::Write;
use std::time::{Duration, Instant};

const WORKERS: usize = 3;
const SECOND: Duration = Duration::from_secs(1);
/// Faults are drawn once a second: one draw in `KILLS` kills a worker.
const KILLS: u64 = 10;
/// One draw in `FREEZES` freezes a worker for longer than its lease.
const FREEZES: u64 = 20;
/// One draw in `RESTARTS` kills the coordinator, in the first half only: in the second half its memory is measured.
const RESTARTS: u64 = 12;

/// Pseudo-random numbers (SplitMix64), the same in every run.
pub(crate) struct Random(pub u64);

impl Random {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % n
    }
}

/// Memory of the coordinator and of the largest worker [MiB], with the number of evaluations recorded at that time.
struct Memory {
    recorded: usize,
    coordinator: f64,
    worker: f64,
}

/// A study of `samples` tasks of one millisecond on three workers. Workers and coordinator are killed and frozen at random.
/// `text` has the number of faults and the memory of the processes at half of the study and at its end.
pub fn soak(samples: usize) -> Report {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let endpoint = free_endpoint();
    let takes = Duration::from_millis(1);
    let start = |k: usize| Process::start(&mut worker(&endpoint, &format!("w{k}"), takes));
    let mut workers: Vec<Process> = (0..WORKERS).map(start).collect();
    let mut process = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
    let mut random = Random(1);
    let (mut killed, mut frozen, mut restarted) = (0, 0, 0);
    let mut memory: Vec<Memory> = Vec::new();
    let started = Instant::now();
    while process.lines("answer").is_empty() {
        assert!(started.elapsed() < 3 * LONGEST, "the study does not end");
        std::thread::sleep(SECOND);
        let recorded = count_recorded(folder.path());
        let now = (process.resident(), workers.iter().filter_map(Process::resident).reduce(f64::max));
        if let (Some(coordinator), Some(worker)) = now {
            memory.push(Memory { recorded, coordinator, worker });
        }
        let k = random.below(WORKERS as u64) as usize;
        let lot = (random.below(KILLS), random.below(FREEZES), random.below(RESTARTS));
        if lot.0 == 0 {
            workers[k].kill();
            workers[k] = start(k);
            killed += 1;
        } else if lot.1 == 0 {
            workers[k].signal("STOP");
            std::thread::sleep(3 * SECOND);
            workers[k].signal("CONT");
            frozen += 1;
        } else if lot.2 == 0 && recorded < samples / 2 {
            process.kill();
            process = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
            restarted += 1;
        }
    }
    let took = started.elapsed();
    let report = report_end(&mut process, folder.path(), samples);
    let mut text = format!(
        "{samples} tasks in {:.0} s; {killed} workers killed, {frozen} frozen, {restarted} coordinators killed",
        took.as_secs_f64()
    );
    let half = memory.iter().find(|at| at.recorded > samples / 2 + samples / 20);
    if let (Some(half), Some(end)) = (half, memory.last()) {
        let tasks = end.recorded.saturating_sub(half.recorded).max(1);
        let growth = (end.coordinator - half.coordinator) * f64::from(1 << 20) / tasks as f64;
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "; coordinator {:.1} MiB at {} tasks and {:.1} at {} ({growth:.0} bytes a task), largest worker {:.1} and {:.1}",
            half.coordinator, half.recorded, end.coordinator, end.recorded, half.worker, end.worker
        );
    }
    Report { text, ..report }
}
