//! Notifies the server of a live run that the journal has grown. The journal,
//! an earlier reporter, has already written
//! the events.

use rtf_model::{Event, EventKind, Record};
use rtf_report::{ReportError, Reporter};
use tokio::sync::watch;

/// Notifies the server that the journal has grown.
#[derive(Clone, Debug)]
pub struct JournalNotifier {
    pub(crate) grown: watch::Sender<u64>,
}

impl JournalNotifier {
    fn notify(&self, record: &Record) {
        // Never blocks.
        self.grown.send_replace(record.events);
    }
}

impl Reporter for JournalNotifier {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        // While so much happens that the queue is never empty, the journal is
        // flushed soon after the ends of tests.
        if let EventKind::TestFinished(_) = event.kind {
            self.notify(record);
        }
        Ok(())
    }

    fn idle(&mut self, record: &Record) -> Result<(), ReportError> {
        self.notify(record);
        Ok(())
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        self.notify(record);
        Ok(())
    }
}
