//! The last lines that a program printed, for the reason of its end.

use std::collections::VecDeque;

use rtf_model::FailureLine;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputStream {
    Stdout,
    Stderr,
}

/// How many lines of each stream are kept.
const LINES: usize = 50;

/// Longer lines are cut.
const LINE_BYTES: usize = 500;

/// The last lines of both streams.
#[derive(Debug, Default)]
pub struct LastOutput {
    stdout: LastLines,
    stderr: LastLines,
}

#[derive(Debug, Default)]
struct LastLines {
    complete: VecDeque<String>,
    open: Vec<u8>,
}

impl LastOutput {
    pub fn add(&mut self, stream: OutputStream, bytes: &[u8]) {
        match stream {
            OutputStream::Stdout => self.stdout.add(bytes),
            OutputStream::Stderr => self.stderr.add(bytes),
        }
    }

    /// The last line of standard error that is not blank.
    #[must_use]
    pub fn last_error_line(&self) -> Option<String> {
        self.stderr.all().pop()
    }

    /// The line that says why the program failed: of standard error, if it printed anything
    /// there.
    #[must_use]
    pub fn failure_line(&self) -> Option<String> {
        let find = |stream: &LastLines| FailureLine::find(&stream.all()).map(|line| line.text);
        find(&self.stderr).or_else(|| find(&self.stdout))
    }
}

impl LastLines {
    fn add(&mut self, bytes: &[u8]) {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            let room = LINE_BYTES.saturating_sub(self.open.len()).min(piece.len());
            self.open.extend_from_slice(&piece[..room]);
            if piece.ends_with(b"\n") {
                let line = text(&std::mem::take(&mut self.open));
                self.complete.extend(line);
                let excess = self.complete.len().saturating_sub(LINES);
                self.complete.drain(..excess);
            }
        }
    }

    fn all(&self) -> Vec<String> {
        self.complete.iter().cloned().chain(text(&self.open)).collect()
    }
}

/// The text of a line without blanks at its end, unless it is blank.
fn text(line: &[u8]) -> Option<String> {
    let line = line.trim_ascii_end();
    (!line.trim_ascii().is_empty()).then(|| String::from_utf8_lossy(line).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reason_is_on_standard_error_if_anything_is() {
        let mut output = LastOutput::default();
        assert_eq!(output.failure_line(), None);
        output.add(OutputStream::Stdout, b"error: no bus\nbye\n");
        assert_eq!(output.failure_line().as_deref(), Some("error: no bus"));
        for piece in [&b"Traceback (most recent call last):\n  File"[..], b" \"x\"\nArmError: fa"] {
            output.add(OutputStream::Stderr, piece);
        }
        output.add(OutputStream::Stderr, b"r\n\nstopped");
        assert_eq!(output.failure_line().as_deref(), Some("ArmError: far"));
        assert_eq!(output.last_error_line().as_deref(), Some("stopped"));
    }

    #[test]
    fn a_flood_of_output_fills_no_memory() {
        let mut output = LastOutput::default();
        output.add(OutputStream::Stdout, &[b'x'; 100_000]);
        (0..1000).for_each(|_| output.add(OutputStream::Stdout, b"\nline"));
        let LastLines { complete, open } = output.stdout;
        assert_eq!((complete.len(), open.len()), (LINES, 4));
    }
}
