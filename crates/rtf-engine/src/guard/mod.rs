//! The guard: the process that the user starts. The runner is its child.
//!
//! [`split`] forks. The guard's side is [`Guard::supervise`]: it forwards signals and
//! waits. The runner's side is the [`Link`], over which it reports what the guard needs if
//! the runner dies: the hooks, which of them have started, and streams that must remain
//! open. The runner sends a heartbeat every second; a silent runner is killed.
//!
//! After the runner's death, [`recovery`] ends its tests, runs the abort hooks, stops the
//! fixtures, kills everything that is left, and closes the journal. After the guard's death, the runner
//! tears down in order, as after Ctrl-C.
//!
//! Rationale: `docs/decisions/0007-the-guard.md`.

mod fixture_stop;
mod heartbeat;
mod hook_process;
mod hook_run;
mod journal_close;
mod link;
mod message;
mod message_queue;
mod message_receiver;
mod recovery;
mod recovery_state;
mod stop_requests;
mod supervisor;
mod unix;

use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rtf_process::resources;

pub(crate) use fixture_stop::FixtureStop;
pub(crate) use link::HEARTBEAT_INTERVAL;
pub use link::Link;
pub(crate) use message::HookStart;
pub use recovery::{RecoveredHook, Recovery};
pub use stop_requests::{StopRequests, WINDOW};
pub use supervisor::{Guard, GuardOutcome};
pub use unix::{permit_background_output, survive_file_size_limit, survive_terminal_stop};

/// Which of the two processes this is.
#[derive(Debug)]
pub enum Side {
    /// The one that the user started.
    Guard(Box<Guard>),
    /// The one that runs tests.
    Runner(Link),
}

/// What keeps a run going: its end counts as SIGTERM.
#[derive(Debug)]
pub enum Lifeline {
    /// The guard discards what it reads from it.
    Input(OwnedFd),
    /// A socket, whose data the runner reads: it ends when the other side closes it.
    Socket(OwnedFd),
}

/// Forks this process. The guard becomes a child subreaper; the runner becomes the leader of
/// a new process group, so that it receives a terminal's Ctrl-C once, from the guard.
///
/// The end of `lifeline` counts as SIGTERM. A runner that is silent
/// for `patience`, or for [`supervisor::MIN_PATIENCE`], is killed.
///
/// # Errors
/// This process has more than one thread, or the system refused.
pub fn split(lifeline: Option<Lifeline>, patience: Duration) -> io::Result<Side> {
    resources::raise_descriptor_limit();
    let (guards, runners) = UnixStream::pair()?;
    let (heartbeat, runners_heartbeat) = UnixStream::pair()?;
    rtf_process::adopt_orphans()?;
    let forked = Instant::now();
    // No signal may arrive before its handler is installed.
    let blocked = unix::BlockedSignals::block();
    match unix::fork()? {
        Some(runner) => {
            drop((runners, runners_heartbeat));
            // Both processes do it, because either may be the first.
            unix::lead_group(Some(runner));
            let signals = unix::GuardSignals::install()?;
            drop(blocked);
            unix::lock_memory();
            let guard = Guard::new(runner, [guards, heartbeat], signals, forked);
            let guard = guard.with_lifeline(lifeline).with_patience(patience);
            Ok(Side::Guard(Box::new(guard)))
        }
        None => {
            drop((guards, heartbeat, lifeline));
            unix::lead_group(None);
            drop(blocked);
            unix::permit_background_output();
            abort_on_panic();
            Ok(Side::Runner(Link::new(runners, runners_heartbeat, forked)))
        }
    }
}

/// Makes a panic of the main thread end the runner at once. Unwinding would kill the fixtures
/// before the guard can run the hooks.
fn abort_on_panic() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        report(panic);
        if std::thread::current().name() == Some("main") {
            std::process::abort();
        }
    }));
}
