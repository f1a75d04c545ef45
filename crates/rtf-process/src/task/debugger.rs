//! Waits for a debugger before the first request of a host (`spec/debugging.md`).

use std::io;
use std::time::Duration;

use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::oneshot;

use super::ProcessTask;

/// How often the kernel is asked for a debugger.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Whether the requests of a host wait for a debugger.
#[derive(Default)]
pub(super) enum DebuggerWait {
    /// They do not wait, or no longer.
    #[default]
    Over,
    /// The host has not answered `initialize` yet.
    Starting,
    /// Until this is sent.
    Waiting(oneshot::Receiver<()>),
}

impl DebuggerWait {
    /// Whether requests are held back.
    pub(super) fn is_over(&self) -> bool {
        matches!(self, Self::Over)
    }

    /// Waits for the debugger. Cancel safe.
    pub(super) async fn attached(&mut self) {
        match self {
            Self::Waiting(attached) => drop(attached.await),
            Self::Starting | Self::Over => std::future::pending().await,
        }
    }
}

impl ProcessTask {
    /// The host has sent its first message: it can be debugged.
    pub(super) fn wait_for_debugger(&mut self) {
        if !matches!(self.debugger, DebuggerWait::Starting) {
            return;
        }
        let pid = self.process.pid;
        let (attached, wait) = oneshot::channel();
        self.debugger = DebuggerWait::Waiting(wait);
        // Without the signal, a debugger still starts the test.
        let continued = signal(SignalKind::user_defined1()).ok();
        self.background.spawn(async move {
            wait_until_traced(pid, continued).await;
            let _ = attached.send(());
        });
        self.job.owner.debugger_awaited(pid);
    }
}

/// Waits until a process is traced, or has ended, or the signal arrives.
async fn wait_until_traced(pid: i32, mut continued: Option<Signal>) {
    while !is_traced(pid).unwrap_or(true) {
        let signalled = async {
            match &mut continued {
                Some(signal) => drop(signal.recv().await),
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            () = signalled => return,
            () = tokio::time::sleep(POLL_INTERVAL) => {}
        }
    }
}

/// Whether a debugger is attached to a process.
fn is_traced(pid: i32) -> io::Result<bool> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status"))?;
    let tracer = status.lines().find_map(|line| line.strip_prefix("TracerPid:"));
    Ok(tracer.is_some_and(|tracer| tracer.trim() != "0"))
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_process_without_a_debugger_is_not_traced() {
        let own = i32::try_from(std::process::id()).unwrap();
        assert!(!super::is_traced(own).unwrap());
        assert!(super::is_traced(-1).is_err());
    }
}
