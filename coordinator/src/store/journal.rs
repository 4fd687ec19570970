//! Writing a campaign: the study's journal, and the results at its end.

use super::{CampaignFile, StoreError, exact};
use crate::evaluate::{EvaluateError, Finished, Request};
use crate::journal::Journal;
use crate::summary::Round;
use rusqlite::{OptionalExtension, params, params_from_iter};
use serde::Serialize;

impl Journal for CampaignFile {
    fn finished(&self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
        Ok(self.find(request)?)
    }

    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        Ok(self.insert(request, finished)?)
    }

    fn note_round(&mut self, round: &Round) -> Result<(), EvaluateError> {
        let json = serde_json::to_string(round)
            .map_err(|error| self.encoding(format!("round {}", round.round), error))?;
        self.connection
            .execute(
                "INSERT OR REPLACE INTO learning_round (round, evaluations, noted_at, json)
                 VALUES (?1, ?2, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'), ?3)",
                params![round.round as i64, round.evaluations as i64, json],
            )
            .map_err(|source| self.database(source))?;
        Ok(())
    }
}

impl CampaignFile {
    fn find(&self, request: &Request) -> Result<Option<Finished>, StoreError> {
        let found = self
            .connection
            .prepare_cached(
                "SELECT sample, with_first_cycle, outcome, worker, coalesce(wall_s, 0.0) FROM evaluation WHERE id = ?1",
            )
            .and_then(|mut statement| {
                statement
                    .query_row([to_key(request.id)], |row| {
                        Ok((
                            row.get::<_, Vec<u8>>(0)?,
                            row.get::<_, bool>(1)?,
                            row.get::<_, Vec<u8>>(2)?,
                            row.get(3)?,
                            row.get(4)?,
                        ))
                    })
                    .optional()
            })
            .map_err(|source| self.database(source))?;
        let Some((sample, with_first_cycle, outcome, worker, wall)) = found else { return Ok(None) };
        let another = |difference| StoreError::AnotherStudy { path: self.path(), id: request.id, difference };
        if sample != exact::sample_to_bytes(&request.sample) {
            return Err(another("sample"));
        }
        if with_first_cycle != request.with_first_cycle {
            return Err(another("wish for the first cycle"));
        }
        let outcome = exact::outcome_from_bytes(&outcome)
            .map_err(|reason| self.encoding(format!("outcome of evaluation {}", request.id), reason))?;
        Ok(Some(Finished { id: request.id, outcome, worker, wall }))
    }

    /// One transaction per evaluation; a second outcome of the same request is harmless, the first one stays.
    fn insert(&mut self, request: &Request, finished: &Finished) -> Result<(), StoreError> {
        if request.id != finished.id {
            return Err(StoreError::WrongNumber { request: request.id, outcome: finished.id });
        }
        if self.find(request)?.is_some() {
            return Ok(());
        }
        let what = || format!("evaluation {}", request.id);
        if request.sample.len() != self.inputs.len() {
            let reason = format!("{} values for {} variables", request.sample.len(), self.inputs.len());
            return Err(self.encoding(what(), reason));
        }
        if let Ok(evaluation) = &finished.outcome {
            let histories = &evaluation.histories;
            let fits = histories.len() == self.outputs.len()
                && histories.iter().all(|history| history.len() == evaluation.cycles.len());
            if !fits {
                return Err(self.encoding(what(), "its histories do not fit the scene's outputs"));
            }
        }
        let outcome =
            exact::outcome_to_bytes(&finished.outcome).map_err(|reason| self.encoding(what(), reason))?;
        self.write(request, finished, &outcome)
            .map_err(|source| StoreError::Database { path: self.dir.join(super::FILE_NAME), source })
    }

    fn write(&mut self, request: &Request, finished: &Finished, outcome: &[u8]) -> rusqlite::Result<()> {
        let key = to_key(request.id);
        let transaction = self.connection.transaction()?;
        transaction
            .prepare_cached(
                "INSERT INTO evaluation (id, failure, worker, wall_s, finished_at, with_first_cycle, sample, outcome)
                 VALUES (?1, ?2, ?3, ?4, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'), ?5, ?6, ?7)",
            )?
            .execute(params![
                key,
                finished.outcome.as_ref().err().map(ToString::to_string),
                finished.worker,
                finished.wall,
                request.with_first_cycle,
                exact::sample_to_bytes(&request.sample),
                outcome,
            ])?;
        // Names by position, values by parameter: `sample` has as many values as the table has columns.
        let placeholders = |count: usize| (1..=count).map(|k| format!("?{k}")).collect::<Vec<_>>().join(", ");
        let names = |own: &str, columns: &[String]| {
            std::iter::once(own.to_string()).chain(columns.iter().cloned()).collect::<Vec<_>>().join(", ")
        };
        let sql = format!(
            "INSERT INTO input ({}) VALUES ({})",
            names("evaluation", &self.inputs),
            placeholders(1 + self.inputs.len())
        );
        let values = std::iter::once(rusqlite::types::Value::from(key))
            .chain(request.sample.iter().map(|value| rusqlite::types::Value::from(*value)));
        transaction.prepare_cached(&sql)?.execute(params_from_iter(values))?;
        if let Ok(evaluation) = &finished.outcome {
            let sql = format!(
                "INSERT INTO output ({}) VALUES ({})",
                names("evaluation, cycles", &self.outputs),
                placeholders(2 + self.outputs.len())
            );
            let mut statement = transaction.prepare_cached(&sql)?;
            for (row, cycles) in evaluation.cycles.iter().enumerate() {
                let values = [key.into(), i64::from(*cycles).into()]
                    .into_iter()
                    .chain(evaluation.histories.iter().map(|h| rusqlite::types::Value::from(h[row])));
                statement.execute(params_from_iter(values))?;
            }
        }
        transaction.commit()
    }

    /// Stores a result document as JSON under a name, e.g. `summary`; a document of that name is replaced.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn put_document<T: Serialize>(&mut self, name: &str, document: &T) -> Result<(), StoreError> {
        let json = serde_json::to_string(document).map_err(|error| self.encoding(name, error))?;
        self.connection
            .execute(
                "INSERT OR REPLACE INTO document (name, written_at, json)
                 VALUES (?1, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'), ?2)",
                (name, json),
            )
            .map_err(|source| self.database(source))?;
        Ok(())
    }
}

/// SQLite's integers are signed; numbers of evaluations start at 0 and never come near the sign.
fn to_key(id: u64) -> i64 {
    i64::try_from(id).expect("evaluations are numbered from 0 upwards, one by one")
}
