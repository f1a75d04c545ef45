//! Finds the processes of a fixture that a fault affects.

use std::collections::BTreeSet;
use std::path::Path;

use rtf_host::ProcessMarks;
use rtf_model::FaultTarget;

/// The processes of a fixture, or those with a certain name.
#[derive(Clone, Debug)]
pub(crate) struct Targets {
    marks: ProcessMarks,
    target: FaultTarget,
}

/// A process and its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub pid: u32,
    pub name: String,
}

impl Targets {
    pub fn new(owner: &str, target: &FaultTarget) -> Self {
        Self { marks: ProcessMarks::new(owner), target: target.clone() }
    }

    /// The processes that run now.
    pub fn find(&self) -> Vec<Target> {
        let all = self.marks.find().filter(|pid| state(*pid).is_some_and(|it| it != 'Z'));
        let wanted = |pid: &u32| {
            self.target.process.as_ref().is_none_or(|process| names(*pid).contains(process))
        };
        let named = |pid| Target { pid, name: names(pid).pop().unwrap_or_default() };
        all.filter(wanted).map(named).collect()
    }

    /// Whether the process still has the marks: its number may have been reused.
    pub fn contains(&self, pid: u32) -> bool {
        self.marks.are_of(pid)
    }

    /// Why there are none.
    pub fn missing(&self) -> String {
        let FaultTarget { fixture, process } = &self.target;
        let Some(process) = process else {
            return format!("the fixture `{fixture}` has no process");
        };
        let running = self.marks.find().filter_map(|pid| names(pid).pop());
        let running: BTreeSet<_> = running.map(|name| format!("`{name}`")).collect();
        let running: Vec<_> = running.into_iter().collect();
        let running = if running.is_empty() { "none".to_owned() } else { running.join(", ") };
        format!("the fixture `{fixture}` has no process `{process}`; it has {running}")
    }

    /// Describes what was done to processes.
    pub fn describe(&self, done: &str, targets: &[Target]) -> String {
        match targets {
            [one] => format!("{done} `{}` (process {})", one.name, one.pid),
            several => {
                format!("{done} {} processes of `{}`", several.len(), self.target.fixture)
            }
        }
    }
}

/// The state of a process: `Z` if it has ended.
fn state(pid: u32) -> Option<char> {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name of the program, in parentheses, may contain anything.
    stat.get(stat.rfind(')')? + 1..)?.trim_start().chars().next()
}

/// The names of a process: of its thread, of its program, and of the script that it runs. The
/// last one is for display.
fn names(pid: u32) -> Vec<String> {
    let comm = std::fs::read_to_string(format!("/proc/{pid}/comm")).unwrap_or_default();
    let line = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
    let words = line.split(|byte| *byte == 0).take(2).enumerate();
    let words = words.filter_map(|(index, word)| {
        let word = std::str::from_utf8(word).ok()?;
        let is_script = index == 0 || Path::new(word).extension().is_some();
        let name = Path::new(word).file_name()?.to_str()?;
        (is_script && !word.starts_with('-')).then(|| name.to_owned())
    });
    std::iter::once(comm.trim_end().to_owned()).chain(words).collect()
}
