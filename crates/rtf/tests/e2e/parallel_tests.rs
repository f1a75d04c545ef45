//! Parallel tests of one suite (`<suite parallel="N">`) with a common fixture.

use rtf_model::{Event, EventKind, Phase, Source, TestId, Trigger, Verdict};

use crate::support::{Folder, Journal, Running, nothing_left, wait_until};

/// A fixture that lives until it is torn down, or until `file` is there, where one is named.
fn fixture(dies_of: &str) -> String {
    format!(
        "  <fixture type='process' name='sim' restarts='1'>\n    \
         <command>sh -c 'trap \"echo down >> sim; exit\" TERM; echo up; \
         while ! test -e \"{dies_of}\"; do sleep 0.01; done; rm \"{dies_of}\"'</command>\n    \
         <ready log='up'/>\n  </fixture>\n"
    )
}

fn suite(folder: &Folder, attributes: &str, body: &str) {
    folder.file("s.xml", &format!("<suite name='s' {attributes}>\n{body}</suite>\n"));
}

/// A test that says in a file that it runs, then does this, in Lua.
fn test(folder: &Folder, name: &str, then: &str) {
    let text = format!(
        "TestCase = {{}}\nfunction TestCase.run()\n  io.open('{name}.runs', 'w'):close()\n  {then}\nend\n"
    );
    folder.file(&format!("{name}.lua"), &text);
}

/// Waits, in Lua, until a file is there.
fn awaits(file: &str) -> String {
    format!("rtf.wait_until(function() return io.open('{file}') end, 60, '{file}')\n")
}

/// Where the attempts of a test begin and end in the journal.
fn spans(journal: &Journal, test: u32) -> Vec<(u64, u64)> {
    let id = TestId(test);
    let seqs = |wanted: &dyn Fn(&EventKind) -> bool| -> Vec<u64> {
        let events = journal.events.iter().filter(|event: &&Event| wanted(&event.kind));
        events.map(|event| event.seq).collect()
    };
    let began = seqs(&|kind| matches!(kind, EventKind::TestStarted { test, .. } if *test == id));
    let ended = seqs(&|kind| matches!(kind, EventKind::TestFinished(end) if end.test == id));
    began.into_iter().zip(ended).collect()
}

fn verdicts(journal: &Journal) -> Vec<&'static str> {
    let tests = journal.record.tests.iter();
    tests.map(|test| test.verdict().map_or("none", Verdict::as_str)).collect()
}

fn lines(folder: &Folder, file: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.path().join(file)).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

/// Two tests that run until somebody ends them, and one after them.
fn two_that_wait(folder: &Folder, hook: &str) -> Running {
    for name in ["A", "B", "C"] {
        test(folder, name, &awaits("never"));
    }
    let tests = "  <test>A.lua</test>\n  <test>B.lua</test>\n  <test>C.lua</test>\n";
    suite(folder, "parallel='2'", &format!("{}{hook}{tests}", fixture("never")));
    let running = folder.start(&["run", "s.xml"]);
    for test in [TestId(0), TestId(1)] {
        let phase = Phase::Run;
        running.wait_for(|kind| *kind == EventKind::TestPhase { test, phase });
    }
    running
}

fn park(on: &str) -> String {
    format!(
        "  <hook name='park' on='{on}'>\n    \
         <command>sh -c 'echo \"$RTF_HOOK_TRIGGER:$RTF_HOOK_TEST\" >> parked'</command>\n  </hook>\n"
    )
}

/// Each of them waits for all others: one after the other they would never end.
#[test]
fn four_tests_that_wait_for_each_other_pass_and_are_told_as_written() {
    let folder = Folder::new();
    let all: String =
        ["A", "B", "C", "D"].iter().map(|name| awaits(&format!("{name}.runs"))).collect();
    for name in ["A", "B", "C", "D"] {
        // The last one ends first.
        let after = if name == "D" { String::new() } else { awaits("D.ended") };
        test(&folder, name, &(all.clone() + &after));
    }
    folder.file(
        "D.lua",
        &(folder.read("D.lua")
            + "function TestCase.tearDown() io.open('D.ended', 'w'):close() end\n"),
    );
    let tests =
        "  <test>A.lua</test>\n  <test>B.lua</test>\n  <test>C.lua</test>\n  <test>D.lua</test>\n";
    suite(&folder, "parallel='4'", &(fixture("never") + tests));
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=junit.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    let journal = folder.journal();
    let spans: Vec<_> = (0..4).flat_map(|test| spans(&journal, test)).collect();
    let last_start = spans.iter().map(|(start, _)| *start).max();
    assert!(last_start < spans.iter().map(|(_, end)| *end).min(), "{spans:?}");
    let junit = folder.read("junit.xml");
    let places: Vec<_> =
        ["A", "B", "C", "D"].iter().map(|name| junit.find(&format!("name=\"{name}\""))).collect();
    assert!(places.is_sorted() && places[0].is_some(), "{junit}");
    // One fixture for all of them.
    assert_eq!(lines(&folder, "sim"), ["down"]);
    assert!(nothing_left(&folder));
}

#[test]
fn no_more_run_at_once_than_the_suite_says_and_an_exclusive_one_alone() {
    let folder = Folder::new();
    // A test that sees another one beside it fails.
    let alone = "local p = io.popen('ls *.busy 2>/dev/null'); local s = p:read('a'); p:close()\n  \
                 rtf.check(s == '', 'beside ' .. s)\n";
    let busy = |name: &str| {
        format!(
            "io.open('{name}.busy', 'w'):close()\n  rtf.sleep(0.05)\n  os.remove('{name}.busy')\n"
        )
    };
    for name in ["A", "B", "C", "E"] {
        test(&folder, name, &busy(name));
    }
    test(&folder, "D", &(alone.to_owned() + &busy("D") + alone));
    let tests: String = ["A", "B", "C"]
        .iter()
        .map(|name| format!("  <test repetition='2'>{name}.lua</test>\n"))
        .collect();
    let tests = tests + "  <test exclusive='true'>D.lua</test>\n  <test>E.lua</test>\n";
    suite(&folder, "parallel='2'", &tests);
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    let journal = folder.journal();
    let mut running = 0;
    for event in &journal.events {
        match &event.kind {
            EventKind::TestStarted { .. } => running += 1,
            EventKind::TestFinished(_) => running -= 1,
            _ => {}
        }
        assert!(running <= 2, "{event:?}");
    }
    let [d] = spans(&journal, 3)[..] else { panic!("one attempt") };
    for other in [0, 1, 2, 4] {
        assert!(spans(&journal, other).iter().all(|(start, end)| *end < d.0 || *start > d.1));
    }
    for repeated in [0, 1, 2] {
        let [first, second] = spans(&journal, repeated)[..] else { panic!("two attempts") };
        assert!(first.1 < second.0, "repetitions never overlap");
    }
}

#[test]
fn a_collapse_interrupts_both_and_each_goes_its_own_way() {
    let folder = Folder::new();
    test(&folder, "A", &awaits("never"));
    // At its second attempt, `again` is there.
    let once = "if io.open('again') then return end\n  ";
    let kills = format!(
        "{once}{}io.open('again', 'w'):close()\n  io.open('die', 'w'):close()\n  {}",
        awaits("A.runs"),
        awaits("never")
    );
    test(&folder, "B", &kills);
    test(&folder, "C", "");
    let tests =
        "  <test>A.lua</test>\n  <test after-collapse='rerun'>B.lua</test>\n  <test>C.lua</test>\n";
    suite(
        &folder,
        "parallel='2' tolerate-collapse='true'",
        &(fixture("die") + &park("collapse") + tests),
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}", finished.stdout);
    let journal = folder.journal();
    assert_eq!(verdicts(&journal), ["collapsed", "passed", "passed"]);
    assert_eq!(journal.record.tests[1].attempts.len(), 2);
    // It is about none of the two.
    assert_eq!(lines(&folder, "parked"), ["collapse:"]);
    let fixture = &journal.record.fixtures[0];
    assert_eq!(fixture.collapses.len(), 1);
    assert!(nothing_left(&folder));
}

#[test]
fn ctrl_c_stops_both_and_parks_once() {
    let folder = Folder::new();
    let running = two_that_wait(&folder, &park("interrupt"));
    running.signal("INT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(130), "{}", finished.stdout);
    assert_eq!(verdicts(&folder.journal()), ["interrupted", "interrupted", "skipped"]);
    assert_eq!(lines(&folder, "parked"), ["interrupt:"]);
    assert_eq!(lines(&folder, "sim"), ["down"]);
    assert!(nothing_left(&folder));
}

#[test]
fn when_the_runner_is_killed_both_are_stopped_before_the_robot_is_parked() {
    let folder = Folder::new();
    let running = two_that_wait(&folder, &park("interrupt"));
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    assert_eq!(lines(&folder, "parked"), ["interrupt:"]);
    assert!(nothing_left(&folder));
    let record = folder.journal().record;
    assert_eq!(record.runner_death(), Some("signal 9 (SIGKILL)"));
    assert_eq!(record.final_totals().of(Verdict::Interrupted), 2);
    assert_eq!(record.final_totals().of(Verdict::Skipped), 1);
}

/// The crash is one test's own; the hook it calls for waits for the other one.
#[test]
fn a_crash_leaves_the_other_alone_and_the_hook_waits_for_it() {
    let folder = Folder::new();
    test(
        &folder,
        "A",
        &format!("{}os.execute('kill -SEGV $PPID')\n  {}", awaits("B.runs"), awaits("never")),
    );
    test(&folder, "B", &awaits("go"));
    test(&folder, "C", "");
    let tests = "  <test>A.lua</test>\n  <test>B.lua</test>\n  <test>C.lua</test>\n";
    suite(&folder, "parallel='2'", &(park("failure") + tests));
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestFinished(end) if end.test == TestId(0)));
    folder.file("go", "");
    assert_eq!(running.finish().code, Some(1));
    let journal = folder.journal();
    assert_eq!(verdicts(&journal), ["crashed", "passed", "passed"]);
    assert_eq!(lines(&folder, "parked"), ["failure:A"]);
    let at = |wanted: &dyn Fn(&EventKind) -> bool| {
        journal.events.iter().position(|event| wanted(&event.kind)).expect("the event")
    };
    let hook = at(&|kind| matches!(kind, EventKind::HookStarted { trigger: Trigger::Failure, .. }));
    assert!(
        at(&|kind| matches!(kind, EventKind::TestFinished(end) if end.test == TestId(1))) < hook
    );
    assert!(hook < at(&|kind| matches!(kind, EventKind::TestStarted { test, .. } if test.0 == 2)));
}

/// Both leave a process behind, and one that passed meanwhile leaves none.
#[test]
fn what_a_test_leaves_behind_is_its_own_when_two_run() {
    let folder = Folder::new();
    let leaves = |seconds: u32, own: &str, other: &str| {
        let sleep = format!("touch {own}.left; sleep {seconds}");
        let (left, meets) = (awaits(&format!("{own}.left")), awaits(&format!("{other}.runs")));
        format!("os.execute([[setsid sh -c '{sleep}' >/dev/null 2>&1 &]])\n  {left}\n  {meets}")
    };
    test(&folder, "A", &leaves(1111, "A", "B"));
    test(&folder, "B", &leaves(2222, "B", "A"));
    test(&folder, "C", &awaits("D.runs"));
    test(&folder, "D", &awaits("C.runs"));
    let tests: String =
        ["A", "B", "C", "D"].iter().map(|name| format!("  <test>{name}.lua</test>\n")).collect();
    suite(&folder, "parallel='4' leaks='fail'", &tests);
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}", finished.stdout);
    let journal = folder.journal();
    assert_eq!(verdicts(&journal), ["error", "error", "passed", "passed"]);
    for (index, (own, other)) in [("1111", "2222"), ("2222", "1111")].into_iter().enumerate() {
        let reason = journal.record.tests[index].reason().unwrap_or_default();
        assert!(reason.contains(own) && !reason.contains(other), "{reason}");
    }
    let left = journal.events.iter().filter_map(|event| match &event.kind {
        EventKind::ProcessesLeaked { source: Source::Test(test), .. } => Some(test.0),
        _ => None,
    });
    let mut left: Vec<_> = left.collect();
    left.sort_unstable();
    assert_eq!(left, [0, 1]);
    assert!(nothing_left(&folder));
}

/// What a test prints stays together, whole lines under its name.
#[test]
fn what_two_tests_print_is_told_in_whole_lines_under_their_names() {
    let folder = Folder::new();
    for (name, other) in [("A", "B"), ("B", "A")] {
        let half = format!("io.stdout:write('half of {name}, ')\n  io.stdout:flush()\n  ");
        let ends = if name == "A" { String::new() } else { awaits("A.ended") };
        let rest = format!("io.stdout:write('the rest of {name}\\n')\n  io.stdout:flush()\n");
        test(&folder, name, &(half + &awaits(&format!("{other}.runs")) + &ends + &rest));
    }
    let tests = "  <test>A.lua</test>\n  <test>B.lua</test>\n";
    suite(&folder, "parallel='2'", tests);
    let running = folder.start(&["run", "-v", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestFinished(end) if end.test == TestId(0)));
    folder.file("A.ended", "");
    let finished = running.finish();
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    for name in ["A", "B"] {
        let line = format!(" s/{name} | half of {name}, the rest of {name}\n");
        assert!(finished.stdout.contains(&line), "{}", finished.stdout);
    }
    let log =
        wait_until("the logs", || folder.path().join("rtf-results/latest/logs").read_dir().ok());
    let logs = log.map(|entry| entry.expect("a log").path()).filter(|path| {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        text.contains("half of A") && text.contains("half of B")
    });
    assert_eq!(logs.count(), 0, "each test has a log of its own");
}

#[test]
fn a_profile_lowers_how_many_tests_run_at_once_and_raises_nothing() {
    let folder = Folder::new();
    folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder.file("many.xml", "<suite parallel='4'><test>T.lua</test></suite>");
    folder.file("one.xml", "<suite><test>T.lua</test></suite>");
    folder.file("rtf.toml", "parallel = 3\n[profile.real]\nparallel = 1\n");
    let parallel = |more: &[&str]| {
        let args = ["list", "--format", "json", "many.xml", "one.xml"];
        let listed = run_list(&folder, &[&args[..], more].concat());
        let tests = listed["tests"].as_array().cloned().unwrap_or_default();
        tests.iter().map(|test| test["parallel"].as_u64()).collect::<Vec<_>>()
    };
    assert_eq!(parallel(&[]), [Some(3), Some(1)]);
    assert_eq!(parallel(&["--profile", "real"]), [Some(1), Some(1)]);
}

fn run_list(folder: &Folder, args: &[&str]) -> serde_json::Value {
    let listed = folder.rtf(args);
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    serde_json::from_str(&listed.stdout).expect("a list")
}
