//! Reads events from the lines of a journal.
//!
//! Nine of ten lines of a long journal are messages, measurements, samples and output.
//! They are parsed without the intermediate untyped value of [`Event`]'s derived
//! implementation, which takes a third of the time.

use rtf_model::{
    Event, EventKind, FixtureId, Measurement, Message, Micros, Output, Samples, Source, Stream,
    TestId,
};
use serde::Deserialize;

/// The fields of all frequent kinds.
#[derive(Deserialize)]
struct Frequent {
    seq: u64,
    at: Micros,
    #[serde(rename = "type")]
    kind: Box<str>,
    source: Option<Source>,
    test: Option<TestId>,
    fixture: Option<FixtureId>,
    message: Option<Message>,
    measurement: Option<Measurement>,
    samples: Option<Samples>,
    stream: Option<Stream>,
    #[serde(default)]
    omitted_bytes: u64,
    text: Option<String>,
}

impl Frequent {
    fn into_event(self) -> Option<Event> {
        let kind = match &*self.kind {
            "message" => {
                let (source, message) = (self.source?, self.message?);
                EventKind::Message { source, message, test: self.test }
            }
            "measured" => {
                let (test, measurement) = (self.test?, self.measurement?);
                EventKind::Measured { test, fixture: self.fixture, measurement }
            }
            "sampled" => EventKind::Sampled { test: self.test?, samples: self.samples? },
            "output" => {
                let (source, stream, text) = (self.source?, self.stream?, self.text?);
                EventKind::Output(Output {
                    source,
                    stream,
                    omitted_bytes: self.omitted_bytes,
                    text,
                })
            }
            _ => return None,
        };
        Some(Event { seq: self.seq, at: self.at, kind })
    }
}

/// Parses the event of a line.
///
/// # Errors
/// The line is not an event.
pub fn parse_event(line: &[u8]) -> serde_json::Result<Event> {
    // Otherwise an unknown field that is not UTF-8 would be skipped.
    let text = str::from_utf8(line).map_err(|_| serde::de::Error::custom("it is not UTF-8"))?;
    // Another kind of event may use a field name with another type: then parse it as usual.
    let frequent = serde_json::from_str::<Frequent>(text).ok().and_then(Frequent::into_event);
    frequent.map_or_else(|| serde_json::from_str(text), Ok)
}

/// The fields that decide whether an event is needed, without parsing the rest.
#[derive(Debug, Deserialize)]
pub struct EventHeader {
    pub seq: u64,
    /// When it happened, in microseconds since the run started.
    pub at: u64,
    #[serde(rename = "type")]
    pub kind: Box<str>,
    source: Option<Source>,
    test: Option<TestId>,
}

impl EventHeader {
    /// The source of a detail: a message, a measurement, samples, an attachment, output,
    /// a stack dump, leaked processes or a case.
    #[must_use]
    pub fn detail_source(&self) -> Option<Source> {
        match &*self.kind {
            // A fixture's report about a test belongs to the test.
            "message" => self.test.map(Source::Test).or(self.source),
            "output" | "stack-dumped" | "processes-leaked" => self.source,
            "measured" | "sampled" | "attached" | "cases-planned" | "case-started"
            | "case-finished" => self.test.map(Source::Test),
            _ => None,
        }
    }

    /// The test that asks a question, or whose question ends. These events are no details: each
    /// reader of a running run gets them.
    #[must_use]
    pub fn questioner(&self) -> Option<Source> {
        let is_question = matches!(&*self.kind, "question-asked" | "question-closed");
        self.test.filter(|_| is_question).map(Source::Test)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_field_that_is_not_utf8_is_no_event() {
        let line = br#"{"seq":1,"at":2,"type":"output","source":{"test":0},"stream":"stdout","text":"a","new":{"?":1}}"#;
        assert!(parse_event(line).is_ok());
        let damaged: Vec<u8> =
            line.iter().map(|byte| if *byte == b'?' { 0xcd } else { *byte }).collect();
        assert!(parse_event(&damaged).is_err());
    }

    #[test]
    fn both_parsers_agree_on_all_stored_streams() {
        let streams = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/streams");
        let mut frequent = 0;
        for file in std::fs::read_dir(streams).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "jsonl") {
                continue;
            }
            for line in std::fs::read_to_string(&path).unwrap().lines() {
                let wanted = serde_json::from_str::<Event>(line).ok();
                assert_eq!(parse_event(line.as_bytes()).ok(), wanted, "{line}");
                let fast = serde_json::from_str::<Frequent>(line).ok();
                frequent += u32::from(fast.and_then(Frequent::into_event).is_some());
            }
        }
        assert!(frequent > 10, "only {frequent} events of the frequent kinds");
    }
}
