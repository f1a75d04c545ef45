//! Asks Git what its files alone do not show. The run does not depend on the answers.

use std::io::Read as _;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// How long a run may wait for Git, from the start of its planning.
const LIMIT: Duration = Duration::from_secs(2);

/// Running Git processes.
#[derive(Debug)]
pub struct GitQuery {
    /// The commit that they are about.
    pub commit: String,
    status: Process,
    author_time: Process,
    started: Instant,
}

/// The answers of Git; `None` for those that it did not give in time.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct GitAnswer {
    /// Whether tracked files differ from the commit.
    pub dirty: Option<bool>,
    /// The author time of the commit.
    pub author_time: Option<String>,
}

impl GitQuery {
    /// Starts Git; `None` if it is not installed.
    pub fn start(dir: &Path, commit: &str) -> Option<Self> {
        let status = ["status", "--porcelain", "--untracked-files=no"];
        let author_time = ["show", "--no-patch", "--format=%aI", commit];
        Some(Self {
            commit: commit.to_owned(),
            status: Process::start(dir, &status)?,
            author_time: Process::start(dir, &author_time)?,
            started: Instant::now(),
        })
    }

    /// Waits for the answers, at most until the limit.
    pub fn finish(mut self) -> GitAnswer {
        let until = self.started + LIMIT;
        let dirty = self.status.output(until, 1).map(|changes| !changes.is_empty());
        let time = self.author_time.output(until, 100);
        let time = time.and_then(|time| String::from_utf8(time).ok());
        let time = time.map(|time| time.trim().to_owned()).filter(|time| !time.is_empty());
        GitAnswer { dirty, author_time: time }
    }
}

#[derive(Debug)]
struct Process {
    child: Child,
    stdout: ChildStdout,
}

impl Process {
    fn start(dir: &Path, args: &[&str]) -> Option<Self> {
        let mut child = Command::new("git")
            // Neither writes to the repository nor executes commands of its configuration.
            .args(["--no-optional-locks", "-c", "core.fsmonitor=false"])
            .args(args)
            .current_dir(dir)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let stdout = child.stdout.take()?;
        Some(Self { child, stdout })
    }

    /// Its first bytes of output; `None` if it does not succeed in time.
    fn output(&mut self, until: Instant, limit: usize) -> Option<Vec<u8>> {
        let mut text = Vec::new();
        let mut buffer = [0; 100];
        while text.len() < limit {
            let rest = Timespec::try_from(until.saturating_duration_since(Instant::now())).ok()?;
            let mut wanted = [PollFd::new(&self.stdout, PollFlags::IN)];
            if poll(&mut wanted, Some(&rest)).ok()? == 0 {
                return None;
            }
            match self.stdout.read(&mut buffer).ok()? {
                0 => return self.child.wait().ok()?.success().then_some(text),
                read => text.extend_from_slice(&buffer[..read]),
            }
        }
        Some(text)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Without effect on a process that has ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
