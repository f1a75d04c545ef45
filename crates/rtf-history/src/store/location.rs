//! Where a history is.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::database::{PostgresUrl, UrlError};

/// Where a history is. It is printed without a password.
#[derive(Clone, Debug)]
pub enum Location {
    /// A SQLite database.
    File(PathBuf),
    Postgres(Arc<PostgresUrl>),
}

impl Location {
    /// Reads an address `postgres://…`.
    ///
    /// # Errors
    /// It is invalid.
    pub fn postgres(url: &str) -> Result<Self, UrlError> {
        PostgresUrl::parse(url).map(|url| Self::Postgres(url.into()))
    }

    /// The file of a SQLite database.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Postgres(_) => None,
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Postgres(url) => write!(f, "{url}"),
        }
    }
}

impl<P: AsRef<Path>> From<P> for Location {
    fn from(path: P) -> Self {
        Self::File(path.as_ref().to_owned())
    }
}

impl From<&Self> for Location {
    fn from(location: &Self) -> Self {
        location.clone()
    }
}
