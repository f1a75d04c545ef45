//! `<provide>` and `${fixture:…}`.

use insta::assert_snapshot;
use rtf_plan::plan::{FixtureBody, ProbeKind};

use crate::bench::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/F.lua", "");
    bench.program("cell/sim", "exit 0");
    bench.program("bin/ssh", "exit 0");
    bench
}

#[test]
fn values_and_their_sources_are_planned() {
    let bench = bench();
    let text = "<suite><fixture type='process' name='sim'><command>./sim</command>\
        <provide name='port' log='port (\\d+)'/><provide name='pid' file='run/pid'/>\
        <provide name='token' command='./sim token' secret='true'/></fixture>\
        <fixture name='arm.left' param='${fixture:sim.port}'>F.lua<provide name='device'/></fixture>\
        <test param='${fixture:arm.left.device} $${fixture:sim.x}'>A.lua</test></suite>";
    bench.file("cell/s.xml", text);
    let suite = bench.plan(&["s.xml"]).suites.remove(0);
    let [sim, arm] = suite.fixtures.as_slice() else { panic!("two fixtures") };
    let names = sim.provides.iter().map(|value| (value.name.as_str(), value.secret));
    assert_eq!(names.collect::<Vec<_>>(), [("port", false), ("pid", false), ("token", true)]);
    assert_eq!(arm.provides[0].name, "device");
    let FixtureBody::Process(process) = &sim.body else { panic!("a process") };
    let [port, pid, token] = process.probes.values.as_slice() else { panic!("three values") };
    assert!(matches!(port.probe.kind, ProbeKind::Log(_)));
    assert!(matches!(&pid.probe.kind, ProbeKind::File(path) if path.ends_with("cell/run/pid")));
    assert!(matches!(&token.probe.kind, ProbeKind::Command(words) if words[1] == "token"));
    assert!(suite.refers_to_values);
    assert_eq!(suite.tests[0].plugin.args[0], "${fixture:arm.left.device}");
}

const WRONG_DECLARATIONS: &str = "<suite>\n\
        <fixture type='process' name='sim'><command>./sim</command>\n\
        <provide log='(x)'/><provide name='9'/><provide name='a'/>\n\
        <provide name='b' log='port \\d+'/><provide name='c' log='('/>\n\
        <provide name='d' log='(x)' file='y'/><provide name='e' log='(${port:x})'/>\n\
        <provide name='f' file='x'/><provide name='f' file='y'/><provide name='g' command='nosuch'/>\n\
        <provide name='h' secret='perhaps' file='z'>text</provide></fixture>\n\
        <fixture type='process' attach='true' name='a'><ready file='x'/><provide name='a' log='(x)'/></fixture>\n\
        <fixture type='process' host='a@b' name='r'><command>sim</command><provide name='a' file='x'/></fixture>\n\
        <fixture>F.lua<provide name='a' file='x'/></fixture>\n\
        <fixture name='x-y'>F.lua<provide name='z'/></fixture>\n\
        <fixture name='x'>F.lua<provide name='y-z'/></fixture>\n\
        <test>A.lua<env name='RTF_FIXTURE_SIM_PORT' value='1'/></test></suite>";

#[test]
fn wrong_declarations_are_reported_with_their_positions() {
    assert_snapshot!(bench().shown(WRONG_DECLARATIONS), @r#"
    incomplete: `<provide>` needs the attribute `name`
      3:1 <provide
    incomplete: `<provide>` needs one of the attributes `log`, `file` and `command`
      3:21 <provide
    invalid-value: `name` is not the name of a value: `9`
      3:36 9
      hint: a name is a letter, followed by letters, digits, `-` and `_`: at most 32 characters
    incomplete: `<provide>` needs one of the attributes `log`, `file` and `command`
      3:40 <provide
    invalid-value: `log` has no group: `port \d+`
      4:24 port \d+
      hint: put the value in parentheses: `listening on port (\d+)`
    invalid-value: `log` is not a regular expression: `(`
      4:58 (
      note: regex parse error:
        (
        ^
    error: unclosed group
    several-sources: `<provide>` has one of the attributes `log`, `file` and `command`
      5:35 y `file` is a second one
    invalid-value: `log` cannot contain `${port:…}` or `${fixture:…}`: `(${port:x})`
      5:62 (${port:x})
      hint: write a pattern for the value: `\d+`
    repeated-value: the value `f` is declared twice
      6:44 f
      6:16 f the first one
    no-such-program: there is no program `nosuch`
      6:84 nosuch
      note: searched `PATH`:
      [ROOT]/bin
      /usr/bin
      /bin
    invalid-value: `secret` has to be `true` or `false`: `perhaps`
      7:27 perhaps
    stray-text: text has no meaning in `<provide>`
      7:45 text not expected here
    no-output: `rtf` cannot read the output of an attached process
      8:88 (x)
    other-machine: `file` checks this machine, and the fixture runs on another one
      9:91 x
      hint: use `log`, or `command="ssh …"`
    wrong-type: `file` is for `type="process"`
      10:39 x
      hint: a plug-in provides its values itself, with `provide(name, value)`
    repeated-value: `x-y.z` and `x.y-z` would both be in `RTF_FIXTURE_X_Y_Z`
      12:39 y-z
      11:41 z the other one
    invalid-value: `name` is a variable that rtf sets itself: `RTF_FIXTURE_SIM_PORT`
      13:23 RTF_FIXTURE_SIM_PORT
    "#);
}

#[test]
fn wrong_references_are_reported_with_their_positions() {
    let text = "<suite><environment>${fixture:sim.port}</environment>\n\
        <env name='P' value='${fixture:sim.port}'/>\n\
        <fixture type='process' name='sim'><command>./sim ${fixture:sim.port}</command>\n\
        <ready tcp='127.0.0.1:${fixture:arm.port}'/><provide name='port' log='(x)'/></fixture>\n\
        <fixture name='arm' depends=''>F.lua<env name='P' value='${fixture:sim.port}'/><provide name='port'/></fixture>\n\
        <fixture name='hand' depends='arm' param='${fixture:arm.port}'>F.lua</fixture>\n\
        <hook on='end'><command>./sim ${fixture:simu.port}</command></hook>\n\
        <test param='${fixture:sim.prot} ${fixture:hand.x} ${fixture:sim} ${fixture:sim.port'>A.lua</test>\n\
        <test param='${fixture:sim.port} $${fixture:}'>A.lua</test></suite>";
    assert_snapshot!(bench().shown(text), @r#"
    invalid-fixture-value: a suite's own settings cannot use the value of a fixture: they also apply to its fixtures
      1:21 ${fixture:sim.port}
      hint: write it in the tests and hooks that need it
    invalid-fixture-value: a suite's own settings cannot use the value of a fixture: they also apply to its fixtures
      2:22 ${fixture:sim.port}
      hint: write it in the tests and hooks that need it
    unknown-fixture-value: the fixture `sim` cannot use its own value
      3:51 ${fixture:sim.port}
    unknown-fixture-value: the fixture `sim` does not depend on `arm`
      4:23 ${fixture:arm.port}
      hint: add `arm` to its `depends`
    unknown-fixture-value: the fixture `arm` does not depend on `sim`
      5:58 ${fixture:sim.port}
      hint: add `sim` to its `depends`
    unknown-fixture-value: there is no fixture `simu`
      7:31 ${fixture:simu.port}
      hint: did you mean `sim`?
    unknown-fixture-value: the fixture `sim` declares no value `prot`
      8:14 ${fixture:sim.prot}
      hint: did you mean `port`?
    unknown-fixture-value: the fixture `hand` declares no value `x`
      8:34 ${fixture:hand.x}
      hint: declare it with `<provide name="x" …/>`
    invalid-fixture-value: `sim` names no value of a fixture
      8:52 ${fixture:sim}
      hint: write `${fixture:NAME.VALUE}`
    invalid-fixture-value: `${fixture:` in `param` is not closed
      8:67 ${fixture: a `}` is missing after it
      hint: `$${fixture:` stands for these characters
    "#);
}
