//! Stack dumps of the program whose case hangs.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rtf_process::stack_dump::remove_noise;
use rtf_process::tree;
use rustix::process::{Pid, Signal, kill_process};

use crate::framework::StackDump;

/// A program that dumps its stacks on a signal does so within this time, or not at all.
const SIGNAL_WAIT: Duration = Duration::from_secs(2);

/// The interval at which the file is polled.
const INTERVAL: Duration = Duration::from_millis(20);

/// Dumps the stacks of a process; `None` if they are in its output.
pub(super) fn dump(kind: StackDump, pid: Pid, file: &Path) -> Option<String> {
    match kind {
        StackDump::Debugger => Some(by_debugger(pid)),
        StackDump::SignalToOutput(signal) => {
            // The program may run the cases in a child. What a case has started must not end.
            let processes = tree::with_descendants(pid.as_raw_nonzero().get());
            for pid in processes.filter_map(Pid::from_raw).filter(|pid| catches(*pid, signal)) {
                let _ = kill_process(pid, signal);
            }
            std::thread::sleep(SIGNAL_WAIT / 4);
            None
        }
        StackDump::SignalToFile => Some(by_signal(pid, file).unwrap_or_else(|| by_debugger(pid))),
    }
}

fn by_signal(pid: Pid, file: &Path) -> Option<String> {
    if !catches(pid, Signal::USR2) {
        return None;
    }
    let _ = kill_process(pid, Signal::USR2);
    let deadline = Instant::now() + SIGNAL_WAIT;
    let mut last = Vec::new();
    while Instant::now() < deadline {
        std::thread::sleep(INTERVAL);
        let text = std::fs::read(file).unwrap_or_default();
        // The dump is complete when it has not grown since the last look.
        if !text.is_empty() && text == last {
            return Some(String::from_utf8_lossy(&text).into_owned());
        }
        last = text;
    }
    None
}

/// Whether a process has a handler for a signal; without one, the signal would kill it.
fn catches(pid: Pid, signal: Signal) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", pid.as_raw_nonzero()));
    let status = status.unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal.as_raw() - 1) & 1 == 1)
}

/// The runner's own debugger is attached to the host, which waits; this one shows the program.
fn by_debugger(pid: Pid) -> String {
    let pid = pid.as_raw_nonzero().to_string();
    let gdb: [&str; 9] = [
        "timeout",
        "10",
        "gdb",
        "-nx",
        "-q",
        "-batch",
        "-p",
        &pid,
        "-ex=thread apply all backtrace 64",
    ];
    let eu_stack = ["timeout", "10", "eu-stack", "-p", &pid];
    for command in [&gdb[..], &eu_stack[..]] {
        let (program, args) = (command[0], &command[1..]);
        let output =
            Command::new(program).args(args).stdin(Stdio::null()).stderr(Stdio::null()).output();
        let text = output.map(|it| String::from_utf8_lossy(&it.stdout).into_owned());
        if let Some(text) = text.ok().filter(|text| text.contains("#0")) {
            return remove_noise(&text);
        }
    }
    "no stack dump: neither `gdb` nor `eu-stack` could read the process".to_owned()
}
