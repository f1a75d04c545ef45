//! Measures the processes of a fixture in `/proc`.

use std::collections::HashMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use rtf_host::ProcessMarks;
use rtf_model::ProcessQuantity;

/// How long a list of processes is used. Finding them takes longer than measuring them.
const SEARCH_INTERVAL: Duration = Duration::from_secs(1);

#[derive(Debug)]
pub(crate) struct FixtureProcesses {
    marks: ProcessMarks,
    pids: Vec<u32>,
    searched: Option<Instant>,
    /// Processor time of each process, in clock ticks, at the last measurement.
    ticks: HashMap<u32, u64>,
    measured: Option<Instant>,
}

impl FixtureProcesses {
    pub fn new(owner: &str) -> Self {
        let marks = ProcessMarks::new(owner);
        let (pids, searched, ticks, measured) = (Vec::new(), None, HashMap::new(), None);
        Self { marks, pids, searched, ticks, measured }
    }

    /// Measures a quantity now. `None` if no process runs, and for the first processor time.
    pub fn measure(&mut self, quantity: ProcessQuantity) -> Option<f64> {
        let now = Instant::now();
        if self.searched.is_none_or(|searched| now - searched >= SEARCH_INTERVAL) {
            self.searched = Some(now);
            self.pids = self.marks.find().collect();
        }
        match quantity {
            ProcessQuantity::Cpu => self.processor_time(now),
            ProcessQuantity::Rss => self.sum(resident_mebibytes),
            ProcessQuantity::Fds => self.sum(descriptors),
        }
    }

    fn sum(&self, of: fn(u32) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.pids.iter().filter_map(|pid| of(*pid)).collect();
        (!values.is_empty()).then(|| values.iter().sum())
    }

    /// Processor time since the last measurement, per time. That of a process which has ended
    /// since then is not known.
    fn processor_time(&mut self, now: Instant) -> Option<f64> {
        let ticks: HashMap<u32, u64> =
            self.pids.iter().filter_map(|pid| Some((*pid, ticks(*pid)?))).collect();
        let used = ticks.iter().map(|(pid, ticks)| {
            ticks.saturating_sub(self.ticks.get(pid).copied().unwrap_or_default())
        });
        let used: u64 = used.sum();
        let before = self.measured.replace(now);
        let is_empty = ticks.is_empty();
        self.ticks = ticks;
        let elapsed = now.checked_duration_since(before?)?.as_secs_f64();
        let seconds = used as f64 / rustix::param::clock_ticks_per_second() as f64;
        (!is_empty && elapsed > 0.0).then(|| seconds / elapsed)
    }
}

fn process_dir(pid: u32) -> PathBuf {
    PathBuf::from(format!("/proc/{pid}"))
}

/// User and system time.
fn ticks(pid: u32) -> Option<u64> {
    let stat = std::fs::read_to_string(process_dir(pid).join("stat")).ok()?;
    // The name of the program, in parentheses, may contain anything.
    let mut fields = stat.get(stat.rfind(')')? + 1..)?.split_ascii_whitespace().skip(11);
    let mut next = || fields.next()?.parse::<u64>().ok();
    Some(next()? + next()?)
}

fn resident_mebibytes(pid: u32) -> Option<f64> {
    let statm = std::fs::read_to_string(process_dir(pid).join("statm")).ok()?;
    let pages: u64 = statm.split_ascii_whitespace().nth(1)?.parse().ok()?;
    Some((pages * rustix::param::page_size() as u64) as f64 / (1024.0 * 1024.0))
}

fn descriptors(pid: u32) -> Option<f64> {
    Some(std::fs::read_dir(process_dir(pid).join("fd")).ok()?.count() as f64)
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::CommandExt;
    use std::process::{Child, Command};

    use rtf_model::protocol::OWNER_VARIABLE;
    use rustix::process::{Pid, Signal, kill_process_group};

    use super::*;

    /// Processes in one group, which is killed at the end.
    struct Busy(Child);

    impl Drop for Busy {
        fn drop(&mut self) {
            let group = i32::try_from(self.0.id()).ok().and_then(Pid::from_raw).unwrap();
            kill_process_group(group, Signal::KILL).unwrap();
            self.0.wait().unwrap();
        }
    }

    /// A shell, and a loop in a second one that it starts.
    fn busy(owner: &str) -> Busy {
        let mut command = Command::new("sh");
        command.args(["-c", "sh -c 'while :; do :; done' & wait"]).process_group(0);
        Busy(command.env(OWNER_VARIABLE, owner).spawn().unwrap())
    }

    #[test]
    fn the_processes_of_an_owner_are_measured() {
        let owner = format!("fixture signals-test-{}/sim", std::process::id());
        let mut processes = FixtureProcesses::new(&owner);
        assert_eq!(processes.measure(ProcessQuantity::Rss), None);
        let _busy = busy(&owner);
        let deadline = Instant::now() + Duration::from_secs(60);
        let mut most = 0.0_f64;
        while (processes.pids.len() < 2 || most < 0.01) && Instant::now() < deadline {
            processes.searched = None;
            most = most.max(processes.measure(ProcessQuantity::Cpu).unwrap_or_default());
        }
        assert_eq!(processes.pids.len(), 2);
        assert!(most >= 0.01, "{most}");
        let memory = processes.measure(ProcessQuantity::Rss).unwrap();
        assert!((0.1..500.0).contains(&memory), "{memory}");
        assert!(processes.measure(ProcessQuantity::Fds).unwrap() >= 2.0);
    }
}
