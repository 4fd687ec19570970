//! Workers that are killed and frozen.

use super::{LONGEST, Report, free_endpoint, report, spread, worker};
use crate::practice_study::PracticeStudy;
use crate::process::Process;
use coordinator::farm::dispatch::{Listen, ZenohEvaluator};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Runs a study in this process while `disturb` injects faults into its workers. Returns the report and the result of
/// `disturb`.
fn disturbed_study<T: Send>(
    samples: usize,
    disturb: impl FnOnce(&str, &coordinator::farm::dispatch::ConnectedWorkers) -> T + Send,
) -> (Report, T) {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let study = PracticeStudy::monte_carlo(samples);
    let (mut journal, _) = study.journal(folder.path()).expect("an empty folder takes a campaign");
    let endpoint = free_endpoint();
    let listen = Listen { endpoint: Some(endpoint.clone()), config: None, insecure: false };
    let campaign = study.campaign(false);
    let mut evaluator = ZenohEvaluator::open(campaign, &listen, Arc::default()).expect("it can listen");
    let connected = evaluator.connected.clone();
    let (ran, disturbed) = std::thread::scope(|scope| {
        let disturb = scope.spawn(|| disturb(&endpoint, &connected));
        let ran = study.run(&mut evaluator, &mut journal);
        (ran, disturb.join())
    });
    let (answer, workers) = ran.expect("the study ends");
    evaluator.finish();
    let report = Report { workers, ..report(&answer, folder.path(), samples) };
    (report, disturbed.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

/// Kills `kills` workers with SIGKILL during a task, while another one works on. `times`: until the coordinator detects the
/// loss and requeues the task.
pub fn killed_workers(kills: usize, samples: usize) -> Report {
    let takes = Duration::from_millis(40);
    let (report, (times, _steady)) = disturbed_study(samples, |endpoint, connected| {
        let steady = Process::start(&mut worker(endpoint, "steady", takes));
        // Without it, the same task would be lost at each kill.
        steady.line("started", 2, LONGEST).expect("it works");
        let mut times = Vec::new();
        for k in 0..kills {
            let name = format!("doomed{k}");
            let mut doomed = Process::start(&mut worker(endpoint, &name, takes));
            doomed.line("started", 1, LONGEST).expect("it gets a task before the study has ended");
            let killed = Instant::now();
            doomed.kill();
            let gone = connected.wait_for(LONGEST, |here| here.iter().all(|worker| worker.name != name));
            assert!(gone, "the loss of {name} was not detected");
            times.push(killed.elapsed());
        }
        // The steady worker runs until the study has ended.
        (times, steady)
    });
    Report { text: format!("requeued after {}", spread(&times)), times, ..report }
}

/// Freezes a worker for `frozen` during a task (its lease is 2 s), then resumes it. `times`: until the coordinator detects
/// the loss.
pub fn frozen_worker(frozen: Duration, samples: usize) -> Report {
    let takes = Duration::from_millis(100);
    let (report, (lost_after, _workers)) = disturbed_study(samples, |endpoint, connected| {
        let stopped = Process::start(&mut worker(endpoint, "frozen", takes));
        stopped.line("started", 2, LONGEST).expect("it gets a task");
        let steady = Process::start(&mut worker(endpoint, "steady", takes));
        let since = Instant::now();
        stopped.signal("STOP");
        let here = |there: bool| {
            connected.wait_for(LONGEST, |here| here.iter().any(|worker| worker.name == "frozen") == there)
        };
        assert!(here(false), "the loss was not detected");
        let lost_after = since.elapsed();
        std::thread::sleep(frozen.saturating_sub(lost_after));
        let before = stopped.lines("started").len();
        stopped.signal("CONT");
        assert!(here(true), "it did not return");
        stopped.line("started", before + 1, LONGEST).expect("it gets tasks again");
        (lost_after, [stopped, steady])
    });
    let text = format!(
        "lost after {:.1} s, back after {:.0} s, {} worked",
        lost_after.as_secs_f64(),
        frozen.as_secs_f64(),
        report.workers.join(" and ")
    );
    Report { text, times: vec![lost_after], ..report }
}
