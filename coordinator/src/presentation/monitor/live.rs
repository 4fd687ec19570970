//! The page of a running study: its progress and its workers, and below them the nominal mechanism, or from the first round on the report
//! of the results so far. The study only records its progress; the page is rendered on request in a thread of the server, from the campaign
//! file, and then reused for a few seconds.

use super::study_section::{STYLE, StatusSource, study_section};
use crate::farm::dispatch::StatusBoard;
use crate::presentation::progress::{record, state_of_study};
use crate::presentation::report::nominal_page::before_results;
use crate::presentation::report::{self, Figure, LiveStatus, Page, ReportInput, SUMMARY_DOCUMENT};
use crate::results::progress::{Observer, Progress};
use crate::results::store::{CampaignFile, StoreError};
use crate::results::summary::{EvaluationCounts, ReliabilityRow, Round, StudySummary};
use crate::study::{Settings, blank};
use common::outputs::Evaluation;
use common::scene::Scene;
use common::wire::StudyStatus;
use maud::html;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Shortest time between two reports.
const SHORTEST_INTERVAL: Duration = Duration::from_secs(3);
/// Shortest time between two pages without a report.
const PAGE_INTERVAL: Duration = Duration::from_secs(1);
/// Shortest time between two reports as a multiple of the rendering time, which bounds the load to a twentieth of a core.
const INTERVAL_FACTOR: u32 = 20;
/// Longest time for which a request for an update waits.
const LONGEST_WAIT: Duration = Duration::from_secs(5);
/// Interval at which a waiting request checks for the end of the study.
const POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Time after the end of a study in which waiting requests are still answered.
const LAST_ANSWERS: Duration = Duration::from_secs(1);
/// Style of the line above the report.
const LINE_STYLE: &str = "#live{position:sticky;top:0;margin:0;padding:.4em 1em;text-align:center;\
                          background:#234;color:#fff;font:14px sans-serif}";

/// Answer to the script of a page that asks for a newer one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct PageUpdate {
    /// Revision of the newest page.
    pub revision: u64,
    /// Progress of the study in one line.
    pub line: String,
    /// True if the study has ended and no page follows.
    pub ended: bool,
}

/// Progress recorded so far.
#[derive(Debug, Default)]
struct ObservedProgress {
    study: StudyStatus,
    rows: Vec<ReliabilityRow>,
    samples: usize,
    rounds: Vec<Round>,
    ending: bool,
    ended: bool,
}

/// The last page, the number of progress records it includes, and the time until which it is reused.
struct CachedPage {
    html: String,
    revision: u64,
    until: Instant,
    holds_report: bool,
}

/// The live page of one study.
pub struct LivePage {
    dir: PathBuf,
    scene: Scene,
    blank: StudySummary,
    /// Workers and queue.
    status: StatusSource,
    /// The mechanism before anything is simulated.
    drawing: Option<Figure>,
    /// The evaluation at the means, once it is in the campaign file.
    nominal: OnceLock<Evaluation>,
    started: Instant,
    /// Evaluations of the initial design.
    initial: usize,
    progress: Mutex<ObservedProgress>,
    cached: Mutex<Option<CachedPage>>,
    revision: watch::Sender<u64>,
    /// True once a page has asked for an update.
    requested: AtomicBool,
}

impl LivePage {
    /// The live page of the study whose campaign file is in `dir`, with a drawing of its mechanism.
    pub fn new(
        dir: &Path,
        scene: &Scene,
        settings: &Settings,
        status: StatusSource,
        drawing: Option<Figure>,
    ) -> Self {
        let study = StudyStatus { budget: settings.max_evaluations as u64, ..StudyStatus::default() };
        Self {
            dir: dir.to_path_buf(),
            scene: scene.clone(),
            blank: blank(scene, settings),
            status,
            drawing,
            nominal: OnceLock::new(),
            started: Instant::now(),
            initial: settings.initial,
            progress: Mutex::new(ObservedProgress { study, ..ObservedProgress::default() }),
            cached: Mutex::new(None),
            revision: watch::Sender::new(1),
            requested: AtomicBool::new(false),
        }
    }

    /// Records progress of the study.
    pub fn record(&self, progress: &Progress) {
        {
            let mut observed = self.observed();
            record(&mut observed.study, progress);
            match progress {
                Progress::RoundFinished(round) => observed.rounds.push(round.clone()),
                Progress::Reliability { rows, samples } => {
                    observed.rows.clone_from(rows);
                    observed.samples = *samples;
                }
                Progress::Ending => observed.ending = true,
                Progress::BatchStarted { .. } | Progress::Evaluated { .. } | Progress::Warning(_) => {}
            }
        }
        self.revision.send_modify(|revision| *revision += 1);
    }

    fn observed(&self) -> MutexGuard<'_, ObservedProgress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The current page, or the last one if it is only a few seconds old.
    pub fn view(&self) -> String {
        let mut cached = self.cached.lock().unwrap_or_else(PoisonError::into_inner);
        let revision = *self.revision.borrow();
        let ended = self.observed().ended;
        if let Some(page) = &*cached
            && ((page.revision == revision && page.holds_report) || (!ended && Instant::now() < page.until))
        {
            return page.html.clone();
        }
        let begun = Instant::now();
        let (html, holds_report) = self.page(revision);
        let interval = SHORTEST_INTERVAL.max(begun.elapsed() * INTERVAL_FACTOR);
        let until = Instant::now() + if holds_report { interval } else { PAGE_INTERVAL };
        *cached = Some(CachedPage { html: html.clone(), revision, until, holds_report });
        html
    }

    /// The update after revision `after`, as soon as a newer page can be rendered or [`LONGEST_WAIT`] has passed.
    pub(super) async fn update_after(&self, after: u64) -> PageUpdate {
        if !self.requested.swap(true, Ordering::Relaxed) {
            tracing::info!("a browser is connected to the live page");
        }
        let mut revisions = self.revision.subscribe();
        let newer = async {
            // The sender lives as long as this value.
            let _ = revisions.wait_for(|revision| *revision > after).await;
            let mut remaining = self.reused_for();
            while !remaining.is_zero() {
                tokio::time::sleep(remaining.min(POLL_INTERVAL)).await;
                remaining = self.reused_for();
            }
        };
        // After the longest wait, the answer is the unchanged revision.
        let _ = tokio::time::timeout(LONGEST_WAIT, newer).await;
        let observed = self.observed();
        let end = || format!("The study has ended; its report is {}", self.report_file().display());
        let line = if observed.ended { end() } else { line(&observed) };
        PageUpdate { revision: *self.revision.borrow(), line, ended: observed.ended }
    }

    /// Marks the study as ended and, if a page is open, waits until its last request is answered.
    pub fn end(&self) {
        let page_is_open = self.requested.load(Ordering::Relaxed);
        self.mark_ended();
        if page_is_open {
            std::thread::sleep(LAST_ANSWERS);
        }
    }

    /// Marks the study as ended; pages are still served.
    pub fn mark_ended(&self) {
        self.observed().ended = true;
        self.revision.send_modify(|revision| *revision += 1);
    }

    /// Time for which the last page is still reused.
    fn reused_for(&self) -> Duration {
        if self.observed().ended {
            return Duration::ZERO;
        }
        let cached = self.cached.lock().unwrap_or_else(PoisonError::into_inner);
        let until = cached.as_ref().map(|cached| cached.until.saturating_duration_since(Instant::now()));
        until.unwrap_or_default()
    }

    /// The page, and true if it contains a report.
    fn page(&self, revision: u64) -> (String, bool) {
        let (summary, line, ended, study) = {
            let observed = self.observed();
            (self.summary(&observed), line(&observed), observed.ended, observed.study.clone())
        };
        let none = || "No reliability is available before the first round of learning.".to_owned();
        // At the end the file contains the summary.
        let report = |summary| self.report((!ended).then_some(&summary)).map_err(|error| error.to_string());
        let report = summary.ok_or_else(none).and_then(report);
        let holds_report = report.is_ok();
        // An error of the file is shown and may be gone at the next request.
        let page = report.unwrap_or_else(|reason| self.before_results(&reason));
        let status = LiveStatus {
            revision,
            head: html! {
                style { (LINE_STYLE) (STYLE) }
                noscript { meta http-equiv="refresh" content="5"; }
                script src="/live.js" defer {}
            },
            line: html! { p id="live" role="status" { (line) } },
            progress: html! { @if !ended { (study_section(&study, self.status.status().as_ref())) } },
        };
        (page.html(Some(&status)), holds_report)
    }

    /// The page before the first round of learning: the nominal mechanism against its limits.
    fn before_results(&self, reason: &str) -> Page {
        let input = ReportInput::of_one(&self.scene, self.blank.clone(), self.nominal().cloned());
        before_results(&input, self.drawing.as_ref(), reason)
    }

    /// The evaluation at the means of the variables, which the study requests first.
    fn nominal(&self) -> Option<&Evaluation> {
        if self.nominal.get().is_none() {
            let stored = CampaignFile::look(&self.dir).and_then(|file| file.evaluation(0));
            // It is asked for again at the next request.
            let evaluation = stored.ok().flatten().and_then(|stored| stored.outcome.ok())?;
            let _ = self.nominal.set(evaluation);
        }
        self.nominal.get()
    }

    /// The text of a file in the folder of the study, once it has ended.
    pub(super) fn result_file(&self, name: &str) -> Option<String> {
        self.observed().ended.then(|| std::fs::read_to_string(self.dir.join(name)).ok())?
    }

    /// Path of the report of the finished study.
    pub fn report_file(&self) -> PathBuf {
        self.dir.join("report.html")
    }

    /// The summary of the results so far; `None` before the first reliability.
    fn summary(&self, observed: &ObservedProgress) -> Option<StudySummary> {
        if observed.rows.is_empty() {
            return None;
        }
        let mut summary = self.blank.clone();
        summary.population = observed.samples;
        summary.reliability.clone_from(&observed.rows);
        let (done, failed) = (observed.study.done as usize, observed.study.failed as usize);
        let initial = self.initial.min(done);
        summary.evaluations = EvaluationCounts { total: done, initial, added: done - initial, failed };
        summary.timing_s.total = self.started.elapsed().as_secs_f64();
        summary.timing_s.simulation = observed.study.simulation;
        summary.convergence.rounds.clone_from(&observed.rounds);
        // The study decides at its end whether its targets are met.
        summary.convergence.targets_met = true;
        Some(summary)
    }

    /// The report of the evaluations in the file with this summary, or with the one in the file.
    fn report(&self, summary: Option<&StudySummary>) -> Result<Page, StoreError> {
        let mut copy = CampaignFile::look(&self.dir)?;
        if let Some(summary) = summary {
            copy.put_document(SUMMARY_DOCUMENT, summary)?;
        }
        let missing = || StoreError::NoCampaign(self.dir.clone());
        let input = ReportInput::from_campaign(&copy, &self.scene)?.ok_or_else(missing)?;
        Ok(report::render(&input, false))
    }
}

/// Progress of the study in one line.
fn line(observed: &ObservedProgress) -> String {
    format!("Running study: {}", state_of_study(&observed.study, observed.ending, None, None))
}

/// An observer that records progress for the views and passes it on to the next observer.
pub struct ProgressRelay<'a> {
    /// Observer that is notified last.
    pub next: &'a mut dyn Observer,
    /// Status that other programs ask for.
    pub board: StatusBoard,
    /// The live page, if there is one.
    pub live: Option<Arc<LivePage>>,
}

impl Observer for ProgressRelay<'_> {
    fn notice(&mut self, progress: &Progress) {
        match progress {
            Progress::Ending => self.board.post_ending(),
            other => self.board.post(|study| record(study, other)),
        }
        if let Some(live) = &self.live {
            live.record(progress);
        }
        // Last, so that the other views are up to date when the terminal shows it.
        self.next.notice(progress);
    }
}

#[cfg(test)]
mod tests {
    use super::super::study_section::StatusSource;
    use super::*;
    use crate::results::progress::Silent;
    use common::wire::Phase;
    use std::time::Instant;

    #[test]
    fn progress_appears_in_the_status() {
        let board = StatusBoard::default();
        board.post(|study| "four-bar".clone_into(&mut study.scene));
        let mut silent = Silent;
        let mut relay = ProgressRelay { next: &mut silent, board: board.clone(), live: None };
        let source = StatusSource::Alone { board, slots: 2, since: Instant::now() };
        assert_eq!(source.status().unwrap().phase, Phase::Learning);
        let batch = Progress::BatchStarted { planned: 5, budget: 40, purpose: "initial design".into() };
        relay.notice(&batch);
        for (done, failed, recalled) in [(1, false, true), (2, true, false)] {
            relay.notice(&Progress::Evaluated { done, failed, recalled, wall: 0.5 });
        }
        let status = source.status().unwrap();
        assert_eq!(status.phase, Phase::Simulating);
        let study = &status.study;
        assert_eq!((study.done, study.planned, study.budget, study.failed, study.recalled), (2, 5, 40, 1, 1));
        assert_eq!((study.scene.as_str(), study.simulation), ("four-bar", 0.5));
        assert_eq!((status.farm.queued, status.farm.under_way, status.farm.slots()), (1, 2, 2));
        relay.notice(&Progress::Ending);
        assert_eq!(source.status().unwrap().phase, Phase::Ending);
    }
}
