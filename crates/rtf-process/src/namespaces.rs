//! A network namespace that new processes enter.

use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::process::Command;
use std::sync::Arc;

use crate::unix;

/// A network namespace, and the user namespace that owns it unless that is the one of
/// this process. They exist at least as long as this value.
#[derive(Debug)]
pub struct Namespaces {
    net: OwnedFd,
    user: Option<OwnedFd>,
}

impl PartialEq for Namespaces {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl Eq for Namespaces {}

impl Namespaces {
    /// Creates the value from the descriptors of the network's namespace and, if any,
    /// the user's.
    pub fn new(descriptors: Vec<OwnedFd>) -> Option<Self> {
        let mut descriptors = descriptors.into_iter();
        Some(Self { net: descriptors.next()?, user: descriptors.next() })
    }

    /// Returns the descriptors in the order that [`Namespaces::new`] takes.
    pub fn descriptors(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        std::iter::once(&self.net).chain(&self.user).map(AsFd::as_fd)
    }

    /// Makes the process of a command enter before it executes its program.
    pub fn enter(self: &Arc<Self>, command: &mut Command) {
        let namespaces = self.clone();
        unix::before_exec(command, move || {
            // Membership of the user namespace permits to enter what it owns.
            if let Some(user) = &namespaces.user {
                unix::enter_namespace(user.as_fd(), libc::CLONE_NEWUSER)?;
            }
            unix::enter_namespace(namespaces.net.as_fd(), libc::CLONE_NEWNET)
        });
    }
}
