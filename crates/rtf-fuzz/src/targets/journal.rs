//! Journals: events, whole journals, and torn ones.

use std::path::Path;
use std::sync::LazyLock;

use rtf_model::{Event, LineSealer, Record, RunState};
use rtf_report::journal::{Stored, parse_event, read_from};
use rtf_report::{junit, tap, text};

/// A line of a journal: both parsers agree, and an event is the same after it is printed.
pub fn check_event(line: &[u8]) {
    let event = parse_event(line).ok();
    let derived =
        std::str::from_utf8(line).ok().and_then(|it| serde_json::from_str::<Event>(it).ok());
    assert_eq!(event, derived, "the parsers disagree");
    let Some(event) = event else { return };
    let printed = serde_json::to_vec(&event).expect("JSON");
    assert_eq!(parse_event(&printed).ok(), Some(event), "after it was printed");
}

/// A journal without check values: with any content, reports can be made from it.
pub fn check(data: &[u8]) {
    let Some(Stored { record, torn }) = read(data) else { return };
    if record.is_green() {
        assert!(!torn && record.damages.is_empty());
        assert_eq!(record.state, RunState::Finished { interrupted: None });
    }
    check_reports(&record);
    // The same lines with check values are the same journal, and their order counts.
    let sealed = seal(data);
    let record = read(&sealed).map(|stored| stored.record);
    if let Some(record) = record {
        check_reports(&record);
    }
}

fn check_reports(record: &Record) {
    let (mut xml, mut lines, mut points) = (Vec::new(), Vec::new(), Vec::new());
    junit::write(&mut xml, record, None).expect("a report in memory");
    text::write(&mut lines, record).expect("a report in memory");
    tap::write(&mut points, record).expect("a report in memory");
    let xml = String::from_utf8(xml).expect("UTF-8");
    if let Err(error) = roxmltree::Document::parse(&xml) {
        panic!("the JUnit report is no XML: {error}\n{xml}");
    }
    for report in [lines, points] {
        let report = String::from_utf8(report).expect("UTF-8");
        let control = report.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
        assert_eq!(control, None, "a report has control characters: {report:?}");
    }
}

fn read(journal: &[u8]) -> Option<Stored> {
    read_from(Path::new("events.jsonl"), journal).ok()
}

/// The lines that are objects, with check values.
fn seal(data: &[u8]) -> Vec<u8> {
    let (mut sealer, mut page) = (LineSealer::default(), Vec::new());
    for line in data.split(|byte| *byte == b'\n') {
        if line.len() > 2 && line.starts_with(b"{") && line.ends_with(b"}") {
            let start = page.len();
            page.extend_from_slice(line);
            sealer.seal(&mut page, start);
        }
    }
    page
}

/// The journal of a green run, and that of a red one.
static JOURNALS: LazyLock<[Vec<u8>; 2]> = LazyLock::new(|| {
    let streams = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rtf-report/tests/streams");
    let journals = ["prepared.jsonl", "crash.jsonl"];
    let journals = journals.map(|name| seal(&std::fs::read(streams.join(name)).expect("a stream")));
    let is_green = |journal: &[u8]| read(journal).expect("a journal").record.is_green();
    assert!(is_green(&journals[0]) && !is_green(&journals[1]));
    journals
});

/// A journal after the changes that the bytes describe: it is green only if it is unchanged.
pub fn check_torn(data: &[u8]) {
    let Some((first, changes)) = data.split_first() else { return };
    let original = &JOURNALS[usize::from(first & 1)];
    let mut journal = original.clone();
    for change in changes.chunks_exact(CHANGE_BYTES).take(8) {
        apply(change, &mut journal);
    }
    let Some(stored) = read(&journal) else { return };
    let is_original_green = first & 1 == 0 && journal == *original;
    assert_eq!(stored.record.is_green(), is_original_green, "after changes");
}

/// The bytes of a change: its kind, two positions, and a byte.
const CHANGE_BYTES: usize = 6;

fn apply(change: &[u8], journal: &mut Vec<u8>) {
    let [kind, a, b, c, d, byte] = *change else { return };
    if journal.is_empty() {
        return;
    }
    let position = |high: u8, low: u8| usize::from(u16::from_be_bytes([high, low]));
    let at = position(a, b) % journal.len();
    let other = position(c, d) % journal.len();
    match kind % 8 {
        0 => journal.truncate(at),
        1 => journal[at] ^= byte,
        2 => journal.insert(at, byte),
        3 => drop(journal.remove(at)),
        4 => journal.swap(at, other),
        5 => drop(journal.drain(at.min(other)..at.max(other))),
        6 => with_lines(journal, |lines| {
            let length = lines.len();
            lines.swap(at % length, other % length);
        }),
        _ => with_lines(journal, |lines| {
            let line = lines[at % lines.len()].clone();
            lines.insert(other % (lines.len() + 1), line);
        }),
    }
}

fn with_lines(journal: &mut Vec<u8>, change: impl FnOnce(&mut Vec<Vec<u8>>)) {
    let mut lines: Vec<Vec<u8>> =
        journal.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    change(&mut lines);
    *journal = lines.concat();
}
