//! The campaign file `DIR/campaign.db` (SQLite): scene, settings, every evaluation, results. It is the study's
//! [`Journal`](crate::results::journal::Journal) and all that `resume`, `report` and `sensitivity` need of a study.
//!
//! Durability: write-ahead log with `synchronous = FULL`, so that a commit returns only after the log was
//! flushed to the disk: no recorded evaluation is lost by kill -9 or loss of power, at the price of one flush per
//! evaluation (milliseconds against seconds of simulation). Exclusion: a lock on `DIR/campaign.lock`, which the
//! operating system releases when the process ends. Readers may open the database meanwhile.

mod connection;
mod error;
mod exact;
mod journal;
mod leg;
#[cfg(test)]
mod leg_tests;
mod read;
mod schema;
#[cfg(test)]
mod tests;

pub use connection::FILE_NAME;
pub use error::{StoreError, is_unusable_path};
pub use journal::FurtherEvaluations;
pub use read::StoredEvaluation;

use crate::farm::evaluate::EvaluationResult;
use common::scene::Scene;
use connection::{Held, connect, connect_read_only, has_no_table, named};
use rusqlite::{Connection, OpenFlags};
use serde::{Deserialize, Serialize};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Name of the lock in its folder.
const LOCK_NAME: &str = "campaign.lock";

/// Scene and settings of a campaign; enough to repeat it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CampaignMeta {
    /// Name of the scene.
    pub scene: String,
    /// Source text of the scene (TOML).
    pub scene_source: String,
    /// Settings of the study.
    pub settings: serde_json::Value,
    /// Command line that started the study.
    pub command: String,
    /// Version of the program.
    pub version: String,
}

/// An open campaign file. The folder stays locked while this lives.
#[derive(Debug)]
pub struct CampaignFile {
    connection: Connection,
    /// Folder of the study.
    pub dir: PathBuf,
    /// Scene and settings of the campaign.
    pub meta: CampaignMeta,
    /// Start of the campaign (UTC, ISO 8601).
    pub created_at: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    /// Whether the file has a column for the level of accuracy.
    has_levels: bool,
    /// When the log was last written into the file.
    log_written: Option<Instant>,
    /// What is held until the file is closed.
    _held: Held,
}

impl CampaignFile {
    /// Starts a campaign in `dir`, which is created if missing.
    ///
    /// # Errors
    /// [`StoreError::InUse`], [`StoreError::AlreadyHoldsCampaign`], or what the file system or SQLite report.
    pub fn create(dir: &Path, meta: &CampaignMeta, scene: &Scene) -> Result<Self, StoreError> {
        std::fs::create_dir_all(dir).map_err(|source| StoreError::Folder(dir.into(), source))?;
        let lock = lock(dir)?;
        let path = dir.join(FILE_NAME);
        // A process killed before its first commit leaves an empty file, which holds no campaign.
        if path.exists() && !is_empty_database(&path)? {
            return Err(StoreError::AlreadyHoldsCampaign(dir.into()));
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE;
        let mut connection = connect(&path, flags)?;
        let started = make_durable(&connection).and_then(|()| start(&mut connection, meta, scene));
        started.map_err(StoreError::of(&path))?;
        Self::from_connection(dir, connection, lock)
    }

    /// Opens the campaign in `dir`; a file of an earlier layout is brought up to the present one.
    ///
    /// # Errors
    /// [`StoreError::InUse`], [`StoreError::NoCampaign`], [`StoreError::NotACampaign`],
    /// [`StoreError::SchemaVersion`], [`StoreError::Outcome`], or what the file system or SQLite report.
    pub fn open(dir: &Path) -> Result<Self, StoreError> {
        let path = campaign_path(dir)?;
        let lock = lock(dir)?;
        if is_empty_database(&path)? {
            return Err(StoreError::NoCampaign(dir.into()));
        }
        let connection = connect(&path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        Self::from_connection(dir, connection, lock)
    }

    /// Opens the campaign in `dir` for reading, while another process may write it, or where nothing may be written: the
    /// file is neither locked nor changed, and one of an earlier layout stays as it is. Documents put into this value are
    /// stored in memory and hide those of the file.
    ///
    /// # Errors
    /// Those of [`CampaignFile::open`], but for a file in use.
    pub fn look(dir: &Path) -> Result<Self, StoreError> {
        let path = campaign_path(dir)?;
        let (connection, held) = connect_read_only(&path)?;
        if has_no_table(&path, &connection).map_err(|error| named(&path, error))? {
            return Err(StoreError::NoCampaign(dir.into()));
        }
        layout(&path, &connection)?;
        // A temporary table goes before one of the file.
        let own = format!(
            "PRAGMA temp_store = MEMORY; CREATE TEMP TABLE {}; INSERT INTO temp.document SELECT * FROM main.document;",
            schema::DOCUMENT
        );
        connection.execute_batch(&own).map_err(StoreError::of(&path))?;
        Self::read(dir, connection, held)
    }

    fn from_connection(dir: &Path, mut connection: Connection, lock: File) -> Result<Self, StoreError> {
        let path = dir.join(FILE_NAME);
        if layout(&path, &connection)? < schema::SCHEMA_VERSION {
            schema::migrate(&mut connection).map_err(StoreError::of(&path))?;
        }
        make_durable(&connection).map_err(StoreError::of(&path))?;
        Self::read(dir, connection, Box::new(lock))
    }

    fn read(dir: &Path, connection: Connection, held: Held) -> Result<Self, StoreError> {
        let path = dir.join(FILE_NAME);
        let failed = StoreError::of(&path);
        let value = |key: &str| -> Result<String, StoreError> {
            let sql = "SELECT value FROM campaign WHERE key = ?1";
            connection.query_row(sql, [key], |row| row.get(0)).map_err(failed)
        };
        let unread = |error: serde_json::Error| {
            StoreError::Encoding(path.clone(), "settings".into(), error.to_string())
        };
        let settings = serde_json::from_str(&value("settings")?).map_err(unread)?;
        let meta = CampaignMeta {
            scene: value("scene")?,
            scene_source: value("scene_source")?,
            settings,
            command: value("command")?,
            version: value("version")?,
        };
        Ok(Self {
            dir: dir.into(),
            meta,
            created_at: value("created_at")?,
            inputs: schema::table_columns(&connection, "input").map_err(failed)?,
            outputs: schema::table_columns(&connection, "output").map_err(failed)?,
            has_levels: layout(&path, &connection)? == schema::SCHEMA_VERSION,
            connection,
            log_written: None,
            _held: held,
        })
    }

    fn path(&self) -> PathBuf {
        self.dir.join(FILE_NAME)
    }

    /// What a call of SQLite returns.
    fn query<'a, T>(
        &'a self,
        ask: impl FnOnce(&'a Connection) -> rusqlite::Result<T>,
    ) -> Result<T, StoreError> {
        ask(&self.connection).map_err(|source| StoreError::Database(self.path(), source))
    }

    /// The outcome of evaluation `id` from its bytes.
    fn outcome(&self, id: i64, bytes: &[u8]) -> Result<EvaluationResult, StoreError> {
        let (path, program) = (self.path(), self.meta.version.clone());
        exact::outcome_from_bytes(bytes).map_err(|reason| StoreError::Outcome { path, id, program, reason })
    }

    fn encoding(&self, what: impl Into<String>, reason: impl ToString) -> StoreError {
        StoreError::Encoding(self.path(), what.into(), reason.to_string())
    }
}

/// Path of the campaign file in a folder.
fn campaign_path(dir: &Path) -> Result<PathBuf, StoreError> {
    let path = dir.join(FILE_NAME);
    match std::fs::metadata(&path) {
        Ok(file) if file.is_file() => Ok(path),
        Err(source) if source.kind() == std::io::ErrorKind::PermissionDenied => {
            Err(StoreError::Folder(dir.into(), source))
        }
        _ => Err(StoreError::NoCampaign(dir.into())),
    }
}

/// Whether a process holds the lock of this folder: a study is running in it.
pub fn is_running(dir: &Path) -> bool {
    let file = File::open(dir.join(LOCK_NAME));
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// Locks the folder for this process; fails at once if it is locked.
fn lock(dir: &Path) -> Result<File, StoreError> {
    let folder = |source| StoreError::Folder(dir.into(), source);
    let mut options = File::options();
    let file = options.create(true).truncate(false).write(true).open(dir.join(LOCK_NAME)).map_err(folder)?;
    file.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => StoreError::InUse(dir.into()),
        TryLockError::Error(source) => folder(source),
    })?;
    Ok(file)
}

/// Some network file systems have no write-ahead log; SQLite then stays with its rollback journal, which is as
/// durable under FULL and only slower.
fn make_durable(connection: &Connection) -> rusqlite::Result<()> {
    connection.query_row("PRAGMA journal_mode = WAL", [], |row| row.get::<_, String>(0))?;
    connection.execute_batch("PRAGMA synchronous = FULL;")
}

/// Whether the file is a database without any table, which a process killed in [`CampaignFile::create`] leaves.
fn is_empty_database(path: &Path) -> Result<bool, StoreError> {
    let connection = connect(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
    has_no_table(path, &connection).map_err(|error| named(path, error))
}

/// Tables and metadata in one transaction: a campaign exists whole or not at all.
fn start(connection: &mut Connection, meta: &CampaignMeta, scene: &Scene) -> rusqlite::Result<()> {
    let transaction = connection.transaction()?;
    transaction.execute_batch(&schema::statements(scene))?;
    let settings = meta.settings.to_string();
    for (key, value) in [
        ("scene", &meta.scene),
        ("scene_source", &meta.scene_source),
        ("settings", &settings),
        ("command", &meta.command),
        ("version", &meta.version),
    ] {
        transaction.execute("INSERT INTO campaign (key, value) VALUES (?1, ?2)", (key, value))?;
    }
    transaction.execute(
        "INSERT INTO campaign (key, value) VALUES ('created_at', strftime('%Y-%m-%dT%H:%M:%fZ', 'now'))",
        [],
    )?;
    schema::insert_leg(&transaction, 0, [&settings, &meta.command, &meta.version])?;
    transaction.commit()
}

/// Version of the layout, one that this program reads.
fn layout(path: &Path, connection: &Connection) -> Result<i64, StoreError> {
    let pragma = |name: &str| {
        let sql = format!("PRAGMA {name}");
        connection.query_row(&sql, [], |row| row.get::<_, i64>(0)).map_err(StoreError::of(path))
    };
    if pragma("application_id")? != schema::APPLICATION_ID {
        return Err(StoreError::NotACampaign(path.into()));
    }
    match pragma("user_version")? {
        known @ schema::EARLIEST_VERSION..=schema::SCHEMA_VERSION => Ok(known),
        found => {
            let program = schema::program_version(connection);
            Err(StoreError::SchemaVersion { path: path.into(), found, program })
        }
    }
}
