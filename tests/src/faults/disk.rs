//! Disks that are slow or full.

use super::{LONGEST, all_kept, all_recorded, check_end, coordinator, free_endpoint, undisturbed, worker};
use crate::practice_study::{PracticeStudy, evaluation, recorded};
use crate::process::Process;
use crate::{Practice, skipped};
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

/// A campaign file on a disk that takes its time, and how far simulation has run ahead of it.
struct Slow {
    file: CampaignFile,
    takes: Duration,
    begun: Arc<AtomicUsize>,
    recorded: usize,
    furthest_ahead: usize,
}

impl Journal for Slow {
    fn finished(&self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
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

    fn note_round(&mut self, round: &Round) -> Result<(), EvaluateError> {
        self.file.note_round(round)
    }
}

/// Every write takes `takes`, a simulation a millisecond: how far the workers run ahead of the disk.
pub fn slow_disk(takes: Duration, samples: usize) -> String {
    /// What two workers of one slot may hold: what runs, what is in reserve, and what waits to be acknowledged.
    const MOST_AHEAD: usize = 2 * 2 * (1 + 256);
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let study = PracticeStudy::monte_carlo(samples);
    let (file, _) = study.journal(folder.path()).expect("an empty folder takes a campaign");
    let begun = Arc::new(AtomicUsize::new(0));
    let mut journal = Slow { file, takes, begun: Arc::clone(&begun), recorded: 0, furthest_ahead: 0 };
    let mut evaluator = ZenohEvaluator::open(study.campaign(false), &Listen::default(), Arc::default())
        .expect("a loopback port can be listened on");
    let workers = ["one", "two"].map(|name| {
        let begun = Arc::clone(&begun);
        let simulate = move |sample: &[f64]| {
            begun.fetch_add(1, Ordering::SeqCst);
            std::thread::sleep(Duration::from_millis(1));
            evaluation(sample)
        };
        let config = ServiceConfig { name: name.into(), ..ServiceConfig::new(&evaluator.endpoints()[0], 1) };
        service::spawn(config, Arc::new(Practice(simulate))).expect("a session to a loopback endpoint opens")
    });
    let (answer, _) = study.run(&mut evaluator, &mut journal).expect("the study comes to its end");
    assert!(answer == undisturbed(samples), "the answer is another one");
    all_recorded(folder.path(), samples);
    let ahead = journal.furthest_ahead;
    assert!(ahead <= MOST_AHEAD, "{ahead} simulations were ahead of the disk");
    evaluator.finish();
    workers.into_iter().for_each(|worker| drop(worker.join()));
    format!("{ahead} of {} simulations at most were ahead of the disk; same answer", samples + 1)
}

/// A file system of limited size, mounted while this lives.
struct Small<'a>(&'a Path);

impl<'a> Small<'a> {
    fn mount(at: &'a Path, options: &str) -> Option<Self> {
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", options, "hingewise-test"])
            .arg(at)
            .stderr(Stdio::null())
            .status();
        mounted.is_ok_and(|status| status.success()).then_some(Small(at))
    }

    fn grow(&self, options: &str) {
        let grown = Command::new("mount").args(["-o", &format!("remount,{options}")]).arg(self.0).status();
        assert!(grown.expect("mount runs").success());
    }
}

impl Drop for Small<'_> {
    fn drop(&mut self) {
        // Lazily: a process of the test may still be ending.
        let _ = Command::new("umount").arg("-l").arg(self.0).status();
    }
}

/// The disk becomes full in mid-study, then has room again; `None` where nothing can be mounted.
pub fn full_disk(samples: usize, takes: Duration) -> Option<String> {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let Some(disk) = Small::mount(folder.path(), "size=512k") else {
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
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && said.contains("full") && said.contains("campaign.db"), "{said}");
    let before = recorded(folder.path());
    assert!((1..samples).contains(&before.len()), "{} were recorded", before.len());
    disk.grow("size=64m");
    let mut again = Process::start(&mut coordinator(folder.path(), &endpoint, samples));
    assert!(again.line("listening", 1, LONGEST).is_some());
    check_end(&mut again, folder.path(), samples);
    all_kept(folder.path(), &before);
    let said = said.lines().last().unwrap_or_default().replace(&folder.path().display().to_string(), "DIR");
    Some(format!("\"{said}\" after {} evaluations; all kept, resumed to the same answer", before.len()))
}
