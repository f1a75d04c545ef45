//! Results of a program that the host started, which runs the test or its cases.

use rtf_model::protocol::Notification;
use rtf_model::{MessageKind, Outcome};

use super::Session;

impl Session {
    /// Sends a notification about a program that the host started. The caller numbers the
    /// cases, and sends nothing about cases after a stop request. Returns false if it is
    /// too long to be sent.
    pub fn forward(&self, notification: &Notification) -> bool {
        let problem = match notification {
            Notification::Message(message) => match message.kind {
                MessageKind::Failure => Some(Outcome::Failed),
                MessageKind::Error => Some(Outcome::Error),
                MessageKind::Report | MessageKind::Check => None,
            },
            Notification::Measured(value) if !value.is_within_limits() => Some(Outcome::Failed),
            Notification::Sampled(samples) => {
                samples.outside().next().is_some().then_some(Outcome::Failed)
            }
            _ => None,
        };
        if let Some(outcome) = problem {
            self.record_reported(outcome);
        }
        if let Notification::Message(_) = notification {
            // A long message is sent in parts.
            self.notify(notification);
            return true;
        }
        self.flush();
        self.0.writer.send(None, notification)
    }

    /// Records the result of the test that no message or case reports. The first problem
    /// has precedence over later ones, and a problem over a skip.
    pub fn record_result(&self, outcome: Outcome, reason: &str) {
        match outcome {
            Outcome::Passed => {}
            Outcome::Skipped => self.state().outcome.skip(reason),
            outcome => self.record(outcome, reason),
        }
    }
}
