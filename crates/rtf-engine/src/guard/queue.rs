//! Notes on their way to the guard. A guard that does not read for a while (it
//! was stopped, or the machine is busy) gets them later; the run never waits.

use std::collections::VecDeque;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::Errno;
use rustix::net::SendFlags;

use super::note::Note;
use rtf_process::descriptor_passing;

/// How many bytes of notes may wait.
const BYTES: usize = 4 << 20;
/// How many descriptors may wait with them.
const WAITING: usize = 48;

/// How long to wait before trying again.
const PAUSE: Duration = Duration::from_millis(1);

/// The runner's end of the line, and what has not been written yet.
#[derive(Debug)]
pub struct Queue {
    socket: UnixStream,
    lines: VecDeque<(Vec<u8>, Vec<OwnedFd>)>,
    bytes: usize,
    descriptors: usize,
    /// Whether so much waited that the rest was thrown away.
    pub missed: bool,
}

impl Queue {
    /// Nothing waits yet.
    pub fn new(socket: UnixStream) -> Self {
        Self { socket, lines: VecDeque::new(), bytes: 0, descriptors: 0, missed: false }
    }

    /// Writes a note after those that wait, as far as there is room.
    ///
    /// # Errors
    /// The guard is gone.
    pub fn tell(&mut self, note: &Note, descriptors: &[BorrowedFd<'_>]) -> io::Result<()> {
        self.flush()?;
        if self.missed && !matches!(note, Note::RunEnds) {
            return Ok(());
        }
        let mut line = line_of(note)?;
        let mut sent = false;
        if self.lines.is_empty() {
            match send(&self.socket, &line, descriptors)? {
                Some(written) if written == line.len() => return Ok(()),
                Some(written) => {
                    sent = true;
                    line.drain(..written);
                }
                None => {}
            }
        }
        let own: io::Result<Vec<_>> = match sent {
            true => Ok(Vec::new()),
            false => descriptors.iter().map(BorrowedFd::try_clone_to_owned).collect(),
        };
        match own {
            Ok(own) if self.has_room(line.len(), own.len()) => self.push(line, own),
            _ if sent => self.push(line, Vec::new()),
            _ => self.miss(note)?,
        }
        Ok(())
    }

    /// Writes what waits, as far as there is room.
    ///
    /// # Errors
    /// The guard is gone.
    pub fn flush(&mut self) -> io::Result<()> {
        while let Some((line, descriptors)) = self.lines.front_mut() {
            let borrowed: Vec<_> = descriptors.iter().map(AsFd::as_fd).collect();
            let Some(written) = send(&self.socket, line, &borrowed)? else { return Ok(()) };
            self.bytes -= written;
            self.descriptors -= descriptors.len();
            descriptors.clear();
            line.drain(..written);
            if line.is_empty() {
                self.lines.pop_front();
            }
        }
        Ok(())
    }

    /// Waits until everything is written.
    ///
    /// # Errors
    /// The guard is gone.
    pub fn finish(&mut self) -> io::Result<()> {
        while !self.lines.is_empty() {
            let mut fds = [PollFd::new(&self.socket, PollFlags::OUT)];
            match poll(&mut fds, None) {
                Ok(_) | Err(Errno::INTR) => self.flush()?,
                Err(error) => return Err(error.into()),
            }
            // There may be room for bytes and none for descriptors.
            std::thread::sleep(PAUSE);
        }
        Ok(())
    }

    fn has_room(&self, bytes: usize, descriptors: usize) -> bool {
        self.missed || (self.bytes + bytes <= BYTES && self.descriptors + descriptors <= WAITING)
    }

    fn push(&mut self, line: Vec<u8>, descriptors: Vec<OwnedFd>) {
        self.bytes += line.len();
        self.descriptors += descriptors.len();
        self.lines.push_back((line, descriptors));
    }

    /// From now on only the end of the run is written. What waits is kept: the
    /// guard understands it, and may have half of the first line.
    fn miss(&mut self, note: &Note) -> io::Result<()> {
        self.missed = true;
        self.push(line_of(&Note::Missed)?, Vec::new());
        if matches!(note, Note::RunEnds) {
            self.push(line_of(note)?, Vec::new());
        }
        Ok(())
    }
}

fn line_of(note: &Note) -> io::Result<Vec<u8>> {
    let mut line = serde_json::to_vec(note)?;
    line.push(b'\n');
    Ok(line)
}

/// Returns the number of bytes written; `None` if there is no room.
fn send(socket: &UnixStream, line: &[u8], fds: &[BorrowedFd<'_>]) -> io::Result<Option<usize>> {
    match descriptor_passing::send(socket.as_fd(), line, fds, SendFlags::DONTWAIT) {
        Ok(written) => Ok(Some(written)),
        // Too many passed descriptors have not been received yet.
        Err(Errno::AGAIN | Errno::TOOMANYREFS | Errno::NOBUFS) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, BufReader};

    use rtf_model::{SuiteId, TestId};

    use super::*;

    fn begins(test: u32) -> Note {
        Note::TestBegins { suite: SuiteId(0), test: TestId(test), name: "arm".to_owned() }
    }

    fn read(socket: UnixStream) -> Vec<Note> {
        let lines = BufReader::new(socket).lines();
        lines.map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect()
    }

    #[test]
    fn notes_wait_for_a_guard_that_does_not_read() {
        let (ours, guards) = UnixStream::pair().unwrap();
        let mut queue = Queue::new(ours);
        let notes: Vec<Note> = (0..10_000).map(begins).collect();
        for note in &notes {
            queue.tell(note, &[]).unwrap();
        }
        assert!(!queue.missed && !queue.lines.is_empty(), "the socket holds less");
        let reader = std::thread::spawn(move || read(guards));
        queue.finish().unwrap();
        drop(queue);
        assert_eq!(reader.join().unwrap(), notes);
    }

    #[test]
    fn what_a_guard_missed_is_said_and_the_end_still_comes() {
        let (ours, guards) = UnixStream::pair().unwrap();
        let mut queue = Queue::new(ours);
        let mut told = 0;
        while !queue.missed {
            queue.tell(&begins(told), &[]).unwrap();
            told += 1;
        }
        queue.tell(&begins(told), &[]).unwrap();
        queue.tell(&Note::RunEnds, &[]).unwrap();
        let reader = std::thread::spawn(move || read(guards));
        queue.finish().unwrap();
        drop(queue);
        let notes = reader.join().unwrap();
        assert_eq!(notes.len(), told as usize + 1);
        assert_eq!(notes[notes.len() - 2..], [Note::Missed, Note::RunEnds]);
    }
}
