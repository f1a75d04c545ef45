//! Searches the output of a process for patterns, and keeps its last lines.
//!
//! A line ends with `\n` or `\r`: what follows a `\r` overwrites the line, as on a terminal, and
//! only the last state of such a line is kept. Patterns are tried on the text without escape
//! sequences, and on the text itself. A line without an end, such as a prompt, is tried by
//! [`LogWatch::try_unfinished`]: a match at its end counts only if nothing follows.

use std::collections::VecDeque;
use std::time::Duration;

use regex::Regex;
use rtf_model::{Stream, explain_failure, plain_text};

/// How many of the last lines a failure report contains.
const TAIL_LINES: usize = 50;

/// A longer line is searched in pieces.
const LINE_BYTES: usize = 64 * 1024;

/// The interval at which an unfinished line is tried.
pub const UNFINISHED_INTERVAL: Duration = Duration::from_millis(200);

/// The buffers of programs have a multiple of this size. What is written when one is full ends
/// anywhere, also within a value.
const BUFFER_BYTES: u64 = 1024;

#[derive(Debug, Default)]
pub struct LogWatch {
    /// Those of standard output and standard error.
    lines: [OpenLine; 2],
    tail: VecDeque<String>,
    awaited: Vec<Regex>,
    forbidden: Vec<Regex>,
    forbidden_line: Option<String>,
    /// The values that no line has provided yet; the first group of the pattern is the value.
    values: Vec<(String, Regex)>,
    found: Vec<(String, String)>,
}

/// The line of a stream that has no end yet.
#[derive(Debug, Default)]
struct OpenLine {
    bytes: Vec<u8>,
    /// The text before the last `\r` of the line.
    overwritten: Option<String>,
    /// The number of bytes of the stream, and what it was when the line was last tried.
    printed: u64,
    tried: u64,
    /// Whether the line was tried after nothing had followed for an interval.
    is_settled: bool,
}

/// What is known of the end of a tried text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineEnd {
    /// Nothing can follow.
    Complete,
    /// Nothing has followed for an interval.
    Quiet,
    /// As before, but a full buffer was written: the rest of a value may be in the next one.
    Cut,
    /// Anything may follow.
    Open,
}

impl LogWatch {
    pub fn new(awaited: Vec<Regex>, forbidden: Vec<Regex>, values: Vec<(String, Regex)>) -> Self {
        Self { awaited, forbidden, values, ..Self::default() }
    }

    pub fn push(&mut self, stream: Stream, bytes: &[u8]) {
        let index = stream as usize;
        self.lines[index].printed += bytes.len() as u64;
        self.lines[index].is_settled &= bytes.is_empty();
        for piece in bytes.split_inclusive(|byte| matches!(byte, b'\n' | b'\r')) {
            let line = &mut self.lines[index];
            match piece {
                [text @ .., b'\n'] => {
                    line.bytes.extend_from_slice(text);
                    self.end_line(index);
                }
                [text @ .., b'\r'] => {
                    line.bytes.extend_from_slice(text);
                    self.overwrite_line(index);
                }
                text => {
                    line.bytes.extend_from_slice(text);
                    if line.bytes.len() > LINE_BYTES {
                        self.end_line(index);
                    }
                }
            }
        }
    }

    /// The output has ended, perhaps without a line break.
    pub fn finish(&mut self) {
        for index in 0..self.lines.len() {
            if !self.lines[index].bytes.is_empty() || self.lines[index].overwritten.is_some() {
                self.end_line(index);
            }
        }
    }

    fn end_line(&mut self, index: usize) {
        let line = &mut self.lines[index];
        let bytes = std::mem::take(&mut line.bytes);
        let overwritten = line.overwritten.take();
        let kept = match overwritten {
            // It was tried at its `\r`.
            Some(text) if bytes.is_empty() => text,
            _ => self.try_text(&String::from_utf8_lossy(&bytes), LineEnd::Complete),
        };
        if self.tail.len() == TAIL_LINES {
            self.tail.pop_front();
        }
        self.tail.push_back(kept);
    }

    fn overwrite_line(&mut self, index: usize) {
        let bytes = std::mem::take(&mut self.lines[index].bytes);
        if !bytes.is_empty() {
            let text = self.try_text(&String::from_utf8_lossy(&bytes), LineEnd::Complete);
            self.lines[index].overwritten = Some(text);
        }
    }

    /// Tries all patterns; returns the text without escape sequences.
    fn try_text(&mut self, text: &str, end: LineEnd) -> String {
        let plain = plain_text(text);
        let texts = [plain.as_ref(), text];
        let texts = &texts[..if plain == text { 1 } else { 2 }];
        let matches = |pattern: &Regex| texts.iter().any(|text| is_match(pattern, text, end));
        self.awaited.retain(|pattern| !matches(pattern));
        self.values.retain(|(name, pattern)| {
            let value = texts.iter().find_map(|text| value(pattern, text, end));
            self.found.extend(value.map(|value| (name.clone(), value.to_owned())));
            value.is_none()
        });
        // The line is reported: a value in it may be a secret, which must be known before.
        let may_report = end == LineEnd::Complete || self.values.is_empty();
        if may_report && self.forbidden_line.is_none() && self.forbidden.iter().any(matches) {
            self.forbidden_line = Some(plain.clone().into_owned());
        }
        plain.into_owned()
    }

    /// Whether a line has no end, and [`LogWatch::try_unfinished`] might find something in it.
    pub fn has_unfinished(&self) -> bool {
        let is_sought =
            !(self.awaited.is_empty() && self.forbidden.is_empty() && self.values.is_empty());
        is_sought && self.lines.iter().any(|line| !line.bytes.is_empty() && !line.is_settled)
    }

    /// Tries the lines that have no end yet. To be called at [`UNFINISHED_INTERVAL`] while
    /// [`LogWatch::has_unfinished`].
    pub fn try_unfinished(&mut self) {
        for index in 0..self.lines.len() {
            let line = &mut self.lines[index];
            line.is_settled = line.tried == line.printed;
            line.tried = line.printed;
            let end = match line.is_settled {
                true if line.printed.is_multiple_of(BUFFER_BYTES) => LineEnd::Cut,
                true => LineEnd::Quiet,
                false => LineEnd::Open,
            };
            if !line.bytes.is_empty() {
                let text = String::from_utf8_lossy(complete_characters(&line.bytes)).into_owned();
                self.try_text(&text, end);
            }
        }
    }

    pub fn has_seen_awaited(&self) -> bool {
        self.awaited.is_empty()
    }

    /// An awaited pattern that has not matched yet.
    pub fn missing(&self) -> Option<&Regex> {
        self.awaited.first()
    }

    /// Whether nothing was printed.
    pub fn is_silent(&self) -> bool {
        self.lines.iter().all(|line| line.printed == 0)
    }

    /// The values found since the last call.
    pub fn take_values(&mut self) -> Vec<(String, String)> {
        std::mem::take(&mut self.found)
    }

    /// The pattern of a value that no line has provided yet.
    pub fn pattern_of(&self, name: &str) -> Option<&Regex> {
        self.values.iter().find(|(known, _)| known == name).map(|(_, pattern)| pattern)
    }

    /// The first line that matched a forbidden pattern, once.
    pub fn take_forbidden(&mut self) -> Option<String> {
        self.forbidden_line.take()
    }

    /// The last lines that have an end.
    pub fn complete_tail(&self) -> Vec<String> {
        self.tail.iter().cloned().collect()
    }

    /// The last lines, also those that have no end yet.
    pub fn tail(&self) -> Vec<String> {
        let mut lines = self.complete_tail();
        lines.extend(self.lines.iter().filter_map(OpenLine::text));
        lines.drain(..lines.len().saturating_sub(TAIL_LINES));
        lines
    }

    /// Appends the line that says why the process failed to the reason.
    pub fn explain(&self, reason: &str) -> String {
        explain_failure(reason, &self.tail())
    }
}

impl OpenLine {
    fn text(&self) -> Option<String> {
        match self.bytes.is_empty() {
            true => self.overwritten.clone(),
            false => Some(plain_text(&String::from_utf8_lossy(&self.bytes)).into_owned()),
        }
    }
}

fn is_match(pattern: &Regex, text: &str, end: LineEnd) -> bool {
    match end {
        LineEnd::Open => pattern.find(text).is_some_and(|found| found.end() < text.len()),
        LineEnd::Complete | LineEnd::Quiet | LineEnd::Cut => pattern.is_match(text),
    }
}

/// The first group of a pattern, unless a part of it may be missing.
fn value<'t>(pattern: &Regex, text: &'t str, end: LineEnd) -> Option<&'t str> {
    let group = pattern.captures(text)?.get(1)?;
    let is_whole = group.end() < text.len() || matches!(end, LineEnd::Complete | LineEnd::Quiet);
    (is_whole && !group.is_empty()).then(|| group.as_str())
}

/// The bytes without an incomplete character at the end.
fn complete_characters(bytes: &[u8]) -> &[u8] {
    let last = bytes.utf8_chunks().last().map_or(&[][..], |chunk| chunk.invalid());
    let is_cut = std::str::from_utf8(last).is_err_and(|error| error.error_len().is_none());
    &bytes[..bytes.len() - if is_cut { last.len() } else { 0 }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use Stream::{Stderr, Stdout};

    fn patterns(texts: &[&str]) -> Vec<Regex> {
        texts.iter().map(|text| Regex::new(text).unwrap()).collect()
    }

    fn awaiting(pattern: &str) -> LogWatch {
        LogWatch::new(patterns(&[pattern]), Vec::new(), Vec::new())
    }

    fn of_value(pattern: &str) -> LogWatch {
        let pattern = Regex::new(pattern).unwrap();
        LogWatch::new(Vec::new(), Vec::new(), vec![("port".to_owned(), pattern)])
    }

    fn port(watch: &mut LogWatch) -> Option<String> {
        watch.take_values().pop().map(|(_, value)| value)
    }

    #[test]
    fn patterns_match_lines_that_arrive_in_pieces() {
        let mut watch = LogWatch::new(patterns(&["^READY$"]), patterns(&["FATAL"]), Vec::new());
        watch.push(Stdout, b"REA");
        assert!(!watch.has_seen_awaited());
        watch.push(Stdout, b"DY\r\nno FAT");
        assert!(watch.has_seen_awaited());
        assert_eq!(watch.take_forbidden(), None);
        watch.push(Stdout, b"AL: motor\n");
        assert_eq!(watch.take_forbidden().as_deref(), Some("no FATAL: motor"));
        assert_eq!(watch.tail(), ["READY", "no FATAL: motor"]);
    }

    #[test]
    fn the_first_line_that_matches_provides_a_value() {
        let mut watch = of_value("port (\\d*)");
        watch.push(Stdout, b"port \nport 40");
        assert_eq!(port(&mut watch), None);
        watch.push(Stdout, b"123\nport 5\n");
        assert_eq!(port(&mut watch).as_deref(), Some("40123"));
        assert!(watch.pattern_of("port").is_none());
    }

    /// What simulators print, cut at any byte.
    #[test]
    fn what_a_terminal_shows_is_searched_wherever_it_is_cut() {
        for (pattern, output) in [
            ("^pxh> $", "boot\r\n\x1b[32mpxh> \x1b[0m"),
            ("^gr\u{fc}n bereit$", "\x1b]0;sim\x07\x1b[1mgr\u{fc}n\x1b[0m bereit\n"),
            ("^100 %$", "\r 50 %\r100 %\r"),
            ("^READY$", "READY\r\r\n"),
            ("^\u{fc}> $", "\u{fc}> "),
            ("32mREADY", "\x1b[32mREADY\x1b[0m\n"),
        ] {
            for size in 1..=output.len() {
                let mut watch = awaiting(pattern);
                output.as_bytes().chunks(size).for_each(|piece| watch.push(Stdout, piece));
                (0..2).for_each(|_| watch.try_unfinished());
                assert!(watch.has_seen_awaited(), "{output:?} in pieces of {size} bytes");
            }
        }
    }

    #[test]
    fn the_streams_have_separate_lines() {
        let mut watch = awaiting("^pxh> $");
        watch.push(Stdout, b"px");
        watch.push(Stderr, b"WARN [mavlink]");
        watch.push(Stdout, b"h> ");
        (0..2).for_each(|_| watch.try_unfinished());
        assert!(watch.has_seen_awaited());
        assert_eq!(watch.tail(), ["pxh> ", "WARN [mavlink]"]);
    }

    #[test]
    fn a_match_at_the_end_of_an_unfinished_line_counts_once_nothing_follows() {
        for (pattern, pieces, is_seen) in [
            ("^READY$", ["READY", " in 5 s", ""], false),
            ("^READY", ["READY", " in 5 s", ""], true),
            ("^READY$", ["REA", "DY", ""], false),
            ("^READY$", ["READY", "", ""], true),
        ] {
            let mut watch = awaiting(pattern);
            for piece in pieces[..2].iter().filter(|piece| !piece.is_empty()) {
                watch.push(Stdout, piece.as_bytes());
                watch.try_unfinished();
            }
            if pieces[1].is_empty() {
                assert!(watch.has_unfinished());
                watch.try_unfinished();
            }
            assert_eq!(watch.has_seen_awaited(), is_seen, "{pattern} {pieces:?}");
        }
    }

    #[test]
    fn an_unfinished_line_is_tried_until_it_is_quiet_and_matches_once() {
        let mut watch = LogWatch::new(Vec::new(), patterns(&["FATAL"]), Vec::new());
        watch.push(Stdout, b"FATAL: motor");
        watch.try_unfinished();
        assert_eq!(watch.take_forbidden().as_deref(), Some("FATAL: motor"));
        watch.push(Stdout, b"\n");
        assert!(!watch.has_unfinished());
        watch.push(Stdout, b"> ");
        (0..2).for_each(|_| {
            assert!(watch.has_unfinished());
            watch.try_unfinished();
        });
        assert!(!watch.has_unfinished(), "nothing was printed since");
    }

    #[test]
    fn a_part_of_a_value_is_no_value() {
        let mut watch = of_value("port (\\d+)");
        watch.push(Stdout, b"port 40");
        watch.try_unfinished();
        assert_eq!(port(&mut watch), None);
        watch.push(Stdout, b"123");
        watch.try_unfinished();
        assert_eq!(port(&mut watch), None);
        watch.try_unfinished();
        assert_eq!(port(&mut watch).as_deref(), Some("40123"), "nothing follows");

        let mut watch = of_value("port (\\d+)");
        watch.push(Stdout, b"\x1b[36mport 40123\x1b[0m pxh> ");
        watch.try_unfinished();
        assert_eq!(port(&mut watch).as_deref(), Some("40123"), "something else follows");

        // A full buffer ends anywhere, and the next one may come late.
        let mut watch = of_value("port (\\d+)");
        watch.push(Stdout, &[vec![b'\n'; 4096 - 7], b"port 40".to_vec()].concat());
        (0..3).for_each(|_| watch.try_unfinished());
        assert_eq!(port(&mut watch), None);
        watch.push(Stdout, b"123\n");
        assert_eq!(port(&mut watch).as_deref(), Some("40123"));
    }

    #[test]
    fn a_line_with_a_value_that_is_not_known_yet_is_not_reported() {
        let value = ("token".to_owned(), Regex::new("token (\\w+)").unwrap());
        let mut watch = LogWatch::new(Vec::new(), patterns(&["FATAL"]), vec![value]);
        watch.push(Stdout, b"FATAL: token s3c");
        watch.try_unfinished();
        assert_eq!(watch.take_forbidden(), None);
        watch.push(Stdout, b"ret\n");
        assert_eq!(watch.take_values().len(), 1);
        assert!(watch.take_forbidden().is_some());
    }

    #[test]
    fn only_the_last_state_of_an_overwritten_line_is_kept() {
        let mut watch = awaiting("never");
        watch.push(Stdout, b"loading\r\n 1 %\r 2 %\r 3 %\r\n\x1b[31mno map\x1b[0m\n 1 %\r");
        assert_eq!(watch.tail(), ["loading", " 3 %", "no map", " 1 %"]);
        watch.finish();
        assert_eq!(watch.tail(), ["loading", " 3 %", "no map", " 1 %"]);
    }
}
