//! Holds back incomplete lines of a fixture whose output contains a secret: the value is
//! known once its line is complete.

use std::borrow::Cow;

use rtf_model::Stream;

/// A longer line is passed on in pieces.
const MAX_LINE_BYTES: usize = 64 * 1024;

/// The incomplete lines of a process, or nothing if lines are not held back.
#[derive(Debug, Default)]
pub struct LineBuffer(Option<[Vec<u8>; 2]>);

impl LineBuffer {
    pub fn new(holds_lines: bool) -> Self {
        Self(holds_lines.then(Default::default))
    }

    pub fn holds_lines(&self) -> bool {
        self.0.is_some()
    }

    /// Takes output; returns the output that is passed on now.
    pub fn push<'b>(&mut self, stream: Stream, bytes: &'b [u8]) -> Cow<'b, [u8]> {
        let Some(lines) = &mut self.0 else { return Cow::Borrowed(bytes) };
        let line = &mut lines[stream as usize];
        line.extend_from_slice(bytes);
        let complete = line.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let complete = if line.len() > MAX_LINE_BYTES { line.len() } else { complete };
        let rest = line.split_off(complete);
        Cow::Owned(std::mem::replace(line, rest))
    }

    /// Returns the rest of each stream at its end.
    pub fn finish(&mut self) -> Vec<(Stream, Vec<u8>)> {
        let lines = self.0.take().unwrap_or_default();
        [Stream::Stdout, Stream::Stderr].into_iter().zip(lines).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn incomplete_lines_wait_for_their_end() {
        let mut buffer = LineBuffer::new(true);
        assert_eq!(&*buffer.push(Stream::Stdout, b"one\ntok"), b"one\n");
        assert_eq!(&*buffer.push(Stream::Stderr, b"other\n"), b"other\n");
        assert_eq!(&*buffer.push(Stream::Stdout, b"en: 1\nla"), b"token: 1\n");
        let rest = [(Stream::Stdout, b"la".to_vec()), (Stream::Stderr, Vec::new())];
        assert_eq!(buffer.finish(), rest);
        assert_eq!(&*LineBuffer::new(false).push(Stream::Stdout, b"tok"), b"tok");
    }
}
