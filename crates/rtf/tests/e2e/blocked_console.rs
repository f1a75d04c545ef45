//! Nothing reads the console (a pager, Ctrl-S, a slow connection): verdicts, hooks and the
//! journal do not wait for it.

use std::io::Read as _;
use std::process::ExitStatus;
use std::time::{Duration, Instant};

use rtf_model::{EventKind, Record, Verdict};

use crate::support::{Folder, Running, nothing_left, wait_until};

/// How long a test may take: much longer than it does on a busy machine.
const LIMIT_SECS: u64 = 15;

const PLUGIN: &str = r#"
TestCase = {}
function TestCase.run()
  for number = 1, tonumber(rtf.param()) or 0 do
    rtf.report(("x"):rep(2000) .. " with the number " .. number)
  end
  if rtf.param() == "hang" then rtf.sleep(1000) end
  if rtf.param() == "last" then io.open("last", "w"):close() end
  rtf.check(rtf.param() ~= "fail", "it was asked to fail")
end
"#;

fn start(tests: &[&str], options: &[&str]) -> (Folder, Running) {
    let folder = Folder::new();
    folder.file("T.lua", PLUGIN);
    let tests: String = tests
        .iter()
        .map(|param| {
            format!("  <test name='{param}' timeout='{LIMIT_SECS}s' param='{param}'>T.lua</test>\n")
        })
        .collect();
    let hook = "<hook on='failure'><command>touch parked</command></hook>";
    folder.file("s.xml", &format!("<suite name='s'>\n  {hook}\n{tests}</suite>\n"));
    let mut args = vec!["run"];
    args.extend(options);
    args.push("s.xml");
    let running = folder.start(&args);
    (folder, running)
}

/// The journal is long: it is read once the last test has begun.
fn wait_for_last(folder: &Folder, running: &Running) {
    wait_until("the last test", || folder.path().join("last").exists().then_some(()));
    running.wait_for(is_over);
}

fn is_over(kind: &EventKind) -> bool {
    matches!(kind, EventKind::RunFinished { .. })
}

fn has_failed(kind: &EventKind) -> bool {
    matches!(kind, EventKind::TestFinished(end) if end.verdict == Verdict::Failed)
}

fn verdicts(record: &Record) -> Vec<Verdict> {
    record.tests.iter().map(|test| record.final_verdict(test.plan.test)).collect()
}

fn ended_within(running: &mut Running, limit: Duration) -> Option<ExitStatus> {
    let begin = Instant::now();
    while begin.elapsed() < limit {
        if let Some(status) = running.child.try_wait().expect("a status") {
            return Some(status);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    None
}

fn read_all(running: &mut Running) -> String {
    let mut text = String::new();
    running.child.stdout.take().expect("a pipe").read_to_string(&mut text).expect("text");
    text
}

#[test]
fn a_flood_that_nobody_reads_passes_and_hooks_and_journal_go_on() {
    let (folder, mut running) = start(&["fail", "3000", "last"], &["-v"]);
    wait_for_last(&folder, &running);
    assert!(folder.path().join("parked").exists(), "the hook did not run");
    let record = folder.journal().record;
    assert_eq!(verdicts(&record), [Verdict::Failed, Verdict::Passed, Verdict::Passed]);
    let text = read_all(&mut running);
    assert!(text.contains("the number 1\n") && !text.contains("the number 3000\n"));
    assert!(text.contains("left out"), "{}", &text[text.len().saturating_sub(500)..]);
    assert!(text.contains("1 failed"), "{}", &text[text.len().saturating_sub(500)..]);
    assert_eq!(running.child.wait().expect("an end").code(), Some(1));
}

#[test]
fn the_journal_knows_what_happened_before_a_runner_that_nobody_reads_is_killed() {
    let (folder, mut running) = start(&["3000", "fail", "hang"], &["-v"]);
    wait_until("the hook", || folder.path().join("parked").exists().then_some(()));
    running.wait_for(has_failed);
    running.kill_runner();
    let text = read_all(&mut running);
    running.child.wait().expect("an end");
    let shown = folder.rtf(&["show"]);
    assert!(shown.stdout.contains("it was asked to fail"), "{}{text}", shown.stdout);
    assert!(nothing_left(&folder));
}

#[test]
fn a_signal_at_the_end_ends_the_wait_for_the_reader() {
    let (folder, mut running) = start(&["3000", "fail", "last"], &["-v"]);
    wait_for_last(&folder, &running);
    // One that comes before the runner waits for the reader asks for the end of the run.
    let code = (0..2).find_map(|_| {
        running.signal("INT");
        ended_within(&mut running, Duration::from_secs(5))
    });
    let code = code.expect("the runner waits on");
    assert_eq!(code.code(), Some(1), "the exit code is about the tests");
    assert_eq!(
        verdicts(&folder.journal().record),
        [Verdict::Passed, Verdict::Failed, Verdict::Passed]
    );
}

/// A stream of data leaves nothing out: then its test waits, but is not blamed.
#[test]
fn the_clock_of_a_test_is_paused_while_its_stream_is_not_read() {
    let (folder, mut running) = start(&["3500"], &["--format", "json"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { .. }));
    // Longer than the test may take.
    std::thread::sleep(Duration::from_secs(LIMIT_SECS + 2));
    let text = read_all(&mut running);
    assert_eq!(running.child.wait().expect("an end").code(), Some(0));
    assert_eq!(text.matches("the number").count(), 3500);
    assert_eq!(verdicts(&folder.journal().record), [Verdict::Passed]);
}
