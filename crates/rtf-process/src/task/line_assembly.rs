//! Assembles the lines of a channel for each sender: a plug-in may fork, and its children
//! share the channel.

use std::collections::HashMap;

use crate::codec::LINE_LIMIT;
use crate::unix::Sender;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineWriter {
    /// The process that carries out requests.
    Host,
    /// A process that the plug-in forked.
    Other,
}

/// A line exceeds the limit.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TooLong;

/// The incomplete lines of all senders.
#[derive(Debug, Default)]
pub(super) struct LineAssembly {
    /// The first sender.
    host: Option<Sender>,
    host_line: Vec<u8>,
    other_lines: HashMap<Sender, Vec<u8>>,
    /// The total length of `other_lines`.
    others_bytes: usize,
}

impl LineAssembly {
    /// Adds bytes of one sender, and calls `take` with each complete line, without its end.
    pub(super) fn push(
        &mut self,
        sender: Sender,
        bytes: &[u8],
        mut take: impl FnMut(LineWriter, &[u8]),
    ) -> Result<(), TooLong> {
        let host = *self.host.get_or_insert(sender);
        if sender == host {
            complete(&mut self.host_line, bytes, |line| take(LineWriter::Host, line));
            return self.check();
        }
        let mut partial = self.other_lines.remove(&sender).unwrap_or_default();
        self.others_bytes -= partial.len();
        complete(&mut partial, bytes, |line| take(LineWriter::Other, line));
        if !partial.is_empty() {
            self.others_bytes += partial.len();
            self.other_lines.insert(sender, partial);
        }
        self.check()
    }

    fn check(&mut self) -> Result<(), TooLong> {
        if self.host_line.len() <= LINE_LIMIT && self.others_bytes <= LINE_LIMIT {
            return Ok(());
        }
        *self = Self { host: self.host, ..Self::default() };
        Err(TooLong)
    }

    /// Returns the incomplete line of the host.
    pub(super) fn take_rest(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.host_line)
    }
}

/// Adds bytes to an incomplete line. The common case, complete lines, copies nothing.
fn complete(partial: &mut Vec<u8>, bytes: &[u8], mut take: impl FnMut(&[u8])) {
    for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
        match piece.strip_suffix(b"\n") {
            Some(end) if partial.is_empty() => take(end),
            Some(end) => {
                partial.extend_from_slice(end);
                take(&std::mem::take(partial));
            }
            None => partial.extend_from_slice(piece),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(lines: &mut LineAssembly, sender: Sender, bytes: &[u8]) -> Vec<(LineWriter, String)> {
        let mut taken = Vec::new();
        let take = |writer, line: &[u8]| {
            taken.push((writer, String::from_utf8_lossy(line).into_owned()));
        };
        lines.push(sender, bytes, take).unwrap();
        taken
    }

    #[test]
    fn each_sender_has_separate_lines() {
        let mut lines = LineAssembly::default();
        let (host, child) = (Sender(7), Sender(8));
        assert_eq!(taken(&mut lines, host, b"a\nb"), [(LineWriter::Host, "a".to_owned())]);
        assert_eq!(taken(&mut lines, child, b"x"), []);
        assert_eq!(taken(&mut lines, host, b"c\n"), [(LineWriter::Host, "bc".to_owned())]);
        assert_eq!(taken(&mut lines, child, b"y\nz"), [(LineWriter::Other, "xy".to_owned())]);
        assert_eq!(taken(&mut lines, host, b"d"), []);
        assert_eq!(lines.take_rest(), b"d");
    }

    #[test]
    fn children_that_end_no_line_do_not_fill_the_memory() {
        let mut lines = LineAssembly::default();
        let half = vec![b'x'; LINE_LIMIT / 2 + 1];
        lines.push(Sender(7), b"a\n", |_, _| {}).unwrap();
        lines.push(Sender(8), &half, |_, _| {}).unwrap();
        lines.push(Sender(7), &half, |_, _| {}).unwrap();
        assert_eq!(lines.push(Sender(9), &half, |_, _| {}), Err(TooLong));
        assert!(lines.other_lines.is_empty() && lines.others_bytes == 0);
    }
}
