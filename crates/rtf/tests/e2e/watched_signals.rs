//! Signals that are recorded while tests run, and monitors that judge the tests.

use rtf_model::{AttemptRecord, MessageKind, SignalSummary, TestId, Verdict};

use crate::support::{Finished, Folder, Journal, nothing_left};

/// Writes a line each 5 ms: its time, and two values. The first one is 1.3 as soon as a test has
/// created the file `high`.
const SOURCE: &str = "import itertools, os, time\n\
for number in itertools.count():\n    \
print(f'{number * 0.005:.3f} {1.3 if os.path.exists(\"high\") else 0.2} {number}', flush=True)\n    \
time.sleep(0.005)\n";
/// Creates the file, and sleeps for the seconds in its parameter.
const TEST: &str = "function TestCase.setup(args) seconds = tonumber(args[1]); return true end\n\
function TestCase.run() io.open('high', 'w'):close()\n\
rtf.sleep(seconds); rtf.report('end of the test') end\n\
function TestCase.tearDown() os.remove('high') end\n";
const QUIET: &str = "function TestCase.run() rtf.sleep(0.2) end\n";

/// Creates a file when it has used half a second of processor time since the file `start` exists.
const BUSY: &str = "import os, time\n\
while not os.path.exists('start'): time.sleep(0.005)\n\
begin = time.process_time()\n\
while time.process_time() < begin + 0.5: pass\n\
open('busy', 'w').close()\n\
while True: pass\n";
/// Waits for that.
const UNTIL_BUSY: &str = "function TestCase.run() io.open('start', 'w'):close()\n\
rtf.require(rtf.wait_until(function() return io.open('busy') ~= nil end, 60, 'use')) end\n";

const SIGNALS: &str = "<signals time='own'><command>python3 source.py</command>\
<signal name='q' unit='rad'/><signal name='count'/></signals>\n";

fn folder(inside: &str) -> Folder {
    let folder = Folder::new();
    folder.file("source.py", SOURCE).file("High.lua", TEST).file("Quiet.lua", QUIET);
    folder.file("s.xml", &format!("<suite name='arm'>\n{inside}\n</suite>"));
    folder
}

fn run(inside: &str) -> (Finished, Journal, Folder) {
    let folder = folder(inside);
    let finished = folder.rtf(&["run", "s.xml"]);
    let journal = folder.journal();
    assert!(nothing_left(&folder));
    (finished, journal, folder)
}

fn attempt(journal: &Journal, test: u32) -> &AttemptRecord {
    journal.record.tests[test as usize].attempts.last().expect("an attempt")
}

fn series<'j>(journal: &'j Journal, test: u32, name: &str) -> &'j SignalSummary {
    let mut all = attempt(journal, test).series.iter();
    all.find(|series| series.name == name).unwrap_or_else(|| panic!("no signal {name}"))
}

fn robustness(journal: &Journal, test: u32, monitor: &str) -> f64 {
    let name = format!("monitor/{monitor}");
    let mut all = attempt(journal, test).measurements.iter();
    all.find(|it| it.name == name).and_then(|it| it.value).unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn a_monitor_fails_a_test_that_would_pass() {
    let (finished, journal, _folder) = run(&format!(
        "{SIGNALS}<monitor name='low'>always(q &lt; 1rad)</monitor>
         <test> Quiet.lua </test><test param='0.3'> High.lua </test>"
    ));
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let verdict = |test| journal.record.verdict(TestId(test));
    assert_eq!((verdict(0), verdict(1)), (Some(Verdict::Passed), Some(Verdict::Failed)));
    let high = attempt(&journal, 1);
    let failure = high.failures().next().expect("a failure");
    assert!(failure.text.starts_with("monitor `low`: `q < 1rad` does not hold at "));
    // The negative robustness of the violation is outside its limit, and no problem of the fixture.
    let within = |test| {
        let mut all = attempt(&journal, test).measurements.iter();
        let robustness = all.find(|it| it.name == "monitor/low").expect("its robustness");
        (robustness.low, robustness.is_within_limits())
    };
    assert_eq!([within(0), within(1)], [(Some(0.0), true), (Some(0.0), false)]);
    assert!(journal.record.fixtures.iter().all(|fixture| fixture.problems.is_empty()));
    assert!(failure.text.contains("q = 1.3 rad (robustness -0.3); its formula is `always(q"));
    assert_eq!(failure.location.as_ref().unwrap().to_string(), "s.xml:3");
    assert_eq!(journal.record.tests[1].reason(), Some(&*failure.text));
    // It continued after that.
    let last = high.messages.iter().rfind(|message| message.kind == MessageKind::Report);
    assert_eq!(last.map(|message| &*message.text), Some("end of the test"));
    assert!((robustness(&journal, 1, "low") + 0.3).abs() < 1e-9);
    assert!((robustness(&journal, 0, "low") - 0.8).abs() < 1e-9);
    assert!(finished.stdout.contains("s.xml:3"), "{}", finished.stdout);
}

/// The source counts its samples.
#[test]
fn no_sample_is_lost_and_times_begin_with_the_test() {
    let (finished, journal, _folder) =
        run(&format!("{SIGNALS}<test> Quiet.lua </test><test> Quiet.lua </test>"));
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    for test in 0..2 {
        let count = series(&journal, test, "count");
        let (first, last) = (count.min.unwrap(), count.max.unwrap());
        assert_eq!(count.count as f64, last - first + 1.0);
        assert!(count.span.0 >= 0.0 && count.span.0 < 1.0, "{:?}", count.span);
        assert!(count.span.1 - count.span.0 > 0.1, "{:?}", count.span);
        assert_eq!(series(&journal, test, "q").unit, "rad");
    }
    assert!(series(&journal, 1, "count").min > series(&journal, 0, "count").max);
}

#[test]
fn a_stop_ends_the_test_and_the_failure_hook_parks_the_robot() {
    let (finished, journal, folder) = run(&format!(
        "{SIGNALS}<hook on='failure'><command>touch parked</command></hook>
         <monitor name='low' severity='stop'>always(q &lt; 1rad)</monitor>
         <test param='100'> High.lua </test><test> Quiet.lua </test>"
    ));
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert!(folder.path().join("parked").exists());
    assert_eq!(journal.record.hooks[0].runs.len(), 1);
    let verdict = |test| journal.record.verdict(TestId(test));
    assert_eq!((verdict(0), verdict(1)), (Some(Verdict::Failed), Some(Verdict::Passed)));
    let reason = journal.record.tests[0].reason().unwrap();
    assert!(reason.starts_with("monitor `low`"), "{reason}");
    assert!(finished.stdout.contains("stopping"), "{}", finished.stdout);
}

#[test]
fn a_critical_violation_skips_the_rest() {
    let (finished, journal, _folder) = run(&format!(
        "{SIGNALS}<monitor name='low' severity='critical'>always(q &lt; 1rad)</monitor>
         <test param='100'> High.lua </test><test> Quiet.lua </test>"
    ));
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Failed));
    let skipped = journal.record.tests[1].skipped.as_deref().expect("it was skipped");
    assert!(skipped.contains("monitor `low`"), "{skipped}");
}

/// Only the end of the test shows that something never happened.
#[test]
fn a_monitor_of_one_test_is_decided_at_its_end() {
    let (finished, journal, _folder) = run(&format!(
        "{SIGNALS}<test name='a'> Quiet.lua
           <monitor name='rises' severity='error'>eventually(q > 1rad)</monitor></test>
         <test name='b'> Quiet.lua </test>"
    ));
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Error));
    assert_eq!(journal.record.verdict(TestId(1)), Some(Verdict::Passed));
    assert!((robustness(&journal, 0, "rises") + 0.8).abs() < 1e-9);
}

#[test]
fn a_monitor_without_samples_is_an_error() {
    let (finished, journal, _folder) = run(
        "<signal name='silent' wait='false'><command>python3 -c 'import time; time.sleep(100)'\
         </command></signal><monitor name='low'>always(silent &lt; 1)</monitor>
         <test> Quiet.lua </test>",
    );
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Error));
    let reason = journal.record.tests[0].reason();
    assert_eq!(reason, Some("monitor `low` was not judged: no sample of `silent`"));
}

#[test]
fn the_processes_of_a_fixture_are_measured() {
    let folder = folder(
        "<fixture type='process' name='sim'><command>python3 busy.py</command></fixture>
         <signal name='load' fixture='sim' of='cpu' every='20ms'/>
         <signal name='memory' fixture='sim' of='rss' every='20ms'/>
         <signal name='files' fixture='sim' of='fds' every='20ms'/>
         <test> Busy.lua </test>",
    );
    folder.file("busy.py", BUSY).file("Busy.lua", UNTIL_BUSY);
    let finished = folder.rtf(&["run", "s.xml"]);
    let journal = folder.journal();
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let load = series(&journal, 0, "load");
    assert!(load.max.unwrap() > 0.0, "{load:?}");
    let memory = series(&journal, 0, "memory");
    // The process may just have been started: only its largest size is that of Python.
    assert!(memory.min.unwrap() > 0.0, "{memory:?}");
    assert!((1.0..200.0).contains(&memory.max.unwrap()), "{memory:?}");
    assert_eq!(memory.unit, "MiB");
    assert!(series(&journal, 0, "files").max.unwrap() >= 3.0);
}

/// What a program does, and the reason of the collapse or the failed set-up.
#[test]
fn a_program_that_does_not_write_samples_is_reported() {
    for (program, reason) in [
        ("print(\"1 2 3\", flush=True)", "the program of `q` wrote `1 2 3`, expected a time and 1"),
        ("pass", "the program of `q` ended with exit status: 0: `"),
        (
            "print(\"1.5 0\", flush=True); input()",
            "wrote the time 1.5, but its times have to be seconds",
        ),
        ("raise SystemExit(3)", "the program of `q` ended with exit status: 3"),
    ] {
        let (finished, journal, _folder) = run(&format!(
            "<signal name='q'><command>python3 -c '{program}'</command></signal>
             <test> Quiet.lua </test>"
        ));
        assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
        let fixture = journal.record.fixtures.last().expect("the fixture `signals`");
        let problem = fixture.lives.iter().find_map(|life| life.problem.clone());
        let problem = problem.unwrap_or_else(|| panic!("{program}: {fixture:#?}"));
        assert!(problem.contains(reason), "{program}: {problem}");
    }
}

#[test]
fn a_program_that_dies_during_a_test_is_a_collapse() {
    let folder = folder(&format!("{SIGNALS}<test param='100'> High.lua </test>"));
    let source = SOURCE.replace("for number", "import sys\nfor number");
    let source = source + "    if os.path.exists('high'): sys.exit(7)\n";
    folder.file("source.py", &source);
    let finished = folder.rtf(&["run", "s.xml"]);
    let journal = folder.journal();
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let reason = journal.record.tests[0].reason().unwrap();
    assert!(reason.contains("ended with exit status: 7: `"), "{reason}");
    assert!(nothing_left(&folder));
}

#[test]
fn wrong_formulas_are_reported_before_anything_starts() {
    let folder = folder(&format!(
        "{SIGNALS}<monitor name='a'>always(Q &lt; 1)</monitor>
         <monitor name='b'>always(q &lt; 1kg)</monitor><test> Quiet.lua </test>"
    ));
    let finished = folder.rtf(&["check", "s.xml"]);
    assert_ne!(finished.code, Some(0));
    for text in [
        "there is no signal `Q`",
        "s.xml:3:26",
        "did you mean `q`?",
        "`rad` and `kg`",
        "s.xml:4:42",
    ] {
        assert!(finished.stderr.contains(text), "{text}: {}", finished.stderr);
    }
}

const LIMITS: &str = "robot: arm\nsignals: {position: '{joint}'}\nmodel: arm.urdf\n\
limits:\n  count: {signal: count, max: 100000}\n\
profiles:\n  simulation:\n    factor: 0.5\n    severity: stop\n";
const ARM: &str = "<robot name='arm'>\n<joint name='q' type='revolute'>\n\
<limit lower='-1.4' upper='1.4' velocity='1' effort='1'/></joint></robot>\n";

#[test]
fn limits_of_a_file_and_a_model_judge_every_test() {
    let folder = folder(&format!(
        "{SIGNALS}<envelope file='arm.limits.yaml'/><test param='30'> High.lua </test>"
    ));
    folder.file("arm.limits.yaml", LIMITS).file("arm.urdf", ARM);
    folder.file("rtf.toml", "[profile.simulation]\n");
    let listed = folder.rtf(&["list", "s.xml", "--monitors"]);
    let formula = "fail      arm: q position: always(q >= -1.4rad and q <= 1.4rad)  (arm.urdf:3:1)";
    assert!(listed.stdout.contains(formula), "{}", listed.stdout);
    let finished = folder.rtf(&["run", "s.xml", "--profile", "simulation"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    assert!(finished.stdout.contains("stopping"), "{}", finished.stdout);
    let journal = folder.journal();
    let failure = attempt(&journal, 0).failures().next().expect("a failure");
    let part = "monitor `arm: q position`: `q <= 0.7rad` does not hold at ";
    assert!(failure.text.starts_with(part), "{}", failure.text);
    assert!(failure.text.ends_with("q <= 0.7rad)` (limit at arm.urdf:3:1)"), "{}", failure.text);
    assert_eq!(failure.location.as_ref().unwrap().to_string(), "arm.urdf:3");
    assert!((robustness(&journal, 0, "arm: q position") + 0.6).abs() < 1e-9);
    assert!(robustness(&journal, 0, "arm: count") > 0.0);
    assert!(nothing_left(&folder));
}

/// Each mistake of the file has its position.
#[test]
fn check_reports_all_mistakes_of_limits() {
    let suite = format!("{SIGNALS}<envelope file='arm.limits.yaml'/><test> Quiet.lua </test>");
    let folder = folder(&suite);
    let limits = "limits:\n  a: {signal: Q, max: 1}\n  b: {signal: q, max: 1kg}\n";
    folder.file("arm.limits.yaml", limits);
    let finished = folder.rtf(&["check", "s.xml"]);
    assert_eq!(finished.code, Some(2));
    assert!(finished.stderr.contains("arm.limits.yaml:2:15"), "{}", finished.stderr);
    assert!(finished.stderr.contains("arm.limits.yaml:3:23"), "{}", finished.stderr);
}
