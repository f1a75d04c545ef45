//! One process of a program: starts it, reads its report, its output and its session, and
//! kills it at the limit of a case.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::os::fd::{AsFd, AsRawFd as _, BorrowedFd, OwnedFd};
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use rtf_model::ExitStatus;
use rtf_model::protocol::{SESSION_VARIABLE, STACK_FILE_VARIABLE};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::{Errno, FdFlags};
use rustix::pipe::PipeFlags;
use rustix::process::{Pid, PidfdFlags, Signal, pidfd_open};

use super::session_socket::{self, SessionSocket};
use super::{TestRun, stack};
use crate::case_reporter::CaseReporter;
use crate::framework::{
    Garbage, Launch, OpenChannel, OutputStream, ReportChannel, ReportReader, Selection,
};
use crate::listing;

/// How much is read at once.
const PIECE: usize = 64 * 1024;

/// How long nothing arrives before a reader reports cases that it holds back.
const RELEASE_WAIT: Duration = Duration::from_millis(200);

/// The longest line of standard error that a reason quotes.
const ERROR_LINE_BYTES: usize = 500;

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

/// How a process ended.
#[derive(Debug)]
pub(super) struct ProcessEnd {
    pub status: ExitStatus,
    pub termination: Termination,
    /// The last line that it wrote to standard error, if its output was watched.
    pub last_error_line: String,
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
    let (source, theirs, channel) = open_channel(test.framework.channel())
        .map_err(|error| format!("the channel for the report cannot be opened: {error}"))?;
    let (program, scratch) = (&test.program, test.scratch);
    let launch = Launch { test: program, cases: selection, channel, scratch };
    let mut command = test.framework.command(&launch)?;
    let (session, session_end) =
        session_socket::pair().map_err(|error| format!("the session cannot be opened: {error}"))?;
    let merged = open_outputs(&mut command, test, &launch)
        .map_err(|error| format!("the outputs of the program cannot be opened: {error}"))?;
    let mut child = spawn(command, test, &session_end)?;
    // Otherwise the end of the program's report would never arrive.
    drop((theirs, session_end));
    let pid = Pid::from_child(&child);
    test.running.set(Some(pid));
    // A stop request may have arrived before there was a process to stop.
    if test.session.interrupted() {
        test.running.signal(Signal::TERM);
    }
    let mut process = RunningProcess {
        test,
        session,
        source: source.or_else(|| stdout_source(&mut child, &launch.channel)),
        outputs: outputs(&mut child, merged),
        reader: test.framework.reader(&launch),
        limit,
        termination: Termination::Exited,
        last_error: LastLine::default(),
        piece: vec![0; PIECE],
    };
    let exited = pidfd_open(pid, PidfdFlags::empty());
    let exited = exited.map_err(|error| format!("the program cannot be watched: {error}"))?;
    process.read_until(exited.as_fd(), pid, cases);
    test.running.set(None);
    let status = child.wait().map_err(|error| format!("the program was lost: {error}"))?;
    let status = match (status.code(), status.signal()) {
        (Some(code), _) => ExitStatus::Code(code),
        (None, signal) => ExitStatus::Signal(signal.unwrap_or_default()),
    };
    process.drain(cases);
    // What the program left in its group must not run next to the next process.
    let _ = rustix::process::kill_process_group(pid, Signal::KILL);
    let RunningProcess { mut reader, mut termination, last_error, .. } = process;
    if test.is_stopping() {
        termination = Termination::Stopped;
    }
    let reports = matches!(termination, Termination::Exited | Termination::CaseTimeout(_));
    if reports
        && let Err(garbage) = reader.finish(status, cases)
        && let Termination::Exited = termination
    {
        termination = Termination::Garbage(garbage);
    }
    let crash_reason = reader.crash_reason();
    Ok(ProcessEnd { status, termination, last_error_line: last_error.text(), crash_reason })
}

/// Sets the streams of a program, and returns the pipe of merged outputs.
fn open_outputs(
    command: &mut Command,
    test: &TestRun<'_>,
    launch: &Launch<'_>,
) -> std::io::Result<Option<OwnedFd>> {
    let watches = test.framework.watches_output();
    command.stdin(Stdio::null());
    if watches && test.framework.merges_output(launch) {
        let (ours, theirs) = rustix::pipe::pipe_with(PipeFlags::CLOEXEC)?;
        command.stdout(theirs.try_clone()?).stderr(theirs);
        return Ok(Some(ours));
    }
    let is_piped = watches || test.framework.channel() == ReportChannel::Stdout;
    let stream = |is_piped| if is_piped { Stdio::piped() } else { Stdio::inherit() };
    command.stdout(stream(is_piped)).stderr(stream(watches));
    Ok(None)
}

fn spawn(mut command: Command, test: &TestRun<'_>, session: &OwnedFd) -> Result<Child, String> {
    command.process_group(0);
    command.env(SESSION_VARIABLE, format!("fd:{}", session.as_raw_fd()));
    command.env(STACK_FILE_VARIABLE, &test.stack_file);
    drop(std::fs::remove_file(&test.stack_file));
    command.spawn().map_err(|error| listing::not_started(command.get_program(), &error))
}

/// Where the report arrives.
enum Source {
    File(File),
    /// The program has not connected yet.
    Listener(TcpListener),
    Stream(TcpStream),
}

impl AsFd for Source {
    fn as_fd(&self) -> BorrowedFd<'_> {
        match self {
            Self::File(file) => file.as_fd(),
            Self::Listener(listener) => listener.as_fd(),
            Self::Stream(stream) => stream.as_fd(),
        }
    }
}

/// Opens the channel: our end, the program's end, and its address.
fn open_channel(
    channel: ReportChannel,
) -> std::io::Result<(Option<Source>, Option<OwnedFd>, OpenChannel)> {
    Ok(match channel {
        ReportChannel::None => (None, None, OpenChannel::None),
        ReportChannel::Stdout => (None, None, OpenChannel::Stdout),
        ReportChannel::Descriptor => {
            let (ours, theirs) = rustix::pipe::pipe_with(PipeFlags::CLOEXEC)?;
            rustix::io::ioctl_fionbio(&ours, true)?;
            rustix::io::fcntl_setfd(&theirs, FdFlags::empty())?;
            let path = format!("/dev/fd/{}", theirs.as_raw_fd());
            (Some(Source::File(ours.into())), Some(theirs), OpenChannel::Descriptor(path.into()))
        }
        ReportChannel::Socket => {
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
            listener.set_nonblocking(true)?;
            let address = listener.local_addr()?;
            (Some(Source::Listener(listener)), None, OpenChannel::Socket(address))
        }
    })
}

fn stdout_source(child: &mut Child, channel: &OpenChannel) -> Option<Source> {
    let stdout = child.stdout.take_if(|_| *channel == OpenChannel::Stdout)?;
    non_blocking(OwnedFd::from(stdout)).map(Source::File)
}

/// The watched outputs.
fn outputs(child: &mut Child, merged: Option<OwnedFd>) -> Vec<(OutputStream, File)> {
    let stdout = child.stdout.take().map(OwnedFd::from).or(merged);
    let stdout = stdout.map(|it| (OutputStream::Stdout, it));
    let stderr = child.stderr.take().map(|it| (OutputStream::Stderr, OwnedFd::from(it)));
    let outputs = stdout.into_iter().chain(stderr);
    outputs.filter_map(|(stream, fd)| Some((stream, non_blocking(fd)?))).collect()
}

fn non_blocking(fd: OwnedFd) -> Option<File> {
    rustix::io::ioctl_fionbio(&fd, true).ok()?;
    Some(fd.into())
}

/// The last line of a stream that is not blank.
#[derive(Debug, Default)]
struct LastLine {
    complete: Vec<u8>,
    open: Vec<u8>,
}

impl LastLine {
    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if byte != b'\n' {
                if self.open.len() < ERROR_LINE_BYTES {
                    self.open.push(byte);
                }
            } else if self.open.trim_ascii().is_empty() {
                self.open.clear();
            } else {
                self.complete = std::mem::take(&mut self.open);
            }
        }
    }

    fn text(&self) -> String {
        let last = if self.open.trim_ascii().is_empty() { &self.complete } else { &self.open };
        String::from_utf8_lossy(last.trim_ascii()).into_owned()
    }
}

/// Why a wait has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wakeup {
    /// The process has ended.
    Exit,
    /// Something arrived.
    Input,
    /// Nothing arrived in time.
    Limit,
}

/// The state of a running process.
struct RunningProcess<'a> {
    test: &'a TestRun<'a>,
    session: SessionSocket,
    source: Option<Source>,
    outputs: Vec<(OutputStream, File)>,
    reader: Box<dyn ReportReader>,
    limit: Option<Duration>,
    termination: Termination,
    last_error: LastLine,
    piece: Vec<u8>,
}

impl RunningProcess<'_> {
    /// Reads until the process has ended.
    fn read_until(&mut self, exited: BorrowedFd<'_>, pid: Pid, cases: &mut CaseReporter<'_>) {
        loop {
            let wait = self.time_left(cases);
            if wait == Some(Duration::ZERO) {
                self.end_case(pid);
            }
            let release = self.reader.holds_back().then_some(RELEASE_WAIT);
            let wakeup = self.wait(exited, wait.into_iter().chain(release).min());
            self.drain(cases);
            match wakeup {
                Wakeup::Exit => return,
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
    fn end_case(&mut self, pid: Pid) {
        let Some(limit) = self.limit else { return };
        let dump = stack::dump(self.test.framework.stack_dump(), pid, &self.test.stack_file);
        if let Some(text) = dump {
            self.test.session.stack(text);
        }
        self.termination = Termination::CaseTimeout(limit);
        self.test.running.signal(Signal::KILL);
    }

    /// Waits for an input or the end of the process.
    fn wait(&self, exited: BorrowedFd<'_>, limit: Option<Duration>) -> Wakeup {
        let input = |fd| PollFd::from_borrowed_fd(fd, PollFlags::IN);
        let mut fds = vec![input(exited), input(self.session.as_fd())];
        fds.extend(self.source.as_ref().map(|source| input(source.as_fd())));
        fds.extend(self.outputs.iter().map(|(_, file)| input(file.as_fd())));
        let limit = limit.and_then(|limit| Timespec::try_from(limit).ok());
        match poll(&mut fds, limit.as_ref()) {
            Ok(0) => Wakeup::Limit,
            Ok(_) if fds[0].revents().contains(PollFlags::IN) => Wakeup::Exit,
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
        if let Some(Source::Listener(listener)) = &self.source
            && let Ok((stream, _)) = listener.accept()
        {
            self.source = stream.set_nonblocking(true).ok().map(|()| Source::Stream(stream));
        }
        loop {
            let count = match &mut self.source {
                Some(Source::File(file)) => file.read(&mut self.piece),
                Some(Source::Stream(stream)) => stream.read(&mut self.piece),
                Some(Source::Listener(_)) | None => return,
            };
            match count {
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
                            self.last_error.add(bytes);
                        }
                    }
                    self.reader.output(stream, bytes, cases);
                }
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => index += 1,
                Err(_) => drop(self.outputs.remove(index)),
            }
        }
    }
}
