//! Stops and continues processes. Several faults can stop the same process; it continues when
//! all of them have ended.

use std::collections::HashMap;
use std::io;
use std::os::fd::OwnedFd;

use rustix::process::{Pid, PidfdFlags, Signal, pidfd_open, pidfd_send_signal};

use crate::targets::Targets;

/// The processes that are stopped.
#[derive(Debug, Default)]
pub(crate) struct Pauses {
    stopped: HashMap<u32, Stopped>,
}

#[derive(Debug)]
struct Stopped {
    process: OwnedFd,
    /// How many faults stop it.
    faults: usize,
}

impl Pauses {
    /// Stops a process; false if it has ended.
    pub fn stop(&mut self, pid: u32, targets: &Targets) -> io::Result<bool> {
        if let Some(stopped) = self.stopped.get_mut(&pid) {
            stopped.faults += 1;
            return Ok(true);
        }
        let Some(process) = open(pid, targets)? else { return Ok(false) };
        if !send(&process, Signal::STOP)? {
            return Ok(false);
        }
        self.stopped.insert(pid, Stopped { process, faults: 1 });
        Ok(true)
    }

    /// Ends the effect of one fault on a process.
    pub fn resume(&mut self, pid: u32) {
        let Some(stopped) = self.stopped.get_mut(&pid) else { return };
        stopped.faults -= 1;
        if stopped.faults == 0
            && let Some(stopped) = self.stopped.remove(&pid)
        {
            let _ = send(&stopped.process, Signal::CONT);
        }
    }

    /// Continues all processes.
    pub fn resume_all(&mut self) {
        for (_, stopped) in self.stopped.drain() {
            let _ = send(&stopped.process, Signal::CONT);
        }
    }
}

/// Sends a signal to a process; false if it has ended.
pub(crate) fn signal(pid: u32, targets: &Targets, signal: Signal) -> io::Result<bool> {
    match open(pid, targets)? {
        Some(process) => send(&process, signal),
        None => Ok(false),
    }
}

/// Opens a process, so that a signal cannot reach another one with the same number.
fn open(pid: u32, targets: &Targets) -> io::Result<Option<OwnedFd>> {
    let Some(number) = i32::try_from(pid).ok().and_then(Pid::from_raw) else { return Ok(None) };
    match pidfd_open(number, PidfdFlags::empty()) {
        Ok(process) => Ok(targets.contains(pid).then_some(process)),
        Err(rustix::io::Errno::SRCH) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

fn send(process: &OwnedFd, signal: Signal) -> io::Result<bool> {
    match pidfd_send_signal(process, signal) {
        Ok(()) => Ok(true),
        Err(rustix::io::Errno::SRCH) => Ok(false),
        Err(error) => Err(error.into()),
    }
}
