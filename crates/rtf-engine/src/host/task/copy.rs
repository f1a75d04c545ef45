//! A file that a process attaches is copied by a thread of its own: a disk that does not
//! answer holds up nobody, and the copy can be given up.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rtf_model::Attachment;
use rustix::fs::OFlags;
use tokio::sync::oneshot;
use tokio::time::Instant;

/// How large a file may be that the runner copies.
const SIZE_LIMIT: u64 = 1024 * 1024 * 1024;
/// How long a copy may take.
const LIMIT: Duration = Duration::from_secs(60);
/// So much is copied before it is seen that the copy was given up.
const CHUNK_BYTES: u64 = 16 * 1024 * 1024;

/// A copy on its way.
#[derive(Debug)]
pub(super) struct Copy {
    /// What is attached, as it is told when the copy is there.
    pub(super) attachment: Attachment,
    /// The path that the process gave.
    pub(super) given: String,
    until: Instant,
    done: oneshot::Receiver<io::Result<()>>,
    given_up: Arc<AtomicBool>,
}

impl Copy {
    /// Begins to copy a file.
    pub(super) fn begin(
        attachment: Attachment,
        (given, from): (&str, PathBuf),
        to: PathBuf,
    ) -> io::Result<Self> {
        let (tell, done) = oneshot::channel();
        let given_up = Arc::new(AtomicBool::new(false));
        let is_given_up = Arc::clone(&given_up);
        // Not tokio's: its runtime would wait for a thread whose disk does not answer.
        std::thread::Builder::new().name("attachment".into()).spawn(move || {
            let copied = copy(&from, &to, &is_given_up);
            if copied.is_err() {
                // There may be a part of it.
                let _ = std::fs::remove_file(&to);
            }
            let _ = tell.send(copied);
        })?;
        Ok(Self {
            attachment,
            given: given.to_owned(),
            until: Instant::now() + LIMIT,
            done,
            given_up,
        })
    }

    /// Waits for the end. May be dropped and called again.
    pub(super) async fn wait(&mut self) -> io::Result<()> {
        match tokio::time::timeout_at(self.until, &mut self.done).await {
            Ok(Ok(copied)) => copied,
            Ok(Err(_)) => Err(io::Error::other("the thread that copies it is gone")),
            Err(_) => Err(io::Error::other(format!("it was not copied within {LIMIT:?}"))),
        }
    }
}

impl Drop for Copy {
    fn drop(&mut self) {
        self.given_up.store(true, Ordering::Relaxed);
    }
}

/// Opens a file that may be attached, without waiting for another process.
///
/// # Errors
/// It is no regular file.
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

fn copy(from: &Path, to: &Path, is_given_up: &AtomicBool) -> io::Result<()> {
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
    while !is_given_up.load(Ordering::Relaxed) {
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
