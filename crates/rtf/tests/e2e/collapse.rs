//! Fixture plug-ins in every script language that collapse, die or hang.

use rtf_model::{EventKind, TestId, Verdict};

use crate::host_modes::MODES;
use crate::support::{Folder, nothing_left};

const TEST: &str = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        open(self.param, 'w').close()\n        self.sleep(60 if self.param == 'go' else 0)\n";

fn suite(fixture: &str, attributes: &str) -> String {
    format!(
        "<suite name='s'>\n  <fixture type='python' {attributes}>{fixture}</fixture>\n  \
         <test type='python' name='first' param='go'>T</test>\n  \
         <test type='python' name='second' param='other'>T</test>\n</suite>\n"
    )
}

/// Dies once when the test runs; after the restart the suite goes on.
const DIES: &str = "import os, rtf, signal, threading, time\n\
class F(rtf.FixtureManager):\n    def setup(self, args):\n        if not os.path.exists('died'):\n            threading.Thread(target=self.die, daemon=True).start()\n    \
def die(self):\n        while not os.path.exists('go'):\n            time.sleep(0.005)\n        open('died', 'w').close()\n        os.kill(os.getpid(), signal.SIGKILL)\n";

#[test]
fn a_fixture_that_is_killed_interrupts_the_test_and_is_restarted() {
    let folder = Folder::new();
    folder.file("T.py", TEST).file("F.py", DIES).file("s.xml", &suite("F", ""));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let journal = folder.journal();
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(journal.record.verdict(TestId(1)), Some(Verdict::Passed));
    assert_eq!(journal.record.fixtures[0].starts, 2);
    let reason = journal.record.tests[0].reason().expect("a reason");
    assert_eq!(reason, "fixture `F` collapsed: its process ended with signal 9 (SIGKILL)");
    let at = |wanted: fn(&EventKind) -> bool| {
        journal.events.iter().find(|event| wanted(&event.kind)).expect("the event").at
    };
    let collapsed = at(|kind| matches!(kind, EventKind::FixtureCollapsed { .. }));
    let finished = at(|kind| matches!(kind, EventKind::TestFinished(_)));
    assert!(finished.since(collapsed).as_secs_f64() < 1.0, "a second at the most");
    assert!(nothing_left(&folder));
}

#[test]
fn a_fixture_without_restarts_breaks_and_the_rest_is_skipped() {
    let folder = Folder::new();
    folder.file("T.py", TEST).file("F.py", DIES).file("s.xml", &suite("F", "restarts='0'"));
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::Skipped));
    let reason = record.tests[1].reason().expect("a reason");
    assert!(reason.starts_with("fixture `F` is broken: its process ended"), "{reason}");
}

#[test]
fn a_test_is_run_again_when_the_suite_says_so() {
    let folder = Folder::new();
    let suite = suite("F", "").replace("name='first'", "name='first' after-collapse='rerun'");
    let test = "import os, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        again = os.path.exists('died')\n        open(self.param, 'w').close()\n        self.sleep(0 if again else 60)\n";
    folder.file("T.py", test).file("F.py", DIES);
    folder.file(
        "s.xml",
        &suite.replace("<suite name='s'>", "<suite name='s' tolerate-collapse='true'>"),
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    let record = folder.journal().record;
    let verdicts: Vec<_> = record.tests[0].attempts.iter().filter_map(|a| a.verdict()).collect();
    assert_eq!(verdicts, [Verdict::Collapsed, Verdict::Passed]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
}

#[test]
fn a_lua_fixture_whose_check_fails_is_restarted_before_the_test() {
    let folder = Folder::new();
    folder.file("T.py", TEST);
    folder.file(
        "F.lua",
        "FixtureManager = {}\nfunction FixtureManager.setup() return true end\n\
         function FixtureManager.check()\n  local seen = io.open('seen')\n  if seen then return true end\n  io.open('seen', 'w'):close()\n  return false\nend\n",
    );
    folder.file("s.xml", "<suite name='s'><fixture type='lua'>F</fixture><test type='python' param='other'>T</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.fixtures[0].starts, 2);
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Passed));
    assert!(record.fixtures[0].collapses[0].1.starts_with("check failed"));
}

#[test]
fn a_fixture_whose_tear_down_hangs_is_ended_by_force() {
    let folder = Folder::new();
    folder.file("T.py", TEST);
    folder.file("F.py", "import rtf, time\nclass F(rtf.FixtureManager):\n    def setup(self, args):\n        return True\n    def tearDown(self):\n        time.sleep(1000)\n");
    folder.file("s.xml", "<suite name='s'><fixture type='python' teardown-timeout='200ms'>F</fixture><test type='python' param='other'>T</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Passed));
    assert_eq!(record.fixtures[0].problems[0].1, "it did not stop within 200ms and was killed");
    assert!(nothing_left(&folder));
}

/// Whatever its host says then: a fixture that died while it ran has collapsed.
#[test]
fn a_test_whose_last_act_kills_its_fixture_does_not_pass_in_any_mode() {
    let plugin = "TestCase = {}\nfunction TestCase.run() end\n\
        function TestCase.tearDown() os.execute('kill -KILL ' .. io.open('pid'):read('a')) end\n";
    for mode in MODES {
        let folder = Folder::new();
        let test = format!("  <test isolation='{}'>T.lua</test>\n", mode.isolation);
        let fixture = "<fixture type='process' name='arm' restarts='9' restart-delay='1ms'>\
            <command>sh -c 'echo $$ > pid; echo up; exec sleep 1000'</command><ready log='up'/></fixture>";
        folder.file("T.lua", plugin);
        // Each restart waits longer than the one before.
        for name in ["a.xml", "b.xml", "c.xml", "d.xml"] {
            let text = format!("<suite>\n  {fixture}\n{}</suite>\n", test.repeat(5));
            folder.file(name, &text);
        }
        let finished = folder.rtf(&["run", "--fork", mode.fork, "."]);
        assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
        assert!(nothing_left(&folder));
        let record = folder.journal().record;
        assert_eq!(record.totals().of(Verdict::Collapsed), 20, "{}", finished.stdout);
    }
}

#[test]
fn why_a_fixture_broke_is_told_once_while_the_run_goes_on_and_once_at_its_end() {
    let folder = Folder::new();
    let fixture = "<fixture type='process' name='sim'><command>sh -c 'echo no display; exit 3'</command>\
                   <ready log='up'/></fixture>";
    let park = "<hook name='park' on='fixture-broken'><command>true</command></hook>";
    let text =
        format!("<suite name='s'>{fixture}{park}{}</suite>\n", "<test>T.lua</test>".repeat(3));
    folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() end\n").file("s.xml", &text);
    let finished = folder.rtf(&["run", "s.xml", "--report", "text=t.txt"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let cause = "set-up failed: it ended with exit code 3 before it was ready";
    for told in [&finished.stdout, &folder.read("t.txt")] {
        assert_eq!(told.matches(cause).count(), 2, "{told}");
        assert_eq!(told.matches("| no display").count(), 1, "{told}");
        assert!(told.matches("fixture `sim` is broken\n").count() >= 4, "{told}");
    }
}
