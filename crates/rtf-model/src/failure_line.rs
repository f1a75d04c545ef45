//! Finds the line of a program's last output that says why the program failed.

use std::borrow::Cow;

use crate::plain_text;

/// The longest line of a reason, in characters.
const MAX_CHARS: usize = 200;

const TRACEBACK: &str = "Traceback (most recent call last):";

/// Texts of a shell, the dynamic linker, a language's runtime or the operating system, in lower
/// case: the line that contains one is the reason.
const CAUSES: [&str; 31] = [
    "error:",
    "exception:",
    "fatal:",
    "panic:",
    "critical:",
    "exception in thread",
    "error while loading shared libraries",
    "symbol lookup error",
    "not found",
    "not recognized",
    "no such file or directory",
    "permission denied",
    "address already in use",
    "connection refused",
    "no route to host",
    "could not resolve",
    "exec format error",
    "directory nonexistent",
    "cannot open display",
    "no module named",
    "cannot find module",
    "terminate called",
    "what():",
    "addresssanitizer",
    "assertion `",
    "assertion failed",
    "error)",
    "[error",
    "[fatal",
    "(fatal)",
    "fatal error",
];

/// Words of lines that probably contain the reason, in lower case.
const HINTS: [&str; 15] = [
    "error",
    "err!",
    "fatal",
    "fail",
    "exception",
    "cannot",
    "can't",
    "could not",
    "couldn't",
    "unable to",
    "denied",
    "refused",
    "invalid",
    "abort",
    "died",
];

/// Lines that are no reason, in lower case, although they contain such words.
const OTHERS: [&str; 9] = [
    "[warn",
    "warning:",
    "[info",
    "[debug",
    "[trace",
    " 0 error",
    "no error",
    "without error",
    "errors: 0",
];

/// The starts of lines of a stack trace, and of advice after it.
const FRAMES: [&str; 8] = [
    "at ",
    "from ",
    "File \"",
    "stack backtrace",
    "stack traceback",
    "note: ",
    "goroutine ",
    "exit status ",
];

/// The line of a program's last output that explains its failure best, without escape sequences
/// and with at most 200 characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailureLine {
    /// The line.
    pub text: String,
    /// Whether it reports a failure; otherwise it is only the last one.
    pub is_cause: bool,
}

impl FailureLine {
    /// Finds the line, oldest line first: the last error that the program or its runtime reports,
    /// otherwise the last line that resembles one, otherwise the last line. `None` without output.
    #[must_use]
    pub fn find<S: AsRef<str>>(lines: &[S]) -> Option<Self> {
        let lines: Vec<Cow<'_, str>> = lines.iter().map(|line| plain_text(line.as_ref())).collect();
        let lines: Vec<&str> =
            lines.iter().map(|line| line.trim_end()).filter(|line| !line.is_empty()).collect();
        let last = |is: &dyn Fn(usize) -> bool| (0..lines.len()).rev().find(|index| is(*index));
        let exceptions: Vec<usize> =
            (0..lines.len()).filter_map(|index| exception(&lines, index)).collect();
        let cause = last(&|index| exceptions.contains(&index) || is_any(lines[index], &CAUSES))
            .or_else(|| last(&|index| is_any(lines[index], &HINTS)));
        let index = cause
            .or_else(|| last(&|index| !is_frame(lines[index])))
            .or_else(|| lines.len().checked_sub(1))?;
        Some(Self { text: shortened(lines[index].trim()), is_cause: cause.is_some() })
    }
}

/// Appends the line of the last output that explains it to the reason of a failure.
#[must_use]
pub fn explain_failure<S: AsRef<str>>(reason: &str, lines: &[S]) -> String {
    match FailureLine::find(lines) {
        Some(FailureLine { text, is_cause: true }) => format!("{reason}: {text}"),
        Some(FailureLine { text, .. }) => format!("{reason}; its last line was: {text}"),
        None => reason.to_owned(),
    }
}

/// The line of the exception whose trace begins or ends in this line.
fn exception(lines: &[&str], index: usize) -> Option<usize> {
    let line = lines[index];
    let end = index + 1;
    if let Some(start) = line.find(TRACEBACK) {
        // What runs a program may put its name before each line.
        let label = &line[..start];
        let is_end = |next: &&str| {
            let text = next.strip_prefix(label).unwrap_or(next);
            !text.starts_with([' ', '\t'])
        };
        return lines[end..].iter().position(is_end).map(|offset| end + offset);
    }
    if line.contains("panicked at ") {
        return Some(if line.ends_with(':') && end < lines.len() { end } else { index });
    }
    (line.trim() == "stack traceback:").then(|| index.checked_sub(1)).flatten()
}

fn is_any(line: &str, words: &[&str]) -> bool {
    let lower = format!(" {}", line.to_lowercase());
    let contains = |word: &&str| lower.contains(*word);
    words.iter().any(&contains) && !OTHERS.iter().any(contains) && !is_frame(line)
}

fn is_frame(line: &str) -> bool {
    let line = line.trim_start();
    let is_number = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    FRAMES.iter().any(|start| line.starts_with(start))
        || line.split_once(": ").is_some_and(|(number, _)| is_number(number))
        || line.strip_prefix('#').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
}

fn shortened(line: &str) -> String {
    match line.char_indices().nth(MAX_CHARS) {
        None => line.to_owned(),
        Some(_) => line.chars().take(MAX_CHARS - 1).chain(['…']).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outputs as they were printed, and their reasons.
    const OUTPUTS: &[(&str, &str)] = &[
        (
            "Traceback (most recent call last):\n  File \"e.py\", line 3, in a\n    1/0\n    ~^~\n\
                 ZeroDivisionError: division by zero\n\n\
                 The above exception was the direct cause of the following exception:\n\n\
                 Traceback (most recent call last):\n  File \"e.py\", line 6, in <module>\n    a()\n\
                 ValueError: no arm\nat all",
            "ValueError: no arm",
        ),
        (
            "up\nTraceback (most recent call last):\n  File \"t.py\", line 2, in <module>\n    time.sleep(9)\n\
                 KeyboardInterrupt",
            "KeyboardInterrupt",
        ),
        (
            "[talker-1] Traceback (most recent call last):\n[talker-1]   File \"t.py\", line 1\n\
                 [talker-1] arm.NotConnected: joint 3\n[talker-1] bye",
            "[talker-1] arm.NotConnected: joint 3",
        ),
        (
            "  File \"s.py\", line 1\n    x = (\n        ^\nSyntaxError: '(' was never closed",
            "SyntaxError: '(' was never closed",
        ),
        (
            "python3: can't open file '/x.py': [Errno 2] No such file or directory",
            "python3: can't open file '/x.py': [Errno 2] No such file or directory",
        ),
        ("/usr/bin/python3: No module named sim", "/usr/bin/python3: No module named sim"),
        ("sh: 1: nosuch: not found", "sh: 1: nosuch: not found"),
        ("bash: nosuch: command not found", "bash: nosuch: command not found"),
        (
            "sh: 1: cannot create /nodir/x: Directory nonexistent\nbye",
            "sh: 1: cannot create /nodir/x: Directory nonexistent",
        ),
        ("env: 'nosuch': No such file or directory", "env: 'nosuch': No such file or directory"),
        (
            "ready\n./m: error while loading shared libraries: libl.so: cannot open shared object file: \
                 No such file or directory",
            "./m: error while loading shared libraries: libl.so: cannot open shared object file: \
                 No such file or directory",
        ),
        (
            "./m: symbol lookup error: ./m: undefined symbol: f",
            "./m: symbol lookup error: ./m: undefined symbol: f",
        ),
        (
            "./m: /lib/x86_64-linux-gnu/libc.so.6: version `GLIBC_2.38' not found (required by ./m)",
            "./m: /lib/x86_64-linux-gnu/libc.so.6: version `GLIBC_2.38' not found (required by ./m)",
        ),
        (
            "terminate called after throwing an instance of 'std::runtime_error'\n  what():  no arm\n\
                 bash:  4632 Aborted                 ./t",
            "what():  no arm",
        ),
        (
            "u: u.cpp:2: int main(): Assertion `c==9' failed.\nstopping",
            "u: u.cpp:2: int main(): Assertion `c==9' failed.",
        ),
        (
            "\nthread 'main' (4692) panicked at r.rs:1:12:\nno arm\nstack backtrace:\n   \
                 0: std::panicking::begin_panic::<&str>\n             at /rustc/std/src/panicking.rs:761:5\n\
                 note: Some details are omitted, run with `RUST_BACKTRACE=full` for a verbose backtrace.",
            "no arm",
        ),
        (
            "-e:1:in `run': no arm (RuntimeError)\n\tfrom -e:1:in `<main>'",
            "-e:1:in `run': no arm (RuntimeError)",
        ),
        (
            "lua: arm.lua:3: no arm\nstack traceback:\n\t[C]: in function 'error'",
            "lua: arm.lua:3: no arm",
        ),
        (
            "node:internal/modules/cjs/loader:1210\n  throw err;\n  ^\n\nError: Cannot find module '/x.js'\n\
                 Require stack:\n- /[eval]\n    at Module._load (node:internal/modules:1038:27)",
            "Error: Cannot find module '/x.js'",
        ),
        (
            "Exception in thread \"main\" java.lang.IllegalStateException: no arm\n\tat X.main(X.java:1)",
            "Exception in thread \"main\" java.lang.IllegalStateException: no arm",
        ),
        (
            "panic: no arm\n\ngoroutine 1 [running]:\nmain.main()\n\t/g.go:2 +0x25\nexit status 2",
            "panic: no arm",
        ),
        ("package 'x' not found", "package 'x' not found"),
        (
            "[INFO] [launch]: All log files can be found below /l\n\
                 [ERROR] [launch]: Caught exception in launch: no file\nshutting down",
            "[ERROR] [launch]: Caught exception in launch: no file",
        ),
        ("make: *** [Makefile:2: all] Error 2\nbye", "make: *** [Makefile:2: all] Error 2"),
        (
            "\x1b[31mERROR: the bus is silent\x1b[0m\r\n0 errors recovered",
            "ERROR: the bus is silent",
        ),
        (
            "[WARN] error: retried\nwaiting\nthe arm is not connected\n\n",
            "the arm is not connected",
        ),
        ("bash:  5925 Segmentation fault      ./sim", "bash:  5925 Segmentation fault      ./sim"),
    ];

    #[test]
    fn the_line_that_says_why_is_found_in_real_outputs() {
        for (output, reason) in OUTPUTS {
            let lines: Vec<&str> = output.split('\n').collect();
            let found = FailureLine::find(&lines).map(|line| line.text);
            assert_eq!(found.as_deref(), Some(*reason), "{output}");
        }
        assert_eq!(explain_failure("it ended", &["", " ", "\x1b[0m"]), "it ended");
        assert_eq!(explain_failure("it ended", &["up", ""]), "it ended; its last line was: up");
        assert_eq!(explain_failure("it ended", &["error: up"]), "it ended: error: up");
    }

    #[test]
    fn a_long_line_is_cut_between_characters() {
        let line = FailureLine::find(&["\u{e9}".repeat(500)]).unwrap().text;
        assert_eq!(line.chars().count(), MAX_CHARS);
        assert!(line.ends_with("\u{e9}…"));
    }
}
