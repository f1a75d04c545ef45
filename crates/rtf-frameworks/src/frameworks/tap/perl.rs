//! Diagnostics of Perl's Test::More, which writes them to standard error.
//!
//! Each failed test line has one block there, in the same order:
//!
//! ```text
//! #   Failed test 'moves'
//! #   at t/arm.t line 3.
//! #          got: '1'
//! #     expected: '2'
//! ```
//!
//! The pipes have no common order, so events from a failed test line on are held until its
//! block is complete, or the program has ended.

use std::collections::VecDeque;
use std::path::Path;

use super::parser::{ReportedPoint, TapEvent};

/// Whether a program is a test of Perl.
pub fn is_perl(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "t" || extension == "pl")
}

/// Adds blocks of standard error to failed test lines.
#[derive(Debug, Default)]
pub struct PerlDiagnostics {
    held: VecDeque<TapEvent>,
    /// The block that is being read.
    block: Option<Block>,
    /// Complete blocks whose test line is missing so far.
    blocks: VecDeque<Block>,
    line: Vec<u8>,
}

#[derive(Debug, Default)]
struct Block {
    name: Option<String>,
    lines: Vec<String>,
}

impl PerlDiagnostics {
    /// Reads standard error, and returns the events that are complete.
    pub fn read(&mut self, bytes: &[u8]) -> Vec<TapEvent> {
        for &byte in bytes {
            if byte == b'\n' {
                let line = std::mem::take(&mut self.line);
                self.read_line(&String::from_utf8_lossy(&line));
            } else {
                self.line.push(byte);
            }
        }
        self.release()
    }

    /// Takes an event, and returns those that are complete.
    pub fn add(&mut self, event: TapEvent) -> Vec<TapEvent> {
        self.held.push_back(event);
        self.release()
    }

    /// The program has ended: all events are complete.
    pub fn finish(&mut self) -> Vec<TapEvent> {
        self.blocks.extend(self.block.take());
        let mut events = self.release();
        events.extend(self.held.drain(..));
        events
    }

    fn read_line(&mut self, line: &str) {
        let Some(comment) = line.trim_start_matches(' ').strip_prefix('#') else { return };
        let text = comment.trim();
        if let Some(rest) = text.strip_prefix("Failed test") {
            self.blocks.extend(self.block.take());
            let quoted = rest.trim().strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''));
            let lines = vec![comment.to_owned()];
            self.block = Some(Block { name: quoted.map(str::to_owned), lines });
        } else if text.starts_with("Looks like ") {
            self.blocks.extend(self.block.take());
        } else if let Some(block) = &mut self.block {
            block.lines.push(comment.to_owned());
        }
    }

    /// The events before the first failed test line whose block is missing.
    fn release(&mut self) -> Vec<TapEvent> {
        let mut events = Vec::new();
        while let Some(event) = self.held.front_mut() {
            if let TapEvent::Point(reported) | TapEvent::Closed(reported) = event
                && awaits_block(reported)
            {
                let fits = |block: &Block| {
                    block.name.as_ref().is_none_or(|name| *name == reported.point.description)
                };
                let Some(index) = self.blocks.iter().position(fits) else { break };
                // Blocks before it belong to no test line of this stream.
                self.blocks.drain(..index);
                if let Some(block) = self.blocks.pop_front() {
                    reported.comments = block.lines;
                }
            }
            events.extend(self.held.pop_front());
        }
        events
    }
}

fn awaits_block(reported: &ReportedPoint) -> bool {
    let ReportedPoint { point, yaml, comments, .. } = reported;
    !point.ok && point.directive.is_none() && yaml.is_empty() && comments.is_empty()
}

#[cfg(test)]
mod tests {
    use super::super::line::TestPoint;
    use super::*;

    fn point(ok: bool, description: &str) -> TapEvent {
        let point = TestPoint { ok, description: description.to_owned(), ..TestPoint::default() };
        TapEvent::Point(ReportedPoint { point, ..ReportedPoint::default() })
    }

    fn shown(events: Vec<TapEvent>) -> Vec<(String, usize)> {
        let show = |event| match event {
            TapEvent::Point(reported) => (reported.point.description, reported.comments.len()),
            other => panic!("{other:?}"),
        };
        events.into_iter().map(show).collect()
    }

    #[test]
    fn a_failed_test_waits_for_its_block() {
        let mut perl = PerlDiagnostics::default();
        assert_eq!(shown(perl.add(point(true, "a"))), [("a".to_owned(), 0)]);
        assert_eq!(perl.add(point(false, "b")), []);
        assert_eq!(perl.add(point(true, "c")), []);
        assert_eq!(perl.read(b"warning\n#   Failed test 'b'\n#   at t.t "), []);
        assert_eq!(perl.read(b"line 3.\n#          got: '1'\n"), []);
        assert_eq!(perl.add(point(false, "d")), []);
        let block_of_d =
            b"    #   Failed test at t.t line 4.\n# Looks like you failed 2 tests of 4.\n";
        let released = [("b".to_owned(), 3), ("c".to_owned(), 0), ("d".to_owned(), 1)];
        assert_eq!(shown(perl.read(block_of_d)), released);
    }

    #[test]
    fn a_block_may_be_missing() {
        let mut perl = PerlDiagnostics::default();
        assert_eq!(perl.add(point(false, "a")), []);
        assert_eq!(perl.add(point(false, "b")), []);
        assert_eq!(perl.read(b"#   Failed test 'b'\n#   at t.t line 3.\n"), []);
        assert_eq!(shown(perl.finish()), [("a".to_owned(), 0), ("b".to_owned(), 0)]);
    }
}
