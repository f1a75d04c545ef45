//! Routes the packets between the processes of a private network through a device of this
//! process.
//!
//! In a private network, all processes talk over the loopback interface. The rule for local
//! addresses is the first one; here, packets that leave a process find another route before
//! it, to the device, and packets that come from the device still find that rule. If the
//! device vanishes, because this process was killed, the other route is gone, too.

use std::fs::File;
use std::io::{self, Write};
use std::process::{Command, Stdio};

use crate::unix;

/// The table with the route to the device.
const TABLE: &str = "7470";
/// The size of packets, as in an Ethernet network: faults affect single packets.
const MTU: &str = "1500";
/// The kernel accepts packets with a loopback address from the device.
const SETTINGS: [(&str, &str); 3] =
    [("route_localnet", "1"), ("accept_local", "1"), ("rp_filter", "0")];

/// Creates the device, and routes packets to it.
///
/// # Errors
/// Why that is not possible.
pub(crate) fn divert() -> Result<File, String> {
    let (tun, name) = unix::open_tun().map_err(|error| {
        format!(
            "cannot create a network device: {error}; hint: this needs `/dev/net/tun` and the \
             permission to configure the private network of the suite"
        )
    })?;
    for (setting, value) in SETTINGS {
        let path = format!("/proc/sys/net/ipv4/conf/{name}/{setting}");
        std::fs::write(&path, value).map_err(|error| format!("cannot write `{path}`: {error}"))?;
    }
    restore();
    let commands = format!(
        "link set dev {name} mtu {MTU} up\n\
         route add 127.0.0.0/8 dev {name} src 127.0.0.1 table {TABLE}\n\
         rule add pref 1 iif lo table {TABLE}\n\
         rule add pref 2 table local\n\
         rule del pref 0\n"
    );
    let result = ip(&["-batch", "-"], &commands);
    if result.is_err() {
        restore();
    }
    result.map(|()| tun)
}

/// Restores the rules, whichever of them there are. There is always a rule for local addresses.
pub(crate) fn restore() {
    // The kernel's own rule is not equal to the same rule of `ip`: it would be added.
    let commands = "rule add pref 2 table local\n\
         rule del pref 0\n\
         rule add pref 0 table local\n\
         rule del pref 1\n\
         rule del pref 2\n";
    // Missing ones cannot be removed.
    let _ = ip(&["-force", "-batch", "-"], commands);
}

fn ip(arguments: &[&str], commands: &str) -> Result<(), String> {
    let failed = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => {
            "the program `ip` is missing; hint: install the package `iproute2`".to_owned()
        }
        _ => format!("cannot run `ip`: {error}"),
    };
    let mut command = Command::new("ip");
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(failed)?;
    if let Some(mut input) = child.stdin.take() {
        input.write_all(commands.as_bytes()).map_err(failed)?;
    }
    let output = child.wait_with_output().map_err(failed)?;
    match output.status.success() {
        true => Ok(()),
        false => Err(format!(
            "cannot route the private network: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        )),
    }
}
