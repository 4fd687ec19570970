//! Legs of a campaign: each `resume` with other settings goes on with the study under them and is recorded.
//!
//! A leg makes its requests anew from the first one on. An evaluation that was recorded before under another number gets
//! the number of its request; one that no request asks for any longer gets a number below zero, and is no part of the
//! result.

use super::schema::insert_leg;
use super::{CampaignFile, StoreError};
use crate::farm::evaluate::Request;
use rusqlite::{Connection, OptionalExtension, Transaction, params};
use serde_json::Value;

/// Tables with the number of an evaluation, and the column that holds it.
const NUMBERED: [(&str, &str); 4] =
    [("evaluation", "id"), ("input", "evaluation"), ("output", "evaluation"), ("output_error", "evaluation")];

impl CampaignFile {
    /// Starts a leg: from now on the study has these settings, and is not finished.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn begin_leg(&mut self, settings: Value, command: &str, version: &str) -> Result<(), StoreError> {
        let evaluations = self.count()?;
        let text = settings.to_string();
        self.transact(|transaction| {
            insert_leg(transaction, evaluations, [&text, command, version])?;
            transaction.execute("UPDATE campaign SET value = ?1 WHERE key = 'settings'", [&text])?;
            transaction.execute_batch("DELETE FROM document; DELETE FROM learning_round;")
        })?;
        self.meta.settings = settings;
        Ok(())
    }

    /// Versions of the program that started the legs of the campaign, the first one included.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn leg_versions(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT version FROM leg ORDER BY number";
        self.query(|connection| connection.prepare(sql)?.query_map([], |row| row.get(0))?.collect())
    }

    /// Removes the failed evaluations of a study in which none has succeeded: its cause may be gone, and there is nothing
    /// to go on from.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn forget_failed_start(&mut self) -> Result<(), StoreError> {
        self.transact(|transaction| {
            // What was set aside is below zero, and has the tables of its values.
            let failed = "SELECT count(*) > 0 AND count(*) = count(failure) FROM evaluation WHERE id >= 0";
            let is_failed: bool = transaction.query_row(failed, [], |row| row.get(0))?;
            let forget = "DELETE FROM input WHERE evaluation >= 0; DELETE FROM evaluation WHERE id >= 0;";
            if is_failed { transaction.execute_batch(forget) } else { Ok(()) }
        })
    }

    /// Takes the evaluations from number `requests` on out of the study: its requests have ended before them.
    ///
    /// # Errors
    /// [`StoreError`].
    pub(super) fn set_aside_from(&mut self, requests: i64) -> Result<(), StoreError> {
        self.transact(|transaction| {
            let mut unused = transaction.prepare("SELECT id FROM evaluation WHERE id >= ?1")?;
            let unused: Vec<i64> =
                unused.query_map([requests], |row| row.get(0))?.collect::<Result<_, _>>()?;
            unused.into_iter().try_for_each(|id| renumber(transaction, id, free_number(transaction)?))
        })
    }

    /// Takes an evaluation whose outcome does not fit the scene out of the study for good, with the reason in the place of a
    /// failure.
    ///
    /// # Errors
    /// [`StoreError`].
    pub(super) fn set_misfit_aside(&mut self, id: i64, reason: &str) -> Result<(), StoreError> {
        self.transact(|transaction| {
            let number = free_number(transaction)?;
            renumber(transaction, id, number)?;
            let sql = "UPDATE evaluation SET failure = ?2, stricter = 2 WHERE id = ?1";
            transaction.execute(sql, params![number, reason]).map(drop)
        })
    }

    /// Sets all evaluations of a worker aside, so that they are requested again; their number.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn set_worker_aside(&mut self, worker: &str) -> Result<usize, StoreError> {
        let sql = "SELECT id FROM evaluation WHERE id >= 0 AND (worker = ?1 OR substr(worker, 1, length(?1) + 1) = ?1 || '/')";
        let ids: Vec<i64> = self
            .query(|connection| connection.prepare(sql)?.query_map([worker], |row| row.get(0))?.collect())?;
        for id in &ids {
            self.set_misfit_aside(*id, &format!("not used: its worker {worker} is not trusted"))?;
        }
        Ok(ids.len())
    }

    /// Gives number `id` to the recorded evaluation of this sample at this level, if there is one; an evaluation of another sample that
    /// has the number is set aside.
    ///
    /// # Errors
    /// [`StoreError`].
    pub(super) fn move_to(&mut self, id: i64, sample: &[u8], request: &Request) -> Result<(), StoreError> {
        let (is_stricter, level) = (request.is_stricter(), request.level);
        self.transact(|transaction| {
            let found: Option<i64> = transaction
                .prepare_cached(
                    "SELECT id FROM (
                       SELECT id FROM evaluation WHERE id > ?1 AND sample = ?2 AND stricter = ?3 AND level = ?4
                       UNION ALL SELECT id FROM evaluation WHERE id < 0 AND sample = ?2 AND stricter = ?3 AND level = ?4
                     ) ORDER BY id < 0, abs(id) LIMIT 1",
                )?
                .query_row(params![id, sample, is_stricter, level], |row| row.get(0))
                .optional()?;
            let occupied = "SELECT count(*) > 0 FROM evaluation WHERE id = ?1";
            let occupied: bool = transaction.prepare_cached(occupied)?.query_row([id], |row| row.get(0))?;
            if occupied {
                renumber(transaction, id, free_number(transaction)?)?;
            }
            found.map_or(Ok(()), |found| renumber(transaction, found, id))
        })
    }

    /// Acts in one transaction, in which rows of a table may refer to a number that follows later.
    pub(super) fn transact(
        &self,
        act: impl FnOnce(&Transaction<'_>) -> rusqlite::Result<()>,
    ) -> Result<(), StoreError> {
        self.query(|connection| {
            let transaction = connection.unchecked_transaction()?;
            transaction.execute_batch("PRAGMA defer_foreign_keys = ON")?;
            act(&transaction)?;
            transaction.commit()
        })
    }
}

/// The first free number below zero.
pub(super) fn free_number(connection: &Connection) -> rusqlite::Result<i64> {
    connection.query_row("SELECT min(0, coalesce(min(id), 0)) - 1 FROM evaluation", [], |row| row.get(0))
}

fn renumber(connection: &Connection, from: i64, to: i64) -> rusqlite::Result<()> {
    for (table, column) in NUMBERED {
        let sql = format!("UPDATE {table} SET {column} = ?2 WHERE {column} = ?1");
        connection.prepare_cached(&sql)?.execute([from, to])?;
    }
    Ok(())
}
