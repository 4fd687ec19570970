//! Further evaluations of a study's simulator: those that a question about a finished study asked for. They are kept in its
//! campaign file for later questions, under numbers below zero, and are no part of the study's own result: `summary.json`,
//! `samples.csv` and the counts of the study do not change. A later leg of the study that requests the same sample finds
//! its outcome here as well, see [`super::leg`].

use super::leg::free_number;
use super::read::COLUMNS;
use super::{CampaignFile, StoreError, StoredEvaluation, exact};
use crate::farm::evaluate::{EvaluateError, Finished, Request};
use crate::results::journal::Journal;
use rusqlite::{OptionalExtension, params};

/// The journal of further evaluations of the study in this file: requests are found by their samples, not by their numbers.
#[derive(Debug)]
pub struct FurtherEvaluations<'a>(pub &'a mut CampaignFile);

impl Journal for FurtherEvaluations<'_> {
    fn finished(&mut self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
        Ok(self.0.find_sample(request)?)
    }

    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        Ok(self.0.insert_further(request, finished)?)
    }

    fn set_aside(&mut self, id: u64, reason: &str) -> Result<(), EvaluateError> {
        self.0.set_aside(id, reason)
    }
}

impl CampaignFile {
    /// Calls `visit` on every recorded evaluation at the working accuracy, or at finer levels if `is_finer`: first those of the study in the
    /// order of their numbers, then the others in the order in which they were recorded.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn for_each_known(
        &self,
        is_finer: bool,
        mut visit: impl FnMut(StoredEvaluation),
    ) -> Result<(), StoreError> {
        let (column, level) = (self.level_column(), if is_finer { "> 0" } else { "= 0" });
        let rest = format!("WHERE stricter < 2 AND {column} {level} ORDER BY id < 0, abs(id)");
        self.each(&rest, |stored| {
            visit(stored);
            Ok(())
        })
    }

    /// The recorded outcome of this sample at this accuracy under any number, as that of the request.
    fn find_sample(&self, request: &Request) -> Result<Option<Finished>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM evaluation WHERE sample = ?1 AND stricter = ?2 AND level = ?3 ORDER BY id < 0, abs(id) LIMIT 1 OFFSET ?4"
        );
        let sample = exact::sample_to_bytes(&request.sample);
        // Of an outlier, the evaluation after those that are known.
        let of_request = params![sample, request.is_stricter(), request.level, request.not_by.len() as i64];
        let found = self.query(|connection| {
            connection.prepare_cached(&sql)?.query_row(of_request, |row| row.try_into()).optional()
        })?;
        found.map(|row| self.recalled(row, request.id)).transpose()
    }

    /// Records an outcome under the first free number below zero.
    fn insert_further(&self, request: &Request, finished: &Finished) -> Result<(), StoreError> {
        let outcome = self.encoded(request, finished)?;
        self.transact(|transaction| {
            self.write(transaction, free_number(transaction)?, request, finished, &outcome)
        })
    }
}
