//! Every element and attribute is read.

use std::time::Duration;

use rtf_model::{
    FaultAmount, FaultTime, FindingSeverity, NetworkFault, ProcessQuantity, SignalTime,
    TestQuantity, Trigger, ValuesFault, Verdict,
};
use rtf_plan::suite::{
    AfterCollapse, ClockSource, DeclaredEffect, DeclaredLimits, DeclaredProbe, DeclaredProbeKind,
    DeclaredSourceKind, DeclaredValueSource, FixtureKind, ForkPoint, HookKind, Leaks,
    MatrixDimension, MiddlewareProbe, ReferenceUser, SignalMiddleware, TestIsolation,
};

use crate::file;

#[test]
fn every_attribute_is_read() {
    let (suite, problems) = file("valid/everything.xml");
    assert!(problems.is_empty(), "{problems:#?}");
    let secs = Duration::from_secs;
    assert_eq!(suite.settings.timeout, Some(secs(5400)));
    assert_eq!(suite.tags, ["hardware", "slow"]);
    assert!(suite.settings.tolerates_collapse);
    assert!(suite.settings.critical_stops_run && suite.settings.skips_fail);
    assert_eq!(suite.settings.parallel, 4);
    let clock = suite.clock.unwrap();
    assert_eq!((clock.source, clock.backstop), (ClockSource::Ros, Some(20)));
    assert_eq!(
        suite.env,
        [("ARM_PORT", "17681"), ("EMPTY", "")].map(|(n, v)| (n.into(), v.into()))
    );
    let test = &suite.tests[0];
    assert_eq!(test.name.as_ref().unwrap().value, "reach");
    assert_eq!(test.plugin.name.value, "ReachTest");
    assert_eq!(test.plugin.param, "--n 3 \"a b\"");
    assert_eq!(test.settings.repetitions, 5);
    assert_eq!(
        test.limits,
        DeclaredLimits {
            load: Some(secs(11)),
            setup: Some(secs(12)),
            run: Some(secs(120)),
            teardown: Some(secs(13)),
            slow: Some(secs(14)),
            grace: Some(secs(15)),
            case: None,
        }
    );
    assert_eq!(
        (test.settings.after_collapse, test.settings.leaks),
        (AfterCollapse::Skip, Leaks::Report)
    );
    assert!(test.settings.critical && test.settings.exclusive);
    assert_eq!(test.tags, ["reach", "slow"]);
    assert_eq!(test.env, [("SEED".to_owned(), "7".to_owned())]);
    let other = &suite.tests[1];
    assert!(!other.settings.critical && !other.settings.exclusive);
    assert_eq!(
        (other.settings.after_collapse, other.settings.leaks),
        (AfterCollapse::Rerun, Leaks::Fail)
    );
    assert_eq!(
        other.limits,
        DeclaredLimits {
            load: Some(secs(1)),
            setup: Some(secs(2)),
            run: Some(secs(10)),
            teardown: Some(secs(3)),
            slow: Some(secs(4)),
            grace: Some(Duration::from_millis(500)),
            case: None,
        }
    );
}

#[test]
fn cases_of_other_frameworks_are_read() {
    let (suite, _) = file("valid/everything.xml");
    assert_eq!(suite.tests[0].cases, None);
    let test = &suite.tests[2];
    assert_eq!(test.limits.case, Some(Duration::from_secs(30)));
    let cases = test.cases.as_ref().unwrap();
    assert_eq!(cases.patterns.as_ref().unwrap().value, "Arm.* !*Slow");
    assert_eq!(cases.isolation.as_ref().unwrap().value, TestIsolation::Case);
    assert_eq!(cases.fork.as_ref().unwrap().value, ForkPoint::Main);
    assert!(cases.case_timeout.is_some());
}

#[test]
fn known_failures_and_matrices_are_read() {
    let (suite, _) = file("valid/everything.xml");
    let test = &suite.tests[0];
    let failure = test.known_failure.as_ref().unwrap();
    assert_eq!(failure.verdicts, [Verdict::Failed, Verdict::TimedOut]);
    assert_eq!(failure.issue.as_deref(), Some("https://example.org/7"));
    assert_eq!(failure.until.as_ref().unwrap().value.to_string(), "2027-01-31");
    let matrix = test.matrix.as_ref().unwrap();
    let [MatrixDimension::Values(name, values), MatrixDimension::File(file)] =
        matrix.dimensions.as_slice()
    else {
        panic!("{matrix:?}")
    };
    assert_eq!((name.value.as_str(), values.join(",").as_str()), ("joint", "0,1,2"));
    assert_eq!(file.value, "poses.csv");
    assert_eq!(matrix.excludes[0].values[1].1, "up");
}

#[test]
fn every_part_of_a_process_fixture_is_read() {
    let (suite, _) = file("valid/everything.xml");
    let fixture = &suite.fixtures[0];
    assert_eq!(fixture.setup, Some(Duration::from_secs(20)));
    assert_eq!(fixture.restarts, Some(0));
    assert_eq!(fixture.check_every, Some(Duration::from_secs(2)));
    let FixtureKind::Process(process) = &fixture.body else { panic!("a process") };
    assert_eq!(process.command.value, ["python3", "simulator.py", "two words", "#7"]);
    assert_eq!(process.stop_signal, Some(2));
    assert_eq!(process.stop_grace, Some(Duration::from_secs(3)));
    assert_eq!(process.stop_codes, [1, 130]);
    let probe = |kind, name: &str, min_rate| {
        format!("{:?}", MiddlewareProbe { kind, name: name.to_owned(), min_rate })
    };
    let kinds = |probes: &[DeclaredProbe]| {
        let kind = |probe: &DeclaredProbe| match &probe.kind {
            DeclaredProbeKind::Tcp(address) => address.clone(),
            DeclaredProbeKind::Http(url) => url.clone(),
            DeclaredProbeKind::Log(pattern) => pattern.to_string(),
            DeclaredProbeKind::Command(words) => words.join("|"),
            DeclaredProbeKind::File(path) => path.clone(),
            DeclaredProbeKind::Middleware(probe) => format!("{probe:?}"),
        };
        probes.iter().map(kind).collect::<Vec<_>>()
    };
    assert_eq!(
        kinds(&process.probes.ready),
        [
            "127.0.0.1:17681",
            "http://127.0.0.1:8080/health",
            "listening on port \\d+",
            "run/sim.pid",
            "python3|arm_client.py|time",
            &probe("ros-node", "/robot/${param:node=driver}", None),
            &probe("ros-service", "/reset", None),
            &probe("yarp-port", "/icubSim/head/state:o", None),
        ]
    );
    assert_eq!(
        kinds(&process.probes.alive),
        [
            "python3|arm_client.py|time",
            "(?i)fatal",
            "[::1]:17681",
            &probe("ros-topic", "/joint_states", Some(99.5)),
            &probe("ros2-topic", "/joint_states", Some(0.5))
        ]
    );
    assert_eq!(process.probes.ready[0].every, Some(Duration::from_millis(50)));
    assert_eq!(process.probes.ready[0].timeout, Some(Duration::from_millis(500)));
    assert_eq!(suite.fixtures[0].depends, None);
    assert_eq!(suite.fixtures[0].restart_delay, Some(Duration::from_millis(500)));
    assert_eq!(suite.fixtures[1].depends.as_ref().unwrap()[0].value, "sim");
}

#[test]
fn every_value_of_a_fixture_is_read() {
    let (suite, _) = file("valid/everything.xml");
    let fixture = &suite.fixtures[0];
    let provides = &fixture.provides;
    let names: Vec<_> = provides.iter().map(|it| (it.name.value.as_str(), it.secret)).collect();
    assert_eq!(names, [("port", false), ("pid", false), ("token", true)]);
    let DeclaredValueSource::Log(pattern) = &provides[0].source else { panic!("a log") };
    assert_eq!(pattern.as_str(), "listening on port (\\d+)");
    let DeclaredValueSource::File(path) = &provides[1].source else { panic!("a file") };
    assert_eq!(path, "run/sim.pid");
    let DeclaredValueSource::Command(words) = &provides[2].source else { panic!("a command") };
    assert_eq!(words.value, ["python3", "arm_client.py", "token"]);
    assert!(matches!(suite.fixtures[1].provides[0].source, DeclaredValueSource::Plugin));
    let references = &suite.fixture_references.found;
    let users: Vec<_> =
        references.iter().map(|it| (it.fixture.as_str(), it.value.as_str(), it.user)).collect();
    let (driver, remote) = (ReferenceUser::Fixture(1), ReferenceUser::Fixture(4));
    let remote = ["host", "host", "port"].map(|value| ("sim", value, remote));
    let later = ("sim", "port", ReferenceUser::TestOrHook);
    let dir = ("sim", "dir", ReferenceUser::TestOrHook);
    assert_eq!(users, [&[("sim", "port", driver)], &remote[..], &[later, later, dir]].concat());
}

#[test]
fn signals_and_monitors_are_read() {
    let (suite, _) = file("valid/everything.xml");
    let [elbow, load, wrist, others @ .., arm] = &*suite.signals else {
        panic!("{:?}", suite.signals)
    };
    let DeclaredSourceKind::Program { command, time, wait } = &elbow.kind else { panic!() };
    assert_eq!(command.value[2..], ["--port", "${fixture:sim.port}"]);
    assert_eq!((*time, *wait), (SignalTime::Arrival, false));
    assert_eq!(elbow.signals[0].unit.value, "rad");
    let DeclaredSourceKind::Fixture { name, quantity, every } = &load.kind else { panic!() };
    assert_eq!((&*name.value, *quantity), ("sim", ProcessQuantity::Cpu));
    assert_eq!(*every, Some(Duration::from_secs(1)));
    let DeclaredSourceKind::Topic { middleware, field } = &wrist.kind else { panic!() };
    assert_eq!(*middleware, SignalMiddleware::Ros);
    assert_eq!(field.value, "/joint_states.position[wrist_1.x]");
    let [ros2, yarp, recorded, sampled] = others else { panic!("{others:?}") };
    for (source, expected, value) in [
        (ros2, SignalMiddleware::Ros2, "/odom.twist.twist.linear.x"),
        (yarp, SignalMiddleware::Yarp, "/imu:o[0][2]"),
    ] {
        let DeclaredSourceKind::Topic { middleware, field } = &source.kind else { panic!() };
        assert_eq!((*middleware, &*field.value), (expected, value));
    }
    let DeclaredSourceKind::Recording { file, field } = &recorded.kind else { panic!() };
    assert_eq!((&*file.value, &*field.value), ("${param:recording}", "/level"));
    let DeclaredSourceKind::Test(TestQuantity::Measurement) = &sampled.kind else { panic!() };
    let DeclaredSourceKind::Program { time, wait, .. } = &arm.kind else { panic!() };
    assert_eq!((*time, *wait), (SignalTime::Own, true));
    let names: Vec<_> = arm.signals.iter().map(|it| (&*it.name.value, &*it.unit.value)).collect();
    assert_eq!(names, [("arm/q", "deg"), ("t", "")]);
    let monitor = &suite.monitors[0];
    assert_eq!((&*monitor.name.value, monitor.severity), ("no overshoot", FindingSeverity::Stop));
    assert_eq!(monitor.formula.value, "always(elbow <= 1.05rad)");
    assert_eq!(suite.tests[0].monitors[0].severity, FindingSeverity::Fail);
    assert_eq!(suite.envelopes[0].file.value, "arm.limits.yaml");
}

#[test]
fn faults_are_read() {
    let (suite, _) = file("valid/everything.xml");
    let [drop, busy, far, off, slipped, stuck, crash, memory] = &*suite.faults else {
        panic!("{:?}", suite.faults)
    };
    let time = |from_us, to_us| Some(FaultTime { from_us, to_us });
    let DeclaredEffect::Stop(target) = &drop.effect else { panic!("{drop:?}") };
    assert_eq!((&*target.fixture.value, target.process.as_deref()), ("sim", Some("arm.py")));
    assert_eq!((drop.at, drop.duration), (None, time(500_000, 500_000)));
    assert!(matches!(busy.effect, DeclaredEffect::Slow { percent: 20, .. }), "{busy:?}");
    assert_eq!((busy.at, busy.seed), (time(1_000_000, 3_000_000), 7));
    let DeclaredEffect::Network { fault, port } = &far.effect else { panic!("{far:?}") };
    assert_eq!(port.as_ref().unwrap().value, "${port:sim}");
    let expected = NetworkFault {
        has_port: true,
        delay_us: 50_000,
        jitter_us: 10_000,
        loss_ppm: 5_000,
        duplicate_ppm: 10_000,
        reorder_ppm: 20_000,
        rate_bits: Some(10_000_000),
        refuses: false,
    };
    assert_eq!(*fault, expected);
    let DeclaredEffect::Network { fault, .. } = &off.effect else { panic!("{off:?}") };
    assert!(fault.refuses && fault.has_port, "{fault:?}");
    let DeclaredEffect::Values { fixture, fault } = &slipped.effect else { panic!("{slipped:?}") };
    let text = |text: &str| Some(text.to_owned());
    let expected = ValuesFault {
        field: text("position[elbow]"),
        set: text("NaN"),
        scale: text("-1"),
        offset: text("0.3"),
        noise: text("1e-3"),
        freezes: false,
        loss_ppm: 10_000,
        delay_us: 20_000,
        seed: 5,
    };
    assert_eq!((&*fixture.value, fault), ("sim", &expected));
    let DeclaredEffect::Values { fault, .. } = &stuck.effect else { panic!("{stuck:?}") };
    assert!(fault.freezes && fault.set.is_none(), "{fault:?}");
    assert!(matches!(crash.effect, DeclaredEffect::Kill(_)), "{crash:?}");
    assert_eq!((crash.at, crash.duration), (time(0, 0), None));
    assert_eq!(memory.name.value, "full memory");
    let DeclaredEffect::Memory(FaultAmount::Leave(leave)) = memory.effect else { panic!() };
    assert_eq!(leave, 64 << 20);
    let DeclaredEffect::Disk { dir, amount } = &suite.tests[0].faults[0].effect else { panic!() };
    assert_eq!(dir.value, "${fixture:sim.dir}/log");
    assert_eq!(*amount, FaultAmount::Size(2_000_000_000));
}

#[test]
fn every_part_of_a_hook_is_read() {
    let (suite, _) = file("valid/everything.xml");
    let park = &suite.hooks[0];
    assert_eq!(park.name.as_ref().unwrap().value, "park");
    assert_eq!(
        park.on,
        [
            Trigger::Failure,
            Trigger::Collapse,
            Trigger::Timeout,
            Trigger::Interrupt,
            Trigger::FixtureBroken,
            Trigger::End,
        ]
    );
    assert_eq!(park.timeout, Some(Duration::from_secs(10)));
    assert_eq!(park.env, [("SPEED".to_owned(), "0.1".to_owned())]);
    let HookKind::Plugin(plugin) = &park.body else { panic!("a plug-in") };
    assert_eq!((plugin.name.value.as_str(), plugin.param.as_str()), ("Park.lua", "--slow"));
    let HookKind::Command(command) = &suite.hooks[1].body else { panic!("a command") };
    assert_eq!(command.value, ["python3", "park.py", "--fast", "--port", "${fixture:sim.port}"]);
    assert_eq!((suite.hooks[1].timeout, suite.hooks[1].name.is_none()), (None, true));
}
