//! Queues messages for a guard that does not read for a while, because it was stopped or
//! the machine is busy. The run never waits.

use std::collections::VecDeque;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::Errno;
use rustix::net::SendFlags;

use super::message::GuardMessage;
use rtf_process::descriptor_passing;

/// The capacity of the queue in bytes.
const MAX_BYTES: usize = 4 << 20;
/// The capacity of the queue in descriptors.
const MAX_DESCRIPTORS: usize = 48;

/// The time between attempts to write.
const RETRY_INTERVAL: Duration = Duration::from_millis(1);

/// The runner's socket, and the lines that it has not written yet.
#[derive(Debug)]
pub struct MessageQueue {
    socket: UnixStream,
    lines: VecDeque<(Vec<u8>, Vec<OwnedFd>)>,
    bytes: usize,
    descriptors: usize,
    /// Whether messages were discarded because the queue was full.
    pub has_lost_messages: bool,
}

impl MessageQueue {
    pub fn new(socket: UnixStream) -> Self {
        Self { socket, lines: VecDeque::new(), bytes: 0, descriptors: 0, has_lost_messages: false }
    }

    /// Writes a message after the queued ones, or queues it.
    ///
    /// # Errors
    /// The guard has ended.
    pub fn send(
        &mut self,
        message: &GuardMessage,
        descriptors: &[BorrowedFd<'_>],
    ) -> io::Result<()> {
        self.flush()?;
        if self.has_lost_messages && !matches!(message, GuardMessage::RunFinished) {
            return Ok(());
        }
        let mut line = line_of(message)?;
        let mut is_partly_sent = false;
        if self.lines.is_empty() {
            match send(&self.socket, &line, descriptors)? {
                Some(written) if written == line.len() => return Ok(()),
                Some(written) => {
                    is_partly_sent = true;
                    line.drain(..written);
                }
                None => {}
            }
        }
        let own: io::Result<Vec<_>> = match is_partly_sent {
            true => Ok(Vec::new()),
            false => descriptors.iter().map(BorrowedFd::try_clone_to_owned).collect(),
        };
        match own {
            Ok(own) if self.has_room(line.len(), own.len()) => self.push(line, own),
            _ if is_partly_sent => self.push(line, Vec::new()),
            _ => self.discard(message)?,
        }
        Ok(())
    }

    /// Writes the queued messages, as far as there is room.
    ///
    /// # Errors
    /// The guard has ended.
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

    /// Waits until all messages were written.
    ///
    /// # Errors
    /// The guard has ended.
    pub fn finish(&mut self) -> io::Result<()> {
        while !self.lines.is_empty() {
            let mut fds = [PollFd::new(&self.socket, PollFlags::OUT)];
            match poll(&mut fds, None) {
                Ok(_) | Err(Errno::INTR) => self.flush()?,
                Err(error) => return Err(error.into()),
            }
            // There may be room for bytes and none for descriptors.
            std::thread::sleep(RETRY_INTERVAL);
        }
        Ok(())
    }

    fn has_room(&self, bytes: usize, descriptors: usize) -> bool {
        self.has_lost_messages
            || (self.bytes + bytes <= MAX_BYTES
                && self.descriptors + descriptors <= MAX_DESCRIPTORS)
    }

    fn push(&mut self, line: Vec<u8>, descriptors: Vec<OwnedFd>) {
        self.bytes += line.len();
        self.descriptors += descriptors.len();
        self.lines.push_back((line, descriptors));
    }

    /// Discards a message. From now on, only the end of the run is sent. The queued messages
    /// remain valid, and the guard may have received a part of the first one.
    fn discard(&mut self, message: &GuardMessage) -> io::Result<()> {
        self.has_lost_messages = true;
        self.push(line_of(&GuardMessage::MessagesLost)?, Vec::new());
        if matches!(message, GuardMessage::RunFinished) {
            self.push(line_of(message)?, Vec::new());
        }
        Ok(())
    }
}

fn line_of(message: &GuardMessage) -> io::Result<Vec<u8>> {
    let mut line = serde_json::to_vec(message)?;
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

    fn test_started(test: u32) -> GuardMessage {
        GuardMessage::TestStarted { suite: SuiteId(0), test: TestId(test), name: "arm".to_owned() }
    }

    fn read(socket: UnixStream) -> Vec<GuardMessage> {
        let lines = BufReader::new(socket).lines();
        lines.map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect()
    }

    #[test]
    fn messages_wait_for_a_guard_that_does_not_read() {
        let (ours, guards) = UnixStream::pair().unwrap();
        let mut queue = MessageQueue::new(ours);
        let messages: Vec<GuardMessage> = (0..10_000).map(test_started).collect();
        for message in &messages {
            queue.send(message, &[]).unwrap();
        }
        assert!(!queue.has_lost_messages && !queue.lines.is_empty(), "the socket holds less");
        let reader = std::thread::spawn(move || read(guards));
        queue.finish().unwrap();
        drop(queue);
        assert_eq!(reader.join().unwrap(), messages);
    }

    #[test]
    fn lost_messages_are_reported_and_the_end_of_the_run_is_sent() {
        let (ours, guards) = UnixStream::pair().unwrap();
        let mut queue = MessageQueue::new(ours);
        let mut sent = 0;
        while !queue.has_lost_messages {
            queue.send(&test_started(sent), &[]).unwrap();
            sent += 1;
        }
        queue.send(&test_started(sent), &[]).unwrap();
        queue.send(&GuardMessage::RunFinished, &[]).unwrap();
        let reader = std::thread::spawn(move || read(guards));
        queue.finish().unwrap();
        drop(queue);
        let messages = reader.join().unwrap();
        assert_eq!(messages.len(), sent as usize + 1);
        assert_eq!(
            messages[messages.len() - 2..],
            [GuardMessage::MessagesLost, GuardMessage::RunFinished]
        );
    }
}
