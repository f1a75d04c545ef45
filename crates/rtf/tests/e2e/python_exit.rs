//! A forked Python host skips most of the interpreter's finalization, but runs everything that a
//! plug-in registered for the exit.

use rtf_model::{EventKind, Output, Source, Verdict};

use crate::bad_libraries::build_c;
use crate::support::{Folder, Journal, nothing_left};

/// A library that crashes when the process ends.
const BAD_LIBRARY: &str = "#include <signal.h>\n\
    __attribute__((destructor)) static void end(void) { raise(SIGBUS); }\n";

const TEST: &str = "
import atexit, json, os, signal, sys, threading
import rtf

class Thing:
    def __init__(self, text):
        self.text = text

    def __del__(self):
        print(f'the end of {self.text}')

class T(rtf.TestCase):
    def run(self):
        self.report('here')
";

/// What plug-ins leave behind, and what is seen of its end.
const ENDS: &[(&str, &str, &str)] = &[
    ("nothing", "", ""),
    ("in its module", "thing = Thing('a thing')", "the end of a thing\n"),
    ("in a ring", "thing = Thing('a ring')\nthing.me = thing\ndel thing", "the end of a ring\n"),
    ("in Python's module", "json.thing = Thing('a guest')", "the end of a guest\n"),
    (
        "of a class that is not collected",
        "class Bare(object):\n    __slots__ = ()\n    def __del__(self):\n        os.write(1, b'bare\\n')\n\
         json.bare = Bare()",
        "bare\n",
    ),
    ("an exit function", "atexit.register(print, 'at exit')", "at exit\n"),
    (
        "exit functions and things",
        "thing = Thing('a thing')\natexit.register(print, 1)\natexit.register(print, 2)",
        "2\n1\nthe end of a thing\n",
    ),
    (
        "a generator",
        "def f():\n    try: yield\n    finally: os.write(1, b'finally\\n')\ng = f(); next(g)",
        "finally\n",
    ),
    ("a thread", "threading.Timer(0.3, print, ['later']).start()", "later\n"),
    (
        "a thing made by an exit function",
        "atexit.register(lambda: print('at exit') or setattr(T, 'late', Thing('late')))",
        "at exit\nthe end of late\n",
    ),
    (
        "an executor",
        "import time\nfrom concurrent.futures import ThreadPoolExecutor\n\
         ThreadPoolExecutor(1).submit(lambda: (time.sleep(0.2), print('done')))",
        "done\n",
    ),
    (
        "output in a buffer of its own",
        "sys.stdout = open(1, 'w', 4096, closefd=False)\nprint('mine')",
        "mine\n",
    ),
    (
        "an unwritten file",
        "json.file = open(1, 'w', 4096, closefd=False)\njson.file.write('in time\\n')",
        "in time\n",
    ),
    ("a partial line", "print('no end', end='')", "no end"),
];

/// What makes the end a crash.
const BAD_ENDS: &[(&str, &str)] = &[
    ("SIGABRT", "atexit.register(os.abort)"),
    ("SIGSEGV", "class Bad:\n    __del__ = lambda me: signal.raise_signal(11)\nbad = Bad()"),
    ("SIGKILL", "json.bad = type('Bad', (), {'__del__': lambda me: os.kill(os.getpid(), 9)})()"),
    ("SIGBUS", "import ctypes\nctypes.CDLL(os.path.abspath('bad.so'))"),
    ("exit code 3", "atexit.register(os._exit, 3)"),
];

/// Runs each of these as a test.
fn run(bodies: &[&str], fork: &str) -> Journal {
    let folder = Folder::new();
    build_c(&folder, "bad.so", BAD_LIBRARY);
    let tests: Vec<_> = (0..bodies.len()).map(|n| format!("  <test>T{n}.py</test>\n")).collect();
    for (number, body) in bodies.iter().enumerate() {
        folder.file(&format!("T{number}.py"), &format!("{TEST}\n{body}\n"));
    }
    folder.file("s.xml", &format!("<suite>\n{}</suite>\n", tests.concat()));
    let finished = folder.rtf(&["run", "--fork", fork, "s.xml"]);
    assert!(nothing_left(&folder), "{}{}", finished.stdout, finished.stderr);
    folder.journal()
}

/// What each test printed.
fn outputs(journal: &Journal) -> Vec<String> {
    let mut outputs = vec![String::new(); journal.record.tests.len()];
    for event in &journal.events {
        if let EventKind::Output(Output { source: Source::Test(test), text, .. }) = &event.kind {
            outputs[test.index()].push_str(text);
        }
    }
    outputs
}

#[test]
fn what_a_plugin_leaves_ends_in_a_fork_as_elsewhere() {
    let bodies: Vec<_> = ENDS.iter().map(|(_, body, _)| *body).collect();
    for fork in ["always", "never"] {
        let journal = run(&bodies, fork);
        for ((what, _, wanted), output) in ENDS.iter().zip(outputs(&journal)) {
            assert_eq!(&output, wanted, "{what}, fork {fork}");
        }
        assert!(journal.record.is_green(), "fork {fork}");
    }
}

#[test]
fn a_crash_at_the_end_is_the_tests_in_a_fork_as_elsewhere() {
    let bodies: Vec<_> = BAD_ENDS.iter().map(|(_, body)| *body).collect();
    for fork in ["always", "never"] {
        let journal = run(&bodies, fork);
        for (test, (how, _)) in journal.record.tests.iter().zip(BAD_ENDS) {
            let (_, finished) = test.attempts[0].finished.as_ref().expect("an end");
            assert_eq!(finished.verdict, Verdict::Crashed, "{how}, fork {fork}");
            let reason = finished.reason.as_deref().unwrap_or_default();
            assert!(reason.contains(how), "{how}, fork {fork}: {reason}");
        }
    }
}

/// Python tells each thing that it takes down when it is asked to be verbose.
#[test]
fn an_interpreter_is_not_taken_down_for_nothing() {
    let folder = Folder::new();
    folder.file("T.py", TEST);
    let test = "  <test>T.py<env name='PYTHONVERBOSE' value='1'/></test>\n";
    folder.file("s.xml", &format!("<suite>\n{test}{test}</suite>\n"));
    for (fork, wanted) in [("always", false), ("never", true)] {
        let finished = folder.rtf(&["run", "--fork", fork, "s.xml"]);
        assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
        for output in outputs(&folder.journal()) {
            assert_eq!(output.contains(" wiping builtins"), wanted, "fork {fork}: {output}");
        }
    }
}
