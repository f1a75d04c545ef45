//! The database: opening, importing and pruning runs, reading rows.

mod campaigns;
mod columns;
mod database;
mod error;
mod import;
mod json;
mod location;
mod migrate;
mod prune;
mod read;
mod rows;
pub mod schema;
pub mod sql;

use std::cell::RefCell;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags};

pub(crate) use columns::{PackedPoint, PackedPoints, PackedResult, PackedResults};
use database::{Database, DatabaseError, PostgresDatabase};
pub use database::{PostgresUrl, UrlError};
pub use error::StoreError;
pub use import::ImportOutcome;
pub use location::Location;
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

/// A longer log, in bytes, does not stay when the database is closed: opening it reads the log,
/// and does not know which part was copied before.
const KEPT_BYTES: u64 = 1 << 20;

/// Number of statements that remain prepared.
const STATEMENTS: usize = 64;

/// The history: a SQLite or PostgreSQL database.
#[derive(Debug)]
pub struct Store {
    database: Database,
    location: Location,
}

impl Store {
    /// Opens the database for imports; creates its file or its tables if they do not exist.
    ///
    /// # Errors
    /// It cannot be written, is damaged, or is no history that this program knows.
    pub fn open(location: impl Into<Location>) -> Result<Self, StoreError> {
        match location.into() {
            Location::File(path) => Self::open_file(&path),
            Location::Postgres(url) => Self::connect(&url, Self::migrate_postgres),
        }
    }

    /// Opens an existing database for questions; it need not be writable.
    ///
    /// # Errors
    /// It does not exist, cannot be read, is damaged, or is no history that this program
    /// knows.
    pub fn open_existing(location: impl Into<Location>) -> Result<Self, StoreError> {
        let location = location.into();
        match &location {
            Location::File(path) if !path.is_file() => Err(StoreError::Missing { location }),
            Location::File(path) => match Self::open_file(path) {
                Err(StoreError::Io { .. } | StoreError::Locked { .. }) => {
                    Self::open_read_only(path)
                }
                opened => opened,
            },
            Location::Postgres(url) => Self::connect(url, Self::check_postgres),
        }
    }

    fn open_file(path: &Path) -> Result<Self, StoreError> {
        if let Some(dir) = path.parent().filter(|dir| !dir.as_os_str().is_empty()) {
            let failed = |source: std::io::Error| StoreError::Io {
                location: path.into(),
                source: source.into(),
            };
            fs::create_dir_all(dir).map_err(failed)?;
        }
        // Another process may be creating the database: SQLite does not wait for that.
        let started = Instant::now();
        loop {
            match Self::open_file_once(path) {
                Err(StoreError::Locked { .. }) if started.elapsed() < BUSY_TIMEOUT => {
                    thread::sleep(RETRY_INTERVAL);
                }
                opened => return opened,
            }
        }
    }

    fn open_file_once(path: &Path) -> Result<Self, StoreError> {
        let failed = |source: rusqlite::Error| StoreError::new(&path.into(), source.into());
        let mut connection = Connection::open(path).map_err(failed)?;
        prepare(&connection).map_err(failed)?;
        migrate::migrate(&mut connection, &path.into())?;
        Ok(Self { database: Database::Sqlite(connection), location: path.into() })
    }

    /// Without permission to write next to the database, SQLite reads it only if it may
    /// assume that no other process writes it.
    fn open_read_only(path: &Path) -> Result<Self, StoreError> {
        let location = Location::from(path);
        let failed = |source: rusqlite::Error| StoreError::new(&location, source.into());
        let path = std::path::absolute(path).map_err(|source| StoreError::Io {
            location: location.clone(),
            source: source.into(),
        })?;
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
        let open = |query: &str| {
            let connection = Connection::open_with_flags(uri(&path, query), flags)?;
            connection.query_row("SELECT COUNT(*) FROM sqlite_master", [], |_| Ok(()))?;
            Ok(connection)
        };
        let connection = open("mode=ro").or_else(|_: rusqlite::Error| open("immutable=1"));
        let connection = connection.map_err(failed)?;
        migrate::check_version(&connection, &location)?;
        Ok(Self { database: Database::Sqlite(connection), location: path.into() })
    }

    fn connect(
        url: &Arc<PostgresUrl>,
        check: impl FnOnce(&mut PostgresDatabase, &Location) -> Result<(), StoreError>,
    ) -> Result<Self, StoreError> {
        let location = Location::Postgres(url.clone());
        let connected = PostgresDatabase::connect(url);
        let mut database = connected.map_err(|error| StoreError::new(&location, error))?;
        check(&mut database, &location)?;
        Ok(Self { database: Database::Postgres(Box::new(RefCell::new(database))), location })
    }

    /// Leaves the write-ahead log when the store is closed, so that closing waits for no disk.
    /// A store that is opened for a question copies it into the database, and so does this one
    /// if the log has become long.
    ///
    /// # Errors
    /// The database cannot be opened any more.
    pub fn keep_log(&self) -> Result<(), StoreError> {
        let (Database::Sqlite(connection), Location::File(path)) = (&self.database, &self.location)
        else {
            return Ok(());
        };
        let mut log = path.clone().into_os_string();
        log.push("-wal");
        let is_short = fs::metadata(log).is_ok_and(|log| log.len() < KEPT_BYTES);
        let kept = connection.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, is_short);
        kept.map(drop).map_err(|error| self.error(error))
    }

    #[must_use]
    pub fn location(&self) -> &Location {
        &self.location
    }

    fn error(&self, source: impl Into<DatabaseError>) -> StoreError {
        StoreError::new(&self.location, source.into())
    }
}

fn prepare(connection: &Connection) -> rusqlite::Result<()> {
    connection.busy_timeout(BUSY_TIMEOUT)?;
    // First of all: reports a file that is no database.
    connection.query_row("PRAGMA schema_version", [], |_| Ok(()))?;
    connection.pragma_update(None, "journal_mode", "WAL")?;
    connection.pragma_update(None, "synchronous", "NORMAL")?;
    connection.pragma_update(None, "wal_autocheckpoint", CHECKPOINT_PAGES)?;
    connection.pragma_update(None, "foreign_keys", true)?;
    connection.set_prepared_statement_cache_capacity(STATEMENTS);
    Ok(())
}

/// A URI of SQLite.
fn uri(path: &Path, query: &str) -> String {
    let text = path.to_string_lossy();
    let escaped = text.replace('%', "%25").replace('?', "%3f").replace('#', "%23");
    format!("file:{escaped}?{query}")
}
