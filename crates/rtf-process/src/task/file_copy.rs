//! Copies an attached file, or writes one, in a dedicated thread: a disk that does not respond
//! blocks no task, and the copy can be abandoned.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rtf_model::Attachment;
use rtf_model::protocol::Notification;
use rustix::fs::OFlags;
use tokio::sync::oneshot;
use tokio::time::Instant;

/// The largest file that the runner copies, in bytes.
const SIZE_LIMIT: u64 = 1024 * 1024 * 1024;
/// The limit for a copy.
const TIME_LIMIT: Duration = Duration::from_secs(60);
/// An abandoned copy ends after this many bytes.
const CHUNK_BYTES: u64 = 16 * 1024 * 1024;

/// A copy in progress.
#[derive(Debug)]
pub(super) struct FileCopy {
    /// The attachment to report when the copy is complete.
    pub(super) attachment: Attachment,
    /// The path that the process reported.
    pub(super) reported_path: String,
    deadline: Instant,
    done: oneshot::Receiver<io::Result<Vec<Notification>>>,
    abandoned: Arc<AtomicBool>,
}

impl FileCopy {
    /// Starts to copy a file. Then `next` returns what else is reported.
    pub(super) fn start(
        attachment: Attachment,
        (reported_path, from): (&str, PathBuf),
        (to, next): (PathBuf, impl FnOnce() -> Vec<Notification> + Send + 'static),
    ) -> io::Result<Self> {
        let abandoned = Arc::new(AtomicBool::new(false));
        let is_abandoned = Arc::clone(&abandoned);
        let copy = move || {
            let copied = copy(&from, &to, &is_abandoned);
            if copied.is_err() {
                let _ = std::fs::remove_file(&to);
            }
            copied.map(|()| next())
        };
        let mut started = Self::start_job(attachment, reported_path, copy)?;
        started.abandoned = abandoned;
        Ok(started)
    }

    /// Starts a job that writes or examines the file of an attachment and returns what else is reported.
    pub(super) fn start_job(
        attachment: Attachment,
        reported_path: &str,
        job: impl FnOnce() -> io::Result<Vec<Notification>> + Send + 'static,
    ) -> io::Result<Self> {
        let (finished, done) = oneshot::channel();
        // Not a thread of tokio: its runtime would wait for a disk that does not respond.
        std::thread::Builder::new().name("attachment".into()).spawn(move || {
            let _ = finished.send(job());
        })?;
        Ok(Self {
            attachment,
            reported_path: reported_path.to_owned(),
            deadline: Instant::now() + TIME_LIMIT,
            done,
            abandoned: Arc::default(),
        })
    }

    /// Waits for the end. Cancel safe.
    pub(super) async fn wait(&mut self) -> io::Result<Vec<Notification>> {
        match tokio::time::timeout_at(self.deadline, &mut self.done).await {
            Ok(Ok(copied)) => copied,
            Ok(Err(_)) => Err(io::Error::other("the thread that copies it has ended")),
            Err(_) => Err(io::Error::other(format!("it was not copied within {TIME_LIMIT:?}"))),
        }
    }
}

impl Drop for FileCopy {
    fn drop(&mut self) {
        self.abandoned.store(true, Ordering::Relaxed);
    }
}

/// Opens a file to attach, without blocking on a FIFO.
///
/// # Errors
/// It is not a regular file.
pub(super) fn open(path: &Path) -> io::Result<File> {
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    let flags = i32::try_from(flags.bits()).unwrap_or_default();
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path)?;
    let kind = file.metadata()?.file_type();
    let what = match () {
        () if kind.is_file() => None,
        () if kind.is_dir() => Some("a directory"),
        () if kind.is_fifo() => Some("a FIFO"),
        () => Some("a device or a socket"),
    };
    match what {
        Some(what) => Err(io::Error::other(format!("it is {what}, not a file"))),
        None => Ok(file),
    }
}

fn too_large() -> io::Error {
    io::Error::other(format!("it is larger than {} MiB", SIZE_LIMIT / 1024 / 1024))
}

fn copy(from: &Path, to: &Path, is_abandoned: &AtomicBool) -> io::Result<()> {
    let source = open(from)?;
    if source.metadata()?.len() > SIZE_LIMIT {
        return Err(too_large());
    }
    std::fs::create_dir_all(to.parent().unwrap_or(to))?;
    let no_link = i32::try_from(OFlags::NOFOLLOW.bits()).unwrap_or_default();
    let mut target = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .custom_flags(no_link)
        .open(to)?;
    let mut copied = 0;
    while !is_abandoned.load(Ordering::Relaxed) {
        let more = io::copy(&mut io::Read::take(&source, CHUNK_BYTES), &mut target)?;
        copied += more;
        if more == 0 {
            return Ok(());
        }
        if copied > SIZE_LIMIT {
            return Err(too_large());
        }
    }
    Err(io::Error::other("the copy was given up"))
}
