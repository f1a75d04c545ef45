//! A host that serves several assignments, one after the other: attributes each message
//! and each byte of output to one of them. See "Shared hosts" in `spec/protocol.md`.
//!
//! At the end of an assignment the host writes a marker to both outputs, and replies. The
//! task holds back everything after these three points until it has read all three. The
//! assignment ends when the host starts the next one, or immediately if none is pending.
//! Until then, the end of the host is attributed to the assignment.

use std::collections::VecDeque;

use rtf_model::protocol::{Notification, OWNER_VARIABLE, Plugin, Reply, Request};
use rtf_model::{ExitStatus, LeakedProcess, Phase, Stream};
use tokio::sync::mpsc;

use super::command::{Assignment, ProcessCommand};
use super::{ProcessEvent, ProcessTask};
use crate::codec::HostMessage;

/// The state of the current assignment.
pub(super) struct SharedHost {
    request: u64,
    marker: Vec<u8>,
    /// Whether the host has replied and continues.
    has_replied: bool,
    /// Whether the end of the assignment was reported.
    is_released: bool,
    /// Whether the marker was read from each output.
    is_marked: [bool; 2],
    /// The messages held back.
    messages: VecDeque<Result<HostMessage, String>>,
    /// The output held back.
    outputs: [Vec<u8>; 2],
    /// The number of assignments, including the current one.
    served: u32,
    /// The owner of leaked processes; `None` for the first assignment.
    leak_owner: Option<String>,
    /// The assignments that the host has not started.
    pending: VecDeque<Assignment>,
}

impl SharedHost {
    pub(super) fn new(request: u64, marker: &str) -> Self {
        Self {
            request,
            marker: marker.as_bytes().to_vec(),
            has_replied: false,
            is_released: false,
            is_marked: [false; 2],
            messages: VecDeque::new(),
            outputs: [Vec::new(), Vec::new()],
            served: 1,
            leak_owner: None,
            pending: VecDeque::new(),
        }
    }

    pub(super) fn push(&mut self, messages: Vec<Result<HostMessage, String>>) {
        self.messages.extend(messages);
    }

    /// Whether the host has replied: its next messages belong to no assignment.
    pub(super) fn has_replied(&self) -> bool {
        self.has_replied
    }

    /// Removes the output of the current assignment from the output held back.
    fn take_output(&mut self, stream: usize, is_open: bool) -> Vec<u8> {
        if self.is_marked[stream] {
            return Vec::new();
        }
        let (held, marker) = (&mut self.outputs[stream], &self.marker);
        if held.is_empty() {
            return Vec::new();
        }
        if let Some(index) = held.windows(marker.len()).position(|part| part == marker) {
            let text = held[..index].to_vec();
            held.drain(..index + marker.len());
            self.is_marked[stream] = true;
            return text;
        }
        // The output may end with a part of the marker.
        let longest = if is_open { held.len().min(marker.len() - 1) } else { 0 };
        let partial = (1..=longest).rev().find(|length| held.ends_with(&marker[..*length]));
        held.drain(..held.len() - partial.unwrap_or(0)).collect()
    }
}

impl ProcessTask {
    /// Adds the directory for attachments and the end marker to a request.
    pub(super) fn complete(&self, plugin: &mut Plugin, attachments_dir: &str, id: u64) {
        plugin.attachments_dir = Some(self.absolute(attachments_dir));
        if let Some(marker) = &mut plugin.end_marker {
            *marker = format!("\0rtf {} {id}\0", self.job.launch.scope);
        }
    }

    pub(super) fn assign(&mut self, mut assignment: Assignment) {
        let mut plugin = std::mem::take(&mut assignment.plugin);
        let request = assignment.request;
        self.complete(&mut plugin, &assignment.attachments_dir, request);
        assignment.plugin.end_marker = plugin.end_marker.clone();
        if let Some(shared) = &mut self.shared {
            shared.pending.push_back(assignment);
        }
        self.write(Some(request), Request::RunTest(plugin));
    }

    pub(super) async fn printed_by_shared_host(&mut self, stream: Stream, bytes: &[u8]) {
        if bytes.is_empty() {
            self.close_output(stream);
        }
        if let Some(shared) = &mut self.shared {
            shared.outputs[stream as usize].extend_from_slice(bytes);
        }
        self.advance().await;
    }

    /// Delivers the messages and output of the current assignment, and continues with the
    /// next one.
    pub(super) async fn advance(&mut self) {
        loop {
            while let Some(message) = self.next_message() {
                self.deliver_of_assignment(message).await;
            }
            for stream in [Stream::Stdout, Stream::Stderr] {
                let is_open = self.is_output_open(stream);
                let Some(shared) = &mut self.shared else { return };
                let text = shared.take_output(stream as usize, is_open);
                if !text.is_empty() {
                    self.report(ProcessEvent::Printed(stream, text)).await;
                }
            }
            if !self.is_delivered() || self.copy.is_some() {
                return;
            }
            let Some(shared) = &mut self.shared else { return };
            if shared.pending.is_empty() {
                if !shared.is_released {
                    shared.is_released = true;
                    let served = shared.served;
                    // The host is idle now.
                    if self.job.is_measured {
                        self.report_usage(Some(served)).await;
                    }
                    self.report(ProcessEvent::Released).await;
                }
                return;
            }
            let Some(message) = shared.messages.pop_front() else { return };
            if starts_assignment(&message) {
                self.start_next_assignment().await;
            } else {
                self.deliver_message(message).await;
            }
        }
    }

    /// The next message of the current assignment.
    fn next_message(&mut self) -> Option<Result<HostMessage, String>> {
        let is_copying = self.copy.is_some();
        let shared = self.shared.as_mut()?;
        if shared.has_replied || is_copying { None } else { shared.messages.pop_front() }
    }

    async fn deliver_of_assignment(&mut self, message: Result<HostMessage, String>) {
        if starts_assignment(&message) {
            return;
        }
        if let (Some(shared), Ok(HostMessage::Reply(id, Reply::Result(answer)))) =
            (&mut self.shared, &message)
        {
            shared.has_replied = *id == shared.request && answer["continues"] == true;
        }
        self.deliver_message(message).await;
    }

    fn is_output_open(&self, stream: Stream) -> bool {
        match stream {
            Stream::Stdout => self.process.stdout.is_some(),
            Stream::Stderr => self.process.stderr.is_some(),
        }
    }

    /// Whether all messages and output of the current assignment were delivered.
    fn is_delivered(&self) -> bool {
        self.shared.as_ref().is_some_and(|shared| {
            shared.has_replied
                && [Stream::Stdout, Stream::Stderr]
                    .into_iter()
                    .all(|stream| shared.is_marked[stream as usize] || !self.is_output_open(stream))
        })
    }

    async fn start_next_assignment(&mut self) {
        let Some(shared) = &mut self.shared else { return };
        let Some(next) = shared.pending.pop_front() else { return };
        let was_released = std::mem::take(&mut shared.is_released);
        (shared.has_replied, shared.is_marked) = (false, [false; 2]);
        shared.served += 1;
        (shared.request, shared.leak_owner) = (next.request, Some(next.leak_owner));
        shared.marker = next.plugin.end_marker.unwrap_or_default().into_bytes();
        if !was_released {
            self.report(ProcessEvent::Released).await;
        }
        (self.job.host, self.job.owner) = (next.host, next.owner);
        self.job.attachments_dir = next.attachments_dir;
    }

    /// Replaces the host's first owner by the current one in reports of leaked processes.
    pub(super) fn rename_leak_owner(&self, left: &mut [LeakedProcess]) {
        let Some(owner) = self.shared.as_ref().and_then(|shared| shared.leak_owner.as_ref()) else {
            return;
        };
        let env = &self.job.launch.request.env;
        let first = env.iter().rev().find(|(name, _)| name == OWNER_VARIABLE);
        for process in left {
            if process.owner.as_deref() == first.map(|(_, owner)| owner.as_str()) {
                process.owner = Some(owner.clone());
            }
        }
    }

    /// Returns the last event, and decides to which assignment it belongs.
    pub(super) fn final_event(
        &mut self,
        status: ExitStatus,
        left: Vec<LeakedProcess>,
    ) -> ProcessEvent {
        if let Some(shared) = &mut self.shared
            && shared.is_released
            && let Some(next) = shared.pending.pop_front()
        {
            self.job.host = next.host;
            return ProcessEvent::NotStarted(status);
        }
        ProcessEvent::Exited(status, left)
    }

    /// The process has ended: reports each assignment that has not started, or that is
    /// still sent, as such. Returns when all senders were dropped, so that no assignment
    /// is lost.
    pub(super) async fn refuse_assignments(
        &mut self,
        mut commands: mpsc::UnboundedReceiver<ProcessCommand>,
        status: ExitStatus,
    ) {
        let pending = self.shared.take().map(|shared| shared.pending);
        for next in pending.into_iter().flatten() {
            drop(self.events.send((next.host, ProcessEvent::NotStarted(status))).await);
        }
        while let Some(command) = commands.recv().await {
            if let ProcessCommand::Assign(next) = command {
                drop(self.events.send((next.host, ProcessEvent::NotStarted(status))).await);
            }
        }
    }
}

fn starts_assignment(message: &Result<HostMessage, String>) -> bool {
    matches!(message, Ok(HostMessage::Notification(Notification::Phase { phase: Phase::Load })))
}
