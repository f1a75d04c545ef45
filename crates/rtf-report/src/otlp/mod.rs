//! The record of a run as a trace of OpenTelemetry: one OTLP export request in JSON, as
//! `/v1/traces` of a collector and its `otlpjsonfile` receiver accept it. See
//! `spec/reports.md`.

mod attributes;
mod spans;
mod trace;

use std::io::{self, Write};

use rtf_model::Record;
use serde_json::json;

/// Writes the trace of a record that will not change any more.
///
/// # Errors
/// `out` cannot be written, or the record has no first event.
pub fn write(out: &mut dyn Write, record: &Record) -> io::Result<()> {
    let Some(run) = &record.run else {
        return Err(io::Error::other("the run has no first event"));
    };
    let spans = spans::of(record, run);
    let scope = json!({"name": "rtf", "version": run.rtf});
    let request = json!({"resourceSpans": [{
        "resource": {"attributes": attributes::of_resource(run)},
        "scopeSpans": [{"scope": scope, "spans": spans}],
    }]});
    serde_json::to_writer(&mut *out, &request)?;
    writeln!(out)
}
