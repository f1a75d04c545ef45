//! The system calls behind [`super::holder`].
#![expect(unsafe_code, reason = "namespaces, and interfaces, are made by system calls")]

use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, AsRawFd, FromRawFd, OwnedFd};

/// Moves this process, which must have one thread only, into new namespaces.
pub fn unshare(kinds: i32) -> io::Result<()> {
    // SAFETY: it has no memory arguments, and this is the only thread.
    done(unsafe { libc::unshare(kinds) })
}

/// Takes over a descriptor that was inherited.
pub fn inherited(fd: i32) -> io::Result<OwnedFd> {
    // SAFETY: a number that is not open makes the call fail, no more.
    done(unsafe { libc::fcntl(fd, libc::F_SETFD, libc::FD_CLOEXEC) })?;
    // SAFETY: it is open, and nothing else in this process owns it.
    Ok(unsafe { OwnedFd::from_raw_fd(fd) })
}

/// Brings the loopback interface of this namespace up, with multicast.
pub fn loopback_up(socket: impl AsFd) -> io::Result<()> {
    let socket = socket.as_fd().as_raw_fd();
    // SAFETY: all zeroes are a valid `ifreq`.
    let mut request = unsafe { MaybeUninit::<libc::ifreq>::zeroed().assume_init() };
    for (place, byte) in request.ifr_name.iter_mut().zip(b"lo") {
        *place = libc::c_char::from_ne_bytes([*byte]);
    }
    let flags = libc::IFF_UP | libc::IFF_RUNNING | libc::IFF_LOOPBACK | libc::IFF_MULTICAST;
    request.ifr_ifru.ifru_flags = i16::try_from(flags).map_err(io::Error::other)?;
    // SAFETY: the request lives until the call returns.
    done(unsafe { libc::ioctl(socket, libc::SIOCSIFFLAGS, &raw mut request) })
}

/// Routes multicast to the loopback interface.
pub fn route_multicast(socket: impl AsFd) -> io::Result<()> {
    // SAFETY: all zeroes are a valid `rtentry`.
    let mut route = unsafe { MaybeUninit::<libc::rtentry>::zeroed().assume_init() };
    route.rt_dst = internet([224, 0, 0, 0]);
    route.rt_genmask = internet([240, 0, 0, 0]);
    route.rt_gateway = internet([0; 4]);
    route.rt_flags = libc::RTF_UP;
    let mut device = *b"lo\0";
    route.rt_dev = device.as_mut_ptr().cast();
    let socket = socket.as_fd().as_raw_fd();
    // SAFETY: the route and the device's name live until the call returns.
    done(unsafe { libc::ioctl(socket, libc::SIOCADDRT, &raw mut route) })
}

/// An IPv4 address as old calls take it.
fn internet(address: [u8; 4]) -> libc::sockaddr {
    // SAFETY: all zeroes are a valid `sockaddr`.
    let mut socket = unsafe { MaybeUninit::<libc::sockaddr>::zeroed().assume_init() };
    socket.sa_family = libc::sa_family_t::try_from(libc::AF_INET).unwrap_or_default();
    // Two bytes of port come first.
    for (place, byte) in socket.sa_data[2..].iter_mut().zip(address) {
        *place = libc::c_char::from_ne_bytes([byte]);
    }
    socket
}

fn done(result: i32) -> io::Result<()> {
    if result == -1 { Err(io::Error::last_os_error()) } else { Ok(()) }
}
