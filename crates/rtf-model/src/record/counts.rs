//! How much an attempt reported; also counted where the reports are not kept.

use crate::{EventKind, MessageKind};

/// How much an attempt reported, whether it was kept or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AttemptCounts {
    /// Messages of all kinds.
    pub messages: u64,
    /// Failures and errors among them.
    pub failures: u64,
    /// Measurements.
    pub measurements: u64,
    /// Samples of signals.
    pub samples: u64,
    /// Measurements and samples outside their limits.
    pub violations: u64,
    /// Attached files.
    pub attachments: u64,
    /// Printed bytes, without omitted ones.
    pub output_bytes: u64,
}

impl AttemptCounts {
    pub(super) fn count(&mut self, kind: &EventKind) {
        match kind {
            EventKind::Message { message, .. } => {
                self.messages += 1;
                let fails = matches!(message.kind, MessageKind::Failure | MessageKind::Error);
                self.failures += u64::from(fails);
            }
            EventKind::Measured { measurement, .. } => {
                self.measurements += 1;
                self.violations += u64::from(!measurement.is_within_limits());
            }
            EventKind::Sampled { samples, .. } => {
                self.samples += samples.points.len() as u64;
                self.violations += samples.outside().count() as u64;
            }
            EventKind::Attached { .. } => self.attachments += 1,
            EventKind::Output(output) => self.output_bytes += output.text.len() as u64,
            _ => {}
        }
    }
}

impl std::ops::AddAssign for AttemptCounts {
    fn add_assign(&mut self, other: Self) {
        self.messages += other.messages;
        self.failures += other.failures;
        self.measurements += other.measurements;
        self.samples += other.samples;
        self.violations += other.violations;
        self.attachments += other.attachments;
        self.output_bytes += other.output_bytes;
    }
}

/// Whether a lean record only counts this event.
pub(super) fn is_detail(kind: &EventKind) -> bool {
    matches!(
        kind,
        EventKind::Message { .. }
            | EventKind::Measured { .. }
            | EventKind::Sampled { .. }
            | EventKind::Attached { .. }
            | EventKind::Output(_)
            | EventKind::StackDumped { .. }
    )
}
