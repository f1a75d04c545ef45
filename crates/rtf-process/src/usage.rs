//! Resource usage of a process and everything below it.

use rtf_model::Usage;

use crate::tree;

/// Measures a process, everything below it, and the orphans of its scope.
pub fn measure(root: i32, scope: &str) -> Usage {
    let mut sum = Usage::default();
    for pid in tree::members(root, scope) {
        // A process that has ended since uses nothing.
        let Ok(status) = std::fs::read_to_string(format!("/proc/{pid}/status")) else { continue };
        sum.processes += 1;
        sum.memory += memory(&status);
        sum.descriptors += descriptors(pid);
    }
    sum
}

/// The bytes of private memory, from `/proc/PID/status`.
fn memory(status: &str) -> u64 {
    let own = ["RssAnon:", "RssShmem:", "VmSwap:"];
    let lines = status.lines().filter_map(|line| own.iter().find_map(|key| line.strip_prefix(key)));
    let kib = lines.filter_map(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
    kib.sum::<u64>() * 1024
}

fn descriptors(pid: i32) -> u64 {
    std::fs::read_dir(format!("/proc/{pid}/fd")).map_or(0, |open| open.count() as u64)
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead as _, BufReader, Write as _};
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn memory_excludes_files() {
        let status = "Name:\tarm\nVmRSS:\t   9000 kB\nRssAnon:\t    4096 kB\nRssFile:\t    4000 kB\n\
                      RssShmem:\t     904 kB\nVmSwap:\t      24 kB\n";
        assert_eq!(memory(status), (4096 + 904 + 24) * 1024);
        assert_eq!(memory("Name:\tkthreadd\n"), 0);
    }

    #[test]
    fn children_and_open_descriptors_count() {
        let script = "read -r _; exec 5</dev/null 6</dev/null; sleep 1000 & echo; wait";
        let mut shell = Command::new("sh")
            .args(["-c", script])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let pid = i32::try_from(shell.id()).unwrap();
        let before = measure(pid, "none");
        shell.stdin.take().unwrap().write_all(b"\n").unwrap();
        let mut line = String::new();
        BufReader::new(shell.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let after = measure(pid, "none");
        tree::kill_tree(pid);
        shell.wait().unwrap();
        assert_eq!((before.processes, after.processes), (1, 2));
        assert!(after.descriptors >= before.descriptors + 2, "{before:?} {after:?}");
        assert!(before.memory > 0 && after.memory > before.memory, "{before:?} {after:?}");
        assert_eq!(measure(pid, "none"), Usage::default());
    }
}
