//! The database: opening, importing and pruning runs, reading rows.

mod columns;
mod error;
mod import;
mod migrate;
mod prune;
mod read;
pub mod sql;

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags};

pub(crate) use columns::{PackedPoint, PackedPoints, PackedResult, PackedResults};
pub use error::StoreError;
pub use import::ImportOutcome;
pub use prune::Keep;
pub use read::StoreCounts;
pub(crate) use read::{ResultRow, TestRow};

/// How long an import waits for another one.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);

/// How often it retries to open a database that another process creates.
const RETRY_INTERVAL: Duration = Duration::from_millis(10);

/// Number of pages after which the write-ahead log is copied into the database: an import
/// of a large run fits into it.
const CHECKPOINT_PAGES: i64 = 8000;

/// The same for a log that stays when the database is closed.
const KEPT_PAGES: i64 = 250;

/// The history: a SQLite database.
#[derive(Debug)]
pub struct Store {
    connection: Connection,
    path: PathBuf,
}

impl Store {
    /// Opens the database for imports; creates it if it does not exist.
    ///
    /// # Errors
    /// The file cannot be written, is damaged, or is no history that this program knows.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        if let Some(dir) = path.parent().filter(|dir| !dir.as_os_str().is_empty()) {
            let failed = |source: std::io::Error| StoreError::Io {
                path: path.to_owned(),
                source: source.into(),
            };
            fs::create_dir_all(dir).map_err(failed)?;
        }
        // Another process may be creating the database: SQLite does not wait for that.
        let started = Instant::now();
        loop {
            match Self::open_once(path) {
                Err(StoreError::Locked { .. }) if started.elapsed() < BUSY_TIMEOUT => {
                    thread::sleep(RETRY_INTERVAL);
                }
                opened => return opened,
            }
        }
    }

    fn open_once(path: &Path) -> Result<Self, StoreError> {
        let failed = |source| StoreError::sqlite(path, source);
        let connection = Connection::open(path).map_err(failed)?;
        let mut store = Self { connection, path: path.to_owned() };
        store.prepare().map_err(failed)?;
        store.migrate()?;
        Ok(store)
    }

    /// Opens an existing database for questions; it need not be writable.
    ///
    /// # Errors
    /// It does not exist, cannot be read, is damaged, or is no history that this program
    /// knows.
    pub fn open_existing(path: &Path) -> Result<Self, StoreError> {
        if !path.is_file() {
            return Err(StoreError::Missing { path: path.to_owned() });
        }
        match Self::open(path) {
            Err(StoreError::Io { .. } | StoreError::Locked { .. }) => Self::open_read_only(path),
            opened => opened,
        }
    }

    /// Without permission to write next to the database, SQLite reads it only if it may
    /// assume that no other process writes it.
    fn open_read_only(path: &Path) -> Result<Self, StoreError> {
        let failed = |source| StoreError::sqlite(path, source);
        let path = std::path::absolute(path)
            .map_err(|source| StoreError::Io { path: path.to_owned(), source: source.into() })?;
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
        let open = |query: &str| {
            let connection = Connection::open_with_flags(uri(&path, query), flags)?;
            connection.query_row("SELECT COUNT(*) FROM sqlite_master", [], |_| Ok(()))?;
            Ok(connection)
        };
        let connection = open("mode=ro").or_else(|_: rusqlite::Error| open("immutable=1"));
        let store = Self { connection: connection.map_err(failed)?, path };
        store.check_version()?;
        Ok(store)
    }

    fn prepare(&self) -> rusqlite::Result<()> {
        self.connection.busy_timeout(BUSY_TIMEOUT)?;
        // First of all: reports a file that is no database.
        self.connection.query_row("PRAGMA schema_version", [], |_| Ok(()))?;
        self.connection.pragma_update(None, "journal_mode", "WAL")?;
        self.connection.pragma_update(None, "synchronous", "NORMAL")?;
        self.connection.pragma_update(None, "wal_autocheckpoint", CHECKPOINT_PAGES)?;
        self.connection.pragma_update(None, "foreign_keys", true)?;
        self.connection.set_prepared_statement_cache_capacity(32);
        Ok(())
    }

    /// Leaves the write-ahead log when the store is closed, so that closing waits for no disk.
    /// A store that is opened for a question copies it into the database. The log stays short,
    /// because opening the database reads it.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn keep_log(&self) -> Result<(), StoreError> {
        let connection = &self.connection;
        let keep = || -> rusqlite::Result<()> {
            connection.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true)?;
            connection.pragma_update(None, "wal_autocheckpoint", KEPT_PAGES)
        };
        keep().map_err(|error| self.error(error))
    }

    /// The path of the database.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn error(&self, source: rusqlite::Error) -> StoreError {
        StoreError::sqlite(&self.path, source)
    }
}

/// A URI of SQLite.
fn uri(path: &Path, query: &str) -> String {
    let text = path.to_string_lossy();
    let escaped = text.replace('%', "%25").replace('?', "%3f").replace('#', "%23");
    format!("file:{escaped}?{query}")
}
