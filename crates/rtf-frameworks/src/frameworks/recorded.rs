//! Replays recorded reports to a reader, for its tests.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::os::unix::net::UnixStream;

use rtf_host::Session;
use rtf_model::ExitStatus;
use serde_json::Value;

use crate::case::CaseResult;
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};

/// The notifications about a report that arrives in pieces of this size, one per line.
/// Cases that are open at the end have crashed.
pub(super) fn replay(
    mut reader: impl ReportReader,
    report: &[u8],
    piece: usize,
    end: ExitStatus,
) -> Result<String, Garbage> {
    let (ours, theirs) = UnixStream::pair().expect("sockets");
    let received = std::thread::spawn(move || {
        let (mut ours, mut text) = (ours, String::new());
        ours.read_to_string(&mut text).map(|_| text)
    });
    let session = Session::over(theirs);
    let mut cases = CaseReporter::new(&session);
    let result = report.chunks(piece).try_for_each(|piece| reader.report(piece, &mut cases));
    let result = result.and_then(|()| reader.finish(end, &mut cases));
    let crashed = CaseResult::new(rtf_model::Outcome::Crashed, "it crashed");
    cases.end_open(&crashed);
    drop(session);
    let text = received.join().expect("a reader").expect("text");
    let lines: Vec<String> = text.lines().map(show).collect();
    result.map(|()| lines.join("\n"))
}

/// The method and the parameters of a notification.
fn show(line: &str) -> String {
    let message: Value = serde_json::from_str(line).expect("JSON");
    let method = message["method"].as_str().expect("a method");
    format!("{method} {}", sorted(message["params"].clone()))
}

/// The value with the fields of objects in alphabetical order: that of `serde_json` depends
/// on the features that other crates of a build select.
fn sorted(value: Value) -> Value {
    match value {
        Value::Object(fields) => {
            let fields: BTreeMap<String, Value> = fields.into_iter().collect();
            fields.into_iter().map(|(name, value)| (name, sorted(value))).collect()
        }
        Value::Array(values) => values.into_iter().map(sorted).collect(),
        other => other,
    }
}

/// Checks that the size of the pieces does not matter, and returns the notifications.
pub(super) fn replay_in_pieces<R: ReportReader>(
    reader: impl Fn() -> R,
    report: &[u8],
    end: ExitStatus,
) -> String {
    let whole = replay(reader(), report, report.len(), end).expect("a good report");
    for piece in [1, 7, 1000] {
        let pieces = replay(reader(), report, piece, end).expect("a good report");
        assert_eq!(pieces, whole, "pieces of {piece} bytes");
    }
    whole
}
