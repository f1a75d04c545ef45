//! What a suite becomes.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rtf_engine::plan::{FixtureBody, FixtureLimits, ProbeKind, TestLimits};

use crate::bench::{Bench, names};

#[test]
fn a_suite_becomes_a_plan() {
    let bench = Bench::new();
    bench.file("cell/lib/libArm.so", "");
    bench.file("cell/lib/Encoder.lua", "");
    bench.file(
        "cell/lib/arm.xml",
        "<suite tags='sim'><environment>--robot r</environment><env name='A' value='1'/>\
         <test param='--n \"a b\"'>Arm</test><test type='lua' tags='x sim'>Encoder</test>\
         <test name='again'>Arm</test><test>Arm</test></suite>",
    );
    let plan = bench.plan(&["lib/arm.xml"]);
    assert_eq!((plan.suites.len(), plan.fixtures, plan.tests), (1, 0, 4));
    let suite = &plan.suites[0];
    assert_eq!((suite.name.as_str(), suite.file.as_str()), ("arm", "lib/arm.xml"));
    assert_eq!(bench.relative(&suite.folder), "cell/lib");
    assert_eq!(suite.environment, "--robot r");
    assert_eq!(names(&plan, 0), ["Arm", "Encoder", "again", "Arm#2"]);
    let (arm, encoder) = (&suite.tests[0], &suite.tests[1]);
    assert_eq!(bench.relative(&arm.plugin.file), "cell/lib/libArm.so");
    assert_eq!(arm.plugin.args, ["--n", "a b"]);
    assert_eq!(arm.plugin.host.command, [bench.path("bin/rtf-host-native")]);
    assert_eq!(encoder.tags, ["sim", "x"]);
    assert_eq!(encoder.id.0, 1);
    let secs = Duration::from_secs;
    assert_eq!(
        *arm.limits,
        TestLimits {
            load: secs(30),
            setup: secs(60),
            run: secs(300),
            teardown: secs(30),
            slow: secs(60),
            grace: secs(2),
        }
    );
    assert!(Arc::ptr_eq(&arm.limits, &encoder.limits));
    assert!(Arc::ptr_eq(&arm.plugin.host, &suite.tests[3].plugin.host));
}

#[test]
fn fixtures_with_their_defaults() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.program("cell/sim", "");
    bench.file(
        "cell/s.xml",
        "<suite><fixture type='process'><command>./sim --fast</command><ready file='up'/>\
         <ready tcp='h:1'/><alive command='sh -c true'/></fixture>\
         <fixture depends='sim'>A.lua</fixture><fixture>A.lua</fixture><test>A.lua</test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    let fixtures = &plan.suites[0].fixtures;
    let names: Vec<_> = fixtures.iter().map(|fixture| fixture.name.as_str()).collect();
    assert_eq!(names, ["sim", "A", "A#2"]);
    assert_eq!((plan.fixtures, fixtures[2].id.0), (3, 2));
    let secs = Duration::from_secs;
    let limits = FixtureLimits { setup: secs(60), check: secs(5), teardown: secs(30) };
    assert_eq!(
        (fixtures[0].limits, fixtures[0].restarts, fixtures[0].check_every),
        (limits, 3, None)
    );
    let FixtureBody::Process(process) = &fixtures[0].body else { panic!("a process") };
    assert_eq!(process.command, [bench.path("cell/sim"), "--fast".to_owned()]);
    assert_eq!((process.stop_signal, process.stop_grace), (15, secs(5)));
    let ProbeKind::File(file) = &process.ready[0].kind else { panic!("a file") };
    assert_eq!(bench.relative(file), "cell/up");
    assert_eq!(process.ready[1].every, Duration::from_millis(100));
    assert_eq!((process.alive[0].every, process.alive[0].timeout), (secs(1), secs(1)));
    let ProbeKind::Command(words) = &process.alive[0].kind else { panic!("a command") };
    assert!(words[0].starts_with('/') && words[0].ends_with("/sh"), "{words:?}");
}

#[test]
fn unknown_types_list_the_known_ones() {
    let bench = Bench::new();
    bench.file(
        "cell/s.xml",
        "<suite><fixture type='procss'>A</fixture><test type='Lua'>A</test></suite>",
    );
    let outcome = bench.build(&["s.xml"]);
    let found = |index: usize| {
        let found = &outcome.diagnostics[index];
        (found.code.as_str(), found.notes[0].as_str(), found.hint.as_deref())
    };
    let known = "known types are `dll`, `lua`, `python`, `process`";
    assert_eq!(found(0), ("unknown-type", known, Some("did you mean `process`?")));
    let known = "known types are `dll`, `lua`, `python`";
    assert_eq!(found(1), ("unknown-type", known, Some("did you mean `lua`?")));
}

#[test]
fn problems_of_all_files_come_at_once() {
    let bench = Bench::new();
    bench.file("cell/a.xml", "<suite><test timeout='x'>A</test></suite>");
    bench.file("cell/b.xml", "<suite><test>A</suite>");
    let codes: Vec<_> =
        bench.problems(&["b.xml", "a.xml", "c.xml"]).into_iter().map(|(code, _)| code).collect();
    assert_eq!(codes, ["malformed-xml", "invalid-value", "no-such-plugin", "no-such-file"]);
    let outcome = bench.build(&["b.xml", "a.xml"]);
    assert!(outcome.sources.text("a.xml").is_some() && outcome.sources.text("b.xml").is_some());
}

#[test]
fn warnings_do_not_stop_a_plan() {
    let mut bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/a.xml", "<suite><!-- -- --><test>A.lua</test></suite>");
    bench.options.param = "x".to_owned();
    let outcome = bench.build(&["a.xml"]);
    let codes: Vec<_> = outcome.diagnostics.iter().map(|found| found.code.as_str()).collect();
    assert_eq!(codes, ["comment-dashes", "without-effect"]);
    assert!(outcome.plan.is_some());
}

#[test]
fn programs_are_found_or_reported() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/plain", "");
    let message = |command: &str| {
        bench.file(
            "cell/s.xml",
            &format!(
                "<suite><fixture type='process'><command>{command}</command></fixture>\
             <test>A.lua</test></suite>"
            ),
        );
        let outcome = bench.build(&["s.xml"]);
        let found = &outcome.diagnostics[0];
        (found.code.clone(), found.message.clone(), found.hint.clone().unwrap_or_default())
    };
    let text = |a: &str, b: &str, c: &str| (a.to_owned(), b.to_owned(), c.to_owned());
    assert_eq!(
        message("./plain"),
        text(
            "no-such-program",
            "the program `./plain` is not executable",
            "make it so with `chmod +x ./plain`"
        )
    );
    assert_eq!(
        message("plain"),
        text(
            "no-such-program",
            "there is no program `plain`",
            "the one in the suite's folder is called `./plain`"
        )
    );
    assert_eq!(
        message("/nowhere/x"),
        text("no-such-program", "there is no program `/nowhere/x`", "")
    );
}

#[test]
fn a_large_suite_is_planned_quickly() {
    const TESTS: usize = 20_000;
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    let tests: String = (0..TESTS)
        .map(|n| format!("  <test type=\"lua\" param=\"--n {n}\" tags=\"large\"> A </test>\n"))
        .collect();
    bench.file("cell/s.xml", &format!("<suite>\n{tests}</suite>\n"));
    let before = Instant::now();
    let plan = bench.plan(&["s.xml"]);
    // Far above what it takes, far below what anything quadratic would take.
    assert!(before.elapsed() < Duration::from_secs(20), "{:?}", before.elapsed());
    assert_eq!(plan.tests as usize, TESTS);
    let tests = &plan.suites[0].tests;
    assert_eq!(tests[TESTS - 1].name, format!("A#{TESTS}"));
    assert_eq!(tests[TESTS - 1].plugin.args[1], (TESTS - 1).to_string());
    assert!(tests.iter().enumerate().all(|(index, test)| test.id.index() == index));
    assert!(tests.iter().all(|test| Arc::ptr_eq(&test.plugin.host, &tests[0].plugin.host)));
}
