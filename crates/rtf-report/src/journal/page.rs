//! Lines of the journal that wait to be written.

use std::io::{self, Write};

use rtf_model::{Event, LineSealer};

/// How much it holds before it grows: what is flushed at once, and a long line.
const SIZE: usize = 128 * 1024;

/// Whole lines that wait to be written.
///
/// The serialiser writes many small pieces. Into a slice that costs much less than
/// into a `Vec`, which may have to grow with each.
#[derive(Debug)]
pub(super) struct WriteBuffer {
    bytes: Vec<u8>,
    used: usize,
    sealer: LineSealer,
}

impl WriteBuffer {
    pub fn new() -> Self {
        Self { bytes: vec![0; SIZE], used: 0, sealer: LineSealer::default() }
    }

    pub fn lines(&self) -> &[u8] {
        &self.bytes[..self.used]
    }

    pub fn clear(&mut self) {
        self.used = 0;
        self.bytes.truncate(SIZE);
    }

    pub fn add(&mut self, event: &Event) -> io::Result<()> {
        let length = loop {
            match write(event, &mut self.bytes[self.used..])? {
                Some(length) => break length,
                None => self.bytes.resize(2 * self.bytes.len(), 0),
            }
        };
        let line = &mut self.bytes[self.used..];
        let end = self.sealer.line_end(&line[..length]);
        line[length - 1..][..end.len()].copy_from_slice(&end);
        self.used += length - 1 + end.len();
        Ok(())
    }
}

/// Writes an event as an object; its length, or nothing when there is no room for
/// it and the end of its line.
fn write(event: &Event, room: &mut [u8]) -> io::Result<Option<usize>> {
    let mut room = Room { bytes: room, used: 0 };
    match object(event, &mut room) {
        Ok(()) => Ok((room.used + LineSealer::END <= room.bytes.len()).then_some(room.used)),
        Err(error) if error.is_io() => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// What the derived implementation writes, without its detour over a map.
fn object(event: &Event, room: &mut Room<'_>) -> serde_json::Result<()> {
    let number = |number: u64, room: &mut Room<'_>| serde_json::to_writer(room, &number);
    let io = serde_json::Error::io;
    room.write_all(b"{\"seq\":").map_err(io)?;
    number(event.seq, room)?;
    room.write_all(b",\"at\":").map_err(io)?;
    number(event.at.0, room)?;
    let start = room.used;
    serde_json::to_writer(&mut *room, &event.kind)?;
    // The kind is an object, too, and never an empty one: its fields follow.
    if let Some(brace) = room.bytes.get_mut(start) {
        *brace = b',';
    }
    Ok(())
}

struct Room<'a> {
    bytes: &'a mut [u8],
    used: usize,
}

impl io::Write for Room<'_> {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        self.write_all(piece).map(|()| piece.len())
    }

    // Called for each small piece: whether it is inlined must not depend on its crate's size.
    #[inline(always)]
    fn write_all(&mut self, piece: &[u8]) -> io::Result<()> {
        let end = self.used + piece.len();
        let Some(room) = self.bytes.get_mut(self.used..end) else {
            return Err(io::ErrorKind::WriteZero.into());
        };
        room.copy_from_slice(piece);
        self.used = end;
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtf_model::{EventKind, LineCheck, LineChecker, Micros, Output, Source, Stream, TestId};

    /// Also those that end where the page does.
    #[test]
    fn lines_of_any_length_are_whole() {
        let (mut page, mut checker) = (WriteBuffer::new(), LineChecker::default());
        let lengths = [0, 10, SIZE / 2, SIZE, 5 * SIZE, 1];
        let at_the_end = (SIZE - 200..SIZE).step_by(3);
        for (seq, length) in (0..).zip(lengths.into_iter().chain(at_the_end)) {
            let text = "x".repeat(length);
            let (source, stream) = (Source::Test(TestId(0)), Stream::Stdout);
            let kind = EventKind::Output(Output { source, stream, omitted_bytes: 0, text });
            let event = Event { seq, at: Micros(seq), kind };
            page.add(&event).unwrap();
            let line = page.lines().strip_suffix(b"\n").unwrap();
            assert_eq!(checker.check(line), LineCheck::Intact);
            assert_eq!(serde_json::from_slice::<Event>(line).unwrap(), event);
            let plain = serde_json::to_vec(&event).unwrap();
            assert!(line.starts_with(plain.strip_suffix(b"}").unwrap()), "field for field");
            page.clear();
        }
        assert_eq!(page.bytes.len(), SIZE);
    }
}
