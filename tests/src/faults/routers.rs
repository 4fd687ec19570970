//! Routers that are killed.

use super::{LONGEST, Report, lost_records, report_end, spread, wait_for_records};
use crate::practice_study::recorded;
use crate::process::Process;
use crate::program;
use crate::router::{TwoSites, zenohd};
use std::process::Command;
use std::time::{Duration, Instant};

const NAMES: [&str; 2] = ["one", "two"];

/// Kills with SIGKILL first the router of the workers' site, then that of the coordinator's, and starts each again after
/// `away`. `times`: from the start of the router until all workers have reconnected and another evaluation is recorded.
/// `None` if `zenohd` is not installed.
pub fn killed_routers(away: Duration, samples: usize, takes: Duration) -> Option<Report> {
    let zenohd = zenohd("killed routers")?;
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let mut sites = TwoSites::start(&zenohd, folder.path());
    let study = folder.path().join("study");
    std::fs::create_dir_all(&study).expect("it can be made");
    let mut coordinator = Command::new(program("practice_study"));
    coordinator.arg("coordinator").arg(&study).args([&sites.coordinator, &samples.to_string()]);
    let mut coordinator = Process::start(coordinator.arg(&sites.coordinator_config));
    let workers = NAMES.map(|name| {
        let mut worker = Command::new(program("practice_study"));
        worker.args(["worker", &sites.far.endpoint(), name, &takes.as_millis().to_string()]);
        Process::start(worker.arg(&sites.worker_config))
    });
    coordinator.line("there", NAMES.len(), LONGEST).expect("both workers connect");
    let (mut times, mut records_lost) = (Vec::new(), 0);
    for kill in 1..=2 {
        wait_for_records(&study, kill * samples / 4);
        let router = if kill == 1 { &mut sites.far } else { &mut sites.near };
        router.kill();
        std::thread::sleep(away);
        let before = recorded(&study);
        let back = Instant::now();
        router.start();
        coordinator.line("there", (kill + 1) * NAMES.len(), LONGEST).expect("both workers come back");
        wait_for_records(&study, before.len() + 1);
        times.push(back.elapsed());
        records_lost += lost_records(&study, &before);
    }
    let report = report_end(&mut coordinator, &study, samples);
    let begun: usize = workers.iter().map(|worker| worker.lines("started").len()).sum();
    let repeated = begun.saturating_sub(samples + 1);
    let text = format!(
        "workers back after {}; {repeated} of {} evaluations done twice",
        spread(&times),
        samples + 1
    );
    Some(Report { text, times, records_lost, repeated, ..report })
}
