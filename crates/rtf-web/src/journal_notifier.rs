//! The reporter of a live run. It writes nothing and keeps nothing: the journal,
//! which comes before it among the reporters, has the events already. It only
//! tells those who follow the journal that there is more.

use rtf_model::{Event, EventKind, Record};
use rtf_report::{ReportError, Reporter};
use tokio::sync::watch;

/// Tells the server that the journal has grown.
#[derive(Clone, Debug)]
pub struct JournalNotifier {
    grown: watch::Sender<u64>,
}

impl JournalNotifier {
    pub(crate) fn new(grown: watch::Sender<u64>) -> Self {
        Self { grown }
    }

    fn tell(&self, record: &Record) {
        // Never waits: whoever listens looks when there is time.
        self.grown.send_replace(record.events);
    }
}

impl Reporter for JournalNotifier {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        // While so much happens that the queue is never empty, the journal is
        // flushed soon after the ends of tests.
        if let EventKind::TestFinished(_) = event.kind {
            self.tell(record);
        }
        Ok(())
    }

    fn idle(&mut self, record: &Record) -> Result<(), ReportError> {
        self.tell(record);
        Ok(())
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        self.tell(record);
        Ok(())
    }
}
