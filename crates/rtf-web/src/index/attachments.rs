//! Names and media types of attachments.

use std::collections::HashMap;

use rtf_model::{Event, EventKind};

/// Names and media types of attachments, by their paths in the run's directory.
#[derive(Debug, Default)]
pub struct AttachmentIndex(HashMap<Box<str>, AttachmentInfo>);

/// The name and media type of an attachment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachmentInfo {
    /// Its name.
    pub name: Box<str>,
    /// Its media type; empty when the test gave none.
    pub media_type: Box<str>,
}

impl AttachmentIndex {
    /// Adds the attachment of an event.
    pub(super) fn take(&mut self, event: &Event) {
        let EventKind::Attached { attachment, .. } = &event.kind else { return };
        let description = AttachmentInfo {
            name: attachment.name.as_str().into(),
            media_type: attachment.media_type.as_str().into(),
        };
        self.0.insert(attachment.path.as_str().into(), description);
    }

    /// The description of the file at this path.
    #[must_use]
    pub fn of(&self, path: &str) -> Option<&AttachmentInfo> {
        self.0.get(path)
    }
}
