//! Further evaluations of a study's simulator: those that a question about a finished study asked for. They are kept in its
//! campaign file for later questions, under numbers below zero, and are no part of the study's own result: `summary.json`,
//! `samples.csv` and the counts of the study do not change. A later leg of the study that requests the same sample finds
//! its outcome here as well, see [`super::leg`].

use super::leg::free_number;
use super::{CampaignFile, StoreError, exact};
use crate::farm::evaluate::{EvaluateError, EvaluationResult, Finished, Request};
use crate::results::journal::Journal;
use crate::results::summary::Round;
use rusqlite::{OptionalExtension, params};

/// The journal of further evaluations: requests are found by their samples, not by their numbers.
#[derive(Debug)]
pub struct FurtherEvaluations<'a> {
    campaign: &'a mut CampaignFile,
}

impl<'a> FurtherEvaluations<'a> {
    /// The further evaluations of a study.
    pub fn of(campaign: &'a mut CampaignFile) -> Self {
        Self { campaign }
    }
}

impl Journal for FurtherEvaluations<'_> {
    fn finished(&mut self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
        Ok(self.campaign.find_sample(request)?)
    }

    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        Ok(self.campaign.insert_further(request, finished)?)
    }

    fn set_aside(&mut self, id: u64, reason: &str) -> Result<(), EvaluateError> {
        self.campaign.set_aside(id, reason)
    }

    fn ended(&mut self, _requests: u64) -> Result<(), EvaluateError> {
        Ok(())
    }

    fn note_round(&mut self, _round: &Round) -> Result<(), EvaluateError> {
        Ok(())
    }
}

impl CampaignFile {
    /// Calls `visit` with sample `(d,)` (SI) and outcome of every recorded evaluation: first those of the study in the order
    /// of their numbers, then the others in the order in which they were recorded.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn for_each_known(
        &self,
        mut visit: impl FnMut(Vec<f64>, EvaluationResult),
    ) -> Result<(), StoreError> {
        let sql = "SELECT id, sample, outcome FROM evaluation WHERE stricter < 2 ORDER BY id < 0, abs(id)";
        let mut statement = self.connection.prepare(sql).map_err(|source| self.database(source))?;
        let rows = statement
            .query_map([], |row| {
                Ok((row.get::<_, i64>(0)?, row.get::<_, Vec<u8>>(1)?, row.get::<_, Vec<u8>>(2)?))
            })
            .map_err(|source| self.database(source))?;
        for row in rows {
            let (id, sample, outcome) = row.map_err(|source| self.database(source))?;
            let what = |part: &str| format!("{part} of evaluation {id}");
            let sample = exact::sample_from_bytes(&sample)
                .ok_or_else(|| self.encoding(what("sample"), "no whole number of values"))?;
            let outcome = exact::outcome_from_bytes(&outcome)
                .map_err(|reason| self.encoding(what("outcome"), reason))?;
            visit(sample, outcome);
        }
        Ok(())
    }

    /// The recorded outcome of this sample at this accuracy under any number, as that of the request.
    fn find_sample(&self, request: &Request) -> Result<Option<Finished>, StoreError> {
        let sql = "SELECT outcome, worker, coalesce(wall_s, 0.0) FROM evaluation WHERE sample = ?1 AND stricter = ?2";
        let sample = exact::sample_to_bytes(&request.sample);
        let found = self
            .connection
            .prepare_cached(sql)
            .and_then(|mut statement| {
                let row = |row: &rusqlite::Row<'_>| Ok((row.get::<_, Vec<u8>>(0)?, row.get(1)?, row.get(2)?));
                statement.query_row(params![sample, request.accuracy.is_some()], row).optional()
            })
            .map_err(|source| self.database(source))?;
        let Some((outcome, worker, wall)) = found else { return Ok(None) };
        let outcome = exact::outcome_from_bytes(&outcome)
            .map_err(|reason| self.encoding(format!("outcome for request {}", request.id), reason))?;
        Ok(Some(Finished { id: request.id, outcome, worker, wall }))
    }

    /// Records an outcome under the first free number below zero.
    fn insert_further(&self, request: &Request, finished: &Finished) -> Result<(), StoreError> {
        let outcome = self.encoded(request, finished)?;
        let failed = |source| self.database(source);
        let transaction = self.connection.unchecked_transaction().map_err(failed)?;
        let number = free_number(&transaction).map_err(failed)?;
        self.write(&transaction, number, request, finished, &outcome).map_err(failed)?;
        transaction.commit().map_err(failed)
    }
}
