//! Suite files → plans.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rtf_plan::plan::{FixtureBody, FixtureLimits, FixturePlan, ProbeKind, TestLimits};

use crate::bench::{Bench, names};
use insta::assert_snapshot;

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
    assert_eq!(suite.settings.environment, "--robot r");
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
    let (setup, check, notify, teardown) = (secs(60), secs(5), secs(10), secs(30));
    let limits = FixtureLimits { setup, check, notify, teardown };
    assert_eq!(
        (fixtures[0].limits, fixtures[0].restarts, fixtures[0].check_every),
        (limits, 3, None)
    );
    let FixtureBody::Process(process) = &fixtures[0].body else { panic!("a process") };
    assert_eq!(process.command, [bench.path("cell/sim"), "--fast".to_owned()]);
    assert_eq!((process.stop_signal, process.stop_grace), (15, secs(5)));
    let ProbeKind::File(file) = &process.probes.ready[0].kind else { panic!("a file") };
    assert_eq!(bench.relative(file), "cell/up");
    assert_eq!(process.probes.ready[1].every, Duration::from_millis(100));
    assert_eq!(
        (process.probes.alive[0].every, process.probes.alive[0].timeout),
        (secs(1), secs(1))
    );
    let ProbeKind::Command(words) = &process.probes.alive[0].kind else { panic!("a command") };
    assert!(words[0].starts_with('/') && words[0].ends_with("/sh"), "{words:?}");
}

/// Middleware probes run a shipped program; the suite cannot inject a command.
#[test]
fn middleware_is_probed_by_a_shipped_program() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file(
        "cell/s.xml",
        "<suite><fixture type='process'><command>sh</command>\
         <ready ros-topic='/n${port:n}/x' min-rate='2.5' timeout='3s'/>\
         <alive ros-node='/talker'/><alive ros2-topic='/chatter'/></fixture><test>A.lua</test></suite>",
    );
    let outcome = bench.build(&["s.xml"]);
    let problem = &outcome.diagnostics[0];
    assert!(problem.message.contains("`ros-topic` cannot be probed"), "{problem:?}");
    assert_eq!(problem.labels[0].line, 1);

    bench.file("share/rtf/fixtures/rtf_fixtures/probe.py", "");
    let plan = bench.plan(&["s.xml"]);
    let FixtureBody::Process(process) = &plan.suites[0].fixtures[0].body else {
        panic!("a process")
    };
    let planned = |probe: &rtf_plan::plan::Probe| match &probe.kind {
        ProbeKind::Middleware { command, subject } => {
            let words: Vec<_> =
                command.iter().map(|word| word.replace(&bench.path(""), "")).collect();
            (words.join(" "), subject.clone(), probe.timeout)
        }
        other => panic!("{other:?}"),
    };
    let program = "bin/python3 -E -S share/rtf/fixtures/rtf_fixtures/probe.py";
    assert_eq!(
        planned(&process.probes.ready[0]),
        (
            format!("{program} ros-topic /n${{port:n}}/x --timeout 3 --min-rate 2.5"),
            "ros-topic `/n${port:n}/x`".to_owned(),
            Duration::from_secs(5)
        )
    );
    assert_eq!(
        planned(&process.probes.alive[0]),
        (
            format!("{program} ros-node /talker --timeout 5"),
            "ros-node `/talker`".to_owned(),
            Duration::from_secs(7)
        )
    );
    // The ROS 2 probe needs packages of the user's Python.
    let (command, subject, _) = planned(&process.probes.alive[1]);
    let program = program.replace(" -E -S", "");
    assert_eq!(command, format!("{program} ros2-topic /chatter --timeout 5"));
    assert_eq!(subject, "ros2-topic `/chatter`");
}

#[test]
fn unknown_types_list_the_known_ones() {
    let bench = Bench::new();
    bench.file(
        "cell/s.xml",
        "<suite><fixture type='procss'>A</fixture><test type='Lau'>A</test></suite>",
    );
    let outcome = bench.build(&["s.xml"]);
    let found = |index: usize| {
        let found = &outcome.diagnostics[index];
        (found.code.as_str(), found.notes[0].as_str(), found.hint.as_deref())
    };
    let known = "known types are `dll`, `lua`, `python`, `ruby`, `process`";
    assert_eq!(found(0), ("unknown-type", known, Some("did you mean `process`?")));
    let known = "known types are `dll`, `lua`, `python`, `ruby`, `gtest`, `catch2`, `doctest`, \
                 `boost`, `cppunit`, `aunit`, `junit`, `pytest`, `unittest`, `launch_testing`, \
                 `ctest`, `rostest`, `cargo`, `go`, `tap`, `program`";
    assert_eq!(found(1), ("unknown-type", known, Some("did you mean `lua`?")));
}

#[test]
fn the_problems_of_all_files_are_reported_at_once() {
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
            "make it executable with `chmod +x ./plain`"
        )
    );
    assert_eq!(
        message("plain"),
        text(
            "no-such-program",
            "there is no program `plain`",
            "use `./plain` for the one in the suite's directory"
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

#[test]
fn an_attached_fixture_is_monitored_by_all_its_probes() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file(
        "cell/s.xml",
        "<suite><fixture type='process' attach='true'><ready tcp='127.0.0.1:5' every='7s'/>\
         <ready file='up'/></fixture><fixture type='process' name='robot' attach='true' check-every='3s'>\
         <ready file='up'/><alive tcp='127.0.0.1:5'/></fixture><test>A.lua</test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    let fixtures = &plan.suites[0].fixtures;
    let times = |probes: &[rtf_plan::plan::Probe]| -> Vec<u128> {
        probes.iter().map(|probe| probe.every.as_millis()).collect()
    };
    let attached = |index: usize| match &fixtures[index].body {
        FixtureBody::Attached(attached) => (times(&attached.ready), times(&attached.alive)),
        other => panic!("{other:?}"),
    };
    assert_eq!(fixtures[0].name, "attached");
    assert_eq!(attached(0), (vec![7000, 100], vec![7000, 1000]));
    assert_eq!(attached(1), (vec![100, 100], vec![3000]));
}

#[test]
fn settings_that_an_attached_fixture_cannot_have_are_reported() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    let text = "<suite><fixture type='process' attach='true'/>\n\
                <fixture type='process' attach='true' name='b'><command>sleep 1</command>\n\
                <ready log='up'/><alive log-bad='down'/><stop grace='1s'/></fixture>\n\
                <fixture attach='true' name='c'>A.lua</fixture>\n\
                <test>A.lua</test></suite>";
    assert_snapshot!(bench.shown(text), @r#"
    incomplete: `<fixture>` needs a `<ready>` or an `<alive>` with `attach="true"`
      1:8 <fixture
    unknown-element: unknown element `<command>`
      2:48 <command not known in `<fixture attach="true">`
      note: `<fixture attach="true">` can have the elements `ready`, `alive`, `reset`, `env`, `provide`
    no-output: `rtf` cannot read the output of an attached process
      3:13 up
    no-output: `rtf` cannot read the output of an attached process
      3:34 down
    unknown-element: unknown element `<stop>`
      3:41 <stop not known in `<fixture attach="true">`
      note: `<fixture attach="true">` can have the elements `ready`, `alive`, `reset`, `env`, `provide`
    wrong-type: only `type="process"` can be attached
      4:10 attach
      hint: a plug-in that only watches needs no `attach`: it has a `check`, and no `setup`
    "#);
}

#[test]
fn a_fixture_on_another_machine_needs_ssh_here_and_its_program_there() {
    let mut bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.program("bin/ssh", "exit 0");
    bench.set("RTF_SSH", "ssh -p 22 -i 'a key'");
    bench.file(
        "cell/s.xml",
        "<suite><fixture type='process' host='pi@robot'><command>no-such-program 'a b'</command>\
         </fixture><test>A.lua</test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    let FixtureBody::Process(process) = &plan.suites[0].fixtures[0].body else { panic!() };
    let remote = process.remote.as_ref().unwrap();
    assert_eq!(process.command, ["no-such-program", "a b"]);
    assert_eq!(remote.host, "pi@robot");
    assert_eq!(remote.ssh, [&bench.path("bin/ssh"), "-p", "22", "-i", "a key"]);
}

#[test]
fn a_remote_machine_can_be_a_reference() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.program("bin/ssh", "exit 0");
    bench.program("cell/sim", "exit 0");
    let fixture = |name: &str, host: &str| {
        format!(
            "<fixture type='process' name='{name}' host='{host}'><command>sim</command></fixture>"
        )
    };
    let sim = "<fixture type='process' name='sim'><command>./sim</command><provide name='ip' log='(x)'/></fixture>";
    let remotes = ["${fixture:sim.ip}", "ssh://pi@robot:${port:ssh}", "pi@${param:robot=arm}"];
    let fixtures = ["a", "b", "c"].iter().zip(remotes).map(|(name, host)| fixture(name, host));
    let fixtures: String = fixtures.collect();
    bench.file("cell/s.xml", &format!("<suite>{sim}{fixtures}<test>A.lua</test></suite>"));
    let suite = bench.plan(&["s.xml"]).suites.remove(0);
    let host = |fixture: &FixturePlan| match &fixture.body {
        FixtureBody::Process(process) => process.remote.as_ref().map(|remote| remote.host.clone()),
        _ => None,
    };
    let hosts: Vec<_> = suite.fixtures.iter().filter_map(host).collect();
    assert_eq!(hosts, [remotes[0], remotes[1], "pi@arm"]);
}

#[test]
fn settings_that_a_remote_fixture_cannot_have_are_reported() {
    let mut bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.set("PATH", &bench.path("bin"));
    let text = "<suite><fixture type='process' host='pi@robot:22'><command>a</command></fixture>\n\
                <fixture type='process' host='-oProxyCommand=x'><command>a</command></fixture>\n\
                <fixture type='process' host='pi@robot'><command>a</command><ready file='b'/></fixture>\n\
                <fixture host='pi@robot' name='c'>A.lua</fixture>\n\
                <fixture type='process' attach='true' host='pi@robot' name='d'><ready tcp='a:1'/></fixture>\n\
                <test>A.lua</test></suite>";
    assert_snapshot!(bench.shown(text), @r#"
    invalid-value: `host` is not a host name for `ssh`: `pi@robot:22`
      1:38 pi@robot:22
      hint: write it like `user@machine` or `ssh://user@machine:2222`
    no-such-program: there is no program `ssh`
      1:38 pi@robot:22
      note: searched `PATH`:
      [ROOT]/bin
    invalid-value: `host` is not a host name for `ssh`: `-oProxyCommand=x`
      2:31 -oProxyCommand=x
      hint: write it like `user@machine` or `ssh://user@machine:2222`
    no-such-program: there is no program `ssh`
      2:31 -oProxyCommand=x
      note: searched `PATH`:
      [ROOT]/bin
    no-such-program: there is no program `ssh`
      3:31 pi@robot
      note: searched `PATH`:
      [ROOT]/bin
    other-machine: `file` checks this machine, and the fixture runs on another one
      3:74 b
      hint: use `log`, `tcp` or `http`, or `command="ssh …"`
    wrong-type: only `type="process"` can run on another machine
      4:10 host
      hint: write a `<command>` that is started there
    unknown-attribute: unknown attribute `host`
      5:39 host not known in `<fixture attach="true">`
      note: `<fixture attach="true">` can have the attributes `name`, `type`, `depends`, `timeout`, `restarts`, `restart-delay`, `check-every`, `attach`
    "#);
    let text = "<suite isolate='network'><fixture type='process' host='pi@robot'><command>a</command></fixture>\n\
                <fixture type='process' host='a' name='d'><command>a</command>\n\
                <env name='RTF_SSH' value=\"ssh 'x\"/></fixture><test>A.lua</test></suite>";
    assert_snapshot!(bench.shown(text), @"
    other-machine: a suite with a private network cannot reach another machine
      1:56 pi@robot
    no-such-program: there is no program `ssh`
      1:56 pi@robot
      note: searched `PATH`:
      [ROOT]/bin
    other-machine: a suite with a private network cannot reach another machine
      2:31 a
    invalid-value: `RTF_SSH` is not a command: `ssh 'x`
      2:31 a
    ");
}
