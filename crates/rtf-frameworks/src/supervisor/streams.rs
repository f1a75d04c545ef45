//! The streams of a process: where its report, its outputs and its session arrive.

use std::fs::File;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::os::fd::{AsFd, AsRawFd as _, BorrowedFd, OwnedFd, RawFd};

use rustix::io::FdFlags;
use rustix::pipe::PipeFlags;

use crate::framework::{Framework, Launch, OpenChannel, OutputStream, ReportChannel};

/// The first descriptor after the standard streams.
const AFTER_STANDARD: RawFd = 3;

/// Where the report arrives.
pub(super) enum Source {
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

/// The channel of a report.
pub(super) struct Channel {
    /// Our end, except of standard output.
    pub source: Option<Source>,
    /// The program's end, which it inherits.
    pub theirs: Option<OwnedFd>,
    /// Its address.
    pub address: OpenChannel,
}

/// Opens a channel. `number` is the program's number of its descriptor, if it is not ours.
pub(super) fn open_channel(
    channel: ReportChannel,
    number: Option<RawFd>,
) -> std::io::Result<Channel> {
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
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
            listener.set_nonblocking(true)?;
            let address = OpenChannel::Socket(listener.local_addr()?);
            (Some(Source::Listener(listener)), None, address)
        }
    };
    Ok(Channel { source, theirs, address })
}

/// The outputs of a process.
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

/// A pipe: our end, which does not block, and the program's end.
fn pipe() -> std::io::Result<(File, OwnedFd)> {
    let (ours, theirs) = rustix::pipe::pipe_with(PipeFlags::CLOEXEC)?;
    Ok((non_blocking(ours)?, theirs))
}

fn non_blocking(fd: OwnedFd) -> std::io::Result<File> {
    rustix::io::ioctl_fionbio(&fd, true)?;
    Ok(fd.into())
}
