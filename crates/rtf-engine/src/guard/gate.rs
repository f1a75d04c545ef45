//! A gate before a hook's command.
//!
//! When the runner dies just as it starts a hook, the guard must know whether
//! the hook has run. So a command waits behind a gate until the guard knows its
//! process. Whoever opens the gate, the runner or after its death the guard,
//! it is passed once. Plug-ins need none: they wait for `run-test`.

/// Waits for two lines (a host's greeting, which every channel begins with, and
/// [`GO`]), then becomes the command. The channel is its standard input: not
/// every shell can read from descriptors of two digits.
const SCRIPT: &str = "read -r _ && read -r _ || exit 125; exec \"$@\" </dev/null";

/// What opens the gate.
pub const GO: &[u8] = b"go\n";

/// The command behind a gate. Its process needs a channel.
#[must_use]
pub fn behind(command: &[String]) -> Vec<String> {
    let gate = ["sh", "-c", SCRIPT, "sh"].into_iter().map(str::to_owned);
    gate.chain(command.iter().cloned()).collect()
}

/// Whether a command waits behind a gate.
#[must_use]
pub fn is_behind(command: &[String]) -> bool {
    command.get(2).is_some_and(|script| script == SCRIPT)
}
