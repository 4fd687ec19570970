//! Coordinators that are killed and stalled.

use super::{
    LONGEST, Report, coordinator, free_endpoint, lost_records, report_end, spread, wait_for_records, worker,
};
use crate::practice_study::recorded;
use crate::process::Process;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

const NAMES: [&str; 2] = ["one", "two"];

/// Kills the coordinator with SIGKILL `kills` times in one study and restarts it after `away`. `times`: until all workers
/// have reconnected.
pub fn killed_coordinator(kills: usize, away: Duration, samples: usize, takes: Duration) -> Report {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let endpoint = free_endpoint();
    let workers = NAMES.map(|name| Process::start(&mut worker(&endpoint, name, takes)));
    let started = || workers.iter().flat_map(|worker| worker.lines("started")).collect::<Vec<_>>();

    let mut process = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
    let (mut back, mut records_lost, mut records_repeated) = (Vec::new(), 0, 0);
    for kill in 1..=kills {
        wait_for_records(folder.path(), kill * samples / (kills + 1));
        process.kill();
        let before = recorded(folder.path());
        assert!(before.len() >= kill * samples / (kills + 1), "records were lost");
        std::thread::sleep(away);
        let begun = started().len();
        process = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
        process.line("listening", 1, LONGEST).expect("it listens again");
        process.line("there", NAMES.len(), LONGEST).expect("all workers come back");
        let seconds = |line: String| line.rsplit(' ').next().and_then(|s| s.parse().ok());
        let after = process.lines("there").into_iter().filter_map(seconds).map(Duration::from_secs_f64);
        back.push(after.max().expect("they are back"));
        // No evaluation in the campaign file may be started again.
        wait_for_records(folder.path(), before.len() + 2);
        let journaled: BTreeSet<&String> = before.iter().map(|(_, mark, _)| mark).collect();
        records_repeated += started()[begun..].iter().filter(|mark| journaled.contains(mark)).count();
        records_lost += lost_records(folder.path(), &before);
    }
    let report = report_end(&mut process, folder.path(), samples);
    let mut times = BTreeMap::new();
    started().into_iter().for_each(|mark| *times.entry(mark).or_insert(0_usize) += 1);
    let repeated: usize = times.values().map(|n| n - 1).sum();
    let text = format!(
        "workers back after {}; {repeated} of {} evaluations done twice, {records_repeated} of them recorded before",
        spread(&back),
        samples + 1
    );
    Report { text, times: back, records_lost, records_repeated, repeated, ..report }
}

/// Freezes the coordinator for `stalled` during a study.
pub fn stalled_coordinator(stalled: Duration, samples: usize, takes: Duration) -> Report {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let endpoint = free_endpoint();
    let mut process = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
    let workers = NAMES.map(|name| Process::start(&mut worker(&endpoint, name, takes)));
    wait_for_records(folder.path(), samples / 3);
    let begun =
        |workers: &[Process]| workers.iter().map(|worker| worker.lines("started").len()).sum::<usize>();
    process.signal("STOP");
    let before = begun(&workers);
    std::thread::sleep(stalled);
    let meanwhile = begun(&workers) - before;
    process.signal("CONT");
    let report = report_end(&mut process, folder.path(), samples);
    let repeated = begun(&workers) - (samples + 1);
    let text =
        format!("{meanwhile} tasks were started meanwhile, then the workers waited; {repeated} done twice");
    Report { text, repeated, ..report }
}
