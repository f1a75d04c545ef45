//! A hint can be followed: what it says repairs the suite.

use rtf_model::SignalSource;

use crate::bench::Bench;
use crate::signals::signals;

/// A suite with a mistake, its hint, and how the mistake is replaced to follow the hint.
const HINTS: &[(&str, &str, &str, &str)] = &[
    ("<suite clock='rso'><test>A.lua</test></suite>", "did you mean `ros`?", "'rso'", "'ros'"),
    (
        "<suite tset-timeout='1s'><test>A.lua</test></suite>",
        "did you mean `test-timeout`?",
        "tset-timeout",
        "test-timeout",
    ),
    ("<suite><tset>A.lua</tset><test>A.lua</test></suite>", "did you mean `test`?", "tset", "test"),
    (
        "<suite><test timeout='soon'>A.lua</test></suite>",
        "write it like `250ms`, `1.5s`, `2min` or `1h 30m`; a bare number is seconds",
        "soon",
        "1h 30m",
    ),
    (
        "<suite><fixture><command>./sim</command></fixture><test>A.lua</test></suite>",
        "write `type=\"process\"`",
        "<fixture>",
        "<fixture type=\"process\">",
    ),
    (
        "<suite><fixture type='process'><command>./sim | ./read</command></fixture>\
         <test>A.lua</test></suite>",
        "if you want a shell, write `sh -c '…'`",
        "./sim | ./read",
        "sh -c './sim | ./read'",
    ),
    (
        "<suite><fixture type='process'><command>./sim</command><ready tcp='5000'/></fixture>\
         <test>A.lua</test></suite>",
        "write it like `127.0.0.1:5000`",
        "'5000'",
        "'127.0.0.1:5000'",
    ),
    (
        "<suite><fixture type='process'><command>./sim</command><ready http='a:80'/></fixture>\
         <test>A.lua</test></suite>",
        "write it like `http://127.0.0.1:8080/health`",
        "'a:80'",
        "'http://127.0.0.1:8080/health'",
    ),
    (
        "<suite><fixture type='process'><command>./sim</command><ready file='a' tcp='a:1'/>\
         </fixture><test>A.lua</test></suite>",
        "write a separate `<ready>` for each; all of them must pass",
        "file='a' tcp",
        "file='a'/><ready tcp",
    ),
    (
        "<suite><fixture type='process'><command>./sim</command><alive http='https://a/up'/>\
         </fixture><test>A.lua</test></suite>",
        "probe it with `command=\"curl -fsS https://a/up\"`",
        "http='https://a/up'",
        "command=\"curl -fsS https://a/up\"",
    ),
    (
        "<suite><fixture type='process' name='sim'><command>./sim</command>\
         <provide name='port' log='port \\d+'/></fixture><test>A.lua</test></suite>",
        "put the value in parentheses: `listening on port (\\d+)`",
        "port \\d+",
        "port (\\d+)",
    ),
    (
        "<suite><hook on=''><command>./sim</command></hook><test>A.lua</test></suite>",
        "the triggers are `failure`, `collapse`, `timeout`, `interrupt`, `fixture-broken`, `end`",
        "on=''",
        "on='failure'",
    ),
    (
        "<suite><hook type='lua' on='end'><command>./sim</command></hook>\
         <test>A.lua</test></suite>",
        "a program has no type; remove the attribute",
        " type='lua'",
        "",
    ),
    (
        "<suite><test>A.lua<hook on='end'><command>./sim</command></hook></test></suite>",
        "`<hook>` is written directly in `<suite>`",
        "<test>A.lua<hook on='end'><command>./sim</command></hook></test>",
        "<test>A.lua</test><hook on='end'><command>./sim</command></hook>",
    ),
    (
        "<suite><test name='a'>A.lua</test><test name='a'>A.lua</test></suite>",
        "give one of them another `name`",
        "<suite><test name='a'>",
        "<suite><test name='b'>",
    ),
    (
        "<suite><test issue='#1'>A.lua</test></suite>",
        "add `expect=\"failed\"`",
        "<test ",
        "<test expect=\"failed\" ",
    ),
    (
        "<suite requires='gpu/x'><test>A.lua</test></suite>",
        "with `gpu/2`, two suites at a time can use a `gpu`",
        "gpu/x",
        "gpu/2",
    ),
    (
        "<suite><fixture type='process' name='sim'><command>./sim ${prot:a}</command></fixture>\
         <test>A.lua</test></suite>",
        "did you mean `${port:`?",
        "${prot:",
        "${port:",
    ),
    (
        "<suite><signal name='q' ros2='/odom'/><test>A.lua</test></suite>",
        "write a topic and a field: `/joint_states.position[elbow]`, `/odom.twist.twist.linear.x`",
        "/odom",
        "/odom.twist.twist.linear.x",
    ),
    (
        "<suite><signal name='q' yarp='/imu:o'/><test>A.lua</test></suite>",
        "write a port and the position of a value in its bottle: `/arm/state:o[3]`, `/imu:o[0][2]`",
        "/imu:o",
        "/imu:o[0][2]",
    ),
    (
        "<suite><signal name='elbow'><command>./read</command></signal>\
         <monitor name='m'>always(elbw > 1)</monitor><test>A.lua</test></suite>",
        "did you mean `elbow`?",
        "elbw",
        "elbow",
    ),
];

fn bench() -> Bench {
    let bench = Bench::new();
    for program in ["sim", "read"] {
        bench.program(&format!("cell/{program}"), "");
    }
    bench.file("cell/A.lua", "");
    bench.file("share/rtf/fixtures/clock.py", "");
    for module in ["__init__", "probe", "ros1_signals", "ros2_signals", "yarp_signals"] {
        bench.file(&format!("share/rtf/fixtures/rtf_fixtures/{module}.py"), "");
    }
    bench
}

/// The messages and hints of a suite.
fn problems(bench: &Bench, suite: &str) -> Vec<(String, Option<String>)> {
    bench.file("cell/s.xml", suite);
    let found = bench.build(&["s.xml"]).diagnostics;
    found.into_iter().map(|problem| (problem.message, problem.hint)).collect()
}

#[test]
fn suites_are_valid_after_their_hints_were_followed() {
    let bench = bench();
    let mut wrong = Vec::new();
    for (suite, hint, mistake, repair) in HINTS {
        assert!(suite.contains(mistake), "{suite}");
        let before = problems(&bench, suite);
        let hints: Vec<_> = before.iter().filter_map(|(_, hint)| hint.as_deref()).collect();
        let after = problems(&bench, &suite.replace(mistake, repair));
        if hints != [*hint] || !after.is_empty() {
            wrong.push((suite, before, after));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// What a running program of signals reports about times of another clock.
#[test]
fn hints_about_times_of_another_clock_can_be_followed() {
    let bench = bench();
    let advice = |suite: &str| {
        assert_eq!(bench.shown(suite), "", "{suite}");
        let plan = bench.plan(&["s.xml"]);
        let (_, config) = signals(&plan);
        let [SignalSource::Program(program)] = &*config.sources else { panic!("{config:?}") };
        program.other_clock.clone()
    };
    let suite = |attributes: &str, signal: &str| {
        format!("<suite{attributes}><signal name='q' {signal}<test>A.lua</test></suite>")
    };
    let own = advice(&suite("", "><command>./read</command></signal>"));
    assert_eq!(own, "`time=\"own\"` in the suite is for another clock");
    advice(&suite("", "time=\"own\"><command>./read</command></signal>"));
    for (signal, clock) in [
        ("ros='/arm.position[elbow]'/>", "clock=\"ros\""),
        ("ros2='/arm.position[elbow]'/>", "clock=\"ros2\""),
        ("yarp='/arm:o[0]'/>", "clock=\"yarp\""),
    ] {
        let wall = advice(&suite("", signal));
        assert_eq!(wall, format!("`{clock}` in `<suite>` is for simulated times"));
        let simulated = advice(&suite(&format!(" {clock}"), signal));
        assert!(simulated.contains("has to use the simulated time"), "{simulated}");
    }
}
