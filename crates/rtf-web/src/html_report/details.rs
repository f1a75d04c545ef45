//! The details of one attempt of a test, start of a fixture or run of a hook.

use std::collections::BTreeMap;

use rtf_model::{Event, EventKind, MessageKind};
use serde::Serialize;

use super::attachments::AttachmentFiles;
use super::excerpt::{Entry, Excerpt, Limits};
use crate::views::{
    Asked, Attached, Cases, Measured, Printed, Questions, Said, Signal, SignalList, Stack,
};

const MESSAGES: Limits = Limits { end: 2000, important: 1000 };
const MEASUREMENTS: Limits = Limits { end: 2500, important: 0 };
/// Bytes.
const OUTPUT: Limits = Limits { end: 128 << 10, important: 0 };
/// Bytes of a test that passed.
const OUTPUT_PASSED: Limits = Limits { end: 32 << 10, important: 0 };

impl Entry for Said {
    fn is_important(&self) -> bool {
        matches!(self.message.kind, MessageKind::Failure | MessageKind::Error)
    }
}

impl Entry for Measured {}

impl Entry for Printed {
    fn size(&self) -> usize {
        self.text.len()
    }
}

/// Details while they are read.
pub struct DetailsBuilder {
    messages: Excerpt<Said>,
    measurements: Excerpt<Measured>,
    output: Excerpt<Printed>,
    signals: SignalList,
    attachments: Vec<Attached>,
    stacks: Vec<Stack>,
    questions: Questions,
}

/// Details as the page reads them.
#[derive(Serialize)]
pub struct Details {
    #[serde(skip_serializing_if = "Vec::is_empty")]
    messages: Vec<Said>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    measurements: Vec<Measured>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    series: Vec<Signal>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    attachments: Vec<Attached>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stacks: Vec<Stack>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    questions: Vec<Asked>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    output: Vec<Printed>,
    /// Numbers of omitted entries, by list. Output states its omissions itself.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    omitted: BTreeMap<&'static str, u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cases: Option<Cases>,
}

impl DetailsBuilder {
    /// No details yet; `has_passed`: less output is kept.
    pub fn new(has_passed: bool) -> Self {
        Self {
            messages: Excerpt::new(MESSAGES),
            measurements: Excerpt::new(MEASUREMENTS),
            output: Excerpt::new(if has_passed { OUTPUT_PASSED } else { OUTPUT }),
            signals: SignalList::default(),
            attachments: Vec::new(),
            stacks: Vec::new(),
            questions: Questions::default(),
        }
    }

    /// Adds the detail of an event.
    ///
    /// # Errors
    /// An attachment cannot be read, or cannot be copied.
    pub fn add(&mut self, event: Event, files: &mut AttachmentFiles) -> std::io::Result<()> {
        let (seq, at) = (event.seq, event.at.0);
        match event.kind {
            EventKind::Message { message, .. } => {
                self.messages.add(Said { seq, at, message }, |_, _| ());
            }
            EventKind::Measured { measurement, .. } => {
                self.measurements.add(Measured::of(seq, at, measurement), |_, _| ());
            }
            EventKind::Sampled { samples, .. } => {
                self.signals.add_samples(samples, |samples| samples)
            }
            EventKind::Attached { attachment, .. } => {
                let url = files.url(&attachment)?;
                self.attachments.push(Attached { seq, at, attachment, url });
            }
            EventKind::StackDumped { text, .. } => self.stacks.push(Stack { seq, at, text }),
            EventKind::Output(output) => {
                self.output.add(Printed::of(seq, at, output), |old, next| {
                    let bytes = old.text.len() as u64 + old.omitted_bytes.unwrap_or(0);
                    next.omitted_bytes = Some(next.omitted_bytes.unwrap_or(0) + bytes);
                });
            }
            kind @ (EventKind::QuestionAsked(_) | EventKind::QuestionClosed(_)) => {
                let event = Event { kind, ..event };
                // The page takes the picture from the attachments.
                self.questions.take(event, |_| None);
            }
            _ => {}
        }
        Ok(())
    }

    /// The details, with the cases of an attempt.
    pub fn finish(self, cases: Option<Cases>) -> Details {
        let (messages, omitted_messages) = self.messages.into_entries();
        let (measurements, omitted_measurements) = self.measurements.into_entries();
        let omitted = [("messages", omitted_messages), ("measurements", omitted_measurements)];
        Details {
            messages,
            measurements,
            series: self.signals.into_signals(),
            attachments: self.attachments,
            stacks: self.stacks,
            questions: self.questions.questions,
            output: self.output.into_entries().0,
            omitted: omitted.into_iter().filter(|(_, number)| *number > 0).collect(),
            cases,
        }
    }
}
