//! Gives a process group the foreground of the runner's terminal, as a shell does with a
//! job: signals of the keyboard go to it, and it may read.

use std::io;
use std::os::fd::{AsFd, OwnedFd};

use rustix::process::Pid;
use rustix::termios::{OptionalActions, Termios, tcgetattr, tcgetpgrp, tcsetattr, tcsetpgrp};

/// The foreground of the terminal on standard input. It is restored on drop, with the
/// settings that the terminal had.
#[derive(Debug)]
pub struct Foreground {
    terminal: OwnedFd,
    before: Pid,
    settings: Termios,
}

impl Foreground {
    /// Gives the foreground to a process group of this session.
    ///
    /// This process must block or ignore SIGTTOU.
    ///
    /// # Errors
    /// Standard input is not the terminal of this session.
    pub(crate) fn give(group: i32) -> io::Result<Self> {
        let terminal = io::stdin().as_fd().try_clone_to_owned()?;
        let group = Pid::from_raw(group).ok_or(io::ErrorKind::InvalidInput)?;
        let (before, settings) = (tcgetpgrp(&terminal)?, tcgetattr(&terminal)?);
        tcsetpgrp(&terminal, group)?;
        Ok(Self { terminal, before, settings })
    }
}

impl Drop for Foreground {
    fn drop(&mut self) {
        // Both fail if the terminal or the group is gone.
        let _ = tcsetattr(&self.terminal, OptionalActions::Drain, &self.settings);
        let _ = tcsetpgrp(&self.terminal, self.before);
    }
}
