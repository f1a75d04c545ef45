//! Files of limits, which become monitors.

use insta::assert_snapshot;
use rtf_model::SignalsConfig;
use rtf_plan::plan::{FixtureBody, Plan};

use crate::bench::Bench;

const SUITE: &str = "<suite><signals><command>./read</command>
<signal name='elbow.q' unit='rad'/><signal name='elbow.dq' unit='rad/s'/>
<signal name='rail/q' unit='m'/><signal name='rail/dq' unit='m/s'/><signal name='tau' unit='Nm'/>
<signal name='heat' unit='°C'/><signal name='range' unit='m'/><signal name='count'/></signals>
<envelope file='arm.limits.yaml'/><test>A.lua</test></suite>";

const URDF: &str = r#"<robot name="arm">
  <joint name="base" type="fixed"/>
  <joint name="elbow" type="revolute">
    <limit lower="-2.5" upper="1.5" velocity="3" effort="0"/>
  </joint>
  <joint name="rail" type="prismatic"><limit lower="0" upper="0.4" velocity="0.5" effort="80"/></joint>
  <joint name="wheel" type="continuous"/>
</robot>"#;

fn bench(limits: &str) -> Bench {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.program("cell/read", "");
    bench.file("cell/s.xml", SUITE);
    bench.file("cell/arm.limits.yaml", limits);
    bench.file("cell/arm.urdf", URDF);
    bench
}

fn monitors(plan: &Plan) -> String {
    let FixtureBody::Plugin(plugin) = &plan.suites[0].fixtures.last().unwrap().body else {
        panic!("no plug-in")
    };
    let config: SignalsConfig = serde_json::from_str(&plugin.param).unwrap();
    let lines = config.monitors.iter().map(|it| {
        assert!(it.tests.is_none());
        let origin = it.origin.as_deref().unwrap();
        assert!(origin.starts_with(&it.location.to_string()), "{origin} {}", it.location);
        format!("{origin} {:?} {}: {}\n", it.severity, it.name, it.formula)
    });
    lines.collect()
}

#[test]
fn each_limit_is_a_monitor() {
    let bench = bench(
        "severity: error
joints:
  elbow:
    position: {signal: elbow.q, min: -2rad, max: 60deg, severity: stop}
    velocity: {rate-of: elbow.q, max: 3}
    acceleration: {rate-of: elbow.dq, max: 40rad/s^2, for: 20ms}
    torque: {signal: tau, max: 7Nm}
    temperature: {signal: heat, max: 60°C}
limits:
  distance to the wall: {signal: 'range', min: 0.1m, severity: critical}
  \"number\": {signal: count, min: 1e1, max: 2e1}
",
    );
    assert_snapshot!(monitors(&bench.plan(&["s.xml"])), @"
    arm.limits.yaml:4:5 Stop elbow position: always(elbow.q >= -2rad and elbow.q <= 60deg)
    arm.limits.yaml:5:5 Error elbow velocity: always(abs(rate(elbow.q)) <= 3)
    arm.limits.yaml:6:5 Error elbow acceleration: always(not(abs(rate(elbow.dq)) <= 40rad/s^2) -> eventually[0,20ms] (abs(rate(elbow.dq)) <= 40rad/s^2))
    arm.limits.yaml:7:5 Error elbow torque: always(abs(tau) <= 7Nm)
    arm.limits.yaml:8:5 Error elbow temperature: always(heat <= 60°C)
    arm.limits.yaml:10:3 Critical distance to the wall: always(range >= 0.1m)
    arm.limits.yaml:11:3 Error number: always(count >= 10 and count <= 20)
    ");
}

#[test]
fn a_model_limits_all_joints_with_signals() {
    let bench = bench(
        "robot: left
model: arm.urdf
signals: {position: '{joint}.q', velocity: rate}
ignore: [wheel]
joints:
  rail:
    position: {signal: rail/q, max: 0.3m}
    velocity: {signal: rail/dq}
    torque: {signal: count, max: 3}
",
    );
    assert_snapshot!(monitors(&bench.plan(&["s.xml"])), @r#"
    arm.limits.yaml:7:5 Fail left: rail position: always("rail/q" >= 0m and "rail/q" <= 0.3m)
    arm.limits.yaml:8:5 Fail left: rail velocity: always(abs("rail/dq") <= 0.5m/s)
    arm.limits.yaml:9:5 Fail left: rail torque: always(abs(count) <= 3)
    arm.urdf:4:5 Fail left: elbow position: always(elbow.q >= -2.5rad and elbow.q <= 1.5rad)
    arm.urdf:4:5 Fail left: elbow velocity: always(abs(rate(elbow.q)) <= 3rad/s)
    "#);
}

#[test]
fn the_profile_replaces_values_and_tightens() {
    let text = "joints:
  elbow: {position: {signal: elbow.q, min: -2rad, max: 1rad}, torque: {signal: tau, max: 7Nm}}
limits: {far: {signal: range, max: 1.05m}, near: {signal: range, min: 0.09m}}
profiles:
  simulation:
    factor: 0.9
    severity: critical
    joints: {elbow: {torque: null, velocity: {signal: elbow.dq, max: 2}}}
    limits: {far: {max: 1m}}
";
    let mut bench = bench(text);
    bench.file("cell/rtf.toml", "[profile.simulation]\n[profile.robot]\n");
    let robot = monitors(&bench.plan(&["s.xml"]));
    assert!(robot.contains("elbow torque: always(abs(tau) <= 7Nm)"), "{robot}");
    bench.options.config_request.profile = Some("simulation".to_owned());
    assert_snapshot!(monitors(&bench.plan(&["s.xml"])), @"
    arm.limits.yaml:2:11 Critical elbow position: always(elbow.q >= -1.85rad and elbow.q <= 0.85rad)
    arm.limits.yaml:8:36 Critical elbow velocity: always(abs(elbow.dq) <= 1.8)
    arm.limits.yaml:3:10 Critical far: always(range <= 0.9m)
    arm.limits.yaml:3:44 Critical near: always(range >= 0.1m)
    ");
    bench.options.config_request.profile = Some("robot".to_owned());
    assert_eq!(monitors(&bench.plan(&["s.xml"])), robot);
}

#[test]
fn all_problems_of_keys_are_reported_at_once() {
    let bench = bench(
        "robbot: ä
model: arm.urdf
severity: warn
factor: 0.5
factor: 0.5
signals: {position: '{joint}.q', speed: x, torque: tau}
ignore: [wheel, wrist]
profiles:
  simulation: {ignored: [], factor: 1.5}
",
    );
    assert_snapshot!(bench.shown(SUITE), @"
    unknown-key: unknown key `robbot`
      1:1 robbot not known in the file
      note: the keys are `robot`, `model`, `severity`, `factor`, `signals`, `ignore`, `joints`, `limits`, `profiles`
      hint: did you mean `robot`?
    invalid-value: `severity` is `warn`, expected one of `fail`, `error`, `stop`, `critical`
      3:11 warn
    duplicate: the key `factor` twice
      5:1 factor the second one
      4:1 factor the first one
    unknown-signal: there is no signal `rail.q`
      6:21 '{joint}.q'
      hint: declare it with `<signal>` in the suite, or write its joint in `ignore`
    unknown-key: unknown key `speed`
      6:34 speed not known in signals
      note: the keys are `position`, `velocity`, `acceleration`, `torque`, `temperature`
    invalid-value: `torque` is `tau`, expected the name of a signal with `{joint}`
      6:52 tau
    unknown-joint: `arm.urdf` has no joint `wrist` that moves
      7:17 wrist
      note: its joints are `elbow`, `rail`, `wheel`
    unknown-key: unknown key `ignored`
      9:16 ignored not known in the file
      note: the keys are `robot`, `model`, `severity`, `factor`, `signals`, `ignore`, `joints`, `limits`, `profiles`
      hint: did you mean `ignore`?
    invalid-value: `factor` is `1.5`, expected a number above 0, at most 1
      9:37 1.5
    unknown-profile: there is no profile `simulation` in `rtf.toml`
      9:3 simulation
    ");
}

#[test]
fn all_problems_of_limits_are_reported_at_once() {
    let bench = bench(
        "model: arm.urdf
factor: 0.5
joints:
  elbow:
    position: {signal: elbow.q, rate-of: elbow.q, min: 2kg}
    velocity: {min: 1, max: fast}
    temperature: {signal: heat}
  elbo: {}
limits:
  cold: {min: 1}
  many: {signal: cuont, max: 3, for: ever}
  range: {signal: range, min: 2m, max: 1m}
  mixed: {signal: range, min: 2m, max: 300cm}
",
    );
    assert_snapshot!(bench.shown(SUITE), @"
    conflicting-keys: a limit has `signal` or `rate-of`, not both
      5:33 rate-of
    unit-mismatch: `elbow position`: the units do not match: `rad/s` and `rad`
      5:42 elbow.q
    unit-mismatch: `elbow position`: the units do not match: `rad/s` and `kg`
      5:56 2kg
    incomplete: the limit needs a signal
      6:5 velocity
      hint: write `signal: …`, or `velocity` in `signals`
    unknown-key: unknown key `min`
      6:16 min not known in the limit `velocity`
      note: the keys are `signal`, `rate-of`, `max`, `for`, `severity`
    invalid-value: `max` is `fast`, expected a number, with or without a unit: `1.05rad`
      6:29 fast
    incomplete: the limit needs a value
      7:5 temperature
      hint: write `max: …`
    unknown-joint: `arm.urdf` has no joint `elbo` that moves
      8:3 elbo
      note: its joints are `elbow`, `rail`, `wheel`
      hint: did you mean `elbow`?
    incomplete: the limit needs a signal
      10:3 cold
      hint: write `signal: …`
    unknown-signal: there is no signal `cuont`
      11:18 cuont
      hint: did you mean `count`?
    invalid-value: `for` is `ever`, expected a duration such as `80ms`
      11:38 ever
    empty-range: `min` is above `max`: 2m > 1m
      12:40 1m
    unit-mismatch: `factor` needs the same unit for `min` and `max`
      13:40 300cm
    ");
}

#[test]
fn a_signal_that_the_suite_lacks_is_not_skipped() {
    let bench = bench("model: arm.urdf\nsignals:\n  position: '{joint}.q'\n");
    assert_snapshot!(bench.shown(SUITE), @"
    unknown-signal: there is no signal `rail.q`
      3:13 '{joint}.q'
      hint: declare it with `<signal>` in the suite, or write its joint in `ignore`
    ");
}

#[test]
fn files_that_cannot_be_read_are_reported_at_their_names() {
    let shown = |limits: &str| bench(limits).shown(SUITE);
    let mut all = String::new();
    for limits in
        ["", "model: none.urdf", "limits: {}", "a: [b", "a: &x 1\nb: *x", "- 1", "x: 1\n---\ny: 2"]
    {
        all += &shown(limits);
    }
    let bench = bench("");
    all += &bench.shown(&SUITE.replace("arm.limits.yaml", "${param:robot}.yaml"));
    all += &bench.shown(&SUITE.replace("arm.limits.yaml", "${param:robot=ur5}.yaml"));
    all += &bench.shown(&SUITE.replace(" file='arm.limits.yaml'", ""));
    assert_snapshot!(all, @"
    incomplete: `arm.limits.yaml` is empty
      1:1  limits are expected here
    no-such-file: there is no file `none.urdf`
      1:8 none.urdf
    incomplete: `arm.limits.yaml` limits nothing
      1:1
      hint: write limits, or `model` and `signals`
    not-yaml: `arm.limits.yaml` is not YAML: while parsing a flow sequence, expected ',' or ']'
      1:6
    not-limits: anchors and aliases are not supported
      1:4 &x 1
      hint: write the value itself
    invalid-value: `the file` is a list, expected a mapping
      1:1 - 1
    not-limits: a second document
      2:1 ---
      hint: a file has one document
    unknown-param: the parameter `robot` has no value
      5:17 ${param:robot}.yaml needed here
      hint: write it under `[param]` in `rtf.toml`, give `--set robot=VALUE`, or a default: `${param:robot=VALUE}`
    no-such-file: there is no file `.yaml`
      5:17 ${param:robot}.yaml
    no-such-file: there is no file `ur5.yaml`
      5:17 ${param:robot=ur5}.yaml
    incomplete: `<envelope>` needs the attribute `file`
      5:1 <envelope
    ");
}

#[test]
fn problems_of_models_are_reported_in_them() {
    let bench = bench("model: m.xml\nsignals: {position: '{joint}.q'}");
    let mut all = String::new();
    for model in [
        "<sdf/>",
        "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:include/></robot>",
        "<robot><joint type='revolute' name='elbow'/><joint type='prismatic'/>
         <joint name='j' type='revolute'><limit lower='a' upper='-1' effort='1 2'/></joint></robot>",
        "<mujoco><worldbody><include file='a.xml'/></worldbody></mujoco>",
        "<mujoco><worldbody><joint name='elbow' range='1 0'/><joint name='b' range='1'/></worldbody></mujoco>",
        "<robot>",
    ] {
        bench.file("cell/m.xml", model);
        all += &bench.shown(SUITE);
    }
    assert_snapshot!(all, @"
    not-a-model: `m.xml` is neither a URDF nor an MJCF: `<sdf>`
      1:1 <sdf
    xacro: `m.xml` is not expanded
      1:52 <xacro:include
      hint: expand it: `xacro arm.urdf.xacro > arm.urdf`
    incomplete: `<joint>` needs a `<limit>`
      1:8 <joint
    incomplete: `<joint>` needs the attribute `name`
      1:45 <joint
    empty-range: the joint `j` cannot move: `lower` is 0, `upper` -1
      2:42 <limit
    invalid-value: `lower` is `a`, expected a number
      2:56 a
    invalid-value: `effort` is `1 2`, expected a number
      2:78 1 2
    not-compiled: `<include>` is not supported in a model
      1:20 <include
      hint: save the compiled model: `mujoco.mj_saveLastXML(file, model)`
    empty-range: `range` is empty: its first number is not the lower one
      1:20 <joint
    invalid-value: `range` is `1`, expected 2 numbers
      1:76 1
    malformed-xml: malformed XML: the file ends before its first element is closed
      1:8
    ");
}

#[test]
fn classes_and_degrees_of_mjcf_apply() {
    let bench = bench("model: m.xml\nsignals: {position: '{joint}.q', torque: '{joint}.dq'}\n");
    let model = "<mujoco><default><joint range='-90 90'/>
<default class='strong'><joint actuatorfrcrange='-3 2'/></default></default><worldbody>
<body childclass='strong'><joint name='elbow'/><body><joint/></body></body></worldbody></mujoco>";
    bench.file("cell/m.xml", model);
    bench.file("cell/s.xml", &SUITE.replace("'elbow.dq' unit='rad/s'", "'elbow.dq' unit='Nm'"));
    assert_snapshot!(monitors(&bench.plan(&["s.xml"])), @"
    m.xml:3:27 Fail elbow position: always(elbow.q >= -1.5707963267948966rad and elbow.q <= 1.5707963267948966rad)
    m.xml:3:27 Fail elbow torque: always(abs(elbow.dq) <= 3Nm)
    ");
    bench.file("cell/m.xml", &model.replace("<mujoco>", "<mujoco><compiler autolimits='false'/>"));
    assert_eq!(bench.problems(&["s.xml"])[0].0, "incomplete");
}

#[test]
fn names_are_unique_and_larger_limits_a_warning() {
    let bench = bench("model: arm.urdf\njoints: {elbow: {position: {signal: elbow.q, max: 2rad}}}");
    let outcome = bench.build(&["s.xml"]);
    let found: Vec<_> = outcome.diagnostics.iter().map(|it| it.message.as_str()).collect();
    assert_eq!(found, ["the limit permits more than the model: 1.5rad at arm.urdf:4:5"]);
    bench.file("cell/rtf.toml", "[profile.simulation]\n");
    bench.file(
        "cell/arm.limits.yaml",
        "limits: {a: {signal: count, max: 2}}\nprofiles: {simulatoin: {}}",
    );
    let shown =
        bench.shown(&SUITE.replace("<test>", "<monitor name='a'>count > 1</monitor><test>"));
    assert_snapshot!(shown, @"
    duplicate-name: a second monitor `a`
      5:1 <envelope from arm.limits.yaml:1:10
      hint: give each file another `robot`, which precedes the names
    unknown-profile: there is no profile `simulatoin` in `rtf.toml`
      2:12 simulatoin
      hint: did you mean `simulation`?
    ");
}
