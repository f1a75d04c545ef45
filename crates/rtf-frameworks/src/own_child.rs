//! Processes of the host, which no program has left behind.

use std::io;
use std::process::{Child, Command};

use rtf_process::tree;

/// Starts a process that the supervisor does not take for one that a program left. The caller
/// waits for its end, and then calls [`tree::remove_own_child`].
///
/// # Errors
/// It cannot be started.
pub fn spawn(command: &mut Command) -> io::Result<Child> {
    let pid_of = |child: &io::Result<Child>| child.as_ref().ok().map(|it| it.id().cast_signed());
    tree::start_own_child(|| command.spawn(), pid_of)
}
