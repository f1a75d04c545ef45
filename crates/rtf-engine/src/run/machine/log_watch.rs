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
    /// The values that no line has provided yet; the first group of the pattern is the value.
    values: Vec<(String, Regex)>,
    found: Vec<(String, String)>,
}

impl LogWatch {
    pub fn new(awaited: Vec<Regex>, forbidden: Vec<Regex>, values: Vec<(String, Regex)>) -> Self {
        Self { awaited, forbidden, values, ..Self::default() }
    }

    pub fn push(&mut self, bytes: &[u8]) {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(piece);
            if piece.ends_with(b"\n") || self.line.len() > LINE_BYTES {
                self.end_line();
            }
        }
    }

    /// The output has ended, perhaps without a line break.
    pub fn end_incomplete_line(&mut self) {
        if !self.line.is_empty() {
            self.end_line();
        }
    }

    fn end_line(&mut self) {
        let line = std::mem::take(&mut self.line);
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end_matches(['\n', '\r']);
        self.awaited.retain(|pattern| !pattern.is_match(line));
        self.values.retain(|(name, pattern)| {
            let group = pattern.captures(line).and_then(|groups| groups.get(1));
            let value = group.map(|group| group.as_str()).filter(|value| !value.is_empty());
            self.found.extend(value.map(|value| (name.clone(), value.to_owned())));
            value.is_none()
        });
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

    pub fn tail(&mut self) -> Vec<String> {
        self.end_incomplete_line();
        self.tail.iter().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_lines_that_arrive_in_pieces() {
        let ready = Regex::new("^READY$").unwrap();
        let mut watch = LogWatch::new(vec![ready], vec![Regex::new("FATAL").unwrap()], Vec::new());
        watch.push(b"REA");
        assert!(!watch.has_seen_awaited());
        watch.push(b"DY\r\nno FAT");
        assert!(watch.has_seen_awaited());
        assert_eq!(watch.take_forbidden(), None);
        watch.push(b"AL: motor\n");
        assert_eq!(watch.take_forbidden().as_deref(), Some("no FATAL: motor"));
        assert_eq!(watch.tail(), ["READY", "no FATAL: motor"]);
    }

    #[test]
    fn the_first_line_that_matches_provides_a_value() {
        let pattern = Regex::new("port (\\d*)").unwrap();
        let mut watch = LogWatch::new(Vec::new(), Vec::new(), vec![("port".to_owned(), pattern)]);
        watch.push(b"port \nport 40");
        assert_eq!(watch.take_values(), []);
        watch.push(b"123\nport 5\n");
        assert_eq!(watch.take_values(), [("port".to_owned(), "40123".to_owned())]);
        assert!(watch.pattern_of("port").is_none());
    }
}
