//! The streams of a process: where its report, its outputs and its session arrive.

use std::fs::File;
use std::io::{ErrorKind, Read, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::os::fd::{AsFd, AsRawFd as _, BorrowedFd, OwnedFd, RawFd};
use std::path::Path;

use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::{FdFlags, retry_on_intr};
use rustix::pipe::PipeFlags;

use crate::framework::{Framework, Launch, OpenChannel, ReportChannel};
use crate::last_output::OutputStream;
use crate::report_dir;

/// The first descriptor after the standard streams.
const AFTER_STANDARD: RawFd = 3;

/// Where the report arrives.
pub(super) enum Source {
    File(File),
    Socket(ReportSocket),
}

impl Source {
    /// The descriptors at which something can arrive.
    pub(super) fn fds(&self) -> Vec<BorrowedFd<'_>> {
        match self {
            Self::File(file) => vec![file.as_fd()],
            Self::Socket(socket) => socket.fds(),
        }
    }
}

impl Read for Source {
    fn read(&mut self, piece: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Self::File(file) => file.read(piece),
            Self::Socket(socket) => socket.read(piece),
        }
    }
}

/// The socket to which a program connects. Only its first connection is the report: processes
/// that execute the program again connect, too, and end if the connection is refused.
pub(super) struct ReportSocket {
    listener: TcpListener,
    /// The first connection, also after its end.
    report: Option<TcpStream>,
    has_ended: bool,
    others: Vec<TcpStream>,
}

impl ReportSocket {
    fn listen() -> std::io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, report: None, has_ended: false, others: Vec::new() })
    }

    fn fds(&self) -> Vec<BorrowedFd<'_>> {
        let report = self.report.as_ref().filter(|_| !self.has_ended);
        let streams = report.into_iter().chain(&self.others).map(AsFd::as_fd);
        std::iter::once(self.listener.as_fd()).chain(streams).collect()
    }

    fn accept(&mut self) {
        while let Ok((stream, _)) = self.listener.accept() {
            if stream.set_nonblocking(true).is_err() {
                continue;
            }
            match self.report {
                None => self.report = Some(stream),
                Some(_) => self.others.push(stream),
            }
        }
    }

    /// Reads what other processes send: they would block otherwise.
    fn discard_others(&mut self, piece: &mut [u8]) {
        self.others.retain_mut(|stream| {
            loop {
                match stream.read(piece) {
                    Ok(0) => return false,
                    Ok(_) => {}
                    Err(error) if error.kind() == ErrorKind::Interrupted => {}
                    Err(error) => return error.kind() == ErrorKind::WouldBlock,
                }
            }
        });
    }

    /// Reads from the report; it would block after its end, because others may connect.
    fn read(&mut self, piece: &mut [u8]) -> std::io::Result<usize> {
        self.accept();
        self.discard_others(piece);
        let Some(report) = self.report.as_mut().filter(|_| !self.has_ended) else {
            return Err(ErrorKind::WouldBlock.into());
        };
        match report.read(piece) {
            Err(error)
                if matches!(error.kind(), ErrorKind::Interrupted | ErrorKind::WouldBlock) =>
            {
                Err(error)
            }
            Ok(count) if count > 0 => Ok(count),
            Ok(_) | Err(_) => {
                self.has_ended = true;
                Err(ErrorKind::WouldBlock.into())
            }
        }
    }
}

/// The channel of a report.
pub(super) struct Channel {
    /// Our end, except of standard output.
    pub source: Option<Source>,
    /// The program's end, which it inherits.
    pub theirs: Option<OwnedFd>,
    pub address: OpenChannel,
}

/// Opens a channel, and offers the report. `number` is the program's number of its descriptor, if
/// it is not ours.
pub(super) fn open_channel(
    channel: ReportChannel,
    number: Option<RawFd>,
    scratch: &Path,
) -> std::io::Result<Channel> {
    let mut channel = connect_channel(channel, number)?;
    if let OpenChannel::Descriptor(path) = &channel.address {
        report_dir::offer(scratch, Some(path))?;
        // Frameworks separate parts of an argument with them.
        if !scratch.to_string_lossy().contains([',', ':']) {
            channel.address = OpenChannel::Descriptor(report_dir::log(scratch));
        }
    } else if let OpenChannel::Socket(_) = &channel.address {
        report_dir::offer(scratch, None)?;
    }
    Ok(channel)
}

fn connect_channel(channel: ReportChannel, number: Option<RawFd>) -> std::io::Result<Channel> {
    let (source, theirs, address) = match channel {
        ReportChannel::None => (None, None, OpenChannel::None),
        ReportChannel::Stdout => (None, None, OpenChannel::Stdout),
        ReportChannel::Descriptor => {
            let (ours, theirs) = rustix::pipe::pipe_with(PipeFlags::CLOEXEC)?;
            rustix::io::fcntl_setfd(&theirs, FdFlags::empty())?;
            let number = number.unwrap_or_else(|| theirs.as_raw_fd());
            let address = OpenChannel::Descriptor(format!("/dev/fd/{number}").into());
            (Some(Source::File(non_blocking(ours)?)), Some(theirs), address)
        }
        ReportChannel::Socket => {
            let socket = ReportSocket::listen()?;
            let address = OpenChannel::Socket(socket.listener.local_addr()?);
            (Some(Source::Socket(socket)), None, address)
        }
    };
    Ok(Channel { source, theirs, address })
}

pub(super) struct Outputs {
    /// Standard output, if it is the report.
    pub report: Option<Source>,
    /// Our ends of the watched ones.
    pub watched: Vec<(OutputStream, File)>,
    /// The program's ends: standard output and standard error.
    pub theirs: [OwnedFd; 2],
}

/// Opens the outputs. Those that are not read are this process's.
pub(super) fn open_outputs(
    framework: &dyn Framework,
    launch: &Launch<'_>,
) -> std::io::Result<Outputs> {
    let watches = framework.watches_output(launch);
    if watches && framework.merges_output(launch) {
        let (ours, theirs) = pipe()?;
        let theirs = [theirs.try_clone()?, theirs];
        return Ok(Outputs { report: None, watched: vec![(OutputStream::Stdout, ours)], theirs });
    }
    let (mut report, mut watched) = (None, Vec::new());
    let stdout = if launch.channel == OpenChannel::Stdout {
        let (ours, theirs) = pipe()?;
        report = Some(Source::File(ours));
        theirs
    } else if watches {
        let (ours, theirs) = pipe()?;
        watched.push((OutputStream::Stdout, ours));
        theirs
    } else {
        rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdout(), AFTER_STANDARD)?
    };
    let stderr = if watches {
        let (ours, theirs) = pipe()?;
        watched.push((OutputStream::Stderr, ours));
        theirs
    } else {
        rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stderr(), AFTER_STANDARD)?
    };
    Ok(Outputs { report, watched, theirs: [stdout, stderr] })
}

/// Passes on what processes print that a stopped program has left, until they have closed the
/// outputs: while they use their grace, a write to a closed pipe would kill them.
pub(super) fn pass_on(mut outputs: Vec<(OutputStream, File)>) {
    let mut piece = [0; 4096];
    while !outputs.is_empty() {
        let watched = outputs.iter().map(|(_, file)| PollFd::new(file, PollFlags::IN));
        let mut fds: Vec<PollFd<'_>> = watched.collect();
        if retry_on_intr(|| poll(&mut fds, None)).is_err() {
            return;
        }
        outputs.retain_mut(|(stream, file)| match file.read(&mut piece) {
            Ok(0) => false,
            Ok(count) => {
                let bytes = &piece[..count];
                // The runner may be gone.
                drop(match stream {
                    OutputStream::Stdout => std::io::stdout().write_all(bytes),
                    OutputStream::Stderr => std::io::stderr().write_all(bytes),
                });
                drop(std::io::stdout().flush());
                true
            }
            Err(error) => matches!(error.kind(), ErrorKind::Interrupted | ErrorKind::WouldBlock),
        });
    }
}

/// A pipe: our end, which does not block, and the program's end.
fn pipe() -> std::io::Result<(File, OwnedFd)> {
    let (ours, theirs) = rustix::pipe::pipe_with(PipeFlags::CLOEXEC)?;
    Ok((non_blocking(ours)?, theirs))
}

fn non_blocking(fd: OwnedFd) -> std::io::Result<File> {
    rustix::io::ioctl_fionbio(&fd, true)?;
    Ok(fd.into())
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    #[test]
    fn only_the_first_connection_is_the_report_and_nobody_waits() {
        let mut socket = ReportSocket::listen().unwrap();
        let address = socket.listener.local_addr().unwrap();
        let (mut piece, mut report) = (vec![0; 1024], Vec::new());
        let mut first = TcpStream::connect(address).unwrap();
        first.write_all(b"first").unwrap();
        while report.len() < 5 {
            if let Ok(count) = socket.read(&mut piece) {
                report.extend_from_slice(&piece[..count]);
            }
        }
        // More than the kernel keeps, after the end of the first one.
        drop(first);
        let second = std::thread::spawn(move || {
            TcpStream::connect(address).unwrap().write_all(&vec![b'2'; 32 << 20]).unwrap();
        });
        while !second.is_finished() {
            let read = socket.read(&mut piece);
            assert_eq!(read.map_err(|error| error.kind()), Err(ErrorKind::WouldBlock));
        }
        second.join().unwrap();
        assert_eq!((report.as_slice(), socket.others.len() <= 1), (&b"first"[..], true));
    }
}
