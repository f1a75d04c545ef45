//! The fork server of a program whose cases run in a process each: the program is executed
//! and linked once, and stops before its own constructors or before `main`. See "Forked
//! programs" in `spec/frameworks.md`.

use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io;
use std::os::fd::{AsFd, AsRawFd as _, BorrowedFd, OwnedFd, RawFd};
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rtf_model::protocol::{FORK_VARIABLE, PROGRAM_FORKS_VARIABLE};
use rtf_process::{descriptor_passing, tree};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::{FdFlags, retry_on_intr};
use rustix::net::{
    AddressFamily, RecvFlags, SendFlags, Shutdown, SocketFlags, SocketType, recv, socketpair,
};
use rustix::process::{Pid, Signal, WaitOptions, kill_process, waitpid};

use crate::{elf, own_child, preload, report_dir};

const LIBRARY: &str = "librtf-fork-server.so";

/// Variables of the dynamic linker whose libraries may not support forks.
const LINKER_VARIABLES: [&str; 2] = ["LD_PRELOAD", "LD_AUDIT"];

/// Has the linker resolve all functions in the server, instead of in each process.
const BIND_VARIABLE: &str = "LD_BIND_NOW";

/// The time to execute and link a program. Without an answer, its cases are executed.
const START_LIMIT: Duration = Duration::from_secs(10);

/// How often a wait checks whether the test is being stopped.
const STOP_CHECK: Duration = Duration::from_millis(50);

/// The time that the server has to end by itself.
const END_LIMIT: Duration = Duration::from_secs(1);

/// Where the program waits and is forked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ForkPoint {
    /// Before its own constructors.
    Start,
    /// After them.
    Main,
}

/// A program that waits before its start, and is forked for each case.
#[derive(Debug)]
pub(super) struct ForkServer {
    socket: OwnedFd,
    process: Child,
    /// Keep their numbers free in all processes of the program.
    session: File,
    report: File,
}

/// The descriptors of a forked program.
#[derive(Debug)]
pub(super) struct ProgramEnds<'a> {
    pub outputs: &'a [OwnedFd; 2],
    pub session: &'a OwnedFd,
    pub report: Option<&'a OwnedFd>,
}

impl ForkServer {
    /// Starts a server with a command that would only list the cases, if the server did not
    /// stop it. `None` if the program's processes must be executed.
    pub(super) fn start(
        command: Command,
        point: ForkPoint,
        scratch: &Path,
        is_stopping: impl Fn() -> bool,
    ) -> Option<Self> {
        let inherits = LINKER_VARIABLES.iter().any(|name| std::env::var_os(name).is_some());
        let is_disabled = std::env::var_os(FORK_VARIABLE).is_some_and(|mode| mode == "never");
        if inherits || is_disabled || !elf::loads_libraries(Path::new(command.get_program())) {
            return None;
        }
        let server = Self::spawn(command, point, scratch)?;
        server.answers(is_stopping).then_some(server)
    }

    fn spawn(mut command: Command, point: ForkPoint, scratch: &Path) -> Option<Self> {
        let libraries = [Some(preload::library(LIBRARY)?), preload::library(report_dir::LIBRARY)];
        let libraries: Vec<_> = libraries.into_iter().flatten().collect();
        preload::add(&mut command, &libraries, scratch).ok()?;
        let (session, report) = (placeholder().ok()?, placeholder().ok()?);
        let flags = SocketFlags::CLOEXEC;
        let (socket, theirs) =
            socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, flags, None).ok()?;
        rustix::io::fcntl_setfd(&theirs, FdFlags::empty()).ok()?;
        let point = if point == ForkPoint::Main { ",main" } else { "" };
        command.env(PROGRAM_FORKS_VARIABLE, format!("{}{point}", theirs.as_raw_fd()));
        command.env(BIND_VARIABLE, "1");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        rtf_host::reset_signals(&mut command);
        command.process_group(0);
        let process = own_child::spawn(&mut command).ok()?;
        Some(Self { socket, process, session, report })
    }

    /// The server's process id, which is also that of the group of the process forked ahead.
    pub(super) fn pid(&self) -> Pid {
        Pid::from_child(&self.process)
    }

    /// Waits for the first packet: the server's process id.
    fn answers(&self, is_stopping: impl Fn() -> bool) -> bool {
        let limit = Instant::now() + START_LIMIT;
        while Instant::now() < limit && !is_stopping() {
            match is_readable(&self.socket, STOP_CHECK) {
                Ok(false) => {}
                Ok(true) => {
                    return self.number().is_ok_and(|id| id == i64::from(self.process.id()));
                }
                Err(_) => return false,
            }
        }
        false
    }

    /// The number of the session's descriptor in the program.
    pub(super) fn session_number(&self) -> RawFd {
        self.session.as_raw_fd()
    }

    /// The number of the report's descriptor in the program.
    pub(super) fn report_number(&self) -> RawFd {
        self.report.as_raw_fd()
    }

    /// Runs this command in the process that the server has forked ahead, in a new process
    /// group. It is a child of this process.
    pub(super) fn fork(&self, command: &Command, ends: &ProgramEnds<'_>) -> io::Result<Pid> {
        let [stdout, stderr] = ends.outputs;
        let mut fds: Vec<(RawFd, BorrowedFd<'_>)> = vec![
            (rustix::stdio::raw_stdout(), stdout.as_fd()),
            (rustix::stdio::raw_stderr(), stderr.as_fd()),
            (self.session_number(), ends.session.as_fd()),
        ];
        fds.extend(ends.report.map(|report| (self.report_number(), report.as_fd())));
        let (numbers, descriptors): (Vec<_>, Vec<_>) = fds.into_iter().unzip();
        let pid = self.process_ahead()?;
        // The process does the same. Either way, the group exists from now on.
        let _ = rustix::process::setpgid(Some(pid), Some(pid));
        let request = request(&numbers, command);
        descriptor_passing::send(self.socket.as_fd(), &request, &descriptors, SendFlags::empty())?;
        Ok(pid)
    }

    /// The process that waits for the next request.
    fn process_ahead(&self) -> io::Result<Pid> {
        let pid = i32::try_from(self.number()?).ok().filter(|pid| *pid > 0);
        pid.and_then(Pid::from_raw).ok_or_else(|| io::Error::other("the program cannot be forked"))
    }

    /// Receives a number; it is negative after an error.
    fn number(&self) -> io::Result<i64> {
        let mut bytes = [0; 32];
        let (length, _) = retry_on_intr(|| recv(&self.socket, &mut bytes, RecvFlags::empty()))?;
        let text = std::str::from_utf8(&bytes[..length]).unwrap_or_default();
        text.parse().map_err(|_| io::Error::other("the fork server has ended"))
    }
}

impl Drop for ForkServer {
    /// Ends the server and the process that it has forked ahead, which exit when nothing more
    /// can be requested.
    fn drop(&mut self) {
        let _ = rustix::net::shutdown(&self.socket, Shutdown::Write);
        let mut ahead = Vec::new();
        while is_readable(&self.socket, END_LIMIT).unwrap_or(false) {
            match self.process_ahead() {
                Ok(pid) => ahead.push(pid),
                Err(_) => break,
            }
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
        tree::remove_own_child(self.process.id().cast_signed());
        for pid in ahead {
            let _ = kill_process(pid, Signal::KILL);
            let _ = retry_on_intr(|| waitpid(Some(pid), WaitOptions::empty()));
        }
    }
}

/// Waits until there is something to receive, or the other end is closed.
fn is_readable(socket: &OwnedFd, limit: Duration) -> rustix::io::Result<bool> {
    let limit = Timespec::try_from(limit).unwrap_or_default();
    let mut fds = [PollFd::new(socket, PollFlags::IN)];
    Ok(retry_on_intr(|| poll(&mut fds, Some(&limit)))? > 0)
}

/// A descriptor that programs inherit.
fn placeholder() -> io::Result<File> {
    let file = File::open("/dev/null")?;
    rustix::io::fcntl_setfd(&file, FdFlags::empty())?;
    Ok(file)
}

/// The strings of a request, each with a zero byte at its end.
fn request(numbers: &[RawFd], command: &Command) -> Vec<u8> {
    let numbers: Vec<String> = numbers.iter().map(RawFd::to_string).collect();
    let args: Vec<&OsStr> =
        std::iter::once(command.get_program()).chain(command.get_args()).collect();
    let mut strings = vec![numbers.join(",").into(), OsString::from(args.len().to_string())];
    strings.extend(args.into_iter().map(OsStr::to_owned));
    // The server's own variables. The command may set them again.
    strings.push(PROGRAM_FORKS_VARIABLE.into());
    for name in preload::VARIABLES.into_iter().chain([BIND_VARIABLE]) {
        strings.push(assignment(OsStr::new(name), std::env::var_os(name).as_deref()));
    }
    strings.extend(command.get_envs().map(|(name, value)| assignment(name, value)));
    strings.iter().flat_map(|string| string.as_bytes().iter().copied().chain([0])).collect()
}

/// `NAME=VALUE`, or `NAME` for a variable to remove.
fn assignment(name: &OsStr, value: Option<&OsStr>) -> OsString {
    let mut text = name.to_owned();
    if let Some(value) = value {
        text.push("=");
        text.push(value);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_has_descriptors_arguments_and_variables() {
        let mut command = Command::new("/arm_test");
        command
            .arg("--case=Arm.Moves")
            .arg("")
            .env("RTF_SESSION", "fd:7")
            .env_remove("GTEST_FILTER");
        let text = String::from_utf8(request(&[1, 2, 7], &command)).unwrap();
        let own = |name| assignment(OsStr::new(name), std::env::var_os(name).as_deref());
        let own = ["LD_PRELOAD", "ASAN_OPTIONS", "LD_BIND_NOW"].map(own);
        let own = own.map(|it| it.into_string().unwrap()).join("|");
        let expected = format!(
            "1,2,7|3|/arm_test|--case=Arm.Moves||RTF_PROGRAM_FORKS|{own}|GTEST_FILTER|RTF_SESSION=fd:7|"
        );
        assert_eq!(text.replace('\0', "|"), expected);
    }
}
