//! Faults of a farm in long runs: prints a table. `cargo run --release -p tests --example faults` takes about ten minutes;
//! without root, the full disk and the cut network are skipped. Build the programs of this package first:
//! `cargo build --release -p tests`.

use std::time::{Duration, Instant};
use tests::faults::{self, Report};

/// Name of a fault and the function that injects it; `None` if that is not possible here.
type Fault = (&'static str, fn() -> Option<Report>);

const SECOND: Duration = Duration::from_secs(1);

const FAULTS: [Fault; 9] = [
    ("kill -9 of a worker in mid-task, 100 times", || Some(faults::killed_workers(100, 3000))),
    ("SIGSTOP of a worker for twice its lease", || Some(faults::frozen_worker(4 * SECOND, 120))),
    ("kill -9 of the coordinator, back after 3 s, 10 times", || {
        Some(faults::killed_coordinator(10, 3 * SECOND, 330, SECOND / 4))
    }),
    ("coordinator stalled for 10 s", || Some(faults::stalled_coordinator(10 * SECOND, 90, SECOND / 4))),
    ("slow disk, 0.2 s a write", || Some(faults::slow_disk(SECOND / 5, 2000))),
    ("full disk", || faults::full_disk(400, SECOND / 100)),
    ("100 000 tasks, random faults", || Some(faults::soak(100_000))),
    ("routers killed for 5 s, one after the other", || faults::killed_routers(5 * SECOND, 400, SECOND / 10)),
    ("network cut for 6 s and for 20 s", || faults::cut_network(&[6 * SECOND, 20 * SECOND], 400, SECOND / 5)),
];

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    println!("| fault | measured |\n|---|---|");
    for (name, inject) in FAULTS.into_iter().filter(|(name, _)| name.contains(&wanted)) {
        let started = Instant::now();
        let report = inject();
        assert!(report.as_ref().is_none_or(Report::is_undisturbed), "{name}: {report:?}");
        let measured = report.map_or_else(|| "not possible here".to_owned(), |report| report.to_string());
        println!("| {name} | {measured} |");
        eprintln!("{name}: {:.0} s", started.elapsed().as_secs_f64());
    }
}
