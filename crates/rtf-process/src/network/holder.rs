//! The process that holds a network namespace.
//!
//! It executes this program with [`HOLD_ARGUMENT`] and has one thread, as entering a
//! user namespace demands. It creates the namespaces, passes them to the runner, and
//! then opens a TCP socket in them on each request: a socket belongs to the namespace in
//! which it was opened, whichever process connects it. The holder ends with the runner's
//! end of its channel.

use std::fs;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use rtf_model::protocol::CHANNEL_VARIABLE;
use rustix::net::{AddressFamily, RecvFlags, SendFlags, SocketFlags, SocketType, socket_with};
use serde::{Deserialize, Serialize};

use super::unix;
use crate::descriptor_passing::{receive, send};

/// The first argument of a process of this program that holds a namespace.
pub const HOLD_ARGUMENT: &str = "--hold-network";
/// The longest message of the holder.
pub const MESSAGE_BYTES: usize = 4096;
/// Request: open an IPv4 socket.
pub const OPEN_IPV4: u8 = b'4';
/// Request: open an IPv6 socket.
pub const OPEN_IPV6: u8 = b'6';
/// Reply: a socket comes with this byte.
pub const OPENED: u8 = b'+';
/// Reply: the socket cannot be opened.
pub const NOT_OPENED: u8 = b'-';

/// The holder's first message.
#[derive(Debug, Serialize, Deserialize)]
pub struct Hello {
    /// Whether there is a user namespace, too.
    pub has_user_namespace: bool,
    /// Why there is no namespace: what the system refused, and a remedy.
    pub refused: Option<String>,
}

/// Creates the namespaces and holds them until the runner has ended.
///
/// # Errors
/// This process was not started by a runner, or the runner has ended.
pub fn hold() -> io::Result<()> {
    let address = std::env::var(CHANNEL_VARIABLE).map_err(io::Error::other)?;
    let fd = address.strip_prefix("fd:").and_then(|fd| fd.parse().ok());
    let channel = unix::inherited(fd.ok_or_else(|| io::Error::other("not a channel"))?)?;
    let (refused, namespaces) = match create() {
        Ok(namespaces) => (None, namespaces),
        Err(refused) => (Some(refused), Vec::new()),
    };
    let hello = Hello { has_user_namespace: namespaces.len() > 1, refused };
    let descriptors: Vec<_> = namespaces.iter().map(AsFd::as_fd).collect();
    let message = serde_json::to_vec(&hello)?;
    send(channel.as_fd(), &message, &descriptors, SendFlags::empty())?;
    if hello.refused.is_some() { Ok(()) } else { serve(channel.as_fd()) }
}

fn serve(channel: BorrowedFd<'_>) -> io::Result<()> {
    loop {
        let mut request = [0];
        let (read, _) = receive(channel, &mut request, RecvFlags::empty())?;
        if read == 0 {
            return Ok(());
        }
        let family =
            if request == [OPEN_IPV6] { AddressFamily::INET6 } else { AddressFamily::INET };
        match socket_with(family, SocketType::STREAM, SocketFlags::CLOEXEC, None) {
            Ok(socket) => send(channel, &[OPENED], &[socket.as_fd()], SendFlags::empty())?,
            Err(_) => send(channel, &[NOT_OPENED], &[], SendFlags::empty())?,
        };
    }
}

/// Creates the namespaces; the error is a message for the user.
fn create() -> Result<Vec<OwnedFd>, String> {
    let (uid, gid) = (rustix::process::geteuid().as_raw(), rustix::process::getegid().as_raw());
    // Only root may do without a user namespace.
    let needs_user = unix::unshare(libc::CLONE_NEWNET).is_err();
    if needs_user {
        unix::unshare(libc::CLONE_NEWUSER | libc::CLONE_NEWNET)
            .map_err(|error| refused("a user namespace with a network", &error))?;
        // Without it, the kernel refuses to map groups.
        let mapped = fs::write("/proc/self/setgroups", "deny")
            .and_then(|()| fs::write("/proc/self/uid_map", format!("{uid} {uid} 1")))
            .and_then(|()| fs::write("/proc/self/gid_map", format!("{gid} {gid} 1")));
        mapped.map_err(|error| {
            refused(&format!("to map user {uid} into a user namespace"), &error)
        })?;
    }
    bring_loopback_up().map_err(|error| refused("to bring the loopback interface up", &error))?;
    let mut names = vec!["/proc/self/ns/net"];
    names.extend(needs_user.then_some("/proc/self/ns/user"));
    let open = |name: &str| {
        let opened = fs::File::open(name).map(OwnedFd::from);
        opened.map_err(|error| format!("cannot open `{name}`: {error}"))
    };
    names.into_iter().map(open).collect()
}

fn bring_loopback_up() -> io::Result<()> {
    let socket = socket_with(AddressFamily::INET, SocketType::DGRAM, SocketFlags::CLOEXEC, None)?;
    unix::loopback_up(&socket)?;
    // Optional: a kernel may lack multicast.
    let _ = unix::route_multicast(&socket);
    Ok(())
}

fn refused(what: &str, error: &io::Error) -> String {
    format!("the system refuses {what} ({error}); {}", advice())
}

/// Names the kernel setting that forbids it, if one can be found.
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
