//! Fixtures that are notified of each test: their attachments are shown with the test.

use rtf_model::{EventKind, FixtureId, Source, Verdict};

use crate::support::{Folder, nothing_left};

const RECORDER: &str = "\
import os, rtf
class Recorder(rtf.FixtureManager):
    def testStarted(self, test):
        self.told = [f'{test.id} {test.name} {test.repetition}.{test.attempt}']
        with open('trace.csv', 'w') as trace:
            trace.write(test.name)
    def testFinished(self, test, verdict, reason):
        self.report(f'{self.told} {verdict} {reason}')
        self.measure('size', os.path.getsize('trace.csv'), 'B')
        if verdict != 'passed':
            self.attach('trace.csv')
        os.remove('trace.csv')
";

const TESTS: &str = "\
function TestCase.run()
  rtf.require(io.open('trace.csv'), 'it is recorded')
  if rtf.param() == 'crash' then os.exit(7) end
  rtf.check(rtf.param() ~= 'fail', 'as asked')
end
";

fn suite(folder: &Folder, fixture: &str, recorder: &str, tests: &str) {
    folder.file("Recorder.py", recorder).file("Test.lua", TESTS);
    let suite = format!("<suite name='arm'>{fixture}\n{tests}</suite>\n");
    folder.file("s.xml", &suite);
}

#[test]
fn what_a_recorder_keeps_is_shown_with_the_test() {
    let folder = Folder::new();
    let tests = "<test name='good' repetition='2'>Test.lua</test>\n\
                 <test name='bad' param='fail' retries='1'>Test.lua</test>\n\
                 <test name='gone' param='crash'>Test.lua</test>\n";
    suite(&folder, "<fixture>Recorder.py</fixture>", RECORDER, tests);
    let finished =
        folder.rtf(&["run", "s.xml", "--report", "junit=junit.xml", "--report", "text=report.txt"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder));
    let journal = folder.journal();
    let told: Vec<_> = journal
        .events
        .iter()
        .filter_map(|event| match &event.kind {
            EventKind::Message { source: Source::Fixture(FixtureId(0)), message, test } => {
                Some((test.expect("the test").0, message.text.as_str()))
            }
            _ => None,
        })
        .collect();
    let gone = "['2 gone 1.1'] crashed the test's process ended in run with exit code 7 \
                before the test was over";
    assert_eq!(
        told,
        [
            (0, "['0 good 1.1'] passed "),
            (0, "['0 good 2.1'] passed "),
            (1, "['1 bad 1.1'] failed as asked"),
            (1, "['1 bad 1.2'] failed as asked"),
            (2, gone),
        ]
    );
    let record = &journal.record;
    let kept: Vec<Vec<_>> = record
        .tests
        .iter()
        .map(|test| test.attempts.iter().map(|attempt| attempt.attachments.len()).collect())
        .collect();
    assert_eq!(kept, [vec![0, 0], vec![1, 1], vec![1]]);
    let results = folder.path().join("rtf-results/latest");
    for (test, name) in [(1, "bad"), (2, "gone")] {
        for attempt in &record.tests[test].attempts {
            let file = results.join(&attempt.attachments[0].path);
            assert_eq!(std::fs::read_to_string(file).expect("the copy"), name);
            assert_eq!(attempt.measurements[0].name, "size");
        }
    }
    let path = &record.tests[2].attempts[0].attachments[0].path;
    assert!(folder.read("junit.xml").contains(path), "{}", folder.read("junit.xml"));
    let text = folder.read("report.txt");
    assert!(text.contains(&format!("attached: trace.csv: {path}")), "{text}");
    assert!(text.contains(gone), "{text}");
    let shown = folder.rtf(&["show", "--verbose"]);
    assert!(shown.stdout.contains("attached trace.csv"), "{}", shown.stdout);
}

#[test]
fn a_recorder_that_hangs_collapses_and_the_verdict_stands() {
    let folder = Folder::new();
    let recorder = RECORDER.replace("        self.report", "        self.sleep(1000)\n        #");
    let fixture = "<fixture notify-timeout='2s'>Recorder.py</fixture>";
    suite(&folder, fixture, &recorder, "<test name='good'>Test.lua</test>\n");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    assert_eq!(record.tests[0].verdict(), Some(Verdict::Passed));
    let why = &record.fixtures[0].collapses[0].1;
    assert_eq!(why, "testFinished did not end within 2s");
    assert!(nothing_left(&folder));
}

#[test]
fn no_test_begins_with_a_recorder_that_cannot_record() {
    let folder = Folder::new();
    let recorder =
        RECORDER.replace("        self.told", "        raise OSError('full')\n        #");
    let fixture = "<fixture restarts='1'>Recorder.py</fixture>";
    suite(&folder, fixture, &recorder, "<test name='good'>Test.lua</test>\n");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    assert_eq!(record.tests[0].verdict(), Some(Verdict::Skipped));
    let broken = record.fixtures[0].broken.as_deref();
    assert_eq!(broken, Some("testStarted failed: OSError: full"));
    assert!(record.tests[0].attempts.is_empty());
}

/// Its end of a test waits for the robot to be parked.
const WAITS: &str = "\
import os, rtf
class Recorder(rtf.FixtureManager):
    def testFinished(self, test, verdict, reason):
        self.wait_until(lambda: os.path.exists('parked'), 60, 'the robot is parked')
";

#[test]
fn a_robot_is_parked_while_a_recorder_has_not_answered_yet() {
    let folder = Folder::new();
    let fixture = "<fixture notify-timeout='60s'>Recorder.py</fixture>\
                   <hook name='park' on='failure'><command>touch parked</command></hook>";
    let tests =
        "<test name='bad' param='fail'>Test.lua</test>\n<test name='good'>Test.lua</test>\n";
    suite(&folder, fixture, WAITS, tests);
    folder.file("trace.csv", "");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder));
    let journal = folder.journal();
    let place = |wanted: &dyn Fn(&EventKind) -> bool| {
        journal.events.iter().position(|event| wanted(&event.kind)).expect("the event")
    };
    // The recorder answers as soon as the robot is parked: the end of the hook may be
    // noticed before or after.
    let parking = place(&|kind| matches!(kind, EventKind::HookStarted { .. }));
    place(&|kind| matches!(kind, EventKind::HookFinished { problem: None, .. }));
    let ended = place(&|kind| matches!(kind, EventKind::TestFinished(_)));
    assert!(parking < ended, "{}", finished.stdout);
    assert!(journal.record.fixtures[0].collapses.is_empty(), "{}", finished.stdout);
    assert_eq!(journal.record.tests[1].verdict(), Some(Verdict::Passed));
}
