//! Reads an event from its line. Nine of ten lines of a long journal are messages,
//! measurements and outputs; these are read without the detour over an untyped
//! value that [`Event`]'s own way of reading takes, in a third of the time.

use rtf_model::{
    Event, EventKind, FixtureId, Measurement, Message, Micros, Output, Samples, Source, Stream,
    TestId,
};
use serde::Deserialize;

/// The fields of the frequent kinds, side by side. The others are read elsewhere.
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

/// Reads an event.
///
/// # Errors
/// The line is none.
pub fn event(line: &[u8]) -> serde_json::Result<Event> {
    // A kind of event may use one of these names otherwise: then this is none of them.
    let frequent = serde_json::from_slice::<Frequent>(line).ok().and_then(Frequent::into_event);
    frequent.map_or_else(|| serde_json::from_slice(line), Ok)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both ways read the same, of every kind that the stored streams have.
    #[test]
    fn frequent_kinds_are_read_as_all_others() {
        let streams = concat!(env!("CARGO_MANIFEST_DIR"), "/../rtf-report/tests/streams");
        let mut frequent = 0;
        for file in std::fs::read_dir(streams).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "jsonl") {
                continue;
            }
            for line in std::fs::read_to_string(&path).unwrap().lines() {
                let wanted = serde_json::from_str::<Event>(line).ok();
                assert_eq!(event(line.as_bytes()).ok(), wanted, "{line}");
                let fast = serde_json::from_str::<Frequent>(line).ok();
                frequent += u32::from(fast.and_then(Frequent::into_event).is_some());
            }
        }
        assert!(frequent > 10, "only {frequent} events of the frequent kinds");
    }
}
