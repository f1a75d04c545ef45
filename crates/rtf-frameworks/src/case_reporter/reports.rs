//! Reports that belong to a case, or to the test: messages, measurements, attachments, output.

use std::io::Write as _;

use rtf_model::protocol::Notification;
use rtf_model::{Attachment, CaseId, Location, Measurement, Message, MessageKind, Samples};

use super::CaseReporter;

impl CaseReporter<'_> {
    /// Reports a message in the case with this path; without a path, in the innermost open
    /// case; if there is none, of the test.
    pub fn message(
        &mut self,
        path: Option<&str>,
        kind: MessageKind,
        text: impl Into<String>,
        location: Option<Location>,
    ) {
        self.full_message(path, Message::new(kind, text, location));
    }

    /// Reports a message with all its fields, see [`Self::message`].
    pub fn full_message(&mut self, path: Option<&str>, mut message: Message) {
        let is_problem = matches!(message.kind, MessageKind::Failure | MessageKind::Error);
        message.case = self.mark(path, is_problem);
        self.session.forward(&Notification::Message(message));
    }

    /// Reports a measurement, see [`Self::message`].
    pub fn measure(&mut self, path: Option<&str>, mut measurement: Measurement) {
        measurement.case = self.mark(path, !measurement.is_within_limits());
        self.session.forward(&Notification::Measured(measurement));
    }

    /// Reports samples, see [`Self::message`].
    pub fn sample(&mut self, path: Option<&str>, mut samples: Samples) {
        let is_problem = samples.outside().next().is_some();
        samples.case = self.mark(path, is_problem);
        self.session.forward(&Notification::Sampled(samples));
    }

    /// Attaches a copy of a file, see [`Self::message`]. Returns false after an error, which
    /// was reported.
    pub fn attach(&mut self, path: Option<&str>, mut attachment: Attachment) -> bool {
        attachment.case = self.mark(path, false);
        let file = attachment.path.clone();
        match self.session.forward_attachment(attachment) {
            Ok(_) => true,
            Err(error) => {
                let text = format!("`{file}` cannot be attached: {error}");
                self.message(path, MessageKind::Error, text, None);
                false
            }
        }
    }

    /// Reports a property of a case: a measurement if it is a number, else a message.
    pub fn property(&mut self, path: Option<&str>, name: &str, value: &str) {
        match value.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => {
                let (name, value) = (name.to_owned(), Some(number));
                self.measure(path, Measurement { name, value, ..Measurement::default() });
            }
            _ => self.message(path, MessageKind::Report, format!("{name}: {value}"), None),
        }
    }

    /// Passes on output of the program that is not part of its report.
    #[expect(clippy::unused_self, reason = "only readers of reports have output")]
    pub fn output(&mut self, bytes: &[u8]) {
        let mut stdout = std::io::stdout().lock();
        drop(stdout.write_all(bytes).and_then(|()| stdout.flush()));
    }

    /// Passes on text that the program wrote to standard error, if its report contains it.
    #[expect(clippy::unused_self, reason = "only readers of reports have output")]
    pub fn error_output(&mut self, bytes: &[u8]) {
        drop(std::io::stderr().lock().write_all(bytes));
    }

    /// Reports an error of the test, outside of its cases.
    pub fn test_error(&mut self, text: String) {
        let message = Message::new(MessageKind::Error, text, None);
        self.session.forward(&Notification::Message(message));
    }

    /// The case of a report, which may be a problem of it.
    fn mark(&mut self, path: Option<&str>, is_problem: bool) -> Option<CaseId> {
        let path = path.or(self.current.as_deref());
        let open = match path {
            Some(path) => self.open.iter_mut().rfind(|open| open.path == path),
            None => self.open.last_mut(),
        };
        match open {
            Some(open) => {
                open.has_problem |= is_problem;
                Some(open.case)
            }
            None => {
                self.process.has_problem |= is_problem;
                None
            }
        }
    }
}
