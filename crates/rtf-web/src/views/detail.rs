//! What one attempt, start or run reported and printed, page by page.

use rtf_model::{Attachment, Measurement, Message, Output, Stream};
use serde::Serialize;
use utoipa::ToSchema;

use super::model;

/// A message.
#[derive(Debug, Serialize, ToSchema)]
pub struct Said {
    /// The number of the event.
    pub seq: u64,
    /// When.
    pub at: u64,
    /// The message.
    #[schema(value_type = model::Message)]
    pub message: Message,
}

/// A measurement.
#[derive(Debug, Serialize, ToSchema)]
pub struct Measured {
    /// The number of the event.
    pub seq: u64,
    /// When.
    pub at: u64,
    /// The measurement.
    #[schema(value_type = model::Measurement)]
    pub measurement: Measurement,
    /// Whether it lies within its limits.
    pub within: bool,
}

impl Measured {
    /// A measurement, judged.
    pub fn of(seq: u64, at: u64, measurement: Measurement) -> Self {
        let within = measurement.is_within_limits();
        Self { seq, at, measurement, within }
    }
}

/// An attached file.
#[derive(Debug, Serialize, ToSchema)]
pub struct Attached {
    /// The number of the event.
    pub seq: u64,
    /// When.
    pub at: u64,
    /// The file.
    #[schema(value_type = model::Attachment)]
    pub attachment: Attachment,
    /// Where this server has it.
    pub url: String,
}

/// A stack dump.
#[derive(Debug, Serialize, ToSchema)]
pub struct Stack {
    /// The number of the event.
    pub seq: u64,
    /// When.
    pub at: u64,
    /// The stacks of all threads.
    pub text: String,
}

/// A piece of a test's output.
#[derive(Debug, Serialize, ToSchema)]
pub struct Printed {
    /// The number of the event.
    pub seq: u64,
    /// When.
    pub at: u64,
    /// Where to.
    #[schema(value_type = model::Stream)]
    pub stream: Stream,
    /// Bytes left out just before the text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub omitted_bytes: Option<u64>,
    /// The text.
    pub text: String,
}

impl Printed {
    /// A piece of output.
    pub fn of(seq: u64, at: u64, output: Output) -> Self {
        let omitted_bytes = Some(output.omitted_bytes).filter(|omitted| *omitted > 0);
        Self { seq, at, stream: output.stream, omitted_bytes, text: output.text }
    }
}

macro_rules! page {
    ($(#[$doc:meta])* $name:ident, $list:ident: $item:ident) => {
        $(#[$doc])*
        #[derive(Debug, Serialize, ToSchema)]
        pub struct $name {
            /// The entries, in order.
            pub $list: Vec<$item>,
            /// The `after` of the next page.
            #[serde(skip_serializing_if = "Option::is_none")]
            pub next: Option<u64>,
        }
    };
}

page!(
    /// A page of messages.
    Messages, messages: Said
);
page!(
    /// A page of measurements.
    Measurements, measurements: Measured
);
page!(
    /// A page of attached files.
    Attachments, attachments: Attached
);
page!(
    /// A page of stack dumps.
    Stacks, stacks: Stack
);
page!(
    /// A page of a test's output.
    OutputPage, output: Printed
);
