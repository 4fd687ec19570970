//! Passes the progress of a study on to its views.

use super::live::LivePage;
use crate::farm::dispatch::StatusBoard;
use crate::presentation::progress::record;
use crate::results::progress::{Observer, Progress};
use std::sync::Arc;

/// An observer that records progress for the views and passes it on to the next observer.
pub struct ProgressRelay<'a> {
    next: &'a mut dyn Observer,
    board: StatusBoard,
    live: Option<Arc<LivePage>>,
}

impl<'a> ProgressRelay<'a> {
    /// A relay to `next` that records progress on `board` and on the live page, if there is one.
    pub fn new(
        scene: &str,
        next: &'a mut dyn Observer,
        board: StatusBoard,
        live: Option<Arc<LivePage>>,
    ) -> Self {
        board.post(|study| scene.clone_into(&mut study.scene));
        Self { next, board, live }
    }
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
    use super::super::status_source::StatusSource;
    use super::*;
    use crate::results::progress::Silent;
    use common::wire::Phase;
    use std::time::Instant;

    #[test]
    fn progress_appears_in_the_status() {
        let board = StatusBoard::default();
        let mut silent = Silent;
        let mut relay = ProgressRelay::new("four-bar", &mut silent, board.clone(), None);
        let source = StatusSource::Alone { board, slots: 2, since: Instant::now() };
        assert_eq!(source.status().unwrap().phase, Phase::Learning);
        let batch =
            Progress::BatchStarted { size: 5, planned: 5, budget: 40, purpose: "initial design".into() };
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
