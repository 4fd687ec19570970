//! Reading a campaign back: evaluations for the result files, documents for the report.

use super::{CampaignFile, StoreError, exact};
use crate::farm::evaluate::{EvaluationResult, Finished};
use crate::results::summary::Round;
use rusqlite::OptionalExtension;
use serde::de::DeserializeOwned;

/// One recorded evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredEvaluation {
    /// Number of the evaluation, below zero if it is no part of the study's result.
    pub id: i64,
    /// Level of accuracy in its study, 0 for the working accuracy.
    pub level: u8,
    /// Values of the random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// What came of it.
    pub outcome: EvaluationResult,
    /// Name of the worker.
    pub worker: String,
    /// Simulation time [s].
    pub wall: f64,
    /// When it was recorded (UTC, ISO 8601).
    pub finished_at: String,
}

/// Columns of [`EvaluationColumns`] in the present layout.
pub(super) const COLUMNS: &str = "id, sample, outcome, worker, coalesce(wall_s, 0.0), finished_at, level";

/// A row of the table `evaluation`.
pub(super) type EvaluationColumns = (i64, Vec<u8>, Vec<u8>, String, f64, String, u8);

impl CampaignFile {
    /// Number of recorded evaluations, those of finer levels included.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn count(&self) -> Result<usize, StoreError> {
        self.count_where("id >= 0")
    }

    /// Number of recorded evaluations at the working accuracy.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn working_count(&self) -> Result<usize, StoreError> {
        self.count_where(&format!("id >= 0 AND {} = 0", self.level_column()))
    }

    /// The column of the level; a file of an earlier layout that is only looked at has none.
    pub(super) fn level_column(&self) -> &'static str {
        if self.has_levels { "level" } else { "0" }
    }

    /// A query for the columns of evaluations; `rest` is what follows the name of the table.
    fn evaluations(&self, rest: &str) -> String {
        format!("SELECT {} FROM evaluation {rest}", COLUMNS.replace("level", self.level_column()))
    }

    /// Number of recorded evaluations that failed.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn failed_count(&self) -> Result<usize, StoreError> {
        self.count_where("id >= 0 AND failure IS NOT NULL")
    }

    fn count_where(&self, condition: &str) -> Result<usize, StoreError> {
        let sql = format!("SELECT count(*) FROM evaluation WHERE {condition}");
        let count = self.query(|connection| connection.query_row(&sql, [], |row| row.get::<_, i64>(0)))?;
        Ok(count.unsigned_abs() as usize)
    }

    /// The evaluation of this number, if recorded.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn evaluation(&self, id: u64) -> Result<Option<StoredEvaluation>, StoreError> {
        let Ok(key) = i64::try_from(id) else { return Ok(None) };
        let sql = self.evaluations("WHERE id = ?1");
        let found =
            self.query(|connection| connection.query_row(&sql, [key], |row| row.try_into()).optional())?;
        found.map(|row| self.decoded(row)).transpose()
    }

    /// Calls `visit` on every recorded evaluation in the order of their numbers, one in memory at a time.
    ///
    /// # Errors
    /// [`StoreError`], or the first error of `visit`.
    pub fn for_each<E: From<StoreError>>(
        &self,
        visit: impl FnMut(StoredEvaluation) -> Result<(), E>,
    ) -> Result<(), E> {
        self.each("WHERE id >= 0 ORDER BY id", visit)
    }

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

    /// Calls `visit` on the rows of a query, one in memory at a time; `rest` is what follows the name of the table.
    pub(super) fn each<E: From<StoreError>>(
        &self,
        rest: &str,
        mut visit: impl FnMut(StoredEvaluation) -> Result<(), E>,
    ) -> Result<(), E> {
        let sql = self.evaluations(rest);
        let mut statement = self.query(|connection| connection.prepare(&sql))?;
        let mut rows = self.query(|_| statement.query_map([], |row| row.try_into()))?;
        while let Some(row) = self.query(|_| rows.next().transpose())? {
            visit(self.decoded(row)?)?;
        }
        Ok(())
    }

    /// The evaluation in a row.
    pub(super) fn decoded(&self, row: EvaluationColumns) -> Result<StoredEvaluation, StoreError> {
        let (id, sample, outcome, worker, wall, finished_at, level) = row;
        let what = || format!("sample of evaluation {id}");
        let sample = exact::sample_from_bytes(&sample);
        let sample = sample.ok_or_else(|| self.encoding(what(), "no whole number of values"))?;
        let outcome = self.outcome(id, &outcome)?;
        Ok(StoredEvaluation { id, level, sample, outcome, worker, wall, finished_at })
    }

    /// The evaluation in a row as the outcome of request `id`.
    pub(super) fn recalled(&self, row: EvaluationColumns, id: u64) -> Result<Finished, StoreError> {
        let StoredEvaluation { outcome, worker, wall, .. } = self.decoded(row)?;
        Ok(Finished { id, outcome, worker, wall })
    }

    /// Rounds of learning noted so far, in order.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn rounds(&self) -> Result<Vec<Round>, StoreError> {
        let rows: Vec<String> = self.query(|connection| {
            let mut statement = connection.prepare("SELECT json FROM learning_round ORDER BY round")?;
            statement.query_map([], |row| row.get(0))?.collect()
        })?;
        let round = |json: String| {
            serde_json::from_str(&json).map_err(|error| self.encoding("learning_round", error))
        };
        rows.into_iter().map(round).collect()
    }

    /// The result document of this name; `None` if the study has not come so far.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn document<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, StoreError> {
        self.json(name, "SELECT json FROM document WHERE name = ?1")
    }

    /// The value that `sql` selects by a name.
    pub(super) fn json<T: DeserializeOwned>(&self, name: &str, sql: &str) -> Result<Option<T>, StoreError> {
        let json: Option<String> =
            self.query(|connection| connection.query_row(sql, [name], |row| row.get(0)).optional())?;
        json.map(|json| serde_json::from_str(&json).map_err(|error| self.encoding(name, error))).transpose()
    }
}
