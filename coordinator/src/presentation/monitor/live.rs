//! The report of a running study, as far as it is. The study only notes what has happened; the report is made in a thread
//! of whoever looks, from what the campaign file holds, and not again before a few seconds have passed.

use crate::presentation::report::format::{count, escape, fixed};
use crate::presentation::report::{self, ReportInput, SUMMARY_DOCUMENT};
use crate::results::progress::Progress;
use crate::results::store::{CampaignFile, StoreError};
use crate::results::summary::{ReliabilityRow, Round, StudySummary};
use crate::study::{Settings, blank};
use common::scene::Scene;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Least time between two reports.
const PAUSE: Duration = Duration::from_secs(3);
/// And as a multiple of what the last one took: a report takes a twentieth of one core at most.
const SHARE: u32 = 20;
/// Longest wait for news.
const LONGEST_WAIT: Duration = Duration::from_secs(20);

/// How often somebody who waits for the next page looks whether the study has ended.
const LOOK_UP: Duration = Duration::from_millis(100);
/// How long the end of a study waits for those who look.
const FAREWELL: Duration = Duration::from_secs(1);

/// A page, and its number.
#[derive(Debug, Clone)]
pub struct View {
    /// Rises with what is shown.
    pub revision: u64,
    /// The page.
    pub html: String,
}

/// What has changed, for the page's script.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct News {
    /// Of the newest page there can be.
    pub revision: u64,
    /// How far the study is, in one line.
    pub line: String,
    /// There will be no more.
    pub ended: bool,
}

/// What the study has told.
#[derive(Debug, Default)]
struct Told {
    done: usize,
    failed: usize,
    planned: usize,
    initial: usize,
    /// Simulation time [s].
    simulation: f64,
    purpose: String,
    rows: Vec<ReliabilityRow>,
    samples: usize,
    rounds: Vec<Round>,
    ending: bool,
    ended: bool,
}

struct Made {
    view: View,
    /// When there may be another one.
    until: Instant,
}

/// See the module.
pub struct Live {
    dir: PathBuf,
    scene: Scene,
    blank: StudySummary,
    started: Instant,
    told: Mutex<Told>,
    made: Mutex<Option<Made>>,
    revision: watch::Sender<u64>,
    /// Whether a page has asked for news.
    watched: AtomicBool,
}

impl Live {
    /// Of the study whose campaign file is in `dir`.
    pub fn new(dir: &Path, scene: &Scene, settings: &Settings) -> Self {
        Self {
            dir: dir.to_path_buf(),
            scene: scene.clone(),
            blank: blank(scene, settings),
            started: Instant::now(),
            told: Mutex::new(Told { initial: settings.initial, ..Told::default() }),
            made: Mutex::new(None),
            revision: watch::Sender::new(1),
            watched: AtomicBool::new(false),
        }
    }

    /// Takes notice of what the study tells.
    pub fn notice(&self, progress: &Progress) {
        {
            let mut told = self.told();
            match progress {
                Progress::BatchStarted { planned, purpose, .. } => {
                    told.planned = *planned;
                    told.purpose.clone_from(purpose);
                }
                Progress::Evaluated { done, failed, wall, .. } => {
                    told.done = *done;
                    told.simulation += wall;
                    told.failed += usize::from(*failed);
                }
                Progress::RoundFinished(round) => told.rounds.push(round.clone()),
                Progress::Reliability { rows, samples } => {
                    told.rows.clone_from(rows);
                    told.samples = *samples;
                }
                Progress::Ending => told.ending = true,
                Progress::Warning(_) => {}
            }
        }
        self.revision.send_modify(|revision| *revision += 1);
    }

    fn told(&self) -> MutexGuard<'_, Told> {
        self.told.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The page as it is now, or as it was a few seconds ago.
    pub fn view(&self) -> View {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let revision = *self.revision.borrow();
        let ended = self.told().ended;
        if let Some(Made { view, until }) = &*made
            && (view.revision == revision || (!ended && Instant::now() < *until))
        {
            return view.clone();
        }
        let begun = Instant::now();
        let (html, holds_report) = self.page(revision);
        let rest = if holds_report { PAUSE.max(begun.elapsed() * SHARE) } else { Duration::ZERO };
        let view = View { revision, html };
        *made = Some(Made { view: view.clone(), until: Instant::now() + rest });
        view
    }

    /// What is new after a page, as soon as another one can be had.
    pub(super) async fn news(&self, after: u64) -> News {
        if !self.watched.swap(true, Ordering::Relaxed) {
            tracing::info!("the live page is being watched");
        }
        let mut revisions = self.revision.subscribe();
        let newer = async {
            // The sender lives as long as this value.
            let _ = revisions.wait_for(|revision| *revision > after).await;
            let mut rest = self.rest();
            while !rest.is_zero() {
                tokio::time::sleep(rest.min(LOOK_UP)).await;
                rest = self.rest();
            }
        };
        // Nothing new is an answer too.
        let _ = tokio::time::timeout(LONGEST_WAIT, newer).await;
        let told = self.told();
        let line = if told.ended { self.farewell() } else { line(&told) };
        News { revision: *self.revision.borrow(), line, ended: told.ended }
    }

    /// Tells those who look that the study has ended, and gives them a moment to hear it.
    pub fn end(&self) {
        self.told().ended = true;
        let looked_at = self.watched.load(Ordering::Relaxed);
        self.revision.send_modify(|revision| *revision += 1);
        if looked_at {
            std::thread::sleep(FAREWELL);
        }
    }

    fn farewell(&self) -> String {
        format!("The study has ended; its report is {}", self.dir.join("report.html").display())
    }

    /// How long until the next page can be had.
    fn rest(&self) -> Duration {
        if self.told().ended {
            return Duration::ZERO;
        }
        let made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.as_ref().map_or(Duration::ZERO, |made| made.until.saturating_duration_since(Instant::now()))
    }

    /// The page, and whether there is a report in it.
    fn page(&self, revision: u64) -> (String, bool) {
        let (summary, line, ended) = {
            let told = self.told();
            (self.summary(&told), line(&told), told.ended)
        };
        let report = match summary {
            None => Err("There is no reliability to show before the first round of learning.".to_owned()),
            // At the end its own summary stands in the file.
            Some(summary) => self.report((!ended).then_some(&summary)).map_err(|error| error.to_string()),
        };
        let holds_report = report.is_ok();
        // What a file could not give now, the next look may.
        let page = report.unwrap_or_else(|sentence| plain(&self.scene.title, &sentence));
        let head = "<style>#live{position:sticky;top:0;margin:0;padding:.4em 1em;text-align:center;\
                    background:#234;color:#fff;font:14px sans-serif}</style>\
                    <noscript><meta http-equiv=\"refresh\" content=\"5\"></noscript>\
                    <script src=\"/live.js\" defer></script>\n</head>";
        let bar = format!("<body>\n<p id=\"live\" role=\"status\">{}</p>", escape(&line));
        let root = format!("<html lang=\"en\" data-revision=\"{revision}\">");
        let page = page.replacen("<html lang=\"en\">", &root, 1);
        (page.replacen("</head>", head, 1).replacen("<body>", &bar, 1), holds_report)
    }

    /// What is known so far, as if it were the end; `None` before there is anything.
    fn summary(&self, told: &Told) -> Option<StudySummary> {
        if told.rows.is_empty() {
            return None;
        }
        let mut summary = self.blank.clone();
        summary.population = told.samples;
        summary.reliability.clone_from(&told.rows);
        summary.evaluations.total = told.done;
        summary.evaluations.initial = told.initial.min(told.done);
        summary.evaluations.added = told.done - summary.evaluations.initial;
        summary.evaluations.failed = told.failed;
        summary.timing_s.total = self.started.elapsed().as_secs_f64();
        summary.timing_s.simulation = told.simulation;
        summary.convergence.rounds.clone_from(&told.rounds);
        // Whether its targets are met is for the study to say, at its end.
        summary.convergence.targets_met = true;
        Some(summary)
    }

    /// The report of what the file holds, with this summary in the place of its own.
    fn report(&self, summary: Option<&StudySummary>) -> Result<String, report::ReportError> {
        let mut look = CampaignFile::look(&self.dir)?;
        if let Some(summary) = summary {
            look.put_document(SUMMARY_DOCUMENT, summary)?;
        }
        let missing = || StoreError::NoCampaign { dir: self.dir.clone() };
        let input = ReportInput::from_campaign(&look, &self.scene)?.ok_or_else(missing)?;
        Ok(report::render(&input)?.html)
    }
}

fn line(told: &Told) -> String {
    let (done, planned) = (count(told.done as u64), count(told.planned.max(told.done) as u64));
    let purpose = match (told.ending, told.purpose.as_str()) {
        (true, _) => ", working out the results".to_owned(),
        (_, "") => String::new(),
        (_, purpose) => format!(", {purpose}"),
    };
    let reliability = told.rounds.last().map_or(String::new(), |round| {
        format!(", R({}) = {} so far", count(round.cycles.into()), fixed(round.reliability_total, 4))
    });
    format!("Running study: {done} of {planned} planned evaluations{purpose}{reliability}")
}

/// A page with a sentence.
fn plain(title: &str, sentence: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0} · Hingewise</title>\n</head>\n\
         <body>\n<main><h1>{0}</h1><p>{1}</p></main>\n</body>\n</html>\n",
        escape(title),
        escape(sentence)
    )
}
