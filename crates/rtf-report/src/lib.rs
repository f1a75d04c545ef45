//! Reporters: each is given every event of a run and shows or keeps what it wants.

use rtf_model::{Event, Record};

/// Is given each event of a run, in order, on one thread.
pub trait Reporter: Send {
    /// Takes in an event. `record` already contains it.
    ///
    /// # Errors
    /// What was to be written could not be written. The run goes on; the
    /// failure is shown at its end and in the exit code.
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError>;

    /// Nothing more is waiting at the moment: a good time to flush.
    ///
    /// # Errors
    /// As for [`Reporter::event`].
    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        Ok(())
    }

    /// The run is over.
    ///
    /// # Errors
    /// As for [`Reporter::event`].
    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        Ok(())
    }
}

/// A report could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {what} to `{path}`")]
pub struct ReportError {
    /// Which report.
    pub what: &'static str,
    /// Where to.
    pub path: std::path::PathBuf,
    /// Why.
    #[source]
    pub source: std::io::Error,
}
