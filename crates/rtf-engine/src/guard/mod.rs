//! The guard: the process that the user starts. It runs the runner below it,
//! and puts things in order when the runner dies.
//!
//! [`split`] makes two processes of one. The guard's side is [`Guard::watch`]:
//! it passes signals on and waits. The runner's side is the [`Link`], over
//! which it tells the guard what would have to be done without it: which hooks
//! there are, which have begun, and which outputs must stay open.
//!
//! The runner shows every second that it is alive. One that does not for a while
//! is killed, and then has died.
//!
//! When the runner has died: the running test is killed ([`after`]), the abort
//! hooks are run ([`hook`]), everything that is left is killed, and the journal
//! is closed ([`closing`]). When the guard has died, the runner tears down in
//! order, as after Ctrl-C.
//!
//! Why it is like this: `docs/decisions/0007-the-guard.md`.

mod after;
mod attend;
mod closing;
mod duties;
mod hook;
mod link;
mod note;
mod queue;
mod requests;
mod unix;
mod watch;

use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rtf_process::resources;

pub use after::{Died, Parked};
pub use link::{BEAT, Link};
pub use note::HookBegins;
pub use requests::{Requests, WINDOW};
pub use unix::survive_file_size_limit;
pub use watch::{Ended, Guard};

/// Which of the two processes this is.
#[derive(Debug)]
pub enum Side {
    /// The one that the user started.
    Guard(Box<Guard>),
    /// The one that runs tests.
    Runner(Link),
}

/// Makes two processes of this one. The guard becomes a child subreaper; the
/// runner gets a process group of its own, so that a terminal's Ctrl-C comes to
/// it once, through the guard.
///
/// The end of `lifeline` counts as SIGTERM; what comes over it is read and forgotten.
/// A runner that does not answer for `patience`, or [`watch::LEAST_PATIENCE`], is killed.
///
/// # Errors
/// This process has more than one thread, or the system refused.
pub fn split(lifeline: Option<OwnedFd>, patience: Duration) -> io::Result<Side> {
    resources::raise_descriptor_limit();
    let (guards, runners) = UnixStream::pair()?;
    let (pulse, felt) = UnixStream::pair()?;
    rustix::process::set_child_subreaper(Some(rustix::process::getpid()))?;
    let forked = Instant::now();
    // No signal may come before it is known who takes it.
    let held = unix::Held::hold();
    match unix::fork()? {
        Some(runner) => {
            drop((runners, felt));
            // Both do it: whoever comes first, it is done.
            unix::own_group(Some(runner));
            let signals = unix::Signals::install()?;
            drop(held);
            unix::stay_in_memory();
            let guard = Guard::new(runner, [guards, pulse], signals, forked);
            let guard = guard.ending_with(lifeline).patient_for(patience);
            Ok(Side::Guard(Box::new(guard)))
        }
        None => {
            drop((guards, pulse, lifeline));
            unix::own_group(None);
            drop(held);
            unix::write_to_terminal_from_behind();
            die_of_panics();
            Ok(Side::Runner(Link::new(runners, felt, forked)))
        }
    }
}

/// Lets a panic of the thread that supervises end the runner at once. Unwinding
/// would kill the fixtures on its way, before the guard can park the robot.
fn die_of_panics() {
    let tell = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        tell(panic);
        if std::thread::current().name() == Some("main") {
            std::process::abort();
        }
    }));
}
