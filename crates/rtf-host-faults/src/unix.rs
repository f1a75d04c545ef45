//! The system call that creates a network device.
#![expect(unsafe_code, reason = "an ioctl without a safe form")]

use std::fs::File;
use std::io;
use std::os::fd::AsRawFd;
use std::os::unix::fs::OpenOptionsExt;

/// `TUNSETIFF` of Linux' include/uapi/linux/if_tun.h.
const TUNSETIFF: libc::Ioctl = 0x4004_54ca;
/// The kernel replaces `%d` by a number.
const PATTERN: &[u8] = b"rtf-fault%d";

/// `struct ifreq`.
#[repr(C)]
struct InterfaceRequest {
    name: [u8; libc::IFNAMSIZ],
    flags: libc::c_short,
    rest: [u8; 22],
}

/// Creates a device that passes packets to this process, and from it; returns its name. It
/// vanishes, with its routes, when the file is closed. Reading does not wait.
pub(crate) fn open_tun() -> io::Result<(File, String)> {
    let mut options = File::options();
    let file =
        options.read(true).write(true).custom_flags(libc::O_NONBLOCK).open("/dev/net/tun")?;
    let flags = (libc::IFF_TUN | libc::IFF_NO_PI) as libc::c_short;
    let mut request = InterfaceRequest { name: [0; libc::IFNAMSIZ], flags, rest: [0; 22] };
    request.name[..PATTERN.len()].copy_from_slice(PATTERN);
    // SAFETY: `request` is a complete `struct ifreq`, and the kernel keeps no pointer to it.
    let result = unsafe { libc::ioctl(file.as_raw_fd(), TUNSETIFF, &raw mut request) };
    if result < 0 {
        return Err(io::Error::last_os_error());
    }
    let name = request.name.split(|byte| *byte == 0).next().unwrap_or_default();
    Ok((file, String::from_utf8_lossy(name).into_owned()))
}
