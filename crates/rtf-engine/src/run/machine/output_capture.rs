//! Limits what is reported of a process's output: the head of each stream at once, and
//! its last bytes at the end, with the number of omitted bytes between them.

use std::collections::VecDeque;

use rtf_model::{EventKind, FixtureProvided, Output, Source, Stream};

use super::context::Context;
use crate::fixture_values::FixtureValues;
use crate::log_watch::complete_characters;

/// How many bytes of each stream are reported as they come.
pub const HEAD_BYTES: usize = 256 * 1024;

/// How many bytes of each stream are kept for the end, once the head is full.
pub const TAIL_BYTES: usize = 64 * 1024;

/// The captured output of one process.
#[derive(Debug)]
pub struct OutputCapture([StreamCapture; 2]);

impl OutputCapture {
    pub fn new(source: Source) -> Self {
        Self([Stream::Stdout, Stream::Stderr].map(|stream| StreamCapture::new(source, stream)))
    }

    /// Reports the part of the output that belongs to the head.
    pub fn push(&mut self, stream: Stream, bytes: &[u8], cx: &mut Context<'_>) {
        let output = self.0[stream as usize].push(bytes, cx.values());
        output.into_iter().for_each(|output| cx.emit(EventKind::Output(output)));
    }

    /// Reports the tails: both streams have ended.
    pub fn finish(&mut self, cx: &mut Context<'_>) {
        for capture in &mut self.0 {
            let tail = capture.finish(cx.values());
            tail.into_iter().for_each(|output| cx.emit(EventKind::Output(output)));
        }
    }
}

#[derive(Debug)]
struct StreamCapture {
    source: Source,
    stream: Stream,
    head_left: usize,
    /// The bytes of a character that is not complete yet.
    partial: Vec<u8>,
    tail: VecDeque<u8>,
    omitted: u64,
}

impl StreamCapture {
    fn new(source: Source, stream: Stream) -> Self {
        let (partial, tail) = (Vec::new(), VecDeque::new());
        Self { source, stream, head_left: HEAD_BYTES, partial, tail, omitted: 0 }
    }

    /// The part that is reported now. The begin of a secret waits for the rest.
    fn push(&mut self, bytes: &[u8], values: &FixtureValues) -> Option<Output> {
        let now = bytes.len().min(self.head_left);
        self.head_left -= now;
        self.push_tail(&bytes[now..]);
        if now == 0 {
            return None;
        }
        self.partial.extend_from_slice(&bytes[..now]);
        let mut complete = complete_characters(&self.partial).len();
        complete -= values.secret_start_len(&self.partial[..complete]);
        let rest = self.partial.split_off(complete);
        let text = std::mem::replace(&mut self.partial, rest);
        self.output(0, &text)
    }

    fn push_tail(&mut self, bytes: &[u8]) {
        let bytes = if bytes.len() > TAIL_BYTES {
            self.omitted += (bytes.len() - TAIL_BYTES) as u64;
            &bytes[bytes.len() - TAIL_BYTES..]
        } else {
            bytes
        };
        let excess = (self.tail.len() + bytes.len()).saturating_sub(TAIL_BYTES);
        self.omitted += excess as u64;
        self.tail.drain(..excess);
        self.tail.extend(bytes);
    }

    fn finish(&mut self, values: &FixtureValues) -> Option<Output> {
        let mut text = std::mem::take(&mut self.partial);
        let omitted = std::mem::take(&mut self.omitted);
        let mut tail = Vec::from(std::mem::take(&mut self.tail));
        if omitted > 0 {
            // A secret may be cut at both ends of the gap.
            let cut = [text.len() - values.secret_start_len(&text), values.secret_end_len(&tail)];
            if cut[0] < text.len() {
                text.truncate(cut[0]);
                text.extend_from_slice(FixtureProvided::SECRET.as_bytes());
            }
            if cut[1] > 0 {
                tail.splice(..cut[1], FixtureProvided::SECRET.bytes());
            }
        }
        text.extend(tail);
        self.output(omitted, &text)
    }

    fn output(&self, omitted: u64, text: &[u8]) -> Option<Output> {
        (!text.is_empty()).then(|| Output {
            source: self.source,
            stream: self.stream,
            omitted_bytes: omitted,
            text: String::from_utf8_lossy(text).into_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtf_model::TestId;

    fn none() -> FixtureValues {
        FixtureValues::default()
    }

    fn capture() -> StreamCapture {
        StreamCapture::new(Source::Test(TestId(0)), Stream::Stdout)
    }

    #[test]
    fn a_character_split_between_two_reads_is_kept_whole() {
        let mut capture = capture();
        assert_eq!(capture.push(&[0xC3], &none()), None);
        assert_eq!(capture.push(&[0xA9, b'!'], &none()).map(|o| o.text), Some("é!".to_owned()));
        assert_eq!(capture.finish(&none()), None);
    }

    #[test]
    fn bytes_that_are_not_utf_8_are_replaced_at_once() {
        let mut capture = capture();
        assert_eq!(
            capture.push(&[0xFF, b'a'], &none()).map(|o| o.text),
            Some("\u{FFFD}a".to_owned())
        );
    }

    #[test]
    fn a_flood_keeps_head_and_tail_and_counts_omitted_bytes() {
        let mut capture = capture();
        let total = HEAD_BYTES + 3 * TAIL_BYTES + 5;
        let flood: Vec<u8> = (0..total).map(|i| b'a' + u8::try_from(i % 26).unwrap()).collect();
        let mut text = String::new();
        for piece in flood.chunks(1000) {
            text.extend(capture.push(piece, &none()).map(|o| o.text));
        }
        assert_eq!(text.as_bytes(), &flood[..HEAD_BYTES]);
        let last = capture.finish(&none()).unwrap();
        assert_eq!(last.omitted_bytes as usize, total - HEAD_BYTES - TAIL_BYTES);
        assert_eq!(last.text.as_bytes(), &flood[total - TAIL_BYTES..]);
    }

    #[test]
    fn a_secret_split_between_two_reads_is_held_back_until_it_is_complete() {
        let mut values = FixtureValues::default();
        values.set(0, ("sim", "token"), "s3cret".into(), true);
        let mut capture = capture();
        let mut text = String::new();
        for piece in ["token s3", "cre", "t\ns", "3x"] {
            text.extend(capture.push(piece.as_bytes(), &values).map(|o| values.mask_text(o.text)));
            assert!(!text.contains("s3c") && !text.ends_with('s'), "{text}");
        }
        assert_eq!(text, "token ***\ns3x");
    }

    #[test]
    fn a_secret_cut_by_the_omitted_bytes_is_not_shown_in_parts() {
        let mut values = FixtureValues::default();
        values.set(0, ("sim", "token"), "s3cret".into(), true);
        let mut capture = capture();
        let mut flood = vec![b'.'; HEAD_BYTES - 3];
        flood.extend(b"s3cret");
        flood.extend(vec![b'.'; TAIL_BYTES]);
        flood.extend(b"s3cret");
        flood.extend(vec![b'.'; TAIL_BYTES - 2]);
        let head = capture.push(&flood, &values).unwrap();
        assert!(head.text.ends_with('.'));
        let tail = capture.finish(&values).unwrap();
        assert!(tail.text.starts_with("******."), "{}", &tail.text[..10]);
    }
}
