//! Misbehaving fixtures. `process_fixture` has those that ignore their signal, `collapse` and
//! `signals` those whose tear-down hangs.

use rtf_model::{EventKind, FixtureId, Record, Source, TestId, Verdict};

use crate::support::{Folder, Journal, nothing_left};

/// Tells that it runs, and waits.
const TEST: &str = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        open('go', 'w').close()\n        self.sleep(float(self.param))\n";

fn run(fixtures: &str, files: &[(&str, &str)], seconds: &str) -> (Folder, Option<i32>) {
    let folder = Folder::new();
    folder.file("T.py", TEST);
    for (name, text) in files {
        folder.file(name, text);
    }
    folder.file(
        "s.xml",
        &format!(
            "<suite name='s'>\n  {fixtures}\n  <test type='python' name='first' param='{seconds}'>T</test>\n  \
             <test type='python' name='second' param='0'>T</test>\n</suite>\n"
        ),
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    assert!(nothing_left(&folder), "{}", finished.stdout);
    (folder, finished.code)
}

fn collapse(record: &Record) -> &str {
    &record.fixtures[0].collapses.first().expect("a collapse").1
}

fn at(journal: &Journal, wanted: fn(&EventKind) -> bool) -> usize {
    journal.events.iter().position(|event| wanted(&event.kind)).expect("the event")
}

/// Forks twice, with a session of its own between: a daemon as in the books.
const DAEMON: &str = "import os, rtf, sys, time\n\
class F(rtf.FixtureManager):\n    def setup(self, args):\n        read, write = os.pipe()\n        if os.fork() == 0:\n            os.setsid()\n            if os.fork() == 0:\n                \
os.write(write, b'%d' % os.getpid())\n                os.closerange(0, 1000)\n                time.sleep(1000)\n            os._exit(0)\n        \
os.wait()\n        self.report(os.read(read, 100).decode())\n        return True\n";

#[test]
fn one_that_forks_twice_and_leaves_its_session_takes_its_daemon_along() {
    let (folder, code) = run("<fixture type='python'>F</fixture>", &[("F.py", DAEMON)], "0");
    assert_eq!(code, Some(0));
    let journal = folder.journal();
    let daemon = journal.events.iter().find_map(|event| match &event.kind {
        EventKind::Message { source: Source::Fixture(_), message, .. } => message.text.parse().ok(),
        _ => None,
    });
    let daemon: i32 = daemon.expect("its number");
    assert!(!std::path::Path::new(&format!("/proc/{daemon}")).exists());
}

/// A program that becomes a daemon is not there any more: it has to stay in front.
#[test]
fn a_program_that_goes_to_the_background_has_ended_and_leaves_nothing() {
    let fixture = "<fixture type='process' name='daemon' restarts='0'>\
         <command>sh -c 'setsid sh -c \"sleep 1000 &amp; exec sleep 1000\" &amp; exit 0'</command>\
         <ready command='test -e never'/></fixture>";
    let (folder, code) = run(fixture, &[], "0");
    assert_eq!(code, Some(1));
    let record = folder.journal().record;
    let broken = record.fixtures[0].broken.as_deref();
    assert_eq!(broken, Some("set-up failed: it ended with exit code 0 before it was ready"));
}

#[test]
fn one_that_floods_its_log_is_watched_and_its_log_is_bounded() {
    // 100 MB at the least, as fast as it can.
    let flood = "import sys\nprint('up', flush=True)\nline = 'x' * 99 + '\\n'\n\
        for _ in range(100):\n    sys.stdout.write(line * 10000)\n\
        print('FATAL: motor 3', flush=True)\nwhile True:\n    sys.stdout.write(line * 1000)\n";
    let fixture = "<fixture type='process' name='noisy' restarts='0'><command>python3 flood.py</command>\
         <ready log='^up$'/><alive log-bad='^FATAL'/></fixture>";
    let (folder, code) = run(fixture, &[("flood.py", flood)], "60");
    assert_eq!(code, Some(1));
    let journal = folder.journal();
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(collapse(&journal.record), "it printed `FATAL: motor 3`");
    let path = folder.path().join("rtf-results/latest/events.jsonl");
    let bytes = std::fs::metadata(path).expect("a journal").len();
    assert!(bytes < 10_000_000, "{bytes} bytes");
}

#[test]
fn one_that_exits_0_while_it_is_needed_has_collapsed() {
    let fixture = "<fixture type='process' name='quitter' restarts='0'>\
         <command>sh -c 'echo up; until test -f go; do sleep 0.01; done; exit 0'</command>\
         <ready log='up'/></fixture>";
    let (folder, code) = run(fixture, &[], "60");
    assert_eq!(code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::Skipped));
    assert_eq!(collapse(&record), "its process ended with exit code 0");
}

#[test]
fn one_whose_check_hangs_has_collapsed_and_is_started_again() {
    let fixture = "<fixture type='python' check-timeout='2s' check-every='10ms'>F</fixture>";
    let hangs = "import os, rtf, time\nclass F(rtf.FixtureManager):\n    def setup(self, args):\n        return True\n    \
        def check(self):\n        if os.path.exists('go') and not os.path.exists('hung'):\n            open('hung', 'w').close()\n            time.sleep(1000)\n        return True\n";
    let (folder, code) = run(
        &fixture.replace("<fixture ", "<fixture teardown-timeout='200ms' "),
        &[("F.py", hangs)],
        "60",
    );
    assert_eq!(code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::Passed));
    assert_eq!(collapse(&record), "check did not answer within 2s");
    assert_eq!(record.fixtures[0].starts, 2);
}

#[test]
fn one_that_collapses_while_another_is_set_up_takes_that_along() {
    // The first dies when the second is being set up, once.
    let fixtures = "<fixture type='process' name='driver' restart-delay='1ms'>\
         <command>sh -c 'echo up; until test -f setting-up -a ! -f died; do sleep 0.01; done; touch died; exit 4'</command>\
         <ready log='up'/></fixture>\
         <fixture type='process' name='robot'>\
         <command>sh -c 'test -f died &amp;&amp; echo ready; touch setting-up; exec sleep 1000'</command>\
         <ready log='ready'/></fixture>";
    let (folder, code) = run(fixtures, &[], "0");
    assert_eq!(code, Some(1));
    let journal = folder.journal();
    let record = &journal.record;
    assert_eq!(collapse(record), "its process ended with exit code 4; its last line was: up");
    assert!(record.fixtures[1].collapses.is_empty(), "{:?}", record.fixtures[1].collapses);
    let starts: Vec<u32> = record.fixtures.iter().map(|fixture| fixture.starts).collect();
    assert_eq!(starts, [2, 2]);
    assert_eq!(record.totals().of(Verdict::Passed), 2);
    let gone = at(&journal, |kind| {
        matches!(kind, EventKind::FixtureStopped { fixture: FixtureId(1), .. })
    });
    let again = at(&journal, |kind| {
        matches!(kind, EventKind::FixtureStarting { fixture: FixtureId(0), attempt: 2 })
    });
    assert!(gone < again, "the one that depends on it went first");
}
