//! Requests whose outcomes are recorded in a campaign file, without a study: for measurements.

use crate::practice_study::PracticeStudy;
use coordinator::farm::evaluate::{Demand, EvaluateError, Finished, Request, RequestSource};
use coordinator::results::journal::Journal;
use coordinator::results::store::CampaignFile;
use std::collections::BTreeMap;
use tempfile::TempDir;

/// A request source that records outcomes in a campaign file.
pub struct Journaled {
    new: Option<Vec<Request>>,
    requests: BTreeMap<u64, Request>,
    file: CampaignFile,
    folder: TempDir,
    writes: usize,
}

impl Journaled {
    /// `count` requests of the practice study, and a campaign file in a new subfolder of `at`.
    pub fn new(count: u64, at: &std::path::Path) -> Self {
        let request = |id: u64| {
            let sample = vec![1e-13 * (1.0 + 1e-6 * id as f64), -0.8, 30e-6, 0.05];
            Request { id, sample, with_first_cycle: false, accuracy: None, level: 0, not_by: vec![] }
        };
        let folder = tempfile::tempdir_in(at).expect("there is room for a folder");
        let (file, _) =
            PracticeStudy::monte_carlo(1).journal(folder.path()).expect("an empty folder takes a campaign");
        let new: Vec<Request> = (0..count).map(request).collect();
        let requests = new.iter().map(|request| (request.id, request.clone())).collect();
        Self { new: Some(new), requests, file, folder, writes: 0 }
    }

    /// Number of evaluations in the file, and of transactions.
    pub fn recorded(&self) -> (usize, usize) {
        (crate::practice_study::recorded(self.folder.path()).len(), self.writes)
    }
}

impl RequestSource for Journaled {
    fn next(&mut self) -> Result<Demand, EvaluateError> {
        Ok(self.new.take().map_or(Demand::End, Demand::Begin))
    }

    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError> {
        self.record_all(vec![finished])
    }

    fn record_all(&mut self, finished: Vec<Finished>) -> Result<(), EvaluateError> {
        self.writes += 1;
        let with_request =
            |finished: Finished| (self.requests.remove(&finished.id).expect("it was requested"), finished);
        let outcomes: Vec<_> = finished.into_iter().map(with_request).collect();
        self.file.record_all(&outcomes)
    }
}
