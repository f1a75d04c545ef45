//! Errors of the store.

use std::path::PathBuf;

use crate::entry::EntryError;

/// The store cannot be used, or not with this run.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// There is no database.
    #[error("there is no history `{}`", path.display())]
    Missing {
        /// Where.
        path: PathBuf,
    },
    /// The database was written by a newer program.
    #[error("the history `{}` is of version {found}, this program reads up to version {known}", path.display())]
    Newer {
        /// Which.
        path: PathBuf,
        /// Its version.
        found: i64,
        /// The newest known version.
        known: usize,
    },
    /// A database of another program.
    #[error("`{}` is a database of another program", path.display())]
    Foreign {
        /// Which.
        path: PathBuf,
    },
    /// The file is damaged, or no database.
    #[error("the history `{}` is damaged", path.display())]
    Corrupt {
        /// Which.
        path: PathBuf,
        /// What SQLite found.
        #[source]
        source: rusqlite::Error,
    },
    /// Another process has written to the database for too long.
    #[error("the history `{}` is locked by another process", path.display())]
    Locked {
        /// Which.
        path: PathBuf,
    },
    /// The database cannot be opened, read or written.
    #[error("cannot use the history `{}`", path.display())]
    Io {
        /// Which.
        path: PathBuf,
        /// Why.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The record of a run cannot be stored.
    #[error(transparent)]
    Entry(#[from] EntryError),
    /// Another run with the same identity is stored.
    #[error("two runs have the id `{id}`")]
    Conflict {
        /// The identity.
        id: String,
    },
}

impl StoreError {
    /// Sorts an error of SQLite.
    pub(super) fn sqlite(path: &std::path::Path, source: rusqlite::Error) -> Self {
        use rusqlite::ErrorCode::{DatabaseBusy, DatabaseCorrupt, DatabaseLocked, NotADatabase};
        let path = path.to_owned();
        match source.sqlite_error_code() {
            Some(DatabaseCorrupt | NotADatabase) => Self::Corrupt { path, source },
            Some(DatabaseBusy | DatabaseLocked) => Self::Locked { path },
            _ => Self::Io { path, source: source.into() },
        }
    }

    /// What the user can do.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Missing { .. } => {
                Some("`rtf run` creates it; `rtf history import` creates it from past runs")
            }
            Self::Newer { .. } => Some("use the newer rtf, or another file with `--history FILE`"),
            Self::Foreign { .. } => Some("choose another file with `--history FILE`"),
            Self::Corrupt { .. } => {
                Some("move it away; `rtf history import` creates it from the journals")
            }
            Self::Locked { .. } => Some("try again when the other process has finished"),
            Self::Conflict { .. } => Some("the journal was changed or copied from another run"),
            Self::Io { .. } | Self::Entry(_) => None,
        }
    }
}
