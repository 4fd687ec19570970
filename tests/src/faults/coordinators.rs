//! Coordinators that are killed and stalled.

use super::{LONGEST, all_kept, check_end, coordinator, free_endpoint, spread, wait_for_records, worker};
use crate::practice_study::recorded;
use crate::process::Process;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

const NAMES: [&str; 2] = ["one", "two"];

/// The coordinator is killed with SIGKILL `kills` times in one study and started again after `away`; how soon the workers
/// are back, and how many evaluations were done twice.
pub fn killed_coordinator(kills: usize, away: Duration, samples: usize, takes: Duration) -> String {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let endpoint = free_endpoint();
    let workers = NAMES.map(|name| Process::start(&mut worker(&endpoint, name, takes)));
    let started = || workers.iter().flat_map(|worker| worker.lines("started")).collect::<Vec<_>>();

    let mut process = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
    let mut back = Vec::new();
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
        back.push(after.max().expect("they are there"));
        // Nothing that was in the campaign file is begun again.
        wait_for_records(folder.path(), before.len() + 2);
        let journaled: BTreeSet<&String> = before.iter().map(|(_, mark, _)| mark).collect();
        let repeated = started()[begun..].iter().filter(|mark| journaled.contains(mark)).count();
        assert_eq!(repeated, 0, "evaluations of the campaign file were done again");
        all_kept(folder.path(), &before);
    }
    check_end(&mut process, folder.path(), samples);
    let mut times = BTreeMap::new();
    started().into_iter().for_each(|mark| *times.entry(mark).or_insert(0_usize) += 1);
    let twice: usize = times.values().map(|n| n - 1).sum();
    format!(
        "workers back after {}; {twice} of {} evaluations done twice, none that was recorded; same answer",
        spread(&mut back),
        samples + 1
    )
}

/// The coordinator stands still for `stalled`, in mid-study.
pub fn stalled_coordinator(stalled: Duration, samples: usize, takes: Duration) -> String {
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
    check_end(&mut process, folder.path(), samples);
    let twice = begun(&workers) - (samples + 1);
    format!(
        "{meanwhile} tasks were begun meanwhile, then the workers waited; {twice} done twice; same answer"
    )
}
