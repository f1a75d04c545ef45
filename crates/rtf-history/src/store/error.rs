//! Errors of the store.

use super::Location;
use super::database::{DatabaseError, ErrorKind};
use crate::entry::EntryError;

/// The store cannot be used, or not with this run.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("there is no history `{}`", location)]
    Missing { location: Location },
    #[error(
        "the history `{}` is of version {found}, this program reads up to version {known}",
        location
    )]
    Newer {
        location: Location,
        found: i64,
        /// The newest known version.
        known: usize,
    },
    #[error("`{}` is a database of another program", location)]
    Foreign { location: Location },
    /// The file is damaged, or no database.
    #[error("the history `{}` is damaged", location)]
    Corrupt {
        location: Location,
        /// What SQLite found.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    #[error("the history `{}` is locked by another process", location)]
    Locked { location: Location },
    /// The database cannot be opened, read or written.
    #[error("cannot use the history `{}`", location)]
    Io {
        location: Location,
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    #[error(transparent)]
    Entry(#[from] EntryError),
    /// Another run with the same identity is stored.
    #[error("two runs have the id `{id}`")]
    Conflict { id: String },
    /// Another campaign with the same identity is stored.
    #[error("two campaigns have the id `{id}`")]
    SameCampaign { id: String },
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
