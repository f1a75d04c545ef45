//! Errors of the store.

use super::Location;
use super::database::{DatabaseError, ErrorKind};
use crate::entry::EntryError;

/// The store cannot be used, or not with this run.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// There is no database.
    #[error("there is no history `{}`", location)]
    Missing {
        /// Where.
        location: Location,
    },
    /// The database was written by a newer program.
    #[error(
        "the history `{}` is of version {found}, this program reads up to version {known}",
        location
    )]
    Newer {
        /// Which.
        location: Location,
        /// Its version.
        found: i64,
        /// The newest known version.
        known: usize,
    },
    /// A database of another program.
    #[error("`{}` is a database of another program", location)]
    Foreign {
        /// Which.
        location: Location,
    },
    /// The file is damaged, or no database.
    #[error("the history `{}` is damaged", location)]
    Corrupt {
        /// Which.
        location: Location,
        /// What SQLite found.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// Another process has written to the database for too long.
    #[error("the history `{}` is locked by another process", location)]
    Locked {
        /// Which.
        location: Location,
    },
    /// The database cannot be opened, read or written.
    #[error("cannot use the history `{}`", location)]
    Io {
        /// Which.
        location: Location,
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
    /// Another campaign with the same identity is stored.
    #[error("two campaigns have the id `{id}`")]
    SameCampaign {
        /// The identity.
        id: String,
    },
}

impl StoreError {
    /// Sorts an error of a database.
    pub(super) fn new(location: &Location, source: DatabaseError) -> Self {
        let location = location.clone();
        match source.kind() {
            ErrorKind::Corrupt => Self::Corrupt { location, source: source.into() },
            ErrorKind::Locked => Self::Locked { location },
            ErrorKind::Other => Self::Io { location, source: source.into() },
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
            Self::SameCampaign { .. } => Some("`campaign.json` was copied from another campaign"),
            Self::Io { .. } | Self::Entry(_) => None,
        }
    }
}
