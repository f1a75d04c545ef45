//! The process that holds a suite's network namespace.
//!
//! It is this program once more, with one thread, as entering a user namespace
//! demands. It makes the namespaces, passes them to the runner, and from then
//! on opens a TCP socket in them whenever it is asked: a socket belongs to the
//! namespace in which it was opened, whoever connects it. It ends with the
//! runner's end of its channel.

use std::fs;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use rtf_model::protocol::CHANNEL_VARIABLE;
use rustix::net::{AddressFamily, SocketFlags, SocketType, socket_with};
use serde::{Deserialize, Serialize};

use super::{pass, unix};

/// The longest message of the holder.
pub const MESSAGE_BYTES: usize = 4096;
/// Asks for a socket of IPv4.
pub const FOUR: u8 = b'4';
/// Asks for a socket of IPv6.
pub const SIX: u8 = b'6';
/// A socket comes beside it.
pub const OPENED: u8 = b'+';
/// There is no such socket.
pub const NOT_OPENED: u8 = b'-';

/// What the holder says first.
#[derive(Debug, Serialize, Deserialize)]
pub struct Hello {
    /// Whether there is a user namespace, too.
    pub user: bool,
    /// Why there is no namespace: what was refused, and what may be done.
    pub refused: Option<String>,
}

/// Makes the namespaces and holds them until the runner is gone.
///
/// # Errors
/// This process was not started by a runner, or the runner is gone.
pub fn hold() -> io::Result<()> {
    let address = std::env::var(CHANNEL_VARIABLE).map_err(io::Error::other)?;
    let fd = address.strip_prefix("fd:").and_then(|fd| fd.parse().ok());
    let channel = unix::inherited(fd.ok_or_else(|| io::Error::other("not a channel"))?)?;
    let (hello, beside) = match make() {
        Ok(made) => (Hello { user: made.len() > 1, refused: None }, made),
        Err(refused) => (Hello { user: false, refused: Some(refused) }, Vec::new()),
    };
    let refused = hello.refused.is_some();
    let descriptors: Vec<_> = beside.iter().map(AsFd::as_fd).collect();
    pass::send(channel.as_fd(), &serde_json::to_vec(&hello)?, &descriptors)?;
    if refused { Ok(()) } else { serve(channel.as_fd()) }
}

fn serve(channel: BorrowedFd<'_>) -> io::Result<()> {
    loop {
        let mut asked = [0];
        let (read, _) = pass::receive(channel, &mut asked)?;
        if read == 0 {
            return Ok(());
        }
        let family = if asked == [SIX] { AddressFamily::INET6 } else { AddressFamily::INET };
        match socket_with(family, SocketType::STREAM, SocketFlags::CLOEXEC, None) {
            Ok(socket) => pass::send(channel, &[OPENED], &[socket.as_fd()])?,
            Err(_) => pass::send(channel, &[NOT_OPENED], &[])?,
        }
    }
}

/// Makes the namespaces; in words why not.
fn make() -> Result<Vec<OwnedFd>, String> {
    let (uid, gid) = (rustix::process::geteuid().as_raw(), rustix::process::getegid().as_raw());
    let as_root = unix::unshare(libc::CLONE_NEWNET);
    let user = match as_root {
        Ok(()) => false,
        Err(_) => {
            unix::unshare(libc::CLONE_NEWUSER | libc::CLONE_NEWNET).map_err(|error| {
                let advice = advice();
                format!("the system refuses a user namespace with a network ({error}); {advice}")
            })?;
            true
        }
    };
    if user {
        // Without it, groups may not be mapped.
        let mapped = fs::write("/proc/self/setgroups", "deny")
            .and_then(|()| fs::write("/proc/self/uid_map", format!("{uid} {uid} 1")))
            .and_then(|()| fs::write("/proc/self/gid_map", format!("{gid} {gid} 1")));
        mapped.map_err(|error| {
            let advice = advice();
            format!(
                "the system refuses to map user {uid} into a user namespace ({error}); {advice}"
            )
        })?;
    }
    up().map_err(|error| {
        let advice = advice();
        format!("the system refuses to bring the loopback interface up ({error}); {advice}")
    })?;
    let mut names = vec!["/proc/self/ns/net"];
    names.extend(user.then_some("/proc/self/ns/user"));
    let open = |name: &str| {
        let opened = fs::File::open(name).map(OwnedFd::from);
        opened.map_err(|error| format!("cannot open `{name}`: {error}"))
    };
    names.into_iter().map(open).collect()
}

fn up() -> io::Result<()> {
    let socket = socket_with(AddressFamily::INET, SocketType::DGRAM, SocketFlags::CLOEXEC, None)?;
    unix::loopback_up(&socket)?;
    // A kernel without multicast can do without.
    let _ = unix::route_multicast(&socket);
    Ok(())
}

/// Which setting of this machine forbids it, as far as can be seen.
fn advice() -> String {
    const SETTINGS: [(&str, &str, &str); 3] = [
        ("kernel.unprivileged_userns_clone", "0", "1"),
        ("kernel.apparmor_restrict_unprivileged_userns", "1", "0"),
        ("user.max_user_namespaces", "0", "10000"),
    ];
    let value = |name: &str| {
        let path = format!("/proc/sys/{}", name.replace('.', "/"));
        fs::read_to_string(path).map(|text| text.trim().to_owned()).unwrap_or_default()
    };
    let forbids = SETTINGS.into_iter().find(|(name, forbids, _)| value(name) == *forbids);
    match forbids {
        Some((name, is, should)) => {
            format!("`{name}` is {is} here: `sysctl {name}={should}` or root helps")
        }
        None => "a container or a seccomp filter may forbid it: run as root, or grant the \
                 container CAP_SYS_ADMIN"
            .to_owned(),
    }
}
