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

/// Whether anything may follow a tried text.
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
pub fn complete_characters(bytes: &[u8]) -> &[u8] {
    // A character has up to four bytes.
    let end = &bytes[bytes.len().saturating_sub(3)..];
    let last = end.utf8_chunks().last().map_or(&[][..], |chunk| chunk.invalid());
    let is_cut = std::str::from_utf8(last).is_err_and(|error| error.error_len().is_none());
    &bytes[..bytes.len() - if is_cut { last.len() } else { 0 }]
}

#[cfg(test)]
mod tests;
