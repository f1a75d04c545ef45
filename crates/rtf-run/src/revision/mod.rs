//! The Git revision of the sources in a directory.

mod files;
mod git;

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use rtf_model::Revision;

use git::GitQuery;

/// A directory relative to the root of its repository, if it is in one.
pub fn dir_in_repository(dir: &Path) -> Option<String> {
    files::find(dir)?.dir
}

/// The default branch of a directory's repository, if it was cloned.
pub fn default_branch(dir: &Path) -> Option<String> {
    files::default_branch(dir)
}

/// Finds out the revision. Git, if it is installed, runs during the planning.
#[derive(Debug)]
pub struct RevisionQuery {
    dir: PathBuf,
    git: RefCell<Option<GitQuery>>,
}

impl RevisionQuery {
    /// Starts Git if the directory belongs to a repository.
    pub fn start(dir: &Path) -> Self {
        let git = files::find(dir).and_then(|revision| GitQuery::start(dir, &revision.commit));
        Self { dir: dir.to_owned(), git: RefCell::new(git) }
    }

    /// The revision that is checked out now.
    pub fn finish(&self) -> Option<Revision> {
        let revision = files::find(&self.dir)?;
        let answer = self.git.take().filter(|git| git.commit == revision.commit);
        let answer = answer.map(GitQuery::finish).unwrap_or_default();
        Some(Revision { dirty: answer.dirty, author_time: answer.author_time, ..revision })
    }
}
