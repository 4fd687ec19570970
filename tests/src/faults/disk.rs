//! Disks that are slow or full.

use super::{LONGEST, Report, coordinator, free_endpoint, lost_records, report, report_end, worker};
use crate::practice_study::{PracticeStudy, evaluation, recorded};
use crate::process::Process;
use crate::{ClosureSimulator, skipped};
use coordinator::farm::dispatch::{Listen, ZenohEvaluator};
use coordinator::farm::evaluate::{EvaluateError, Finished, Request};
use coordinator::results::journal::Journal;
use coordinator::results::store::CampaignFile;
use coordinator::results::summary::Round;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use worker::service::{self, ServiceConfig};

/// A campaign file on a slow disk; counts the simulations ahead of it.
struct SlowJournal {
    file: CampaignFile,
    takes: Duration,
    begun: Arc<AtomicUsize>,
    recorded: usize,
    furthest_ahead: usize,
}

impl Journal for SlowJournal {
    fn finished(&mut self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
        self.file.finished(request)
    }

    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        self.record_all(&[(request.clone(), finished.clone())])
    }

    fn record_all(&mut self, outcomes: &[(Request, Finished)]) -> Result<(), EvaluateError> {
        std::thread::sleep(self.takes);
        self.file.record_all(outcomes)?;
        self.recorded += outcomes.len();
        self.furthest_ahead = self.furthest_ahead.max(self.begun.load(Ordering::SeqCst) - self.recorded);
        Ok(())
    }

    fn set_aside(&mut self, id: u64, reason: &str) -> Result<(), EvaluateError> {
        self.file.set_aside(id, reason)
    }

    fn ended(&mut self, requests: u64) -> Result<(), EvaluateError> {
        self.file.ended(requests)
    }

    fn note_round(&mut self, round: &Round) -> Result<(), EvaluateError> {
        self.file.note_round(round)
    }
}

/// Most simulations that two workers of one slot may finish ahead of the disk: running, prefetched, and not acknowledged.
pub const MOST_UNRECORDED: usize = 2 * 2 * (1 + 256);

/// Every write takes `takes`, a simulation one millisecond. `unrecorded`: most simulations ahead of the disk.
pub fn slow_disk(takes: Duration, samples: usize) -> Report {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let study = PracticeStudy::monte_carlo(samples);
    let (file, _) = study.journal(folder.path()).expect("an empty folder takes a campaign");
    let begun = Arc::new(AtomicUsize::new(0));
    let mut journal = SlowJournal { file, takes, begun: Arc::clone(&begun), recorded: 0, furthest_ahead: 0 };
    let mut evaluator = ZenohEvaluator::open(study.campaign(false), &Listen::default(), Arc::default())
        .expect("a loopback port can be listened on");
    let workers = ["one", "two"].map(|name| {
        let begun = Arc::clone(&begun);
        let simulate = move |sample: &[f64]| {
            begun.fetch_add(1, Ordering::SeqCst);
            std::thread::sleep(Duration::from_millis(1));
            evaluation(sample)
        };
        let config = ServiceConfig { name: name.into(), ..ServiceConfig::new(&evaluator.endpoints[0], 1) };
        service::spawn(config, Arc::new(ClosureSimulator(simulate)))
            .expect("a session to a loopback endpoint opens")
    });
    let (answer, _) = study.run(&mut evaluator, &mut journal).expect("the study ends");
    let unrecorded = journal.furthest_ahead;
    evaluator.finish();
    workers.into_iter().for_each(|worker| drop(worker.join()));
    let text = format!("{unrecorded} of {} simulations at most were ahead of the disk", samples + 1);
    Report { text, unrecorded, ..report(&answer, folder.path(), samples) }
}

/// A file system of limited size, unmounted when dropped.
struct SmallDisk<'a>(&'a Path);

impl<'a> SmallDisk<'a> {
    fn mount(at: &'a Path, options: &str) -> Option<Self> {
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", options, "hingewise-test"])
            .arg(at)
            .stderr(Stdio::null())
            .status();
        mounted.is_ok_and(|status| status.success()).then_some(SmallDisk(at))
    }

    fn grow(&self, options: &str) {
        let grown = Command::new("mount").args(["-o", &format!("remount,{options}")]).arg(self.0).status();
        assert!(grown.expect("mount runs").success());
    }
}

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        // Lazily: a process of the test may still be running.
        let _ = Command::new("umount").arg("-l").arg(self.0).status();
    }
}

/// Fills the disk during a study, then enlarges it and resumes. `None` if no file system can be mounted.
pub fn full_disk(samples: usize, takes: Duration) -> Option<Report> {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let Some(disk) = SmallDisk::mount(folder.path(), "size=512k") else {
        skipped("a full disk", "a file system can be mounted by root only");
        return None;
    };
    let endpoint = free_endpoint();
    let _workers = ["one", "two"].map(|name| Process::start(&mut worker(&endpoint, name, takes)));
    let output = coordinator(folder.path(), &endpoint, samples)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .expect("the program starts");
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success(), "{error}");
    let before = recorded(folder.path());
    assert!((1..samples).contains(&before.len()), "{} were recorded", before.len());
    disk.grow("size=64m");
    let mut again = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
    assert!(again.line("listening", 1, LONGEST).is_some());
    let report = report_end(&mut again, folder.path(), samples);
    let records_lost = lost_records(folder.path(), &before);
    let last = error.lines().last().unwrap_or_default().replace(&folder.path().display().to_string(), "DIR");
    let text = format!("\"{last}\" after {} evaluations; {records_lost} lost, resumed", before.len());
    Some(Report { text, records_lost, error, ..report })
}
