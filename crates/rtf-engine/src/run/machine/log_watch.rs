//! Searches a process fixture's output for patterns that make it ready or collapsed, and
//! keeps its last lines.

use std::collections::VecDeque;

use regex::Regex;

/// How many of the last lines a failure report contains.
pub const TAIL_LINES: usize = 50;

/// A longer line is searched in pieces.
const LINE_BYTES: usize = 64 * 1024;

#[derive(Debug, Default)]
pub struct LogWatch {
    line: Vec<u8>,
    tail: VecDeque<String>,
    awaited: Vec<Regex>,
    forbidden: Vec<Regex>,
    forbidden_line: Option<String>,
}

impl LogWatch {
    pub fn new(awaited: Vec<Regex>, forbidden: Vec<Regex>) -> Self {
        Self { awaited, forbidden, ..Self::default() }
    }

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
        if self.forbidden_line.is_none()
            && self.forbidden.iter().any(|pattern| pattern.is_match(line))
        {
            self.forbidden_line = Some(line.to_owned());
        }
        if self.tail.len() == TAIL_LINES {
            self.tail.pop_front();
        }
        self.tail.push_back(line.to_owned());
    }

    pub fn has_seen_awaited(&self) -> bool {
        self.awaited.is_empty()
    }

    /// An awaited pattern that has not matched yet.
    pub fn missing(&self) -> Option<&Regex> {
        self.awaited.first()
    }

    /// The first line that matched a forbidden pattern, once.
    pub fn take_forbidden(&mut self) -> Option<String> {
        self.forbidden_line.take()
    }

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
    fn patterns_match_lines_that_arrive_in_pieces() {
        let ready = Regex::new("^READY$").unwrap();
        let mut watch = LogWatch::new(vec![ready], vec![Regex::new("FATAL").unwrap()]);
        watch.push(b"REA");
        assert!(!watch.has_seen_awaited());
        watch.push(b"DY\r\nno FAT");
        assert!(watch.has_seen_awaited());
        assert_eq!(watch.take_forbidden(), None);
        watch.push(b"AL: motor\n");
        assert_eq!(watch.take_forbidden().as_deref(), Some("no FATAL: motor"));
        assert_eq!(watch.tail(), ["READY", "no FATAL: motor"]);
    }
}
