//! Attachments that the runner copies because the host of a test did not.

use std::fs::File;
use std::process::Command;

use rtf_model::{AttemptRecord, Verdict};

use crate::host_modes::{FORKED, SHARED};
use crate::support::{Folder, nothing_left};

/// Attaches what its parameter names, as a raw client of the protocol; tells of it before
/// and afterwards.
const PLUGIN: &str = r#"
import json
import os
import rtf


def channel():
    for fd in range(3, 64):
        try:
            if os.readlink(f"/proc/self/fd/{fd}").startswith("socket:"):
                return fd
        except OSError:
            continue


class T(rtf.TestCase):
    def run(self):
        self.report("before")
        params = {"name": "kept", "path": self.param, "media_type": ""}
        line = {"jsonrpc": "2.0", "method": "attached", "params": params}
        os.write(channel(), json.dumps(line).encode() + b"\n")
        self.report("afterwards")
"#;

fn texts(attempt: &AttemptRecord) -> Vec<&str> {
    attempt.messages.iter().map(|message| message.text.as_str()).collect()
}

#[test]
fn only_files_of_some_size_are_attached_and_nothing_waits_for_others() {
    for mode in [FORKED, SHARED] {
        let folder = Folder::new();
        folder.file("T.py", PLUGIN).file("small", "some text");
        let large = File::create(folder.path().join("large")).expect("a file");
        large.set_len(5 << 30).expect("room for a hole");
        let fifo = Command::new("mkfifo").arg(folder.path().join("fifo")).status();
        assert!(fifo.expect("mkfifo").success());
        let problems = [
            ("small", ""),
            ("fifo", "it is a FIFO, not a file"),
            (".", "it is a directory, not a file"),
            ("/dev/zero", "it is a device or a socket, not a file"),
            ("large", "it is larger than 1024 MiB"),
            ("nowhere", "No such file or directory (os error 2)"),
        ];
        let tests: String = problems
            .iter()
            .map(|(path, _)| {
                let isolation = mode.isolation;
                format!("<test isolation='{isolation}' timeout='30s' param='{path}'>T.py</test>\n")
            })
            .collect();
        folder.file("s.xml", &format!("<suite name='s'>\n{tests}</suite>\n"));
        let finished = folder.rtf(&["run", "--fork", mode.fork, "s.xml"]);
        assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
        assert!(nothing_left(&folder));
        let record = folder.journal().record;
        for (test, (path, problem)) in record.tests.iter().zip(problems) {
            let attempt = &test.attempts[0];
            let verdict = attempt.finished.as_ref().expect("an end").1.verdict;
            if problem.is_empty() {
                assert_eq!(texts(attempt), ["before", "afterwards"]);
                assert_eq!(verdict, Verdict::Passed);
                let kept = &attempt.attachments[0].path;
                assert_eq!(folder.read(&format!("rtf-results/latest/{kept}")), "some text");
            } else {
                let why = format!("`{path}` cannot be attached: {problem}");
                assert_eq!(texts(attempt), ["before", why.as_str(), "afterwards"], "in order");
                assert_ne!(verdict, Verdict::Passed, "{path}");
                assert!(attempt.attachments.is_empty());
            }
        }
    }
}
