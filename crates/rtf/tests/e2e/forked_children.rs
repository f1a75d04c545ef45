//! A test forks, and its child continues as if it were the test: only the original process
//! decides the verdict.

use rtf_model::{AttemptRecord, Verdict};

use crate::host_modes::{FORKED, MODES, Mode, SHARED};
use crate::support::{Folder, Journal, build_cpp, nothing_left, root};

/// What the parent does, and the verdict over the test.
const ENDS: [(&str, Verdict); 4] = [
    ("crash", Verdict::Crashed),
    ("hang", Verdict::TimedOut),
    ("exit", Verdict::Crashed),
    ("fail", Verdict::Failed),
];
const ROUNDS: usize = 5;

const LUA: &str = r#"
local forks = require("Forks")
TestCase = {}
function TestCase.run()
  if rtf.param() == "pass" then return end
  if forks.split() then
    rtf.report("from the child")
    return
  end
  forks.act(rtf.param())
  rtf.check(rtf.param() ~= "fail", "it was asked to fail")
end
"#;

/// Finds its channel, and lets a child write there.
const PYTHON: &str = r#"
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
        if self.param == "halves":
            return self.halves()
        child = os.fork()
        if child == 0:
            for number in (2, 3):
                answer = '{"jsonrpc":"2.0","id":%d,"result":{"outcome":"passed"}}\n'
                os.write(channel(), (answer % number).encode())
            os._exit(0)
        os.waitpid(child, 0)
        if self.param == "exit":
            os._exit(0)
        if self.param == "crash":
            os.abort()
        if self.param == "hang":
            self.sleep(1000)

    def halves(self):
        goes_on, go_on = os.pipe()
        said, say = os.pipe()
        child = os.fork()
        line = b'{"jsonrpc":"2.0","method":"message","params":{"kind":"report","text":"the child"}}\n'
        if child == 0:
            os.write(channel(), line[:40])
            os.write(say, b"x")
            os.read(goes_on, 1)
            os.write(channel(), line[40:])
            os._exit(0)
        os.read(said, 1)
        self.report("the parent")
        os.write(go_on, b"x")
        os.waitpid(child, 0)
"#;

/// Runs tests with these parameters.
fn run(folder: &Folder, (mode, plugin): (Mode, &str), params: &[&str]) -> Journal {
    let tests = params.iter().enumerate().map(|(n, param)| {
        let timeout = if *param == "hang" { "timeout='1s'" } else { "" };
        let isolation = mode.isolation;
        format!(
            "  <test name='t{n}' isolation='{isolation}' {timeout} param='{param}'>{plugin}</test>\n"
        )
    });
    let text = format!("<suite name='s'>\n{}</suite>\n", tests.collect::<String>());
    folder.file("s.xml", &text);
    let finished = folder.rtf(&["run", "--fork", mode.fork, "s.xml"]);
    assert!(finished.code.is_some_and(|code| code < 2), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(folder));
    folder.journal()
}

fn attempts(journal: &Journal) -> impl Iterator<Item = &AttemptRecord> {
    journal.record.tests.iter().map(|test| &test.attempts[0])
}

fn verdicts(journal: &Journal) -> Vec<Verdict> {
    let end = |attempt: &AttemptRecord| attempt.finished.as_ref().expect("an end").1.verdict;
    attempts(journal).map(end).collect()
}

fn has(attempt: &AttemptRecord, text: &str) -> bool {
    attempt.messages.iter().any(|message| message.text == text)
}

fn a_child_never_ends_its_parents_test(plugin: &str) {
    for mode in MODES {
        // Each of them before one that passes: the next test is not to blame.
        let pairs =
            ENDS.iter().flat_map(|(end, verdict)| [(*end, *verdict), ("pass", Verdict::Passed)]);
        let rounds: Vec<(&str, Verdict)> = std::iter::repeat_n(pairs, ROUNDS).flatten().collect();
        let params: Vec<&str> = rounds.iter().map(|(param, _)| *param).collect();
        let folder = Folder::new();
        folder.file("T.lua", LUA);
        let cpp = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp").join("Forks.so");
        std::fs::copy(&cpp, folder.path().join("Forks.so")).expect("a copy");
        let journal = run(&folder, (mode, plugin), &params);
        let expected: Vec<Verdict> = rounds.iter().map(|(_, verdict)| *verdict).collect();
        assert_eq!(verdicts(&journal), expected, "{}", mode.name);
        let reports = attempts(&journal).filter(|attempt| has(attempt, "from the child"));
        assert_eq!(reports.count(), ENDS.len() * ROUNDS, "what a child reports is kept");
    }
}

#[test]
fn the_forked_child_of_a_cpp_test_never_ends_its_parents_test() {
    a_child_never_ends_its_parents_test("Forks.so");
}

#[test]
fn the_forked_child_of_a_lua_test_never_ends_its_parents_test() {
    a_child_never_ends_its_parents_test("T.lua");
}

/// Whatever host a plug-in has: the runner knows who wrote a line.
#[test]
fn an_answer_of_another_process_is_none() {
    for mode in [FORKED, SHARED] {
        let folder = Folder::new();
        folder.file("T.py", PYTHON);
        let journal = run(&folder, (mode, "T.py"), &["exit", "crash", "hang", "pass"]);
        let expected = [Verdict::Crashed, Verdict::Crashed, Verdict::TimedOut, Verdict::Passed];
        assert_eq!(verdicts(&journal), expected, "{}", mode.name);
    }
}

#[test]
fn lines_of_two_processes_are_not_mixed() {
    let folder = Folder::new();
    folder.file("T.py", PYTHON);
    let journal = run(&folder, (FORKED, "T.py"), &["halves"]);
    assert_eq!(verdicts(&journal), [Verdict::Passed]);
    let attempt = attempts(&journal).next().expect("an attempt");
    assert!(has(attempt, "the parent") && has(attempt, "the child"), "{:?}", attempt.messages);
}
