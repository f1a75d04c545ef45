//! The rule of every SDK: the first failure or error decides.

use rtf_model::protocol::Answer;
use rtf_model::{Measurement, Message, MessageKind, Outcome};

/// What is known so far about the request that is being carried out.
#[derive(Clone, Debug, Default)]
pub(crate) struct Judge {
    /// Whether a failure means that the bench is wrong: in the set-up and
    /// tear-down of a test, and in those of a fixture.
    pub(crate) failures_are_errors: bool,
    first: Option<Answer>,
}

impl Judge {
    pub(crate) fn note_message(&mut self, message: &Message) {
        match message.kind {
            MessageKind::Failure => self.note_failure(&message.text),
            MessageKind::Error => self.note(Outcome::Error, &message.text),
            MessageKind::Report | MessageKind::Check => {}
        }
    }

    pub(crate) fn note_measurement(&mut self, measurement: &Measurement) {
        if !measurement.is_within_limits() {
            let Measurement { name, .. } = measurement;
            let (value, limits) = (measurement.value_with_unit(), measurement.limits());
            let text = match limits.as_str() {
                "" => format!("{name}: {value}"),
                limits => format!("{name}: {value} is outside {limits}"),
            };
            self.note_failure(&text);
        }
    }

    pub(crate) fn note_failure(&mut self, text: &str) {
        let outcome = if self.failures_are_errors { Outcome::Error } else { Outcome::Failed };
        self.note(outcome, text);
    }

    pub(crate) fn note(&mut self, outcome: Outcome, reason: &str) {
        self.first.get_or_insert_with(|| answer(outcome, Some(reason.to_owned())));
    }

    pub(crate) fn all_holds(&self) -> bool {
        self.first.is_none()
    }

    pub(crate) fn answer(&mut self) -> Answer {
        let passed = || answer(Outcome::Passed, None);
        std::mem::take(self).first.unwrap_or_else(passed)
    }
}

fn answer(outcome: Outcome, reason: Option<String>) -> Answer {
    Answer { outcome, reason, subscriptions: Vec::new(), continues: false }
}
