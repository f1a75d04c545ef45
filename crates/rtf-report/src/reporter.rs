//! What every reporter has in common.

use std::path::{Path, PathBuf};

use rtf_model::{Event, Record};

/// Is given each event of a run, in order, on one thread.
pub trait Reporter: Send {
    /// Takes in an event. `record` already contains it.
    ///
    /// # Errors
    /// The report cannot be written. The run continues without
    /// this reporter; the others are notified at once, and the failure is shown at
    /// its end and in the exit code.
    fn event(&mut self, _event: &Event, _record: &Record) -> Result<(), ReportError> {
        Ok(())
    }

    /// Nothing more is waiting at the moment: a good time to flush.
    ///
    /// # Errors
    /// As for [`Reporter::event`].
    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        Ok(())
    }

    /// Another reporter could not write, and is given nothing more.
    fn reporter_failed(&mut self, _error: &ReportError) {}

    /// No event will follow: the run has ended, or its stream ended early.
    ///
    /// # Errors
    /// As for [`Reporter::event`].
    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        Ok(())
    }
}

#[derive(Debug, thiserror::Error)]
#[error("cannot write {what} to `{}`", path.display())]
pub struct ReportError {
    pub what: &'static str,
    pub path: PathBuf,
    #[source]
    pub source: std::io::Error,
}

impl ReportError {
    /// Names the report and its place: for `map_err`.
    pub(crate) fn at<'a>(
        what: &'static str,
        path: &'a Path,
    ) -> impl FnOnce(std::io::Error) -> Self + use<'a> {
        move |source| Self { what, path: path.to_owned(), source }
    }
}
