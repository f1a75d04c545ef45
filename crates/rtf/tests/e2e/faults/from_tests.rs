//! Faults that a test injects.

use rtf_model::{TestId, Verdict};

use super::{faults, folder, passes};
use crate::support::nothing_left;

const FROM_TEST: &str = "import rtf\n\
def ticks():\n    with open('tick') as file: return int(file.read())\n\
class T(rtf.TestCase):\n    \
def stands(self):\n        before = ticks(); self.sleep(0.15); return ticks() == before\n    \
def run(self):\n        \
with self.fault('drop'):\n            self.require(self.stands(), 'it stands')\n        \
before = ticks(); self.wait_until(lambda: ticks() > before, 30, 'it runs')\n        \
lost = self.fault('drop'); self.require(self.stands(), 'it stands again')\n        \
if self.param == 'leave': return\n        \
lost.remove(); lost.remove()\n        \
self.fault('drop'); self.fault('drop')\n";

#[test]
fn a_test_injects_a_fault_and_removes_it_early() {
    let folder = folder(
        "<fault name='drop' kind='stop' fixture='camera'/>
         <test param='leave'> T.py </test><test> T.py </test>",
        "",
    );
    folder.file("T.py", FROM_TEST);
    let finished = folder.rtf(&["run", "s.xml"]);
    let journal = folder.journal();
    assert!(nothing_left(&folder));
    let verdict = |test| journal.record.verdict(TestId(test));
    assert_eq!((verdict(0), verdict(1)), (Some(Verdict::Passed), Some(Verdict::Error)));
    let reason = journal.record.tests[1].reason().unwrap();
    assert_eq!(reason, "the fault \"drop\" was not injected: it lasts already");
    for (test, count) in [(0, 2), (1, 3)] {
        let faults = &journal.record.tests[test].attempts[0].faults;
        assert_eq!(faults.len(), count, "{}", finished.stdout);
        assert!(faults.iter().all(|fault| fault.removed.is_some()), "{faults:?}");
    }
}

/// Sends the request of a test to the fixture, as another user.
const STRANGER: &str = r##"import rtf, subprocess
REQUEST = """import socket, sys
with socket.socket(socket.AF_UNIX) as connection:
    connection.connect(chr(0) + sys.argv[1])
    try:
        connection.sendall(bytes("inject#drop#T#".replace("#", chr(10)), "ascii"))
        print(connection.recv(1000))
    except ConnectionError:
        print(b"")
"""
OTHER = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "/usr/bin/python3", "-c"]

class T(rtf.TestCase):
    def run(self):
        command = [*OTHER, REQUEST, self.fixture_value("faults.socket")]
        done = subprocess.run(command, capture_output=True, text=True)
        self.check(done.stdout == "b''\n", done.stdout + done.stderr)
"##;

#[test]
fn another_user_injects_no_fault() {
    assert!(rustix::process::geteuid().is_root(), "this test acts as another user, as root");
    let folder = folder(
        "<fault name='drop' kind='stop' fixture='camera'/>\n<test type='python'> T.py </test>",
        "",
    );
    folder.file("T.py", STRANGER);
    passes(&folder.rtf(&["run", "s.xml"]));
    assert!(faults(&folder.journal()).is_empty(), "a fault was injected");
}

#[test]
fn a_fault_that_is_not_declared_is_an_error_of_the_test() {
    for (inside, problem) in [
        ("", "the suite declares no `<fault>` without `at`"),
        (
            "<fault name='other' kind='stop' fixture='camera'/>",
            "the suite declares no such fault; this test can inject `other`",
        ),
        (
            "<fault name='other' kind='stop' fixture='camera'/>
             <fault name='drop' kind='stop' fixture='camera' at='1h'/>",
            "it has a time, `at`, at which the suite injects it",
        ),
    ] {
        let folder = folder(&format!("{inside}<test> T.py </test>"), "");
        folder.file("T.py", FROM_TEST);
        folder.rtf(&["run", "s.xml"]);
        let journal = folder.journal();
        let reason = journal.record.tests[0].reason().unwrap_or_default();
        assert_eq!(reason, format!("the fault \"drop\" was not injected: {problem}"));
    }
}
