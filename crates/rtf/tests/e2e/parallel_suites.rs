//! Suites that run in parallel (`--jobs`): they are independent, and a request to end the run
//! ends all of them in order.

use std::path::Path;
use std::time::Duration;

use rtf_model::{Event, EventKind, Phase, SuiteId, TestId, Verdict};

use crate::host_modes::MODES;
use crate::support::{Folder, Journal, Random, Running, nothing_left, number};

/// A fixture that lives, and tells in a file that it was torn down.
fn fixture(name: &str) -> String {
    format!(
        "  <fixture type='process' name='sim'>\n    \
         <command>sh -c 'trap \"echo down >> {name}.sim; exit\" TERM; echo up; while :; do sleep 0.01; done'</command>\n    \
         <ready log='up'/>\n  </fixture>\n"
    )
}

fn park(name: &str) -> String {
    format!(
        "  <hook name='park' on='interrupt end'>\n    \
         <command>sh -c 'echo $RTF_HOOK_TRIGGER $RTF_HOOK_TEST >> {name}.parked'</command>\n  </hook>\n"
    )
}

/// A suite of one fixture, whose tests are plug-ins of these names.
fn suite(folder: &Folder, name: &str, (more, attributes): (&str, &str), tests: &[&str]) {
    let tests: String = tests.iter().map(|test| format!("  <test>{test}.lua</test>\n")).collect();
    let text = format!("<suite {attributes}>\n{}{more}{tests}</suite>\n", fixture(name));
    folder.file(&format!("{name}.xml"), &text);
}

/// A test that says in a file that it runs, and waits for another file.
fn meets(folder: &Folder, test: &str, other: &str) {
    let text = format!(
        "TestCase = {{}}\nfunction TestCase.run()\n  io.open('{test}.runs', 'w'):close()\n  \
         rtf.wait_until(function() return io.open('{other}') end, 60, '{other}')\nend\n"
    );
    folder.file(&format!("{test}.lua"), &text);
}

fn lines(folder: &Folder, file: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.path().join(file)).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

/// Two suites whose tests run until somebody ends them.
fn two_that_wait(folder: &Folder) -> Running {
    for name in ["a", "b"] {
        meets(folder, &format!("T{name}"), "never");
        suite(folder, name, (&park(name), ""), &[&format!("T{name}")]);
    }
    let running = folder.start(&["run", "--jobs", "2", "a.xml", "b.xml"]);
    for test in [TestId(0), TestId(1)] {
        let phase = Phase::Run;
        running.wait_for(|kind| *kind == EventKind::TestPhase { test, phase });
    }
    running
}

/// When a suite began and ended, as places in the journal.
fn place(journal: &Journal, suite: u32) -> (usize, usize) {
    let suite = SuiteId(suite);
    let at = |wanted: &dyn Fn(&EventKind) -> bool| {
        let mut events = journal.events.iter();
        events.position(|event: &Event| wanted(&event.kind)).expect("the event")
    };
    let began = at(&|kind| *kind == EventKind::SuiteStarted { suite });
    (began, at(&|kind| *kind == EventKind::SuiteFinished { suite }))
}

#[test]
fn two_suites_that_wait_for_each_other_are_green_side_by_side() {
    let folder = Folder::new();
    meets(&folder, "Ta", "Tb.runs");
    meets(&folder, "Tb", "Ta.runs");
    for name in ["a", "b"] {
        suite(&folder, name, ("", ""), &[&format!("T{name}")]);
    }
    let finished = folder.rtf(&["run", "-j", "2", "a.xml", "b.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    let told = folder.redact(&finished.stdout);
    for line in [
        "      begin  suite a  1 test, 1 fixture  a.xml\n",
        "      begin  suite b  1 test, 1 fixture  b.xml\n",
        " fixture a/sim\n",
        " fixture b/sim\n",
        " a/Ta\n",
        " b/Tb\n",
        " suite a\n",
        " suite b\n",
    ] {
        assert!(told.contains(line), "{line}\n{told}");
    }
    let journal = folder.journal();
    let ((a, a_end), (b, b_end)) = (place(&journal, 0), place(&journal, 1));
    assert!(a < b && b < a_end && a < b_end, "in the plan's order, and at the same time");
    for name in ["a", "b"] {
        assert_eq!(lines(&folder, &format!("{name}.sim")), ["down"]);
    }
    assert!(nothing_left(&folder));
}

#[test]
fn ctrl_c_tears_all_of_them_down_and_parks_every_robot() {
    let folder = Folder::new();
    let running = two_that_wait(&folder);
    running.signal("INT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(130), "{}", finished.stdout);
    let journal = folder.journal();
    for (index, name) in ["a", "b"].into_iter().enumerate() {
        assert_eq!(lines(&folder, &format!("{name}.parked")), [format!("interrupt T{name}")]);
        assert_eq!(lines(&folder, &format!("{name}.sim")), ["down"]);
        assert_eq!(journal.record.tests[index].verdict(), Some(Verdict::Interrupted));
    }
    assert!(nothing_left(&folder));
}

#[test]
fn a_killed_runner_leaves_nothing_and_every_robot_is_parked_once() {
    let folder = Folder::new();
    let running = two_that_wait(&folder);
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    // Each hook is told which test it is about: its own suite's.
    for name in ["a", "b"] {
        assert_eq!(lines(&folder, &format!("{name}.parked")), [format!("interrupt T{name}")]);
    }
    assert!(nothing_left(&folder));
    let record = folder.journal().record;
    assert!(record.hooks.iter().all(|hook| hook.runs.len() == 1), "{:?}", record.hooks);
    assert_eq!(record.runner_death(), Some("signal 9 (SIGKILL)"));
}

#[test]
fn a_suite_that_has_ended_is_not_parked_again_when_the_runner_dies() {
    let folder = Folder::new();
    meets(&folder, "Ta", "Tb.runs");
    meets(&folder, "Tb", "never");
    for name in ["a", "b"] {
        suite(&folder, name, (&park(name), ""), &[&format!("T{name}")]);
    }
    let running = folder.start(&["run", "--jobs", "2", "a.xml", "b.xml"]);
    running.wait_for(|kind| *kind == EventKind::SuiteFinished { suite: SuiteId(0) });
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    assert_eq!(lines(&folder, "a.parked"), ["end"]);
    assert_eq!(lines(&folder, "b.parked"), ["interrupt Tb"]);
    assert!(nothing_left(&folder));
}

#[test]
fn suites_that_require_the_same_robot_never_overlap_and_keep_no_other_from_running() {
    let folder = Folder::new();
    // `a` ends only when `free`, which is the third, runs beside it.
    meets(&folder, "Ta", "Tfree.runs");
    meets(&folder, "Tb", "Tb.runs");
    meets(&folder, "Tfree", "Tfree.runs");
    suite(&folder, "a", ("", "requires='robot'"), &["Ta"]);
    suite(&folder, "b", ("", "requires='robot'"), &["Tb"]);
    suite(&folder, "free", ("", ""), &["Tfree"]);
    let mut command = folder.command(&["run", "--jobs", "2", "a.xml", "b.xml", "free.xml"]);
    command.env("RTF_LOCKS", folder.path().join("locks"));
    let finished = folder.start_command(command).finish();
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    let journal = folder.journal();
    let [(_, a_end), (b, _), (free, _)] = [0, 1, 2].map(|suite| place(&journal, suite));
    assert!(free < a_end && a_end < b, "{}", finished.stdout);
    let waits = |event: &Event| matches!(event.kind, EventKind::SuiteWaiting { .. });
    assert!(!journal.events.iter().any(waits), "nobody waits for its own run");
}

#[test]
fn what_fails_in_one_suite_counts_in_all() {
    let folder = Folder::new();
    let fails = "TestCase = {}\nfunction TestCase.run()\n  \
                 rtf.wait_until(function() return io.open('Tb.runs') end, 60, 'b')\n  rtf.fail('no')\nend\n";
    folder.file("Ta.lua", fails);
    meets(&folder, "Tb", "a.parked");
    meets(&folder, "Tc", "never");
    suite(&folder, "a", (&park("a"), ""), &["Ta"]);
    suite(&folder, "b", ("", ""), &["Tb", "Tc"]);
    let finished = folder.rtf(&["run", "--jobs", "2", "--max-fail", "1", "a.xml", "b.xml"]);
    assert_eq!(finished.code, Some(1), "{}", finished.stdout);
    let record = folder.journal().record;
    // What runs comes to its end.
    assert_eq!(record.tests[1].verdict(), Some(Verdict::Passed));
    let why = Some("1 test has not passed (--max-fail 1)");
    assert_eq!(record.tests[2].skipped.as_deref(), why);
}

/// Halves of lines are flushed, so that those of three suites meet.
#[test]
fn the_console_prints_whole_lines_of_suites_that_run_side_by_side() {
    let folder = Folder::new();
    for name in ["a", "b", "c"] {
        let text = format!(
            "TestCase = {{}}\nfunction TestCase.run()\n  local half = ('{name}'):rep(40)\n  \
             for _ = 1, 50 do\n    rtf.report(half)\n    io.write(half)\n    io.flush()\n    \
             io.write(half, '\\n')\n    io.flush()\n  end\nend\n"
        );
        folder.file(&format!("T{name}.lua"), &text);
        suite(&folder, name, ("", ""), &[&format!("T{name}")]);
    }
    let finished = folder.rtf(&["run", "-v", "-j", "3", "a.xml", "b.xml", "c.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    for name in ["a", "b", "c"] {
        let half = name.repeat(40);
        let whole =
            [format!("{name}/T{name}: report: {half}"), format!("{name}/T{name} | {half}{half}")];
        let told: Vec<_> = finished.stdout.lines().filter(|line| line.contains(&half)).collect();
        assert_eq!(told.len(), 100, "{}", finished.stdout);
        for line in told {
            assert!(whole.iter().any(|whole| line.trim_start() == whole), "{line}");
        }
    }
}

#[test]
fn twenty_suites_with_fixtures_of_their_own_are_green_again_and_again() {
    let folder = Folder::new();
    folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() rtf.sleep(0.01) end\n");
    let names: Vec<String> = (0..20).map(|n| format!("s{n}.xml")).collect();
    for name in &names {
        let plain = name.trim_end_matches(".xml");
        let command = format!("sh -c 'echo {plain} is up; exec sleep 1000'");
        let fixture = format!(
            "  <fixture type='process' name='{plain}'>\n    <command>{command}</command>\n    \
             <ready log='up'/>\n  </fixture>\n"
        );
        let text = format!("<suite>\n{fixture}{}</suite>\n", "  <test>T.lua</test>\n".repeat(3));
        folder.file(name, &text);
    }
    let mut args = vec!["run", "--jobs", "4"];
    args.extend(names.iter().map(String::as_str));
    for round in 0..number("RTF_CHAOS_ROUNDS").unwrap_or(3) {
        let finished = folder.rtf(&args);
        assert_eq!(finished.code, Some(0), "round {round}: {}", finished.stdout);
        let journal = folder.journal();
        check_own(&journal, &folder.path().join("rtf-results/latest/logs"), &names);
        assert!(nothing_left(&folder), "round {round}");
    }
}

/// Never more than four at a time, and nothing of one in the log of another.
fn check_own(journal: &Journal, logs: &Path, names: &[String]) {
    let mut running = 0;
    for event in &journal.events {
        match event.kind {
            EventKind::SuiteStarted { .. } => running += 1,
            EventKind::SuiteFinished { .. } => running -= 1,
            _ => {}
        }
        assert!(running <= 4, "{running} suites at once");
    }
    for name in names {
        let name = name.trim_end_matches(".xml");
        let log = logs.join(format!("{name}.fixture-{name}.log"));
        let log = std::fs::read_to_string(log).expect("a log");
        assert_eq!(log, format!("{name} is up\n"));
    }
}

#[test]
fn a_runner_killed_at_any_moment_beside_two_suites_leaves_nothing_and_parks_each_once() {
    let mut random = Random::from_environment();
    for run in 0..number("RTF_CHAOS_RUNS").unwrap_or(100).div_ceil(4) {
        let (folder, mode) = (Folder::new(), MODES[random.below(3) as usize]);
        folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() rtf.sleep(0.02) end\n");
        for name in ["a", "b"] {
            let network = if random.below(4) == 0 { "isolate='network'" } else { "" };
            suite(&folder, name, (&park(name), network), &["T", "T", "T"]);
            let shared = format!("<test isolation='{}'>", mode.isolation);
            let file = format!("{name}.xml");
            folder.file(&file, &folder.read(&file).replace("<test>", &shared));
        }
        let args = ["run", "--fork", mode.fork, "--jobs", "2", "a.xml", "b.xml"];
        let running = folder.start(&args);
        running.runner();
        // Not to wait for something: this is the random moment.
        std::thread::sleep(Duration::from_micros(random.below(500_000)));
        let killed = running.try_kill_runner();
        let finished = running.finish();
        let context =
            format!("run {run}, {}, {killed}: {}{}", mode.name, finished.stdout, finished.stderr);
        assert!(nothing_left(&folder), "{context}");
        let path = folder.path().join("rtf-results/latest/events.jsonl");
        if std::fs::metadata(&path).is_ok_and(|file| file.len() > 0) {
            parked_once(&folder, &context);
        }
    }
}

/// A hook ran once in each suite that had begun, as the journal tells.
fn parked_once(folder: &Folder, context: &str) {
    let journal = folder.journal();
    for (index, name) in ["a", "b"].into_iter().enumerate() {
        // It may have died while it told its plan.
        let (Some(suite), Some(hook)) =
            (journal.record.suites.get(index), journal.record.hooks.get(index))
        else {
            continue;
        };
        let parked = lines(folder, &format!("{name}.parked")).len();
        assert!(parked <= 1, "{name} parked {parked} times\n{context}");
        let began = usize::from(suite.started.is_some());
        assert_eq!(hook.runs.len(), began, "{name}\n{context}");
        let ready = journal.record.fixtures[index].ready.is_some();
        assert!(!ready || parked == 1, "{name} is not parked\n{context}");
    }
}
