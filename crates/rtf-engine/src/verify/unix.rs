//! Process groups of hosts that check plug-ins.

use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::process::{Child, Command, ExitStatus};
use std::sync::mpsc::sync_channel;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process_group};

/// Starts the command in a new process group.
pub(super) fn in_own_group(command: &mut Command) {
    command.process_group(0);
}

/// Kills a child that was started [`in_own_group`], and its group.
pub(super) fn kill_group(child: &mut Child) {
    kill(child.id());
    let _ = child.wait();
}

/// Waits for the end of a child that was started [`in_own_group`]. After
/// `limit` it is killed.
pub(super) fn wait(mut child: Child, limit: Duration) -> Option<ExitStatus> {
    let group = child.id();
    let (sender, receiver) = sync_channel(1);
    std::thread::spawn(move || sender.send(child.wait()));
    match receiver.recv_timeout(limit) {
        Ok(status) => status.ok(),
        Err(_) => {
            kill(group);
            let _ = receiver.recv();
            None
        }
    }
}

fn kill(group: u32) {
    if let Some(pid) = i32::try_from(group).ok().and_then(Pid::from_raw) {
        // Fails if all of them have ended.
        let _ = kill_process_group(pid, Signal::KILL);
    }
}

/// Describes how a process ended.
pub(super) fn describe(status: ExitStatus) -> String {
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("exit code {code}"),
        (None, Some(11)) => "a segmentation fault (signal 11)".to_owned(),
        (None, Some(6)) => "an abort (signal 6)".to_owned(),
        (None, Some(signal)) => format!("signal {signal}"),
        (None, None) => status.to_string(),
    }
}
