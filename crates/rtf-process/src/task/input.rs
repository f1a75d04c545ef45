//! Processes the messages and the output of a process.

use std::time::Duration;

use rtf_model::protocol::Notification;
use rtf_model::{ExitStatus, Stream};

use super::line_assembly::{LineWriter, TooLong};
use super::shared_host::SharedHost;
use super::streams::{Buffers, Received, read, receive};
use super::{ProcessEvent, ProcessTask};
use crate::codec::{self, HostMessage, LINE_LIMIT};
use crate::process::StartedProcess;
use crate::spawn_request::ProcessRole;

/// The number of reads after the limit: enough for the contents of a socket and two
/// pipes, but not for an endless flood.
const LATE_READS: u32 = 64;

impl ProcessTask {
    /// Delivers a line without an end, unless the process was killed.
    pub(super) async fn deliver_last_line(&mut self, status: ExitStatus) {
        let line = self.lines.take_rest();
        if !line.is_empty() && !self.has_no_assignment() && matches!(status, ExitStatus::Code(_)) {
            self.deliver_message(codec::decode(&line)).await;
        }
    }

    /// Reads the remaining output. The limit applies to waiting, not to reading.
    pub(super) async fn drain(&mut self, buffers: &mut Buffers, limit: Duration) {
        let limit = tokio::time::Instant::now() + limit;
        let mut late_reads = 0;
        while self.is_open() && late_reads < LATE_READS {
            late_reads += u32::from(tokio::time::Instant::now() >= limit);
            let process = &mut self.process;
            tokio::select! {
                biased;
                () = receive(&process.channel, &mut buffers.channel) =>
                    self.received(&buffers.channel).await,
                _ = read(&mut process.stdout, &mut buffers.stdout) =>
                    self.printed(Stream::Stdout, &buffers.stdout).await,
                _ = read(&mut process.stderr, &mut buffers.stderr) =>
                    self.printed(Stream::Stderr, &buffers.stderr).await,
                () = tokio::time::sleep_until(limit) => return,
            }
        }
    }

    fn is_open(&self) -> bool {
        let StartedProcess { channel, stdout, stderr, .. } = &self.process;
        channel.is_some() || stdout.is_some() || stderr.is_some()
    }

    /// Processes bytes of the channel; none when it was closed.
    pub(super) async fn received(&mut self, received: &Received) {
        let (sender, bytes) = received.get();
        if bytes.is_empty() {
            // An incomplete line waits for the exit status.
            self.process.channel = None;
        }
        let mut messages = Vec::new();
        let whole = self.lines.push(sender, bytes, |writer, line| {
            messages.extend(match writer {
                LineWriter::Host => Some(codec::decode(line)),
                LineWriter::Other => codec::decode_other(line),
            });
        });
        match &mut self.shared {
            Some(shared) => shared.push(messages),
            None => self.held_back.extend(messages),
        }
        self.deliver().await;
        if whole == Err(TooLong) && !self.has_no_assignment() {
            let what = format!("it wrote a line of more than {LINE_LIMIT} bytes");
            self.report(ProcessEvent::ProtocolViolated(what)).await;
        }
    }

    /// Delivers the received messages, up to an attachment that is being copied.
    pub(super) async fn deliver(&mut self) {
        if self.shared.is_some() {
            return self.advance().await;
        }
        while self.copy.is_none()
            && let Some(line) = self.held_back.pop_front()
        {
            self.deliver_message(line).await;
        }
    }

    pub(super) fn is_test(&self) -> bool {
        self.role() == Some(ProcessRole::Test)
    }

    fn has_no_assignment(&self) -> bool {
        self.shared.as_ref().is_some_and(SharedHost::has_replied)
    }

    pub(super) async fn deliver_message(&mut self, message: Result<HostMessage, String>) {
        let event = match message {
            Ok(HostMessage::Notification(Notification::Attached(attachment))) => {
                return self.store_attachment(attachment).await;
            }
            Ok(HostMessage::Notification(Notification::QuestionAsked(question))) => {
                ProcessEvent::Notified(Notification::QuestionAsked(self.with_picture(question)))
            }
            Ok(HostMessage::Notification(Notification::Trajectory(check))) if self.is_test() => {
                return self.check_trajectory(check).await;
            }
            Ok(HostMessage::Notification(notification)) => {
                if self.is_test() {
                    self.record_samples(&notification);
                }
                ProcessEvent::Notified(notification)
            }
            Ok(HostMessage::Reply(id, reply)) => ProcessEvent::Replied(id, reply),
            Err(what) => ProcessEvent::ProtocolViolated(what),
        };
        self.report(event).await;
    }

    pub(super) async fn printed(&mut self, stream: Stream, bytes: &[u8]) {
        if self.shared.is_some() {
            self.printed_by_shared_host(stream, bytes).await;
        } else if bytes.is_empty() {
            self.close_output(stream);
        } else {
            self.report(ProcessEvent::Printed(stream, bytes.to_vec())).await;
        }
    }

    pub(super) fn close_output(&mut self, stream: Stream) {
        match stream {
            Stream::Stdout => self.process.stdout = None,
            Stream::Stderr => self.process.stderr = None,
        }
    }
}
