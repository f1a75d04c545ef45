//! Lines of a channel, put together for each process that writes there: a plug-in may
//! fork, and its children share the channel.

use std::collections::HashMap;

use crate::host::codec::LINE_LIMIT;
use crate::host::unix::Sender;

/// Who wrote a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Writer {
    /// The process that carries out requests.
    Host,
    /// Another one, which the plug-in forked.
    Other,
}

/// A process wrote too much without ending its line.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TooLong;

/// The beginnings of lines that have not ended yet.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// The process that wrote first.
    host: Option<Sender>,
    of_host: Vec<u8>,
    of_others: HashMap<Sender, Vec<u8>>,
    /// The length of all of those.
    others_bytes: usize,
}

impl Lines {
    /// Takes what one process wrote, and calls `take` with each line that is complete,
    /// without its end.
    pub(super) fn push(
        &mut self,
        sender: Sender,
        bytes: &[u8],
        mut take: impl FnMut(Writer, &[u8]),
    ) -> Result<(), TooLong> {
        let host = *self.host.get_or_insert(sender);
        if sender == host {
            complete(&mut self.of_host, bytes, |line| take(Writer::Host, line));
            return self.check();
        }
        let mut begun = self.of_others.remove(&sender).unwrap_or_default();
        self.others_bytes -= begun.len();
        complete(&mut begun, bytes, |line| take(Writer::Other, line));
        if !begun.is_empty() {
            self.others_bytes += begun.len();
            self.of_others.insert(sender, begun);
        }
        self.check()
    }

    fn check(&mut self) -> Result<(), TooLong> {
        if self.of_host.len() <= LINE_LIMIT && self.others_bytes <= LINE_LIMIT {
            return Ok(());
        }
        *self = Self { host: self.host, ..Self::default() };
        Err(TooLong)
    }

    /// The line that the host was writing when the channel was closed.
    pub(super) fn take_rest(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.of_host)
    }
}

/// Adds bytes to the beginning of a line. The common case, whole lines, copies nothing.
fn complete(begun: &mut Vec<u8>, bytes: &[u8], mut take: impl FnMut(&[u8])) {
    for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
        match piece.strip_suffix(b"\n") {
            Some(end) if begun.is_empty() => take(end),
            Some(end) => {
                begun.extend_from_slice(end);
                take(&std::mem::take(begun));
            }
            None => begun.extend_from_slice(piece),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(lines: &mut Lines, sender: Sender, bytes: &[u8]) -> Vec<(Writer, String)> {
        let mut taken = Vec::new();
        let take = |writer, line: &[u8]| {
            taken.push((writer, String::from_utf8_lossy(line).into_owned()));
        };
        lines.push(sender, bytes, take).unwrap();
        taken
    }

    #[test]
    fn each_process_has_lines_of_its_own() {
        let mut lines = Lines::default();
        let (host, child) = (Sender(7), Sender(8));
        assert_eq!(taken(&mut lines, host, b"a\nb"), [(Writer::Host, "a".to_owned())]);
        assert_eq!(taken(&mut lines, child, b"x"), []);
        assert_eq!(taken(&mut lines, host, b"c\n"), [(Writer::Host, "bc".to_owned())]);
        assert_eq!(taken(&mut lines, child, b"y\nz"), [(Writer::Other, "xy".to_owned())]);
        assert_eq!(taken(&mut lines, host, b"d"), []);
        assert_eq!(lines.take_rest(), b"d");
    }

    #[test]
    fn children_that_end_no_line_do_not_fill_the_memory() {
        let mut lines = Lines::default();
        let half = vec![b'x'; LINE_LIMIT / 2 + 1];
        lines.push(Sender(7), b"a\n", |_, _| {}).unwrap();
        lines.push(Sender(8), &half, |_, _| {}).unwrap();
        lines.push(Sender(7), &half, |_, _| {}).unwrap();
        assert_eq!(lines.push(Sender(9), &half, |_, _| {}), Err(TooLong));
        assert!(lines.of_others.is_empty() && lines.others_bytes == 0);
    }
}
