//! A network namespace that new processes enter.

use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::process::Command;
use std::sync::Arc;

use super::unix;

/// A network namespace, and the user namespace that owns it when that is not
/// the one of this process. It lives as long as this does.
#[derive(Debug)]
pub struct Namespaces {
    net: OwnedFd,
    user: Option<OwnedFd>,
}

impl Namespaces {
    /// The namespaces of these descriptors: the network's, then the user's.
    #[must_use]
    pub fn new(descriptors: Vec<OwnedFd>) -> Option<Self> {
        let mut descriptors = descriptors.into_iter();
        Some(Self { net: descriptors.next()?, user: descriptors.next() })
    }

    /// The descriptors, to be passed on: [`Namespaces::new`] takes them.
    pub fn descriptors(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        std::iter::once(&self.net).chain(&self.user).map(AsFd::as_fd)
    }

    /// Lets the process of a command enter before it executes its program.
    pub fn enter(self: &Arc<Self>, command: &mut Command) {
        unix::before_exec(command, self.clone());
    }

    /// Moves this process, which must have one thread only, into them.
    pub(super) fn enter_now(&self) -> std::io::Result<()> {
        // Who enters the user namespace may enter what it owns.
        if let Some(user) = &self.user {
            unix::enter(user.as_fd(), libc::CLONE_NEWUSER)?;
        }
        unix::enter(self.net.as_fd(), libc::CLONE_NEWNET)
    }
}
