//! What a process says over its channel and prints, up to its end.

use rtf_model::protocol::Notification;
use rtf_model::{ExitStatus, Stream};

use super::lines::{TooLong, Writer};
use super::sharing::Sharing;
use super::streams::{Buffers, Received, read, receive};
use super::{DRAIN_LIMIT, Task};
use crate::host::codec::{self, FromHost, LINE_LIMIT};
use crate::host::spawner::Process;
use crate::run::machine::HostInput;

/// After the limit, what is there already is still taken in: more than a socket and two
/// pipes hold, but no endless flood.
const LATE_READS: u32 = 64;

impl Task {
    /// A line without an end, which is no fault of one that was killed while it wrote.
    pub(super) async fn last_line(&mut self, status: ExitStatus) {
        let line = self.lines.take_rest();
        if !line.is_empty() && !self.is_between_tests() && matches!(status, ExitStatus::Code(_)) {
            self.understand(codec::decode(&line)).await;
        }
    }

    /// Reads what is left. Only the wait has a limit: what was written is taken in, however
    /// long that takes.
    pub(super) async fn drain(&mut self, buffers: &mut Buffers) {
        let limit = tokio::time::Instant::now() + DRAIN_LIMIT;
        let mut late_reads = 0;
        while self.is_open() && late_reads < LATE_READS {
            late_reads += u32::from(tokio::time::Instant::now() >= limit);
            let process = &mut self.process;
            tokio::select! {
                biased;
                () = receive(&process.channel, &mut buffers.channel) =>
                    self.heard(&buffers.channel).await,
                _ = read(&mut process.stdout, &mut buffers.stdout) =>
                    self.printed(Stream::Stdout, &buffers.stdout).await,
                _ = read(&mut process.stderr, &mut buffers.stderr) =>
                    self.printed(Stream::Stderr, &buffers.stderr).await,
                () = tokio::time::sleep_until(limit) => return,
            }
        }
    }

    fn is_open(&self) -> bool {
        let Process { channel, stdout, stderr, .. } = &self.process;
        channel.is_some() || stdout.is_some() || stderr.is_some()
    }

    /// Something came over the channel; nothing when it was closed.
    pub(super) async fn heard(&mut self, received: &Received) {
        let (sender, bytes) = received.get();
        if bytes.is_empty() {
            // What it was saying is understood when it is known how it ended.
            self.process.channel = None;
        }
        let mut heard = Vec::new();
        let whole = self.lines.push(sender, bytes, |writer, line| {
            heard.extend(match writer {
                Writer::Host => Some(codec::decode(line)),
                Writer::Other => codec::decode_other(line),
            });
        });
        match &mut self.sharing {
            Some(sharing) => sharing.push(heard),
            None => self.held.extend(heard),
        }
        self.deliver().await;
        if whole == Err(TooLong) && !self.is_between_tests() {
            let what = format!("it wrote a line of more than {LINE_LIMIT} bytes");
            self.tell(HostInput::Garbage(what)).await;
        }
    }

    /// Delivers what was heard, up to a file that is being copied.
    pub(super) async fn deliver(&mut self) {
        if self.sharing.is_some() {
            return self.advance().await;
        }
        while self.copy.is_none()
            && let Some(line) = self.held.pop_front()
        {
            self.understand(line).await;
        }
    }

    fn is_between_tests(&self) -> bool {
        self.sharing.as_ref().is_some_and(Sharing::has_answered)
    }

    pub(super) async fn understand(&mut self, heard: Result<FromHost, String>) {
        let input = match heard {
            Ok(FromHost::Told(Notification::Attached(attachment))) => {
                return self.keep(attachment).await;
            }
            Ok(FromHost::Told(notification)) => HostInput::Told(notification),
            Ok(FromHost::Answered(id, reply)) => HostInput::Answered(id, reply),
            Err(what) => HostInput::Garbage(what),
        };
        self.tell(input).await;
    }

    pub(super) async fn printed(&mut self, stream: Stream, bytes: &[u8]) {
        if self.sharing.is_some() {
            return self.printed_shared(stream, bytes).await;
        }
        if bytes.is_empty() {
            match stream {
                Stream::Stdout => self.process.stdout = None,
                Stream::Stderr => self.process.stderr = None,
            }
        } else {
            self.tell(HostInput::Printed(stream, bytes.to_vec())).await;
        }
    }
}
