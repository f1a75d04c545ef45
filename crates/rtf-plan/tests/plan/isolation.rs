//! The private resources of suites.

use insta::assert_snapshot;
use rtf_plan::plan::{Isolation, OwnMiddleware, Preparation, ProbeKind};

use crate::bench::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/F.lua", "");
    bench.file("share/rtf/fixtures/rtf_fixtures/ros2_signals.py", "");
    for shipped in [
        "roscore.py",
        "rosbag.py",
        "clock.py",
        "yarpserver.py",
        "yarpmanager.py",
        "rtf_fixtures/__init__.py",
    ] {
        bench.file(&format!("share/rtf/fixtures/{shipped}"), "");
    }
    bench.program("cell/sim", "exit 0");
    bench.program("bin/ssh", "exit 0");
    bench
}

fn isolation(attributes: &str, inside: &str) -> Isolation {
    let bench = bench();
    let suite = format!("<suite {attributes}>{inside}<test>A.lua</test></suite>");
    bench.file("cell/s.xml", &suite);
    bench.plan(&["s.xml"]).suites.remove(0).isolate
}

#[test]
fn which_suites_get_private_middleware() {
    use OwnMiddleware::{Always, No, Ros2UnlessSet, UnlessSet};
    let plugin = "<fixture>F.lua</fixture>";
    let local = "<fixture type='process' name='l'><command>sh</command></fixture>";
    let signal = "<signal name='x' ros2='/odom.twist.twist.linear.x'/>";
    let attached = "<fixture type='process' attach='true' name='a'><ready file='x'/></fixture>";
    let remote = "<fixture type='process' host='a@b' name='r'><command>sim</command></fixture>";
    for (attributes, inside, expected) in [
        ("", "", Ros2UnlessSet),
        ("", plugin, Ros2UnlessSet),
        // Messages that no process of the suite can send.
        ("", signal, No),
        ("clock='ros2'", "", No),
        ("", &format!("{plugin}{signal}"), Ros2UnlessSet),
        ("clock='ros2'", plugin, Ros2UnlessSet),
        ("", local, UnlessSet),
        ("", &format!("{plugin}{local}"), UnlessSet),
        ("", "<fixture>roscore</fixture>", UnlessSet),
        ("", "<fixture>rosbag</fixture>", Ros2UnlessSet),
        ("", "<fixture>yarpmanager</fixture>", Ros2UnlessSet),
        ("", "<fixture>yarpserver</fixture><fixture>yarpmanager</fixture>", UnlessSet),
        ("middleware='own'", "<fixture>yarpmanager</fixture>", Always),
        ("", &format!("<fixture>roscore</fixture>{attached}"), No),
        ("middleware='own'", plugin, Always),
        ("", attached, No),
        ("", remote, No),
        ("middleware='own'", remote, Always),
        ("", &format!("{local}{attached}"), No),
        ("isolate='network'", "", Always),
        ("isolate='network' middleware='shared'", plugin, No),
        ("middleware='own'", attached, Always),
        ("middleware='shared'", plugin, No),
    ] {
        let isolation = isolation(attributes, inside);
        assert_eq!(isolation.middleware, expected, "{attributes} {inside}");
        assert_eq!(isolation.network, attributes.contains("network"));
    }
}

/// Suites of 2.x with `yarpmanager` were given a private namespace, in which there is no server.
#[test]
fn which_suites_use_the_name_server_of_the_user() {
    let manager = "<fixture>yarpmanager</fixture>";
    let core = "<fixture>roscore</fixture>";
    let server = "<fixture>yarpserver</fixture>";
    let local = "<fixture type='process' name='l'><command>sh</command></fixture>";
    for (attributes, inside, expected) in [
        ("", format!("{core}{manager}"), true),
        ("", format!("{core}{server}{manager}"), false),
        // It may start a server.
        ("", format!("{local}{manager}"), false),
        ("", core.to_owned(), false),
        ("middleware='own'", format!("{core}{manager}"), false),
        ("isolate='network'", format!("{core}{manager}"), false),
    ] {
        let isolation = isolation(attributes, &inside);
        assert_eq!(isolation.shares_name_server, expected, "{attributes} {inside}");
    }
}

/// Each of them may start nodes of ROS 2.
#[test]
fn plugins_without_a_suite_get_a_private_domain() {
    let plan = bench().plan(&["A.lua"]);
    assert_eq!(plan.suites[0].isolate.middleware, OwnMiddleware::Ros2UnlessSet);
}

/// Planning reserves nothing: `rtf check` needs no port.
#[test]
fn ports_are_collected_and_not_replaced() {
    let bench = bench();
    let text = "<suite><environment>--p ${port:e}</environment><env name='V' value='${port:b}'/>\
        <fixture type='process' name='sim'><command>./sim --at ${port:sim}</command>\
        <ready tcp='127.0.0.1:${port:sim}'/><ready http='http://127.0.0.1:${port:web}/x'/>\
        <ready command='./sim ${port:c}'/><ready file='up.${port:f}'/></fixture>\
        <hook on='end'><command>./sim ${port:h}</command></hook>\
        <test param='--port ${port:sim} $${port:no} ${HOME} ${x'>A.lua</test></suite>";
    bench.file("cell/s.xml", text);
    let suite = bench.plan(&["s.xml"]).suites.remove(0);
    assert_eq!(suite.isolate.ports, ["b", "c", "e", "f", "h", "sim", "web"]);
    assert_eq!(suite.preparation, Preparation::NotNeeded);
    assert_eq!(suite.tests[0].plugin.args[1], "${port:sim}");
    let rtf_plan::plan::FixtureBody::Process(process) = &suite.fixtures[0].body else {
        panic!("a process")
    };
    let ProbeKind::Tcp(address) = &process.probes.ready[0].kind else { panic!("a probe") };
    assert_eq!(address, "127.0.0.1:${port:sim}");
}

#[test]
fn invalid_ports_are_reported_with_their_positions() {
    let text = "<suite isolate='netwrok' middleware='mine'>\n\
        <env name='RTF_PORT_X' value='1'/>\n\
        <fixture type='process' name='sim'><command>./sim ${port:a-b} ${port:9}</command>\n\
        <ready tcp='127.0.0.1:${port:}'/><ready log='at ${port:a-b}'/><ready tcp='${port:x}'/></fixture>\n\
        <test param='${port:a_b} ${port:open'>A.lua</test>\n\
        <test param='  &amp; ${prot:sim} ${PORT:-5} ${port:A-B}'>A.lua</test></suite>";
    assert_snapshot!(bench().shown(text), @r"
    invalid-value: `isolate` has to be `network`: `netwrok`
      1:17 netwrok
      hint: did you mean `network`?
    invalid-value: `middleware` has to be `own` or `shared`: `mine`
      1:38 mine
    invalid-value: `name` is a variable that rtf sets itself: `RTF_PORT_X`
      2:12 RTF_PORT_X
    invalid-port: `9` is not the name of a port
      3:63 ${port:9}
      note: a name starts with a letter, followed by letters, digits, `-` and `_`: at most 32 characters
    invalid-port: `` is not the name of a port
      4:23 ${port:}
      note: a name starts with a letter, followed by letters, digits, `-` and `_`: at most 32 characters
    invalid-value: `log` cannot contain `${port:…}` or `${fixture:…}`: `at ${port:a-b}`
      4:46 at ${port:a-b}
      hint: write a pattern for the value: `\d+`
    invalid-value: `tcp` is not a host and a port: `${port:x}`
      4:75 ${port:x}
      hint: write it like `127.0.0.1:5000`
    invalid-port: the ports `a-b` and `a_b` would both be in `RTF_PORT_A_B`
      5:14 ${port:a_b}
      3:51 ${port:a-b} the other one
    invalid-port: `${port:` in `param` is not closed
      5:26 ${port: a `}` is missing after it
      hint: `$${port:` stands for these characters
    invalid-port: the ports `a-b` and `A-B` would both be in `RTF_PORT_A_B`
      6:45 ${port:A-B}
      3:51 ${port:a-b} the other one
    no-port: `${prot:` means itself
      6:22 ${prot:
      hint: did you mean `${port:`?
    ");
}
