//! Versions of the database.

use rusqlite::Connection;
use rusqlite_migration::{M, Migrations};

use super::database::PostgresDatabase;
use super::{Location, Store, StoreError, schema};

/// Brings a SQLite database to the newest version.
pub(super) fn migrate(connection: &mut Connection, at: &Location) -> Result<(), StoreError> {
    if check_version(connection, at)? == schema::MIGRATIONS.len() {
        return Ok(());
    }
    let steps = schema::MIGRATIONS.iter().map(|step| M::up(step)).collect();
    match Migrations::new(steps).to_latest(connection) {
        Ok(()) => {}
        // Another process was faster.
        Err(_) if check_version(connection, at)? == schema::MIGRATIONS.len() => {}
        Err(rusqlite_migration::Error::RusqliteError { err, .. }) => {
            return Err(StoreError::new(at, err.into()));
        }
        Err(other) => {
            return Err(StoreError::Io { location: at.clone(), source: other.into() });
        }
    }
    let id = schema::APPLICATION_ID;
    let marked = connection.pragma_update(None, "application_id", id);
    marked.map_err(|error| StoreError::new(at, error.into()))
}

/// Returns the version, unless it is unknown.
pub(super) fn check_version(connection: &Connection, at: &Location) -> Result<usize, StoreError> {
    let number = |name: &str| {
        connection.query_row(&format!("PRAGMA {name}"), [], |row| row.get::<_, i64>(0))
    };
    let read = || -> rusqlite::Result<(i64, i64, bool)> {
        let tables = "SELECT COUNT(*) FROM sqlite_master";
        let tables = connection.query_row(tables, [], |row| row.get::<_, i64>(0))?;
        Ok((number("user_version")?, number("application_id")?, tables == 0))
    };
    let (version, application, is_empty) =
        read().map_err(|error| StoreError::new(at, error.into()))?;
    // A creation that was killed may have no application id yet.
    let is_ours = application == schema::APPLICATION_ID || is_empty || is_new_history(connection);
    if is_ours {
        known_version(version, at)
    } else {
        Err(StoreError::Foreign { location: at.clone() })
    }
}

/// Returns the version, unless it is newer than this program.
fn known_version(version: i64, at: &Location) -> Result<usize, StoreError> {
    let known = schema::MIGRATIONS.len();
    let newer = || StoreError::Newer { location: at.clone(), found: version, known };
    usize::try_from(version).ok().filter(|version| *version <= known).ok_or_else(newer)
}

/// Whether the tables are ours although the application id was not set.
fn is_new_history(connection: &Connection) -> bool {
    let tables = "SELECT COUNT(*) FROM sqlite_master
                  WHERE type = 'table' AND name IN ('run', 'test', 'result', 'point', 'pruned')";
    connection.query_row(tables, [], |row| row.get::<_, i64>(0)) == Ok(5)
}

impl Store {
    /// Brings a PostgreSQL database to the newest version.
    pub(super) fn migrate_postgres(
        database: &mut PostgresDatabase,
        at: &Location,
    ) -> Result<(), StoreError> {
        let failed = |error| StoreError::new(at, error);
        let version = database.version().map_err(failed)?.unwrap_or_default();
        if known_version(version, at)? < schema::MIGRATIONS.len() {
            database.migrate().map_err(failed)?;
        }
        Ok(())
    }

    /// Accepts a PostgreSQL database that has a history.
    pub(super) fn check_postgres(
        database: &mut PostgresDatabase,
        at: &Location,
    ) -> Result<(), StoreError> {
        match database.version().map_err(|error| StoreError::new(at, error))? {
            None => Err(StoreError::Missing { location: at.clone() }),
            Some(_) => Self::migrate_postgres(database, at),
        }
    }
}
