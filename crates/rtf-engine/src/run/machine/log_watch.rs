//! Looks at a process's output line by line: for the patterns that make a
//! process fixture ready or unwell, and to keep its last lines.

use std::collections::VecDeque;

use regex::Regex;

/// How many of the last lines are kept for a report about a failure.
pub const TAIL_LINES: usize = 50;

/// A line longer than this is looked at in pieces.
const LINE_BYTES: usize = 64 * 1024;

/// What a fixture's process printed, line by line.
#[derive(Debug, Default)]
pub struct LogWatch {
    line: Vec<u8>,
    tail: VecDeque<String>,
    awaited: Vec<Regex>,
    forbidden: Vec<Regex>,
    found: Option<String>,
}

impl LogWatch {
    /// Waits for `awaited`, and looks out for `forbidden`.
    pub fn new(awaited: Vec<Regex>, forbidden: Vec<Regex>) -> Self {
        Self { awaited, forbidden, ..Self::default() }
    }

    /// Takes in what was printed.
    pub fn push(&mut self, bytes: &[u8]) {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(piece);
            if piece.ends_with(b"\n") || self.line.len() > LINE_BYTES {
                self.end_line();
            }
        }
    }

    fn end_line(&mut self) {
        let line = std::mem::take(&mut self.line);
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end_matches(['\n', '\r']);
        self.awaited.retain(|pattern| !pattern.is_match(line));
        if self.found.is_none() && self.forbidden.iter().any(|pattern| pattern.is_match(line)) {
            self.found = Some(line.to_owned());
        }
        if self.tail.len() == TAIL_LINES {
            self.tail.pop_front();
        }
        self.tail.push_back(line.to_owned());
    }

    /// Whether every awaited pattern was seen.
    pub fn awaited_seen(&self) -> bool {
        self.awaited.is_empty()
    }

    /// An awaited pattern that was not seen.
    pub fn awaited(&self) -> Option<&Regex> {
        self.awaited.first()
    }

    /// The first line with a forbidden pattern, told once.
    pub fn take_found(&mut self) -> Option<String> {
        self.found.take()
    }

    /// The last lines.
    pub fn tail(&mut self) -> Vec<String> {
        if !self.line.is_empty() {
            self.end_line();
        }
        self.tail.iter().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_found_in_lines_that_come_in_pieces() {
        let ready = Regex::new("^READY$").unwrap();
        let mut watch = LogWatch::new(vec![ready], vec![Regex::new("FATAL").unwrap()]);
        watch.push(b"REA");
        assert!(!watch.awaited_seen());
        watch.push(b"DY\r\nno FAT");
        assert!(watch.awaited_seen());
        assert_eq!(watch.take_found(), None);
        watch.push(b"AL: motor\n");
        assert_eq!(watch.take_found().as_deref(), Some("no FATAL: motor"));
        assert_eq!(watch.tail(), ["READY", "no FATAL: motor"]);
    }
}
