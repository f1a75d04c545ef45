//! Attributes: names of OpenTelemetry's semantic conventions where there is one, otherwise
//! `rtf.…`.

use rtf_model::{
    FaultRecord, Measurement, Message, MessageKind, RunStarted, SignalSummary, Verdict,
};
use serde::Serialize;
use serde_json::{Value, json};

/// Attributes while they are collected.
#[derive(Debug, Default, Serialize)]
pub struct Attributes(Vec<Value>);

impl Attributes {
    /// Adds a text, unless it is empty.
    pub fn text(mut self, key: &str, value: &str) -> Self {
        if !value.is_empty() {
            self.0.push(json!({"key": key, "value": {"stringValue": value}}));
        }
        self
    }

    pub fn whole(mut self, key: &str, value: u64) -> Self {
        // 64-bit numbers are strings in the JSON of protobuf.
        self.0.push(json!({"key": key, "value": {"intValue": value.to_string()}}));
        self
    }

    /// Adds a number, if it is finite.
    pub fn number(mut self, key: &str, value: Option<f64>) -> Self {
        if let Some(value) = value.filter(|value| value.is_finite()) {
            self.0.push(json!({"key": key, "value": {"doubleValue": value}}));
        }
        self
    }

    pub fn flag(mut self, key: &str, value: bool) -> Self {
        self.0.push(json!({"key": key, "value": {"boolValue": value}}));
        self
    }
}

/// The attributes of what produced the trace.
pub fn of_resource(run: &RunStarted) -> Attributes {
    let host = run.manifest.origin.as_ref().map_or("", |origin| origin.host.as_str());
    Attributes::default()
        .text("service.name", "rtf")
        .text("service.version", &run.rtf)
        .text("host.name", host)
}

/// The sources, machine and job of a run.
pub fn of_run(run: &RunStarted) -> Attributes {
    let revision = run.manifest.revision.as_ref();
    let branch = revision.and_then(|revision| revision.branch.as_deref());
    let job = run.manifest.origin.as_ref().and_then(|origin| origin.ci_job.as_deref());
    Attributes::default()
        .text("rtf.run", &run.run)
        .text("rtf.profile", run.manifest.profile.as_deref().unwrap_or_default())
        .text("vcs.ref.head.revision", revision.map_or("", |revision| &revision.commit))
        .text("vcs.ref.head.name", branch.unwrap_or_default())
        .text("cicd.pipeline.run.url.full", job.unwrap_or_default())
}

/// The status of a test or case by the semantic conventions, which know only two; skipped
/// and unfinished ones have none.
pub fn result_status(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "pass",
        Verdict::Skipped | Verdict::Interrupted => "",
        _ => "fail",
    }
}

/// A measurement, for an event.
pub fn of_measurement(measurement: &Measurement) -> Attributes {
    Attributes::default()
        .text("rtf.name", &measurement.name)
        .number("rtf.value", measurement.value)
        .text("rtf.unit", &measurement.unit)
        .number("rtf.low", measurement.low)
        .number("rtf.high", measurement.high)
}

pub fn of_fault(record: &FaultRecord) -> Attributes {
    let fault = &record.fault;
    Attributes::default()
        .text("rtf.fault", &fault.name)
        .text("rtf.fault.kind", fault.kind.as_str())
        .text("rtf.fault.effect", &fault.effect)
}

/// A signal in numbers, for an event.
pub fn of_signal(signal: &SignalSummary) -> Attributes {
    Attributes::default()
        .text("rtf.name", &signal.name)
        .text("rtf.unit", &signal.unit)
        .whole("rtf.count", signal.count)
        .number("rtf.min", signal.min)
        .number("rtf.mean", signal.mean)
        .number("rtf.max", signal.max)
        .number("rtf.low", signal.low)
        .number("rtf.high", signal.high)
        .whole("rtf.outside", signal.outside)
}

/// A message, for an event: its name and its attributes.
pub fn of_message(message: &Message) -> (&'static str, Attributes) {
    let name = match message.kind {
        MessageKind::Failure => "failure",
        MessageKind::Error => "error",
        _ => "report",
    };
    let attributes = Attributes::default().text("rtf.text", &message.text);
    let attributes = match &message.location {
        Some(at) => {
            attributes.text("code.file.path", &at.file).whole("code.line.number", at.line.into())
        }
        None => attributes,
    };
    (name, attributes)
}
