//! Workers that are killed and frozen.

use super::{LONGEST, all_recorded, free_endpoint, spread, undisturbed, worker};
use crate::practice_study::PracticeStudy;
use crate::process::Process;
use coordinator::farm::dispatch::{Listen, ZenohEvaluator};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A practice study in this process, and what `beside` does to its workers meanwhile; the names that worked, and what
/// `beside` came to.
fn beside_study<T: Send>(
    samples: usize,
    beside: impl FnOnce(&str, &coordinator::farm::dispatch::ConnectedWorkers) -> T + Send,
) -> (Vec<String>, T) {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let study = PracticeStudy::monte_carlo(samples);
    let (mut journal, _) = study.journal(folder.path()).expect("an empty folder takes a campaign");
    let endpoint = free_endpoint();
    let listen = Listen { endpoint: Some(endpoint.clone()), config: None, insecure: false };
    let campaign = study.campaign(false);
    let mut evaluator = ZenohEvaluator::open(campaign, &listen, Arc::default()).expect("it can listen");
    let connected = evaluator.connected_workers();
    let (ran, came_to) = std::thread::scope(|scope| {
        let beside = scope.spawn(|| beside(&endpoint, &connected));
        let ran = study.run(&mut evaluator, &mut journal);
        (ran, beside.join())
    });
    let (answer, names) = ran.expect("the study comes to its end");
    assert!(answer == undisturbed(samples), "the answer is another one");
    all_recorded(folder.path(), samples);
    evaluator.finish();
    (names, came_to.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

/// `kills` workers are killed with SIGKILL in mid-task, while another one goes on; how soon the coordinator knew, and gave
/// the task to others.
pub fn killed_workers(kills: usize, samples: usize) -> String {
    let takes = Duration::from_millis(40);
    let (_, (mut noticed, _steady)) = beside_study(samples, |endpoint, connected| {
        let steady = Process::start(&mut worker(endpoint, "steady", takes));
        // Without it the same task would be lost again and again.
        steady.line("started", 2, LONGEST).expect("it works");
        let mut noticed = Vec::new();
        for k in 0..kills {
            let name = format!("doomed{k}");
            let mut doomed = Process::start(&mut worker(endpoint, &name, takes));
            doomed.line("started", 1, LONGEST).expect("it gets a task before the study has ended");
            let killed = Instant::now();
            doomed.kill();
            let gone = connected.wait_for(LONGEST, |here| here.iter().all(|worker| worker.name != name));
            assert!(gone, "the death of {name} went unnoticed");
            noticed.push(killed.elapsed());
        }
        // The steady one stays until the study has ended.
        (noticed, steady)
    });
    format!("requeued after {}, same answer, every evaluation recorded once", spread(&mut noticed))
}

/// A worker is frozen in mid-task for `frozen` (its lease is 2 s), then goes on; whether it worked on afterwards.
pub fn frozen_worker(frozen: Duration, samples: usize) -> String {
    let takes = Duration::from_millis(100);
    let (names, (lost_after, _workers)) = beside_study(samples, |endpoint, connected| {
        let stopped = Process::start(&mut worker(endpoint, "frozen", takes));
        stopped.line("started", 2, LONGEST).expect("it gets a task");
        let steady = Process::start(&mut worker(endpoint, "steady", takes));
        let since = Instant::now();
        stopped.signal("STOP");
        let here = |there: bool| {
            connected.wait_for(LONGEST, |here| here.iter().any(|worker| worker.name == "frozen") == there)
        };
        assert!(here(false), "its silence went unnoticed");
        let lost_after = since.elapsed();
        std::thread::sleep(frozen.saturating_sub(lost_after));
        let before = stopped.lines("started").len();
        stopped.signal("CONT");
        assert!(here(true), "it did not come back");
        stopped.line("started", before + 1, LONGEST).expect("it gets tasks again");
        (lost_after, [stopped, steady])
    });
    let workers = names.join(" and ");
    format!(
        "lost after {:.1} s, back after {:.0} s, {workers} worked; same answer, every evaluation recorded once",
        lost_after.as_secs_f64(),
        frozen.as_secs_f64()
    )
}
