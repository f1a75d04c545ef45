//! Everything that is only in the printed text of a Go test: its log, and why it died.

use std::path::Path;

use rtf_model::Location;

/// A line of the log, with its continuation lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct LogEntry {
    pub text: String,
    pub location: Location,
}

/// The reason why the process died.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Crash {
    pub reason: String,
    /// The innermost call of the first goroutine in a file of the package.
    pub location: Option<Location>,
}

/// Returns the entries that `t.Log`, `t.Error`, `t.Skip` and so on wrote:
/// `    arm_test.go:12: text`. Continuation lines are indented by eight spaces.
pub(super) fn log_entries(text: &str, dir: &Path) -> Vec<LogEntry> {
    let mut entries: Vec<LogEntry> = Vec::new();
    let mut continues = false;
    for line in text.lines() {
        if let Some((location, text)) = log_start(line, dir) {
            entries.push(LogEntry { text: text.to_owned(), location });
            continues = true;
        } else if let (Some(line), Some(entry), true) =
            (line.strip_prefix("        "), entries.last_mut(), continues)
        {
            entry.text.push('\n');
            entry.text.push_str(line);
        } else {
            continues = false;
        }
    }
    for entry in &mut entries {
        entry.text = entry.text.trim().to_owned();
    }
    entries
}

fn log_start<'a>(line: &'a str, dir: &Path) -> Option<(Location, &'a str)> {
    let line = line.strip_prefix("    ").filter(|line| !line.starts_with(' '))?;
    let (file, rest) = line.split_once(".go:")?;
    let (number, text) = rest.split_once(':')?;
    let line = number.parse().ok()?;
    let file = dir.join(format!("{file}.go")).to_string_lossy().into_owned();
    Some((Location { file, line }, text.strip_prefix(' ').unwrap_or(text)))
}

/// Returns why the process died in a test that printed this text.
pub(super) fn crash(text: &str, dir: &Path) -> Option<Crash> {
    let is_start = |line: &str| {
        ["panic: ", "fatal error: ", "SIGSEGV"].iter().any(|start| line.starts_with(start))
    };
    let mut lines = text.lines().skip_while(|line| !is_start(line));
    let Some(first) = lines.next() else { return end_of_process(text) };
    let mut reason = first.to_owned();
    for line in lines.by_ref().take_while(|line| !line.is_empty()) {
        reason.push('\n');
        reason.push_str(line);
    }
    for mark in [" [recovered, repanicked]", " [recovered]"] {
        reason = reason.replace(mark, "");
    }
    let mut calls = lines.take_while(|line| !line.is_empty());
    Some(Crash { reason, location: calls.find_map(|line| call(line, dir)) })
}

/// How a process ended that printed no reason: its last line is `signal: killed` or
/// `exit status 3`.
fn end_of_process(text: &str) -> Option<Crash> {
    let is_end = |line: &&str| line.starts_with("signal: ") || line.starts_with("exit status ");
    let last = text.lines().last().filter(is_end)?;
    Some(Crash { reason: format!("the test ended its process with {last}"), location: None })
}

/// A call in a file of the package: `\t/home/robot/arm/arm_test.go:17 +0x25`.
fn call(line: &str, dir: &Path) -> Option<Location> {
    let place = line.strip_prefix('\t')?.split(" +0x").next()?;
    let (file, line) = place.rsplit_once(':')?;
    let is_ours = Path::new(file).parent() == Some(dir);
    let line = line.parse().ok().filter(|_| is_ours)?;
    Some(Location { file: file.to_owned(), line })
}

/// Returns why an example failed: `got:`, `want:` and their texts, which are its last lines.
pub(super) fn example_failure(text: &str) -> Option<String> {
    let start = text.rfind("\ngot:\n")?;
    Some(text[start..].trim().to_owned()).filter(|text| text.contains("\nwant:\n"))
}

/// Whether a line of output is of the report: `=== RUN   TestMoves`.
pub(super) fn is_framing(line: &str, test: &str) -> bool {
    let parts = match line.trim_end().split_once(' ') {
        Some(("===", rest)) => rest.split_once(' '),
        Some(("---", rest)) => rest.split_once(": "),
        _ => None,
    };
    let Some((word, rest)) = parts else { return false };
    let is_word = ["RUN", "PAUSE", "CONT", "NAME", "PASS", "FAIL", "SKIP"].contains(&word);
    let rest = rest.trim_start();
    is_word && rest.strip_prefix(test).is_some_and(|rest| rest.is_empty() || rest.starts_with(" ("))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn location(line: u32) -> Location {
        Location { file: "/robot/arm/arm_test.go".to_owned(), line }
    }

    #[test]
    fn entries_of_the_log_have_their_continuation_lines() {
        let text = "printed\n    arm_test.go:12: first\n          second\n        \nprinted\n        not of the log\n    arm_test.go:14: \n        Error: late\n";
        let entries = log_entries(text, Path::new("/robot/arm"));
        let entry = |text: &str, line| LogEntry { text: text.to_owned(), location: location(line) };
        assert_eq!(entries, [entry("first\n  second", 12), entry("Error: late", 14)]);
    }

    #[test]
    fn the_location_of_a_panic_is_a_call_in_the_package() {
        let text = "--- FAIL: TestX (0.00s)\npanic: on fire [recovered]\n\tpanic: on fire\n\ngoroutine 5 [running]:\ntesting.tRunner.func1()\n\t/go/src/testing/testing.go:1977 +0x349\narm.TestX(0x1)\n\t/robot/arm/arm_test.go:17 +0x25\n";
        let crash = crash(text, Path::new("/robot/arm"));
        let reason = "panic: on fire\n\tpanic: on fire".to_owned();
        assert_eq!(crash, Some(Crash { reason, location: Some(location(17)) }));
    }

    #[test]
    fn lines_about_other_tests_are_output() {
        assert!(is_framing("--- FAIL: TestX (0.00s)\n", "TestX"));
        assert!(is_framing("=== PAUSE TestX/a b\n", "TestX/a b"));
        assert!(!is_framing("--- FAIL: TestY (0.00s)\n", "TestX"));
        assert!(!is_framing("=== RUN\n", "TestX"));
    }
}
