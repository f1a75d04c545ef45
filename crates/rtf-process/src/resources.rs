//! Descriptors and memory: the shares of the runner and of the processes that it starts.
//!
//! - The runner raises its descriptor limit to the hard limit; the processes that it
//!   starts get the user's limit.
//! - A [`DescriptorReserve`] makes sure that a hook can be started.
//! - When memory runs out, the kernel should choose a test, a host or a fixture, never
//!   the runner or its guard.

use std::fs::File;
use std::io;
use std::os::fd::OwnedFd;
use std::process::Command;
use std::sync::{LazyLock, OnceLock};

use rustix::process::{Pid, Resource, Rlimit, getrlimit, prlimit, setrlimit};

use crate::unix;

/// The kernel treats a process as if it used this share of the memory in addition, in
/// 1/1000.
const EXPENDABLE: i32 = 500;
/// The kernel's highest score.
const MAX_SCORE: i32 = 1000;
/// The size of the reserve, and the share (1/4) of all descriptors that it may take.
const RESERVE: usize = 32;
const RESERVE_SHARE: u64 = 4;

/// The user's descriptor limit, if the runner has raised its own.
static USER_LIMIT: OnceLock<Rlimit> = OnceLock::new();

/// The runner's out-of-memory score, which its children inherit.
static OWN_SCORE: LazyLock<i32> = LazyLock::new(|| {
    let text = std::fs::read_to_string("/proc/self/oom_score_adj").unwrap_or_default();
    text.trim().parse().unwrap_or_default()
});

/// Raises the descriptor limit of this process to the hard limit.
pub fn raise_descriptor_limit() {
    let given = getrlimit(Resource::Nofile);
    let raised = Rlimit { current: given.maximum, maximum: given.maximum };
    if given.current != given.maximum && setrlimit(Resource::Nofile, raised).is_ok() {
        let _ = USER_LIMIT.set(given);
    }
}

/// Sets the user's descriptor limit for a process that waits for its greeting.
pub fn limit_descriptors(pid: i32) {
    if let (Some(given), Some(pid)) = (USER_LIMIT.get(), Pid::from_raw(pid)) {
        // Fails if it has ended.
        let _ = prlimit(Some(pid), Resource::Nofile, *given);
    }
}

/// Sets the user's descriptor limit for a command that does not wait for a greeting. Returns
/// whether the runner has another one.
pub fn limit_descriptors_of(command: &mut Command) -> bool {
    let given = USER_LIMIT.get().copied();
    if let Some(given) = given {
        unix::before_exec(command, move || Ok(setrlimit(Resource::Nofile, given)?));
    }
    given.is_some()
}

/// Makes the kernel choose this process and its future children before the runner when
/// memory runs out.
pub fn make_expendable(pid: i32) {
    let score = (*OWN_SCORE).max(0).saturating_add(EXPENDABLE).min(MAX_SCORE);
    // Fails if it has ended.
    let _ = std::fs::write(format!("/proc/{pid}/oom_score_adj"), score.to_string());
}

/// Descriptors that are reserved for hooks and fixtures.
#[derive(Debug, Default)]
pub struct DescriptorReserve(Vec<OwnedFd>);

impl DescriptorReserve {
    /// Reserves as many as possible, up to the limit.
    pub fn fill(&mut self) {
        while self.0.len() < reserve_size() {
            match File::open("/dev/null") {
                Ok(file) => self.0.push(file.into()),
                Err(_) => return,
            }
        }
    }

    /// Releases half of the reserve, for a hook all of it.
    pub fn release(&mut self, for_hook: bool) {
        self.0.truncate(if for_hook { 0 } else { reserve_size() / 2 });
    }
}

fn reserve_size() -> usize {
    let most = getrlimit(Resource::Nofile)
        .current
        .map_or(RESERVE, |limit| usize::try_from(limit / RESERVE_SHARE).unwrap_or(RESERVE));
    most.min(RESERVE)
}

/// Whether the error means that no descriptor is left.
pub fn is_exhausted(error: &io::Error) -> bool {
    matches!(error.raw_os_error(), Some(libc::EMFILE | libc::ENFILE))
}
