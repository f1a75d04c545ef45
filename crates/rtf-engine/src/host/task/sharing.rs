//! A host that several tests share: which test each message and each byte
//! belongs to. See "Shared hosts" in `spec/protocol.md`.
//!
//! At the end of a test the host writes a mark to both outputs, and answers. What
//! comes behind these three places is held back until all three were reached.
//! Then the test is over as soon as the host says that it begins the next one;
//! or at once, when it was not asked for one. Until then its death is the test's.

use std::collections::VecDeque;

use rtf_model::protocol::{Notification, OWNER_VARIABLE, Plugin, Reply, Request};
use rtf_model::{ExitStatus, LeakedProcess, Phase, Source, Stream};
use tokio::sync::mpsc;

use super::{Order, Task, keep};
use crate::host::codec::FromHost;
use crate::host::usage;
use crate::run::machine::{HostId, HostInput};

/// A test that joins a host.
#[derive(Debug)]
pub struct Next {
    /// The host's id from the beginning of the test on.
    pub host: HostId,
    /// The test.
    pub source: Source,
    /// Whose processes are that it leaves: `test arm/EncoderTest`.
    pub owner: String,
    /// The number of the request.
    pub request: u64,
    /// The request.
    pub plugin: Plugin,
}

/// What is known of the present test.
pub(super) struct Sharing {
    request: u64,
    mark: Vec<u8>,
    /// Whether the host has answered, and stays.
    answered: bool,
    /// Whether it was told that the test is over.
    released: bool,
    /// Whether each output has ended, for this test.
    marked: [bool; 2],
    /// What is held back of the channel, and of each output.
    lines: VecDeque<Result<FromHost, String>>,
    outputs: [Vec<u8>; 2],
    /// How many tests the host has served, the present one included.
    served: u32,
    /// Whose leftovers those of the present test are; unless it was the first.
    owner: Option<String>,
    /// What the host was asked for, and has not begun.
    upcoming: VecDeque<Next>,
}

impl Sharing {
    /// Before the first test of a host.
    pub(super) fn new(request: u64, mark: &str) -> Self {
        Self {
            request,
            mark: mark.as_bytes().to_vec(),
            answered: false,
            released: false,
            marked: [false; 2],
            lines: VecDeque::new(),
            outputs: [Vec::new(), Vec::new()],
            served: 1,
            owner: None,
            upcoming: VecDeque::new(),
        }
    }

    /// Takes what came over the channel.
    pub(super) fn push(&mut self, lines: Vec<Result<FromHost, String>>) {
        self.lines.extend(lines);
    }

    /// Whether the present test was answered for: what the host says then belongs to none.
    pub(super) fn has_answered(&self) -> bool {
        self.answered
    }

    /// What one output has for the present test.
    fn take_output(&mut self, stream: usize, is_open: bool) -> Vec<u8> {
        if self.marked[stream] {
            return Vec::new();
        }
        let (held, mark) = (&mut self.outputs[stream], &self.mark);
        if held.is_empty() {
            return Vec::new();
        }
        if let Some(place) = held.windows(mark.len()).position(|part| part == mark) {
            let text = held[..place].to_vec();
            held.drain(..place + mark.len());
            self.marked[stream] = true;
            return text;
        }
        // Its end may be the beginning of the mark.
        let longest = if is_open { held.len().min(mark.len() - 1) } else { 0 };
        let kept = (1..=longest).rev().find(|length| held.ends_with(&mark[..*length]));
        held.drain(..held.len() - kept.unwrap_or(0)).collect()
    }
}

impl Task {
    /// What only this task knows of a request.
    pub(super) fn dress(&self, plugin: &mut Plugin, (source, host): (Source, HostId), id: u64) {
        let folder = self.shared.run_folder.join(keep::attachments_dir(source, host));
        plugin.attachments_dir = Some(folder.to_string_lossy().into_owned());
        if let Some(mark) = &mut plugin.end_marker {
            *mark = format!("\0rtf {} {id}\0", self.job.launch.scope);
        }
    }

    pub(super) async fn serve_next(&mut self, mut next: Next) {
        let mut plugin = std::mem::take(&mut next.plugin);
        self.dress(&mut plugin, (next.source, next.host), next.request);
        next.plugin.end_marker = plugin.end_marker.clone();
        let request = next.request;
        if let Some(sharing) = &mut self.sharing {
            sharing.upcoming.push_back(next);
        }
        self.write(Some(request), Request::RunTest(plugin));
    }

    pub(super) async fn printed_shared(&mut self, stream: Stream, bytes: &[u8]) {
        if bytes.is_empty() {
            match stream {
                Stream::Stdout => self.process.stdout = None,
                Stream::Stderr => self.process.stderr = None,
            }
        }
        if let Some(sharing) = &mut self.sharing {
            sharing.outputs[stream as usize].extend_from_slice(bytes);
        }
        self.advance().await;
    }

    /// Delivers what belongs to the present test, and goes on to the next.
    pub(super) async fn advance(&mut self) {
        loop {
            while let Some(line) = self.next_line() {
                self.understand_shared(line).await;
            }
            for stream in [Stream::Stdout, Stream::Stderr] {
                let is_open = self.is_output_open(stream);
                let Some(sharing) = &mut self.sharing else { return };
                let text = sharing.take_output(stream as usize, is_open);
                if !text.is_empty() {
                    self.tell(HostInput::Printed(stream, text)).await;
                }
            }
            if !self.is_behind_marks() || self.copy.is_some() {
                return;
            }
            let Some(sharing) = &mut self.sharing else { return };
            if sharing.upcoming.is_empty() {
                if !sharing.released {
                    sharing.released = true;
                    let served = sharing.served;
                    self.measure(served).await;
                    self.tell(HostInput::Released).await;
                }
                return;
            }
            let Some(line) = sharing.lines.pop_front() else { return };
            if begins_a_test(&line) {
                self.go_on().await;
            } else {
                self.understand(line).await;
            }
        }
    }

    /// Looks at the host, which has nothing to do now.
    async fn measure(&self, served: u32) {
        if self.job.measured {
            let usage = usage::of(self.process.pid, &self.job.launch.scope);
            self.tell(HostInput::Uses { usage, tests_served: Some(served) }).await;
        }
    }

    /// The next line of the present test.
    fn next_line(&mut self) -> Option<Result<FromHost, String>> {
        let is_copying = self.copy.is_some();
        let sharing = self.sharing.as_mut()?;
        if sharing.answered || is_copying { None } else { sharing.lines.pop_front() }
    }

    async fn understand_shared(&mut self, line: Result<FromHost, String>) {
        if begins_a_test(&line) {
            return;
        }
        if let (Some(sharing), Ok(FromHost::Answered(id, Reply::Result(answer)))) =
            (&mut self.sharing, &line)
        {
            sharing.answered = *id == sharing.request && answer["continues"] == true;
        }
        self.understand(line).await;
    }

    fn is_output_open(&self, stream: Stream) -> bool {
        match stream {
            Stream::Stdout => self.process.stdout.is_some(),
            Stream::Stderr => self.process.stderr.is_some(),
        }
    }

    /// Whether everything of the present test was delivered.
    fn is_behind_marks(&self) -> bool {
        let is_done = |sharing: &Sharing, stream: Stream| {
            sharing.marked[stream as usize] || !self.is_output_open(stream)
        };
        self.sharing.as_ref().is_some_and(|sharing| {
            sharing.answered && is_done(sharing, Stream::Stdout) && is_done(sharing, Stream::Stderr)
        })
    }

    /// The host has begun the next test.
    async fn go_on(&mut self) {
        let Some(sharing) = &mut self.sharing else { return };
        let Some(next) = sharing.upcoming.pop_front() else { return };
        let was_released = std::mem::take(&mut sharing.released);
        (sharing.answered, sharing.marked) = (false, [false; 2]);
        sharing.served += 1;
        (sharing.request, sharing.owner) = (next.request, Some(next.owner));
        sharing.mark = next.plugin.end_marker.unwrap_or_default().into_bytes();
        if !was_released {
            self.tell(HostInput::Released).await;
        }
        (self.job.host, self.job.source) = (next.host, next.source);
    }

    /// Names the present test as the owner of what was left.
    pub(super) fn disown(&self, left: &mut [LeakedProcess]) {
        let Some(owner) = self.sharing.as_ref().and_then(|sharing| sharing.owner.as_ref()) else {
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

    /// How the end of the process is told; under which id, is decided here, too.
    pub(super) fn end_of(&mut self, status: ExitStatus, left: Vec<LeakedProcess>) -> HostInput {
        if let Some(sharing) = &mut self.sharing
            && sharing.released
            && let Some(next) = sharing.upcoming.pop_front()
        {
            self.job.host = next.host;
            return HostInput::Unbegun(status);
        }
        HostInput::Exited(status, left)
    }

    /// The process has ended: every test that was sent to it and has not begun, or
    /// that is sent to it now, is reported as such. Returns when the suite's task
    /// has dropped all senders, so no order is lost in between.
    pub(super) async fn refuse(
        &mut self,
        mut orders: mpsc::UnboundedReceiver<Order>,
        status: ExitStatus,
    ) {
        let upcoming = self.sharing.take().map(|sharing| sharing.upcoming);
        for next in upcoming.into_iter().flatten() {
            drop(self.inputs.send((next.host, HostInput::Unbegun(status))).await);
        }
        while let Some(order) = orders.recv().await {
            if let Order::ServeNext(next) = order {
                drop(self.inputs.send((next.host, HostInput::Unbegun(status))).await);
            }
        }
    }
}

fn begins_a_test(line: &Result<FromHost, String>) -> bool {
    matches!(line, Ok(FromHost::Told(Notification::Phase { phase: Phase::Load })))
}
