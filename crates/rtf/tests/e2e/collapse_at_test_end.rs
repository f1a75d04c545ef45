//! A fixture dies at the moment at which a test ends, especially the last one: no verdict is
//! green.

use rtf_model::{TestId, Verdict};

use crate::support::{Folder, nothing_left};

/// Its last act takes the device away.
const UNPLUGS: &str = "TestCase = {}\nfunction TestCase.run() end\n\
    function TestCase.tearDown() os.remove('device') end\n";

const CHECKS: &str = "import os, rtf\nclass F(rtf.FixtureManager):\n    def check(self):\n        \
    if not os.path.exists('device'):\n            self.fail('the device is gone')\n";

#[test]
fn a_device_that_is_gone_with_the_end_of_the_last_test_is_a_collapse() {
    let process = |alive: &str| {
        format!(
            "<fixture type='process' name='arm' restarts='0'><command>sleep 1000</command>\
             <alive {alive} every='1h'/></fixture>"
        )
    };
    for fixture in [
        "<fixture type='python' name='arm' restarts='0'>F</fixture>".to_owned(),
        "<fixture type='python' name='arm' restarts='0' check-every='1h'>F</fixture>".to_owned(),
        process("file='device'"),
        process("command='test -e device'"),
    ] {
        let folder = Folder::new();
        folder.file("T.lua", UNPLUGS).file("F.py", CHECKS).file("device", "");
        folder.file("s.xml", &format!("<suite name='s'>{fixture}<test>T.lua</test></suite>"));
        let finished = folder.rtf(&["run", "s.xml"]);
        assert_eq!(finished.code, Some(1), "{fixture}\n{}{}", finished.stdout, finished.stderr);
        let record = folder.journal().record;
        assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed), "{fixture}");
        assert!(nothing_left(&folder));
    }
}

/// The signal was sent before the test ended: whatever the kernel has done with it
/// since, the test is not green. With a memory image and without, asleep and at work.
#[test]
fn a_fixture_that_gets_a_deadly_signal_as_the_last_test_ends_has_collapsed() {
    let plugin = "TestCase = {}\nfunction TestCase.run() end\nfunction TestCase.tearDown()\n  \
        os.execute('kill -s ' .. rtf_signal .. ' ' .. io.open('pid'):read('l'))\nend\n";
    for command in ["exec sleep 1000", "while :; do :; done"] {
        for signal in ["TERM", "SEGV", "KILL"] {
            let folder = Folder::new();
            let fixture = format!(
                "<fixture type='process' name='arm' restarts='0'>\
                 <command>sh -c 'ulimit -c 0; echo $$ &gt; pid; echo up; {command}'</command>\
                 <ready log='up'/></fixture>"
            );
            folder.file("T.lua", &format!("rtf_signal = '{signal}'\n{plugin}"));
            // Each is the last test of its suite.
            for suite in 0..25 {
                let text = format!("<suite>{fixture}<test>T.lua</test></suite>");
                folder.file(&format!("{suite}.xml"), &text);
            }
            let finished = folder.rtf(&["run", "."]);
            assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
            let totals = folder.journal().record.totals();
            assert_eq!(totals.of(Verdict::Collapsed), 25, "{signal}\n{}", finished.stdout);
            assert!(nothing_left(&folder));
        }
    }
}

/// It printed a suite that is `PASSED`, whatever its process did when it was stopped.
#[test]
fn a_process_that_does_not_end_as_it_was_asked_to_is_a_problem_of_its_tear_down() {
    let killed = "its process ended with signal 9 (SIGKILL) while it was being stopped";
    let code = "its process ended with exit code 3 while it was being stopped";
    for (trap, stop, problem) in [
        ("exit 3", "<stop/>", Some(code)),
        ("kill -KILL $$", "<stop/>", Some(killed)),
        ("exit 3", "<stop exit-codes='1 3'/>", None),
        ("exit 0", "<stop/>", None),
        ("exit 130", "<stop signal='INT'/>", None),
        ("trap - TERM; kill -TERM $$", "<stop/>", None),
    ] {
        let folder = Folder::new();
        let script = format!("trap \"{trap}\" TERM INT; echo up; while :; do sleep 0.01; done");
        let text = format!(
            "<suite name='s'><fixture type='process' name='arm'><command>sh -c '{script}'</command>\
             <ready log='up'/>{stop}</fixture><test>T.lua</test></suite>"
        );
        folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() end\n").file("s.xml", &text);
        let finished = folder.rtf(&["run", "s.xml"]);
        let record = folder.journal().record;
        let problems = &record.fixtures[0].problems;
        // The shell may print that `sleep` was terminated.
        let end = problems.first().and_then(|(_, text)| text.split("; its last line was: ").next());
        assert_eq!(end, problem, "{trap}");
        let code = Some(i32::from(problem.is_some()));
        assert_eq!(finished.code, code, "{}{}", finished.stdout, finished.stderr);
    }
}

#[test]
fn a_suite_whose_tear_down_goes_beyond_its_timeout_does_not_pass() {
    let folder = Folder::new();
    let text = "<suite name='s' timeout='3s'><fixture type='process' name='arm'>\
        <command>sh -c 'trap \"sleep 4; exit 0\" TERM; echo up; while :; do sleep 0.01; done'</command>\
        <ready log='up'/></fixture><test>T.lua</test></suite>";
    folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() end\n").file("s.xml", text);
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let problem = &folder.journal().record.fixtures[0].problems[0].1;
    assert_eq!(problem, "it was not torn down in time: the suite did not end within 3s");
}
