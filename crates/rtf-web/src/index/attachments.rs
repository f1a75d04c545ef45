//! Names and media types of attachments.

use std::collections::HashMap;

use rtf_model::{Attachment, Event, EventKind, Record, TestId, TestRecord};
use rtf_report::console::is_recording;

/// Names and media types of attachments, by their paths in the run's directory, and which of them
/// are recordings.
#[derive(Debug, Default)]
pub struct AttachmentIndex {
    files: HashMap<Box<str>, AttachmentInfo>,
    /// The first recording of each attempt.
    recordings: HashMap<AttemptKey, Box<str>>,
}

/// The test, the repetition and the attempt.
type AttemptKey = (TestId, u32, u32);

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachmentInfo {
    pub name: Box<str>,
    /// Its media type; empty when the test gave none.
    pub media_type: Box<str>,
}

impl AttachmentInfo {
    pub fn of(attachment: &Attachment) -> Self {
        let Attachment { name, media_type, .. } = attachment;
        Self { name: name.as_str().into(), media_type: media_type.as_str().into() }
    }
}

impl AttachmentIndex {
    /// Adds the attachment of an event, which the record contains.
    pub(super) fn take(&mut self, event: &Event, record: &Record) {
        let EventKind::Attached { test, attachment, .. } = &event.kind else { return };
        let attempt = record.tests.get(test.index()).and_then(|test| test.attempts.last());
        if let Some(attempt) = attempt.filter(|_| is_recording(attachment)) {
            let key = (*test, attempt.repetition, attempt.attempt);
            self.recordings.entry(key).or_insert_with(|| attachment.path.as_str().into());
        }
        self.files.insert(attachment.path.as_str().into(), AttachmentInfo::of(attachment));
    }

    /// The recording of the attempt that decided about a test.
    pub(crate) fn recording(&self, test: &TestRecord) -> Option<&str> {
        let attempt = test.decisive_attempt()?;
        let key = (test.plan.test, attempt.repetition, attempt.attempt);
        self.recordings.get(&key).map(|path| &**path)
    }

    #[must_use]
    pub fn of(&self, path: &str) -> Option<&AttachmentInfo> {
        self.files.get(path)
    }
}
