//! One process of a program: starts it, reads its report, its output and its session, and
//! kills it at the limit of a case.

use std::collections::HashMap;
use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::{AsFd, AsRawFd as _, BorrowedFd, OwnedFd};
use std::os::unix::process::CommandExt as _;
use std::process::{Command, Stdio};
use std::time::Duration;

use rtf_model::ExitStatus;
use rtf_model::protocol::{SESSION_VARIABLE, STACK_FILE_VARIABLE};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::{Errno, retry_on_intr};
use rustix::process::{Pid, PidfdFlags, Signal, WaitOptions, pidfd_open, waitpid};

use super::fork_server::ProgramEnds;
use super::session_socket::{self, SessionSocket};
use super::streams::{self, Source};
use super::{TestRun, stack};
use crate::case::Selection;
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, Launch, ReportChannel, ReportReader};
use crate::last_output::{LastOutput, OutputStream};
use crate::{listing, report_dir};

/// How much is read at once.
const PIECE: usize = 64 * 1024;

/// How long nothing arrives before a reader reports cases that it holds back.
const RELEASE_WAIT: Duration = Duration::from_millis(200);

/// How long packets are collected that the program does not expect answers to.
const PAUSE: Duration = Duration::from_millis(2);

/// Why a process ended.
#[derive(Debug)]
pub(super) enum Termination {
    /// By itself.
    Exited,
    /// The runner stopped the test.
    Stopped,
    /// A case exceeded this limit.
    CaseTimeout(Duration),
    /// Its report could not be read.
    Garbage(Garbage),
}

#[derive(Debug)]
pub(super) struct ProcessEnd {
    pub status: ExitStatus,
    pub termination: Termination,
    /// What it printed last, if its output was watched.
    pub last_output: LastOutput,
    /// Why it died, if it or its framework printed that.
    pub crash_reason: Option<String>,
}

/// Runs a process until it has ended and everything that it wrote is read.
pub(super) fn run(
    test: &TestRun<'_>,
    selection: Selection<'_>,
    limit: Option<Duration>,
    cases: &mut CaseReporter<'_>,
) -> Result<ProcessEnd, String> {
    let mut process = start(test, selection, limit, cases.results())?;
    let pid = process.pid;
    test.running.set(Some(pid));
    // A stop request may have arrived before there was a process to stop.
    if test.session.interrupted() {
        test.running.signal(Signal::TERM);
    }
    let exited = pidfd_open(pid, PidfdFlags::empty());
    let exited = exited.map_err(|error| format!("the program cannot be watched: {error}"))?;
    process.read_until(exited.as_fd(), cases);
    test.running.set(None);
    let status = wait_for(pid).map_err(|error| format!("the program was lost: {error}"))?;
    process.drain(cases);
    let RunningProcess { mut reader, mut termination, last_output, source, mut outputs, .. } =
        process;
    if test.is_stopping() {
        termination = Termination::Stopped;
        let report = match source {
            Some(Source::File(file)) if test.framework.channel() == ReportChannel::Stdout => {
                outputs.push((OutputStream::Stdout, file));
                None
            }
            report => report,
        };
        test.running.keep_reading(outputs, report);
    }
    let is_killed = !matches!(termination, Termination::Exited);
    let reports = matches!(termination, Termination::Exited | Termination::CaseTimeout(_));
    if reports
        && let Err(garbage) = reader.finish(status, cases)
        && let Termination::Exited = termination
    {
        termination = Termination::Garbage(garbage);
    }
    let crash_reason = reader.crash_reason();
    // What the program left must not run next to the next process. After a stop, the runner waits
    // for the rest.
    if !matches!(termination, Termination::Stopped) {
        cases.leave(test.sweep(is_killed.then_some(pid)));
    }
    Ok(ProcessEnd { status, termination, last_output, crash_reason })
}

/// Starts a process: forks it if there is a fork server, which is given up when it fails.
fn start<'a>(
    test: &'a TestRun<'a>,
    selection: Selection<'_>,
    limit: Option<Duration>,
    finished: &HashMap<String, bool>,
) -> Result<RunningProcess<'a>, String> {
    let server = test.fork_server.take();
    let report_number = server.as_ref().map(super::fork_server::ForkServer::report_number);
    let channel = streams::open_channel(test.framework.channel(), report_number, test.scratch)
        .map_err(|error| format!("the channel for the report cannot be opened: {error}"))?;
    let launch = Launch {
        test: &test.program,
        cases: selection,
        channel: channel.address,
        wanted: test.wanted,
        finished,
        scratch: test.scratch,
    };
    let mut command = test.framework.command(&launch)?;
    if test.framework.has_own_report() {
        report_dir::prepare(&mut command, &launch, server.is_none())?;
    }
    let (session, session_end) =
        session_socket::pair().map_err(|error| format!("the session cannot be opened: {error}"))?;
    let outputs = streams::open_outputs(test.framework, &launch)
        .map_err(|error| format!("the outputs of the program cannot be opened: {error}"))?;
    command.env(STACK_FILE_VARIABLE, &test.stack_file);
    drop(std::fs::remove_file(&test.stack_file));
    let ends = ProgramEnds {
        outputs: &outputs.theirs,
        session: &session_end,
        report: channel.theirs.as_ref(),
    };
    let pid = match server {
        None => execute(command, &ends)?,
        Some(server) => {
            command.env(SESSION_VARIABLE, format!("fd:{}", server.session_number()));
            let Ok(pid) = server.fork(&command, &ends) else {
                drop(server);
                return start(test, selection, limit, finished);
            };
            test.fork_server.set(Some(server));
            pid
        }
    };
    // The program's ends are closed here. Otherwise the end of its report would never arrive.
    Ok(RunningProcess {
        test,
        pid,
        session,
        is_session_closed: false,
        source: channel.source.or(outputs.report),
        outputs: outputs.watched,
        reader: test.framework.reader(&launch),
        limit,
        termination: Termination::Exited,
        last_output: LastOutput::default(),
        piece: vec![0; PIECE],
    })
}

fn execute(mut command: Command, ends: &ProgramEnds<'_>) -> Result<Pid, String> {
    let own = |fd: &OwnedFd| fd.try_clone().map(Stdio::from);
    let [stdout, stderr] = ends.outputs;
    let outputs = own(stdout).and_then(|stdout| Ok((stdout, own(stderr)?)));
    let (stdout, stderr) =
        outputs.map_err(|error| format!("the outputs of the program cannot be opened: {error}"))?;
    command.stdin(Stdio::null()).stdout(stdout).stderr(stderr);
    command.env(SESSION_VARIABLE, format!("fd:{}", ends.session.as_raw_fd()));
    command.process_group(0);
    rtf_host::reset_signals(&mut command);
    let child = command.spawn();
    let child = child.map_err(|error| listing::not_started(command.get_program(), &error))?;
    Ok(Pid::from_child(&child))
}

/// Waits for the end of a child process.
fn wait_for(pid: Pid) -> rustix::io::Result<ExitStatus> {
    let ended = retry_on_intr(|| waitpid(Some(pid), WaitOptions::empty()))?;
    let (_, status) = ended.ok_or(Errno::CHILD)?;
    Ok(match status.exit_status() {
        Some(code) => ExitStatus::Code(code),
        None => ExitStatus::Signal(status.terminating_signal().unwrap_or_default()),
    })
}

/// Why a wait has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wakeup {
    Exit,
    /// Something arrived.
    Input,
    /// Nothing arrived in time.
    Limit,
}

struct RunningProcess<'a> {
    test: &'a TestRun<'a>,
    pid: Pid,
    session: SessionSocket,
    /// Whether the program, and everything that it started, has closed its end of the session.
    is_session_closed: bool,
    source: Option<Source>,
    outputs: Vec<(OutputStream, File)>,
    reader: Box<dyn ReportReader>,
    limit: Option<Duration>,
    termination: Termination,
    last_output: LastOutput,
    piece: Vec<u8>,
}

impl RunningProcess<'_> {
    /// Reads until the process has ended.
    fn read_until(&mut self, exited: BorrowedFd<'_>, cases: &mut CaseReporter<'_>) {
        loop {
            let wait = self.time_left(cases);
            if wait == Some(Duration::ZERO) {
                self.end_case();
            }
            let release = self.reader.holds_back().then_some(RELEASE_WAIT);
            let wakeup = self.wait(exited, wait.into_iter().chain(release).min());
            self.drain(cases);
            match wakeup {
                Wakeup::Exit => return,
                Wakeup::Input if self.session.is_relaxed() => std::thread::sleep(PAUSE),
                Wakeup::Input => {}
                Wakeup::Limit => self.reader.release(cases),
            }
        }
    }

    /// The time until the running case reaches its limit.
    fn time_left(&self, cases: &CaseReporter<'_>) -> Option<Duration> {
        let limit = self.limit.filter(|_| matches!(self.termination, Termination::Exited))?;
        let (_, started) = cases.running()?;
        Some(limit.saturating_sub(started.elapsed()))
    }

    /// Ends a process whose case exceeded its limit.
    fn end_case(&mut self) {
        let Some(limit) = self.limit else { return };
        let dump = stack::dump(self.test.framework.stack_dump(), self.pid, &self.test.stack_file);
        if let Some(text) = dump {
            self.test.session.stack(text);
        }
        self.termination = Termination::CaseTimeout(limit);
        self.test.running.signal(Signal::KILL);
    }

    /// Waits for an input or the end of the process.
    fn wait(&mut self, exited: BorrowedFd<'_>, limit: Option<Duration>) -> Wakeup {
        let input = |fd| PollFd::from_borrowed_fd(fd, PollFlags::IN);
        let mut fds = vec![input(exited)];
        // A closed session always has an input: waiting for the end of the program with it would
        // take a processor from the program.
        let watches_session = !self.is_session_closed;
        fds.extend(watches_session.then(|| input(self.session.as_fd())));
        fds.extend(self.source.iter().flat_map(Source::fds).map(input));
        fds.extend(self.outputs.iter().map(|(_, file)| input(file.as_fd())));
        let limit = limit.and_then(|limit| Timespec::try_from(limit).ok());
        let ready = poll(&mut fds, limit.as_ref());
        let has_exited = fds[0].revents().contains(PollFlags::IN);
        // What it has sent before is read next, and there is nothing more.
        let is_closed = watches_session && fds[1].revents().contains(PollFlags::HUP);
        self.is_session_closed |= is_closed;
        match ready {
            Ok(0) => Wakeup::Limit,
            Ok(_) if has_exited => Wakeup::Exit,
            Ok(_) | Err(Errno::INTR) => Wakeup::Input,
            Err(_) => Wakeup::Exit,
        }
    }

    /// Reads everything that has arrived. A packet of the session belongs to the case that
    /// the report has announced before.
    fn drain(&mut self, cases: &mut CaseReporter<'_>) {
        self.drain_report(cases);
        self.drain_outputs(cases);
        while let Some(packet) = self.session.receive() {
            self.drain_report(cases);
            self.drain_outputs(cases);
            self.session.handle(&packet, self.test.fixture_values, cases);
        }
    }

    fn drain_report(&mut self, cases: &mut CaseReporter<'_>) {
        while let Some(source) = &mut self.source {
            match source.read(&mut self.piece) {
                Ok(0) => self.source = None,
                Ok(count) => self.read_report(count, cases),
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => return,
                Err(_) => self.source = None,
            }
        }
    }

    /// Parses a piece of the report. After garbage, the rest is only output.
    fn read_report(&mut self, count: usize, cases: &mut CaseReporter<'_>) {
        let bytes = &self.piece[..count];
        if let Termination::Garbage(_) = self.termination {
            if self.test.framework.channel() == ReportChannel::Stdout {
                cases.output(bytes);
            }
        } else if let Err(garbage) = self.reader.report(bytes, cases) {
            self.termination = Termination::Garbage(garbage);
            self.test.running.signal(Signal::KILL);
        }
    }

    /// Passes on the watched outputs.
    fn drain_outputs(&mut self, cases: &mut CaseReporter<'_>) {
        let mut index = 0;
        while let Some((stream, file)) = self.outputs.get_mut(index) {
            let stream = *stream;
            match file.read(&mut self.piece) {
                Ok(0) => drop(self.outputs.remove(index)),
                Ok(count) => {
                    let bytes = &self.piece[..count];
                    match stream {
                        OutputStream::Stdout => cases.output(bytes),
                        OutputStream::Stderr => {
                            drop(std::io::stderr().write_all(bytes));
                        }
                    }
                    self.last_output.add(stream, bytes);
                    self.reader.output(stream, bytes, cases);
                }
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => index += 1,
                Err(_) => drop(self.outputs.remove(index)),
            }
        }
        self.reader.settle(cases);
    }
}
