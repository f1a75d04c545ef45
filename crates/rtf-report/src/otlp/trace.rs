//! A trace: its id, its times, and its spans while they are collected.

use jiff::Timestamp;
use rtf_model::{Micros, RunStarted};
use serde_json::{Value, json};

use super::attributes::Attributes;
use crate::fnv;

/// More events of a span are counted: collectors and their stores limit the size of a span.
const EVENTS: usize = 128;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Status {
    /// Neither good nor bad: skipped.
    Unset,
    /// As expected.
    Ok,
    /// A problem, and its reason.
    Error(String),
}

#[derive(Debug)]
pub struct Span {
    pub name: String,
    /// The number of the span that contains it.
    pub parent: Option<u64>,
    pub start: Micros,
    pub end: Micros,
    pub attributes: Attributes,
    pub status: Status,
    /// Time, name and attributes, the most important ones first.
    pub events: Vec<(Micros, &'static str, Attributes)>,
}

/// A trace while its spans are collected.
#[derive(Debug)]
pub struct Trace {
    id: String,
    /// When the run started, in nanoseconds since 1970.
    epoch: u64,
    pub spans: Vec<Value>,
}

impl Trace {
    /// The trace of a run: the same id each time.
    pub fn new(run: &RunStarted) -> Self {
        let started = run.started_at.parse::<Timestamp>().unwrap_or_default();
        let epoch = u64::try_from(started.as_nanosecond()).unwrap_or(0);
        Self { id: trace_id(run), epoch, spans: Vec::new() }
    }

    /// Adds a span; returns its number.
    pub fn add(&mut self, span: Span) -> u64 {
        let number = self.spans.len() as u64 + 1;
        let Span { name, parent, start, end, attributes, status, mut events } = span;
        let dropped = events.len().saturating_sub(EVENTS);
        events.truncate(EVENTS);
        events.sort_by_key(|(at, _, _)| *at);
        let event = |(at, name, attributes): (Micros, &str, Attributes)| json!({"timeUnixNano": self.nanos(at), "name": name, "attributes": attributes});
        let events: Vec<_> = events.into_iter().map(event).collect();
        let mut json = json!({
            "traceId": self.id,
            "spanId": span_id(number),
            "name": name,
            "kind": 1,
            "startTimeUnixNano": self.nanos(start),
            "endTimeUnixNano": self.nanos(end.max(start)),
            "attributes": attributes,
            "events": events,
            "droppedEventsCount": dropped,
            "status": status_json(status),
        });
        if let Some(parent) = parent {
            json["parentSpanId"] = span_id(parent).into();
        }
        self.spans.push(json);
        number
    }

    fn nanos(&self, at: Micros) -> String {
        self.epoch.saturating_add(at.0.saturating_mul(1000)).to_string()
    }
}

fn status_json(status: Status) -> Value {
    match status {
        Status::Unset => json!({}),
        Status::Ok => json!({"code": 1}),
        Status::Error(message) => json!({"code": 2, "message": message}),
    }
}

/// Spans of one trace are numbered; zero is no id.
fn span_id(number: u64) -> String {
    format!("{number:016x}")
}

/// The id of the run, which is a UUID; of old journals and merged runs, a hash of the name.
fn trace_id(run: &RunStarted) -> String {
    let origin = run.manifest.origin.as_ref().map_or("", |origin| origin.id.as_str());
    let digits: String = origin.chars().filter(char::is_ascii_hexdigit).collect();
    let is_valid = digits.len() == 32 && digits.bytes().any(|digit| digit != b'0');
    if is_valid {
        digits.to_ascii_lowercase()
    } else {
        format!("{:032x}", fnv::hash(run.run.as_bytes()))
    }
}
