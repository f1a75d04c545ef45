//! Descriptors and memory: what the runner keeps for itself, and what the
//! processes get that it starts.
//!
//! - The runner may have as many descriptors as the system allows; what it starts
//!   has the limit that the user gave.
//! - Some descriptors are kept in [`Reserve`], so that a hook can be started when
//!   there are no others.
//! - When memory runs out, the kernel is to choose a test, a host or a fixture,
//!   never the runner or its guard.

use std::fs::File;
use std::io;
use std::os::fd::OwnedFd;
use std::process::Command;
use std::sync::{LazyLock, OnceLock};

use rustix::process::{Pid, Resource, Rlimit, getrlimit, prlimit, setrlimit};

use super::unix;

/// How much more likely the kernel ends a process than the runner when memory
/// runs out: as if it used half of what there is.
const EXPENDABLE: i32 = 500;
/// The most that the kernel knows.
const MOST_EXPENDABLE: i32 = 1000;
/// How many descriptors are kept at the most.
const KEPT: usize = 32;
/// Which part of all that there may be is kept.
const PART: u64 = 4;

/// The limit of descriptors that the user gave, when this process has another.
static GIVEN: OnceLock<Rlimit> = OnceLock::new();

/// The runner's own likelihood to be ended by the kernel, which it hands on.
static OWN: LazyLock<i32> = LazyLock::new(|| {
    let text = std::fs::read_to_string("/proc/self/oom_score_adj").unwrap_or_default();
    text.trim().parse().unwrap_or_default()
});

/// Lets this process have as many descriptors as the system allows.
pub fn raise_descriptor_limit() {
    let given = getrlimit(Resource::Nofile);
    let raised = Rlimit { current: given.maximum, maximum: given.maximum };
    if given.current != given.maximum && setrlimit(Resource::Nofile, raised).is_ok() {
        let _ = GIVEN.set(given);
    }
}

/// Gives a process that does not do anything yet the user's limit of descriptors.
pub fn limit_descriptors(pid: i32) {
    if let (Some(given), Some(pid)) = (GIVEN.get(), Pid::from_raw(pid)) {
        // One that has ended needs none.
        let _ = prlimit(Some(pid), Resource::Nofile, *given);
    }
}

/// Gives the process of a command that begins at once the user's limit of
/// descriptors.
pub fn limit_descriptors_of(command: &mut Command) {
    if let Some(given) = GIVEN.get().copied() {
        unix::before_exec(command, move || Ok(setrlimit(Resource::Nofile, given)?));
    }
}

/// Lets the kernel choose this process, and what it will start, before the runner
/// when memory runs out.
pub fn make_expendable(pid: i32) {
    let score = (*OWN).max(0).saturating_add(EXPENDABLE).min(MOST_EXPENDABLE);
    // One that has ended needs none.
    let _ = std::fs::write(format!("/proc/{pid}/oom_score_adj"), score.to_string());
}

/// Descriptors that are kept for hooks and fixtures.
#[derive(Debug, Default)]
pub struct Reserve(Vec<OwnedFd>);

impl Reserve {
    /// Keeps as many as there are, up to the limit.
    pub fn fill(&mut self) {
        while self.0.len() < kept() {
            match File::open("/dev/null") {
                Ok(file) => self.0.push(file.into()),
                Err(_) => return,
            }
        }
    }

    /// Gives some back, for a hook all of them.
    pub fn release(&mut self, for_hook: bool) {
        // Fixtures leave half of them to hooks.
        self.0.truncate(if for_hook { 0 } else { kept() / 2 });
    }
}

fn kept() -> usize {
    let most = getrlimit(Resource::Nofile)
        .current
        .map_or(KEPT, |limit| usize::try_from(limit / PART).unwrap_or(KEPT));
    most.min(KEPT)
}

/// Whether there are no descriptors left.
#[must_use]
pub fn is_exhausted(error: &io::Error) -> bool {
    matches!(error.raw_os_error(), Some(libc::EMFILE | libc::ENFILE))
}
