//! Reading a campaign back: evaluations for the result files, documents for the report.

use super::{CampaignFile, StoreError, exact};
use crate::farm::evaluate::EvaluationResult;
use crate::results::summary::Round;
use rusqlite::{OptionalExtension, Row};
use serde::de::DeserializeOwned;

/// One recorded evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredEvaluation {
    /// Number of the evaluation.
    pub id: u64,
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

const COLUMNS: &str = "id, sample, outcome, worker, coalesce(wall_s, 0.0), finished_at";

type RawRow = (i64, Vec<u8>, Vec<u8>, String, f64, String);

fn raw(row: &Row<'_>) -> rusqlite::Result<RawRow> {
    Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?, row.get(5)?))
}

impl CampaignFile {
    /// Number of recorded evaluations.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn count(&self) -> Result<usize, StoreError> {
        self.connection
            .query_row("SELECT count(*) FROM evaluation WHERE id >= 0", [], |row| row.get::<_, i64>(0))
            .map(|count| count.unsigned_abs() as usize)
            .map_err(|source| self.database(source))
    }

    /// Number of recorded evaluations that failed.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn failed_count(&self) -> Result<usize, StoreError> {
        let sql = "SELECT count(*) FROM evaluation WHERE id >= 0 AND failure IS NOT NULL";
        let count = self.connection.query_row(sql, [], |row| row.get::<_, i64>(0));
        count.map(|count| count.unsigned_abs() as usize).map_err(|source| self.database(source))
    }

    /// The evaluation of this number, if recorded.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn evaluation(&self, id: u64) -> Result<Option<StoredEvaluation>, StoreError> {
        let Ok(key) = i64::try_from(id) else { return Ok(None) };
        self.connection
            .query_row(&format!("SELECT {COLUMNS} FROM evaluation WHERE id = ?1"), [key], raw)
            .optional()
            .map_err(|source| self.database(source))?
            .map(|row| self.decode(row))
            .transpose()
    }

    /// Calls `visit` on every recorded evaluation in the order of their numbers, one in memory at a time.
    ///
    /// # Errors
    /// [`StoreError`], or the first error of `visit`.
    pub fn for_each<E: From<StoreError>>(
        &self,
        mut visit: impl FnMut(StoredEvaluation) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut statement = self
            .connection
            .prepare(&format!("SELECT {COLUMNS} FROM evaluation WHERE id >= 0 ORDER BY id"))
            .map_err(|source| self.database(source))?;
        let rows = statement.query_map([], raw).map_err(|source| self.database(source))?;
        for row in rows {
            let row = row.map_err(|source| self.database(source))?;
            visit(self.decode(row)?)?;
        }
        Ok(())
    }

    fn decode(&self, row: RawRow) -> Result<StoredEvaluation, StoreError> {
        let (id, sample, outcome, worker, wall, finished_at) = row;
        let what = |part: &str| format!("{part} of evaluation {id}");
        Ok(StoredEvaluation {
            id: u64::try_from(id).map_err(|error| self.encoding(what("number"), error))?,
            sample: exact::sample_from_bytes(&sample)
                .ok_or_else(|| self.encoding(what("sample"), "no whole number of values"))?,
            outcome: exact::outcome_from_bytes(&outcome)
                .map_err(|reason| self.unreadable_outcome(id, reason))?,
            worker,
            wall,
            finished_at,
        })
    }

    /// Rounds of learning noted so far, in order.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn rounds(&self) -> Result<Vec<Round>, StoreError> {
        let mut statement = self
            .connection
            .prepare("SELECT json FROM learning_round ORDER BY round")
            .map_err(|source| self.database(source))?;
        let rows = statement.query_map([], |row| row.get::<_, String>(0)).map_err(|e| self.database(e))?;
        rows.map(|json| {
            let json = json.map_err(|source| self.database(source))?;
            serde_json::from_str(&json).map_err(|error| self.encoding("learning_round", error))
        })
        .collect()
    }

    /// The result document of this name; `None` if the study has not come so far.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn document<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, StoreError> {
        let json: Option<String> = self
            .connection
            .query_row("SELECT json FROM document WHERE name = ?1", [name], |row| row.get(0))
            .optional()
            .map_err(|source| self.database(source))?;
        json.map(|json| serde_json::from_str(&json).map_err(|error| self.encoding(name, error))).transpose()
    }
}
