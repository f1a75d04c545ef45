//! The databases: the same statements for SQLite and PostgreSQL. They differ in how they are
//! opened, and in the types of columns ([`dialect`]).

mod batch;
mod dialect;
mod postgres;
mod tls;
mod value;

pub(super) use batch::Batch;
pub(super) use postgres::PostgresDatabase;
pub use postgres::{PostgresUrl, UrlError};
pub(crate) use value::{Row, Value};

use std::cell::RefCell;
use std::error::Error as _;

use ::postgres::error::SqlState;

#[derive(Debug, thiserror::Error)]
pub(crate) enum DatabaseError {
    #[error(transparent)]
    Sqlite(#[from] rusqlite::Error),
    #[error("{}", with_causes(.0))]
    Postgres(::postgres::Error),
    #[error("{0}")]
    Connection(&'static str),
    #[error("a number is out of range")]
    Range(#[from] std::num::TryFromIntError),
}

impl From<::postgres::Error> for DatabaseError {
    fn from(error: ::postgres::Error) -> Self {
        Self::Postgres(error)
    }
}

/// The error alone is `db error`, or `error connecting to server`.
fn with_causes(error: &::postgres::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text += &format!(": {error}");
        cause = error.source();
    }
    text
}

/// How an error is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ErrorKind {
    Corrupt,
    Locked,
    Other,
}

impl DatabaseError {
    pub fn kind(&self) -> ErrorKind {
        use rusqlite::ErrorCode::{DatabaseBusy, DatabaseCorrupt, DatabaseLocked, NotADatabase};
        match self {
            Self::Sqlite(error) => match error.sqlite_error_code() {
                Some(DatabaseCorrupt | NotADatabase) => ErrorKind::Corrupt,
                Some(DatabaseBusy | DatabaseLocked) => ErrorKind::Locked,
                _ => ErrorKind::Other,
            },
            Self::Postgres(error) if error.code() == Some(&SqlState::LOCK_NOT_AVAILABLE) => {
                ErrorKind::Locked
            }
            Self::Postgres(_) | Self::Connection(_) | Self::Range(_) => ErrorKind::Other,
        }
    }
}

/// Called with each row of an answer.
pub(crate) type Visit<'a> = &'a mut dyn FnMut(&Row<'_>) -> Result<(), DatabaseError>;

/// An open database.
#[derive(Debug)]
pub(super) enum Database {
    Sqlite(rusqlite::Connection),
    Postgres(Box<RefCell<PostgresDatabase>>),
}

impl Database {
    /// Executes a statement, and visits the rows of its answer.
    pub fn for_each(
        &self,
        sql: &str,
        values: &[Value<'_>],
        visit: Visit<'_>,
    ) -> Result<(), DatabaseError> {
        match self {
            Self::Sqlite(connection) => {
                visit_rows(&mut *connection.prepare_cached(sql)?, values, visit)
            }
            Self::Postgres(database) => database.borrow_mut().for_each(sql, values, visit),
        }
    }

    pub fn execute(&self, sql: &str, values: &[Value<'_>]) -> Result<(), DatabaseError> {
        self.for_each(sql, values, &mut |_| Ok(()))
    }

    /// Executes statements, each with this id.
    pub fn delete(&self, statements: &[&str], id: i64) -> Result<(), DatabaseError> {
        statements.iter().try_for_each(|statement| self.execute(statement, &[id.into()]))
    }

    /// Executes a statement, and reads the rows of its answer.
    pub fn rows<T>(
        &self,
        sql: &str,
        values: &[Value<'_>],
        read: impl Fn(&Row<'_>) -> Result<T, DatabaseError>,
    ) -> Result<Vec<T>, DatabaseError> {
        let mut rows = Vec::new();
        self.for_each(sql, values, &mut |row| {
            rows.push(read(row)?);
            Ok(())
        })?;
        Ok(rows)
    }

    /// Executes a statement for each row of values, and visits the rows of the answers, which
    /// are in any order. PostgreSQL gets many rows at a time. SQLite gets one: to prepare a
    /// statement takes it longer than to execute it, and much longer if it has many parameters.
    pub fn batch(
        &self,
        batch: &Batch,
        values: &[Value<'_>],
        visit: Visit<'_>,
    ) -> Result<(), DatabaseError> {
        match self {
            Self::Sqlite(_) if values.is_empty() => Ok(()),
            Self::Sqlite(connection) => {
                let mut statement = connection.prepare_cached(&batch.sql(1))?;
                let mut rows = values.chunks_exact(batch.columns);
                rows.try_for_each(|row| visit_rows(&mut statement, row, visit))
            }
            Self::Postgres(_) => {
                let mut statements = batch.statements(values);
                statements.try_for_each(|(sql, values)| self.for_each(&sql, values, visit))
            }
        }
    }

    /// Begins a transaction for writing: other writers wait for its end.
    pub fn begin(&self) -> Result<Transaction<'_>, DatabaseError> {
        match self {
            // At once for writing: two readers that both want to write would fail.
            Self::Sqlite(connection) => connection.execute_batch("BEGIN IMMEDIATE")?,
            Self::Postgres(database) => database.borrow_mut().begin()?,
        }
        Ok(Transaction { database: self, is_open: true })
    }

    fn execute_batch(&self, sql: &str) -> Result<(), DatabaseError> {
        match self {
            Self::Sqlite(connection) => Ok(connection.execute_batch(sql)?),
            Self::Postgres(database) => database.borrow_mut().execute_batch(sql),
        }
    }
}

/// Executes a statement of SQLite, and visits the rows of its answer.
fn visit_rows(
    statement: &mut rusqlite::Statement<'_>,
    values: &[Value<'_>],
    visit: Visit<'_>,
) -> Result<(), DatabaseError> {
    let mut rows = statement.query(rusqlite::params_from_iter(values))?;
    while let Some(row) = rows.next()? {
        visit(&Row::Sqlite(row))?;
    }
    Ok(())
}

/// A transaction that is undone unless it is committed.
pub(super) struct Transaction<'a> {
    database: &'a Database,
    is_open: bool,
}

impl Transaction<'_> {
    pub fn commit(mut self) -> Result<(), DatabaseError> {
        self.database.execute_batch("COMMIT")?;
        self.is_open = false;
        Ok(())
    }
}

impl std::ops::Deref for Transaction<'_> {
    type Target = Database;

    fn deref(&self) -> &Database {
        self.database
    }
}

impl Drop for Transaction<'_> {
    fn drop(&mut self) {
        if self.is_open {
            // If that fails, the connection is lost, which also undoes it.
            let _ = self.database.execute_batch("ROLLBACK");
        }
    }
}
