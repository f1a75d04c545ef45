//! What a process, and everything that it started, uses.

use rtf_model::Usage;

use super::tree;

/// Looks at a process of a scope, at all below it, and at the orphans of the scope.
pub fn of(root: i32, scope: &str) -> Usage {
    let mut sum = Usage::default();
    for pid in tree::members(root, scope) {
        // One that has ended meanwhile uses nothing.
        let Ok(status) = std::fs::read_to_string(format!("/proc/{pid}/status")) else { continue };
        sum.processes += 1;
        sum.memory += memory(&status);
        sum.descriptors += descriptors(pid);
    }
    sum
}

/// The bytes of memory that are its own, from `/proc/PID/status`.
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
    fn memory_is_what_no_file_backs() {
        let status = "Name:\tarm\nVmRSS:\t   9000 kB\nRssAnon:\t    4096 kB\nRssFile:\t    4000 kB\n\
                      RssShmem:\t     904 kB\nVmSwap:\t      24 kB\n";
        assert_eq!(memory(status), (4096 + 904 + 24) * 1024);
        assert_eq!(memory("Name:\tkthreadd\n"), 0);
    }

    #[test]
    fn what_a_process_starts_and_opens_counts() {
        let script = "read -r _; exec 5</dev/null 6</dev/null; sleep 1000 & echo; wait";
        let mut shell = Command::new("sh")
            .args(["-c", script])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let pid = i32::try_from(shell.id()).unwrap();
        let before = of(pid, "none");
        shell.stdin.take().unwrap().write_all(b"\n").unwrap();
        let mut line = String::new();
        BufReader::new(shell.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let after = of(pid, "none");
        tree::kill_tree(pid);
        shell.wait().unwrap();
        assert_eq!((before.processes, after.processes), (1, 2));
        assert!(after.descriptors >= before.descriptors + 2, "{before:?} {after:?}");
        assert!(before.memory > 0 && after.memory > before.memory, "{before:?} {after:?}");
        assert_eq!(of(pid, "none"), Usage::default());
    }
}
