//! Tests that follow simulated time, which a fixture writes.

use rtf_model::{EventKind, TestId, Verdict};

use crate::support::{Folder, nothing_left};

/// Its time runs so many times as fast as the world's, up to a limit; then it
/// stands still, or does what the third argument says.
pub const SIMULATOR: &str = r#"
import os, sys, time
rate, last, then = [*sys.argv[1:], "inf", "stands"][0:3]
path = os.environ["RTF_CLOCK_FILE"]
def show(text):
    with open(path + ".new", "w") as file:
        file.write(text)
    os.replace(path + ".new", path)
start = time.monotonic()
while True:
    now = (time.monotonic() - start) * float(rate)
    if now > float(last):
        if then == "jumps":
            start = time.monotonic()
        elif then == "breaks":
            show("soon\n")
            time.sleep(1000)
        now = float(last)
    show(f"{now:.6f}\n")
    time.sleep(0.002)
"#;

const SLEEPER: &str = "import time\nimport rtf\n\nclass Sleeper(rtf.TestCase):\n    def run(self):\n        \
    begin = time.monotonic()\n        self.sleep(float(self.param))\n        \
    self.measure('wall', time.monotonic() - begin, 's')\n";

fn folder(simulator: &str, attributes: &str, test: &str, seconds: &str) -> Folder {
    let folder = Folder::new();
    folder.file("simulator.py", SIMULATOR).file("Sleeper.py", SLEEPER);
    let suite = format!(
        "<suite name='s' clock='file' {attributes}>\n  <fixture name='sim' type='process' restarts='0'>\
         <command>python3 simulator.py {simulator}</command></fixture>\n  \
         <test {test} param='{seconds}'>Sleeper.py</test>\n</suite>\n"
    );
    folder.file("s.xml", &suite);
    folder
}

/// The wall time that the test slept.
fn slept(folder: &Folder) -> f64 {
    let events = folder.journal().events;
    let measured = events.iter().find_map(|event| match &event.kind {
        EventKind::Measured { measurement, .. } => measurement.value,
        _ => None,
    });
    measured.expect("a measurement")
}

#[test]
fn a_fast_simulator_makes_waits_short_and_a_slow_one_makes_limits_long() {
    let fast = folder("20", "", "timeout='300s'", "30");
    let finished = fast.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(slept(&fast) < 20.0);
    let slow = folder("0.2", "", "timeout='700ms' slow='50ms'", "0.3");
    let finished = slow.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(slept(&slow) > 1.0);
    let journal = slow.journal();
    assert!(journal.events.iter().any(|event| matches!(event.kind, EventKind::TestSlow { .. })));
    assert!(nothing_left(&slow));
}

#[test]
fn a_limit_is_reached_when_the_simulator_says_so() {
    let folder = folder("50", "", "timeout='20s'", "1000000");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::TimedOut));
    let reason = record.tests[0].reason().expect("a reason");
    let begin = "run did not end within 20s of simulated time, which took ";
    assert!(reason.starts_with(begin), "{reason}");
}

#[test]
fn a_simulator_that_stands_still_does_not_hold_a_test_for_ever() {
    let folder = folder("50 2", "clock-backstop='2'", "timeout='1s'", "1000");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    let reason = record.tests[0].reason().expect("a reason");
    let begin = "run did not end within 1s of simulated time, nor within 2s: the clock ";
    assert!(reason.starts_with(begin) && reason.contains("stood at 2s"), "{reason}");
}

#[test]
fn a_simulator_that_is_reset_again_and_again_is_followed() {
    let folder = folder("20 5 jumps", "", "timeout='100s'", "30");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(slept(&folder) > 1.0);
}

#[test]
fn a_clock_that_shows_no_time_collapses_and_says_what_it_shows() {
    let folder = folder("20 50 breaks", "", "", "1000");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let clock = &record.fixtures[1];
    assert_eq!(clock.plan.name, "clock");
    let reason = &clock.collapses[0].1;
    assert!(reason.contains("$RTF_CLOCK_FILE has 'soon\\n'"), "{reason}");
    assert!(nothing_left(&folder));
}

#[test]
fn hooks_and_suites_without_a_clock_follow_the_wall_clock() {
    let folder = folder("50", "", "", "1");
    folder.file(
        "Told.py",
        "import os\nimport rtf\n\nclass Told(rtf.TestCase):\n    def run(self):\n        \
        self.report(os.environ.get('RTF_CLOCK') or 'wall')\n",
    );
    folder.file("none.xml", "<suite><test>Told.py</test></suite>");
    folder.file("hook.xml", "<suite clock='file'><fixture type='process'><command>python3 simulator.py 50</command></fixture>\
        <hook on='end'>Told.py</hook><test param='1'>Sleeper.py</test></suite>");
    let mut command = folder.command(&["run", "none.xml", "hook.xml"]);
    // As when rtf is run by a test of a suite with a clock.
    command.env("RTF_CLOCK", "/nowhere");
    let finished = crate::support::Finished::of(command.output().expect("rtf runs"));
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let journal = folder.journal();
    let told: Vec<_> = journal
        .events
        .iter()
        .filter_map(|event| match &event.kind {
            EventKind::Message { message, .. } => Some(message.text.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(told, ["wall", "wall"]);
}
