//! Who watches a study for others, and where they look.

use super::live::Live;
use crate::farm::dispatch::{StatusBoard, StatusHandle};
use crate::results::progress::{Observer, Progress};
use common::wire::{FarmStatus, ReliabilitySoFar, Status, StudyStatus, WorkerStatus};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest wait for the farm to say how it is.
const PATIENCE: Duration = Duration::from_secs(2);

/// Passes notices on, and posts them for whoever looks.
pub struct Watch<'a> {
    next: &'a mut dyn Observer,
    board: StatusBoard,
    live: Option<Arc<Live>>,
}

impl<'a> Watch<'a> {
    /// Passes on to `next`; posts on `board`, and to the live page if there is one.
    pub fn new(scene: &str, next: &'a mut dyn Observer, board: StatusBoard, live: Option<Arc<Live>>) -> Self {
        board.post(|study| scene.clone_into(&mut study.scene));
        Self { next, board, live }
    }
}

impl Observer for Watch<'_> {
    fn notice(&mut self, progress: &Progress) {
        match progress {
            Progress::Ending => self.board.post_ending(),
            other => self.board.post(|study| post(study, other)),
        }
        if let Some(live) = &self.live {
            live.notice(progress);
        }
        // Last, so that whoever reads of it on the terminal finds it everywhere.
        self.next.notice(progress);
    }
}

fn post(study: &mut StudyStatus, progress: &Progress) {
    match progress {
        Progress::BatchStarted { planned, budget, purpose, .. } => {
            (study.planned, study.budget) = (*planned as u64, *budget as u64);
            study.purpose.clone_from(purpose);
        }
        Progress::Evaluated { done, failed, recalled, wall } => {
            study.done = *done as u64;
            study.planned = study.planned.max(study.done);
            study.failed += u64::from(*failed);
            study.recalled += u64::from(*recalled);
            if !recalled && wall.is_finite() {
                study.simulation += wall;
            }
        }
        Progress::RoundFinished(round) => {
            study.rounds += 1;
            study.reliability = Some(ReliabilitySoFar {
                cycles: round.cycles,
                total: round.reliability_total,
                standard_error: round.standard_error(),
            });
        }
        Progress::Warning(_) => study.warnings += 1,
        Progress::Reliability { .. } | Progress::Ending => {}
    }
}

/// Where to look how a study is getting on.
#[derive(Debug, Clone)]
pub enum Source {
    /// At a farm.
    Farm(StatusHandle),
    /// At a study whose simulator runs on slots of this process.
    Alone {
        /// What the study has posted.
        board: StatusBoard,
        /// Its slots.
        slots: u32,
        /// Since when it runs.
        since: Instant,
    },
}

impl Source {
    /// The status now; `None` if the farm has ended or does not answer.
    pub fn status(&self) -> Option<Status> {
        match self {
            Source::Farm(look) => look.status(PATIENCE),
            Source::Alone { board, slots, since } => {
                let up = since.elapsed();
                let mut status = board.status(FarmStatus::default(), up);
                let StudyStatus { done, recalled, planned, .. } = status.study;
                let under_way = planned.saturating_sub(done);
                let rate = done.saturating_sub(recalled) as f64 / up.as_secs_f64().max(1.0);
                let worker = WorkerStatus {
                    name: "this-process".to_owned(),
                    slots: *slots,
                    under_way: u32::try_from(under_way).unwrap_or(u32::MAX).min(*slots),
                    done: done.saturating_sub(recalled),
                    rate,
                };
                let at_work = u64::from(worker.under_way);
                let queued = under_way - at_work;
                status =
                    board.status(FarmStatus { queued, under_way: at_work, rate, workers: vec![worker] }, up);
                Some(status)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::progress::Silent;
    use common::wire::Phase;

    #[test]
    fn what_a_study_tells_stands_in_its_status() {
        let board = StatusBoard::default();
        let mut silent = Silent;
        let mut watch = Watch::new("four-bar", &mut silent, board.clone(), None);
        let source = Source::Alone { board, slots: 2, since: Instant::now() };
        assert_eq!(source.status().unwrap().phase, Phase::Learning);
        let batch =
            Progress::BatchStarted { size: 5, planned: 5, budget: 40, purpose: "initial design".into() };
        watch.notice(&batch);
        for (done, failed, recalled) in [(1, false, true), (2, true, false)] {
            watch.notice(&Progress::Evaluated { done, failed, recalled, wall: 0.5 });
        }
        let status = source.status().unwrap();
        assert_eq!(status.phase, Phase::Simulating);
        let study = &status.study;
        assert_eq!((study.done, study.planned, study.budget, study.failed, study.recalled), (2, 5, 40, 1, 1));
        assert_eq!((study.scene.as_str(), study.simulation), ("four-bar", 0.5));
        assert_eq!((status.farm.queued, status.farm.under_way, status.farm.slots()), (1, 2, 2));
        watch.notice(&Progress::Ending);
        assert_eq!(source.status().unwrap().phase, Phase::Ending);
    }
}
