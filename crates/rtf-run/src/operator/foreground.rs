//! Which process may read from the terminal.

use std::io;

use rtf_engine::guard;
use rustix::process::Pid;
use rustix::termios::{tcgetpgrp, tcsetpgrp};

/// Which process group has the foreground of the terminal, and so may read from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Foreground {
    /// That of the guard, which the user started.
    Guard,
    /// That of this process, the runner.
    Runner,
    /// Another one: the run is in the background of a shell.
    Other,
}

/// The group of the guard, this process's parent.
pub(super) fn guard_group() -> Option<Pid> {
    rustix::process::getpgid(rustix::process::getppid()).ok()
}

/// Which group has it now; `guard` is that of the guard.
pub(super) fn foreground(guard: Option<Pid>) -> Foreground {
    match tcgetpgrp(io::stdin()).ok() {
        Some(group) if group == rustix::process::getpgrp() => Foreground::Runner,
        group if group.is_some() && group == guard => Foreground::Guard,
        _ => Foreground::Other,
    }
}

/// The foreground of the terminal while this process reads an answer. The guard blocks SIGTTOU in
/// both processes. Ctrl-C then interrupts this process, which handles it like the guard.
pub(super) struct BorrowedForeground(Option<Pid>);

impl BorrowedForeground {
    /// Takes it from the guard; `None` if that does not have it.
    pub(super) fn take(guard: Option<Pid>) -> Option<Self> {
        let take = || tcsetpgrp(io::stdin(), rustix::process::getpgrp()).is_ok();
        let has = match foreground(guard) {
            Foreground::Runner => true,
            Foreground::Guard => take(),
            Foreground::Other => false,
        };
        has.then_some(Self(guard))
    }
}

impl Drop for BorrowedForeground {
    fn drop(&mut self) {
        if let (Foreground::Runner, Some(guard)) = (foreground(self.0), self.0) {
            // Fails if the terminal is gone.
            let _ = tcsetpgrp(io::stdin(), guard);
        }
    }
}

/// Takes the terminal back from a runner that has died while it read an answer.
pub fn recover_terminal(had_foreground: bool) {
    if had_foreground {
        guard::permit_background_output();
        let _ = tcsetpgrp(io::stdin(), rustix::process::getpgrp());
    }
}

/// Whether this process is in the foreground of its terminal.
pub fn has_foreground() -> bool {
    foreground(guard_group()) == Foreground::Runner
}
