//! Versions of the database.

use rusqlite_migration::{M, Migrations};

use super::{Store, StoreError, sql};

impl Store {
    /// Brings the database to the newest version.
    pub(super) fn migrate(&mut self) -> Result<(), StoreError> {
        if self.check_version()? == sql::MIGRATIONS.len() {
            return Ok(());
        }
        let steps = sql::MIGRATIONS.iter().map(|step| M::up(step)).collect();
        match Migrations::new(steps).to_latest(&mut self.connection) {
            Ok(()) => {}
            // Another process was faster.
            Err(_) if self.check_version()? == sql::MIGRATIONS.len() => {}
            Err(rusqlite_migration::Error::RusqliteError { err, .. }) => {
                return Err(self.error(err));
            }
            Err(other) => {
                return Err(StoreError::Io { path: self.path.clone(), source: other.into() });
            }
        }
        let id = sql::APPLICATION_ID;
        self.connection.pragma_update(None, "application_id", id).map_err(|e| self.error(e))
    }

    /// Returns the version, unless it is unknown.
    pub(super) fn check_version(&self) -> Result<usize, StoreError> {
        let number = |name: &str| {
            self.connection.query_row(&format!("PRAGMA {name}"), [], |row| row.get::<_, i64>(0))
        };
        let read = || -> rusqlite::Result<(i64, i64, bool)> {
            let tables = "SELECT COUNT(*) FROM sqlite_master";
            let tables = self.connection.query_row(tables, [], |row| row.get::<_, i64>(0))?;
            Ok((number("user_version")?, number("application_id")?, tables == 0))
        };
        let (version, application, is_empty) = read().map_err(|error| self.error(error))?;
        let path = self.path.clone();
        let known = sql::MIGRATIONS.len();
        // A creation that was killed may have no application id yet.
        let is_ours = application == sql::APPLICATION_ID || is_empty || self.is_new_history();
        match usize::try_from(version) {
            _ if !is_ours => Err(StoreError::Foreign { path }),
            Ok(version) if version <= known => Ok(version),
            _ => Err(StoreError::Newer { path, found: version, known }),
        }
    }

    /// Whether the tables are ours although the application id was not set.
    fn is_new_history(&self) -> bool {
        let tables = "SELECT COUNT(*) FROM sqlite_master
                      WHERE type = 'table' AND name IN ('run', 'test', 'result', 'point', 'pruned')";
        self.connection.query_row(tables, [], |row| row.get::<_, i64>(0)) == Ok(5)
    }
}
