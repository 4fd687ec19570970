//! Writing of a campaign file: the journal of the study, the results at its end, and the journal of further evaluations.
//!
//! Further evaluations of a study's simulator are those that a question about a finished study asked for. They are kept in its campaign
//! file for later questions, under numbers below zero, and are no part of the study's own result: `summary.json`, `samples.csv` and the
//! counts of the study do not change. A later leg of the study that requests the same sample finds its outcome here as well, see
//! [`super::leg`].

use super::exact::OutcomeFault;
use super::leg::free_number;
use super::read::{COLUMNS, EvaluationColumns};
use super::{CampaignFile, StoreError, exact};
use crate::farm::evaluate::{EvaluateError, Finished, Request};
use crate::results::journal::Journal;
use crate::results::summary::Round;
use crate::results::timing::Timing;
use common::outputs::Evaluation;
use rusqlite::types::Value;
use rusqlite::{Connection, OptionalExtension, Row, Transaction, params, params_from_iter};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Longest time in which what is recorded is in the log alone.
const LOG_EVERY: Duration = Duration::from_secs(60);

impl Journal for CampaignFile {
    fn finished(&mut self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
        match self.recall(request) {
            Err(StoreError::Outcome { id, reason: reason @ OutcomeFault::Damaged, .. }) => {
                tracing::warn!(
                    "outcome of evaluation {id}: {reason}; it is set aside, and the sample is evaluated again"
                );
                self.set_misfit_aside(id, &reason.to_string())?;
                Ok(None)
            }
            found => Ok(found?),
        }
    }

    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        Ok(self.insert([(request, finished)])?)
    }

    fn record_all(&mut self, outcomes: &[(Request, Finished)]) -> Result<(), EvaluateError> {
        Ok(self.insert(outcomes.iter().map(|(request, finished)| (request, finished)))?)
    }

    fn set_aside(&mut self, id: u64, reason: &str) -> Result<(), EvaluateError> {
        Ok(self.set_misfit_aside(to_key(id), reason)?)
    }

    fn ended(&mut self, requests: u64) -> Result<(), EvaluateError> {
        Ok(self.set_aside_from(to_key(requests))?)
    }

    fn note_round(&mut self, round: &Round) -> Result<(), EvaluateError> {
        let json = self.in_json(&format!("round {}", round.round), round)?;
        let sql = "INSERT OR REPLACE INTO learning_round (round, evaluations, noted_at, json)
                   VALUES (?1, ?2, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'), ?3)";
        let (number, evaluations) = (round.round as i64, round.evaluations as i64);
        self.query(|connection| connection.execute(sql, params![number, evaluations, json]))?;
        Ok(())
    }

    fn times(&self) -> Result<Timing, EvaluateError> {
        Ok(self.json("times", "SELECT value FROM campaign WHERE key = ?1")?.unwrap_or_default())
    }

    fn note_times(&mut self, times: &Timing) -> Result<(), EvaluateError> {
        let text = self.in_json("times", times)?;
        let sql = "INSERT OR REPLACE INTO campaign (key, value) VALUES ('times', ?1)";
        self.query(|connection| connection.execute(sql, [text]))?;
        Ok(())
    }
}

impl CampaignFile {
    /// The recorded outcome of a request: that of its number or, after a change of the settings, one of the same sample
    /// under another number, which gets this one.
    fn recall(&mut self, request: &Request) -> Result<Option<Finished>, StoreError> {
        match self.find(request) {
            Err(StoreError::AnotherStudy { .. }) | Ok(None) if request.id > 0 => {
                let sample = exact::sample_to_bytes(&request.sample);
                self.move_to(to_key(request.id), &sample, request)?;
                self.find(request)
            }
            found => found,
        }
    }

    /// The outcome recorded under the number of a request.
    fn find(&self, request: &Request) -> Result<Option<Finished>, StoreError> {
        let sql = format!("SELECT {COLUMNS}, with_first_cycle, stricter FROM evaluation WHERE id = ?1");
        let read = |row: &Row<'_>| Ok((row.try_into()?, row.get(7)?, row.get(8)?));
        let found: Option<(EvaluationColumns, bool, bool)> = self.query(|connection| {
            connection.prepare_cached(&sql)?.query_row([to_key(request.id)], read).optional()
        })?;
        let Some((row, with_first_cycle, is_stricter)) = found else { return Ok(None) };
        let (_, sample, .., level) = &row;
        let differences = [
            (*sample != exact::sample_to_bytes(&request.sample), "sample"),
            (with_first_cycle != request.with_first_cycle, "wish for the first cycle"),
            (is_stricter != request.is_stricter() || *level != request.level, "accuracy"),
        ];
        if let Some((_, difference)) = differences.into_iter().find(|(differ, _)| *differ) {
            return Err(StoreError::AnotherStudy { path: self.path(), id: request.id, difference });
        }
        self.recalled(row, request.id).map(Some)
    }

    /// Records all outcomes in one transaction, or none; of two outcomes of one request, the first one stays.
    fn insert<'a>(
        &mut self,
        outcomes: impl IntoIterator<Item = (&'a Request, &'a Finished)>,
    ) -> Result<(), StoreError> {
        let transaction = self.query(Connection::unchecked_transaction)?;
        for (request, finished) in outcomes {
            if request.id != finished.id {
                return Err(StoreError::WrongNumber { request: request.id, outcome: finished.id });
            }
            if self.find(request)?.is_none() {
                let (key, outcome) = (to_key(request.id), self.encoded(request, finished)?);
                self.query(|_| self.write(&transaction, key, request, finished, &outcome))?;
            }
        }
        self.query(|_| transaction.commit())?;
        self.write_log_into_file()
    }

    /// Writes the log into the file, now and then: without it, a copy of the file alone would lack everything recorded since. Readers may
    /// delay a part of it until the next time.
    fn write_log_into_file(&mut self) -> Result<(), StoreError> {
        if self.log_written.is_some_and(|last| last.elapsed() < LOG_EVERY) {
            return Ok(());
        }
        self.log_written = Some(Instant::now());
        let pragma = "PRAGMA wal_checkpoint(PASSIVE)";
        self.query(|connection| connection.query_row(pragma, [], |_| Ok(())))
    }

    /// The outcome's exact bytes, if it fits the scene. Of an evaluation without its first cycle the bores at the end of life are left out:
    /// they would be half of a campaign file, and results are made of histories.
    fn encoded(&self, request: &Request, finished: &Finished) -> Result<Vec<u8>, StoreError> {
        let (given, wanted) = (request.sample.len(), self.inputs.len());
        let bytes = match &finished.outcome {
            _ if given != wanted => Err(format!("{given} values for {wanted} variables")),
            Ok(Evaluation { histories, cycles, .. })
                if histories.len() != self.outputs.len()
                    || histories.iter().any(|history| history.len() != cycles.len()) =>
            {
                Err("its histories do not fit the scene's outputs".to_owned())
            }
            Ok(evaluation) if !states_errors(evaluation) && !evaluation.errors.is_empty() => {
                Err("its stated errors do not fit its histories".to_owned())
            }
            Ok(evaluation) if !request.with_first_cycle && !evaluation.joints.is_empty() => {
                exact::outcome_to_bytes(&Ok(Evaluation { joints: vec![], ..evaluation.clone() }))
            }
            outcome => exact::outcome_to_bytes(outcome),
        };
        bytes.map_err(|reason| self.encoding(format!("evaluation {}", request.id), reason))
    }

    /// Writes an evaluation under the number `key`.
    fn write(
        &self,
        transaction: &Transaction<'_>,
        key: i64,
        request: &Request,
        finished: &Finished,
        outcome: &[u8],
    ) -> rusqlite::Result<()> {
        transaction
            .prepare_cached(
                "INSERT INTO evaluation
                 (id, failure, worker, wall_s, finished_at, with_first_cycle, sample, outcome, stricter, level)
                 VALUES (?1, ?2, ?3, ?4, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'), ?5, ?6, ?7, ?8, ?9)",
            )?
            .execute(params![
                key,
                finished.outcome.as_ref().err().map(ToString::to_string),
                finished.worker,
                finished.wall,
                request.with_first_cycle,
                exact::sample_to_bytes(&request.sample),
                outcome,
                request.is_stricter(),
                request.level,
            ])?;
        let values = std::iter::once(Value::from(key)).chain(request.sample.iter().map(|v| Value::from(*v)));
        let sql = insert_statement("input", "evaluation", &self.inputs);
        transaction.prepare_cached(&sql)?.execute(params_from_iter(values))?;
        if let Ok(evaluation) = &finished.outcome {
            let Evaluation { cycles, histories, errors, .. } = evaluation;
            write_rows(transaction, "output", &self.outputs, key, cycles, histories)?;
            if states_errors(evaluation) {
                write_rows(transaction, "output_error", &self.outputs, key, cycles, errors)?;
            }
        }
        Ok(())
    }

    fn in_json<T: Serialize>(&self, name: &str, value: &T) -> Result<String, StoreError> {
        serde_json::to_string(value).map_err(|error| self.encoding(name, error))
    }

    /// Stores a result document as JSON under a name, e.g. `summary`; a document of that name is replaced.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn put_document<T: Serialize>(&mut self, name: &str, document: &T) -> Result<(), StoreError> {
        let json = self.in_json(name, document)?;
        let sql = "INSERT OR REPLACE INTO document (name, written_at, json)
                   VALUES (?1, strftime('%Y-%m-%dT%H:%M:%fZ', 'now'), ?2)";
        self.query(|connection| connection.execute(sql, (name, json)))?;
        Ok(())
    }
}

/// SQLite's integers are signed; numbers of evaluations are far below their range.
fn to_key(id: u64) -> i64 {
    i64::try_from(id).expect("evaluations are numbered from 0 upwards, one by one")
}

/// Whether an evaluation states an error of every value.
fn states_errors(evaluation: &Evaluation) -> bool {
    let lengths = |rows: &[Vec<f64>]| rows.iter().map(Vec::len).collect::<Vec<_>>();
    lengths(&evaluation.errors) == lengths(&evaluation.histories)
}

/// One row per checkpoint, from values `(outputs, m)`.
fn write_rows(
    transaction: &Transaction<'_>,
    table: &str,
    outputs: &[String],
    key: i64,
    cycles: &[u32],
    values: &[Vec<f64>],
) -> rusqlite::Result<()> {
    let sql = insert_statement(table, "evaluation, cycles", outputs);
    let mut statement = transaction.prepare_cached(&sql)?;
    for (row, cycles) in cycles.iter().enumerate() {
        let own = [key.into(), i64::from(*cycles).into()].into_iter();
        statement.execute(params_from_iter(own.chain(values.iter().map(|of| Value::from(of[row])))))?;
    }
    Ok(())
}

/// Names by position, values by parameter: `own` columns of the table first, then `columns`.
fn insert_statement(table: &str, own: &str, columns: &[String]) -> String {
    let names: Vec<&str> = own.split(", ").chain(columns.iter().map(String::as_str)).collect();
    let places: Vec<String> = (1..=names.len()).map(|k| format!("?{k}")).collect();
    format!("INSERT INTO {table} ({}) VALUES ({})", names.join(", "), places.join(", "))
}

/// The journal of further evaluations of the study in this file: requests are found by their samples, not by their numbers.
#[derive(Debug)]
pub struct FurtherEvaluations<'a>(pub &'a mut CampaignFile);

impl Journal for FurtherEvaluations<'_> {
    /// The recorded outcome of this sample at this accuracy under any number, as that of the request.
    fn finished(&mut self, request: &Request) -> Result<Option<Finished>, EvaluateError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM evaluation WHERE sample = ?1 AND stricter = ?2 AND level = ?3 ORDER BY id < 0, abs(id) LIMIT 1 OFFSET ?4"
        );
        let sample = exact::sample_to_bytes(&request.sample);
        // Of an outlier, the evaluation after those that are known.
        let of_request = params![sample, request.is_stricter(), request.level, request.not_by.len() as i64];
        let found = self.0.query(|connection| {
            connection.prepare_cached(&sql)?.query_row(of_request, |row| row.try_into()).optional()
        })?;
        Ok(found.map(|row| self.0.recalled(row, request.id)).transpose()?)
    }

    /// Records an outcome under the first free number below zero.
    fn record(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        let outcome = self.0.encoded(request, finished)?;
        Ok(self.0.transact(|transaction| {
            self.0.write(transaction, free_number(transaction)?, request, finished, &outcome)
        })?)
    }

    fn set_aside(&mut self, id: u64, reason: &str) -> Result<(), EvaluateError> {
        self.0.set_aside(id, reason)
    }
}
