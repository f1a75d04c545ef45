//! Signals and monitors, and the additional fixture of a suite that has some.

use insta::assert_snapshot;
use rtf_model::{
    FindingSeverity, ProcessQuantity, SignalSource, SignalTime, SignalsConfig, TestQuantity,
};
use rtf_plan::plan::{FixtureBody, Plan, PluginPlan};

use crate::bench::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    for file in ["cell/A.lua", "cell/B.lua"] {
        bench.file(file, "");
    }
    bench.program("cell/read", "");
    bench.program("cell/sim", "");
    bench
}

const SIMULATOR: &str = "<fixture type='process' name='sim'><command>./sim</command></fixture>";

pub fn signals(plan: &Plan) -> (&PluginPlan, SignalsConfig) {
    let fixture = plan.suites[0].fixtures.last().unwrap();
    let FixtureBody::Plugin(plugin) = &fixture.body else { panic!("no plug-in") };
    (plugin, serde_json::from_str(&plugin.param).unwrap())
}

#[test]
fn signals_become_a_fixture_that_depends_on_all_others() {
    let bench = bench();
    let suite = format!(
        "<suite>{SIMULATOR}<fixture type='process' name='signals' depends=''>\
         <command>./sim</command></fixture>
         <signals time='own' wait='false'><command>./read ${{port:sim}} 'a b'</command>\
         <signal name='q' unit='rad'/><signal name='arm/dq' unit='rad/s'/></signals>
         <signal name='load' fixture='sim' of='cpu' every='1s'/>
         <signal name='memory' fixture='signals' of='rss'/>
         <signal name='torque'><command>./read t</command></signal>
         <monitor name='slow' severity='stop'>always(\"arm/dq\" &lt; 2 rad/s)</monitor>
         <test>A.lua<monitor name='end'>eventually(q > 1)</monitor></test>
         <test>B.lua<matrix name='n' values='1 2'/>
         <monitor name='end'>memory &lt; 10 MiB and load >= 0</monitor></test></suite>"
    );
    bench.file("cell/s.xml", &suite.replace("2 rad/s", "2rad/s").replace("10 MiB", "10MiB"));
    let plan = bench.plan(&["s.xml"]);
    let fixture = plan.suites[0].fixtures.last().unwrap();
    assert_eq!((fixture.name.as_str(), &*fixture.depends), ("signals#2", &[0, 1][..]));
    let (plugin, config) = signals(&plan);
    assert_eq!(&*plugin.plugin_type, "signals");
    assert_eq!(plugin.host.command, [bench.path("bin/rtf-host-signals")]);
    let read = bench.path("cell/read");
    assert_eq!(plugin.args, [&read, "${port:sim}", "a b", &read, "t"]);
    let [SignalSource::Program(pair), SignalSource::Fixture(load), memory, _] = &*config.sources
    else {
        panic!("{config:?}")
    };
    assert_eq!((pair.words, pair.time, pair.wait), (3, SignalTime::Own, false));
    assert_eq!((&*pair.signals[1].name, &*pair.signals[1].unit), ("arm/dq", "rad/s"));
    assert_eq!((&*load.fixture, load.quantity), ("sim", ProcessQuantity::Cpu));
    assert_eq!(load.every_ms, 1000);
    assert!(matches!(memory, SignalSource::Fixture(memory) if memory.signal.unit == "MiB"));
    let monitors: Vec<_> = config.monitors.iter().map(|it| (&*it.name, it.severity)).collect();
    let fail = FindingSeverity::Fail;
    assert_eq!(monitors, [("slow", FindingSeverity::Stop), ("end", fail), ("end", fail)]);
    assert_eq!(config.monitors[0].location.to_string(), "s.xml:6");
    assert!(config.monitors[0].judges("A") && !config.monitors[2].judges("A"));
    let tests = config.monitors[2].tests.as_deref();
    assert_eq!(tests, Some(&["B[n=1]".to_owned(), "B[n=2]".to_owned()][..]));
}

/// One program reads all topics.
#[test]
fn topics_of_ros_share_a_program() {
    let bench = bench();
    bench.file("share/rtf/fixtures/rtf_fixtures/ros1_signals.py", "");
    bench.file(
        "cell/s.xml",
        "<suite><signal name='q' ros='/joint_states.position[elbow]'/>\
         <signal name='t'><command>./read t</command></signal>\
         <signal name='v' unit='m/s' ros='/odom.twist.twist.linear.x'/><test>A.lua</test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    let (plugin, config) = signals(&plan);
    let script = bench.path("share/rtf/fixtures/rtf_fixtures/ros1_signals.py");
    let python = bench.path("bin/python3");
    let fields = ["/joint_states.position[elbow]", "/odom.twist.twist.linear.x"];
    let program: [&str; 4] = [&python, &script, fields[0], fields[1]];
    assert_eq!(plugin.args[2..], program);
    let [_, SignalSource::Program(topics)] = &*config.sources else { panic!("{config:?}") };
    let names: Vec<_> = topics.signals.iter().map(|signal| &*signal.name).collect();
    assert_eq!((topics.words, names), (4, vec!["q", "v"]));
    assert_eq!((topics.time, topics.wait), (SignalTime::Clock, true));
}

#[test]
fn a_suite_without_signals_has_no_such_fixture() {
    let bench = bench();
    bench.file("cell/s.xml", "<suite><test>A.lua</test></suite>");
    assert!(bench.plan(&["s.xml"]).suites[0].fixtures.is_empty());
}

#[test]
fn all_problems_of_signals_are_reported() {
    let bench = bench();
    let shown = bench.shown(&format!(
        "<suite>{SIMULATOR}
         <fixture type='process' name='robot' attach='true'><ready tcp='127.0.0.1:1'/></fixture>
         <signal name='q' unit='rad'/>
         <signal name='q' fixture='simm' of='cpu'/>
         <signal name='load' fixture='robot' of='threads' unit='%'/>
         <signal name='l' fixture='robot' of='fds'/>
         <signal name='both' fixture='sim' of='cpu'><command>./read</command></signal>
         <signal name='&quot;a'><command>./read</command></signal>
         <signal name='t'><command>./nothing</command></signal>
         <signal name='t'><command>./read</command></signal>
         <signals><signal/></signals>
         <signals time='later'><command>./read</command></signals>
         <test>A.lua</test></suite>"
    ));
    assert_snapshot!(shown, @r#"
    incomplete: `<signal>` needs a source: a `<command>`, `ros`, `ros2`, `yarp`, `file` and `topic`, `test`, or `fixture` and `of`
      3:10 <signal
    unknown-fixture: there is no fixture `simm`
      4:36 simm
      hint: did you mean `sim`?
    invalid-value: `of` has to be `cpu` or `rss` or `fds`: `threads`
      5:50 threads
    wrong-type: `unit` is fixed for a signal with `fixture`
      5:59 unit
    wrong-type: `robot` cannot be measured: it is attached: `rtf` does not know its processes
      6:36 robot
    several-sources: a signal has one source: a `<command>`, `ros`, `ros2`, `yarp`, `file`, `test` or `fixture`
      7:30 fixture a second source
    invalid-value: `name` is not the name of a signal: `"a`
      8:24 &quot;a
      hint: a name has no quotes and no control characters
    no-such-program: there is no program `./nothing`
      9:36 ./nothing
      note: looked for [ROOT]/cell/nothing
    duplicate-name: two signals are named `t`
      10:24 t the second one
      9:24 t the first one
      hint: give one of them another `name`
    incomplete: `<signals>` needs a `<command>` that writes the samples
      11:10 <signals
    incomplete: `<signal>` needs the attribute `name`
      11:19 <signal
    incomplete: `<signals>` needs a `<signal>` for each value on a line
      12:10 <signals
    invalid-value: `time` has to be `clock` or `own` or `arrival`: `later`
      12:25 later
    "#);
}

#[test]
fn all_problems_of_monitors_are_reported_at_their_place_in_the_text() {
    let bench = bench();
    let shown = bench.shown(
        "<suite><signals><command>./read</command><signal name='elbow' unit='rad'/>\
         <signal name='goal' unit='m'/></signals>
         <monitor name='a'>always(elbow &lt; 2 &amp;&amp; elbow > 1)</monitor>
         <monitor name='b'>1 &gt; elbw or wrist > 1</monitor>
         <monitor name='b'>elbow - goal &lt;= 0.05</monitor>
         <monitor severity='warn'/>
         <test>A.lua<monitor name='a'>goal &lt; 1kg</monitor></test></suite>",
    );
    assert_snapshot!(shown, @"
    invalid-formula: unexpected `&&`
      2:48 &amp;&amp;
      hint: write `and`
    unknown-signal: there is no signal `elbw`
      3:35 elbw
      hint: did you mean `elbow`?
    unknown-signal: there is no signal `wrist`
      3:43 wrist
      note: the suite has `elbow`, `goal`
    duplicate-name: two monitors are named `b`
      4:25 b the second one
      3:25 b the first one
      hint: give one of them another `name`
    unit-mismatch: the units do not match: `rad` and `m`
      4:36 goal
    incomplete: `<monitor>` needs the attribute `name`
      5:10 <monitor
    incomplete: `<monitor>` needs a formula as its text
      5:10 <monitor
    invalid-value: `severity` has to be `fail` or `error` or `stop` or `critical`: `warn`
      5:29 warn
    duplicate-name: two monitors are named `a`
      6:36 a the second one
      2:25 a the first one
      hint: give one of them another `name`
    unit-mismatch: the units do not match: `m` and `kg`
      6:49 1kg
    ");
}

#[test]
fn a_monitor_needs_signals() {
    let bench = bench();
    let shown = bench
        .shown("<suite><test>A.lua<monitor name='a'>always(q &lt; 1)</monitor></test></suite>");
    assert_snapshot!(shown, @"
    unknown-signal: there is no signal `q`
      1:44 q
      hint: declare it with `<signal>` in the suite
    ");
}

#[test]
fn formulas_have_parameters() {
    let bench = bench();
    bench.program("bin/true", "");
    bench.file(
        "cell/s.xml",
        "<suite><signal name='q' unit='rad' test='sample'/>
         <monitor name='low'>always(q &lt; ${param:limit=2}rad)</monitor>
         <test>A.lua<matrix name='limit' values='1 3'/>
         <monitor name='own'>always(q &lt; ${param:limit}rad)</monitor></test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    let (_, config) = signals(&plan);
    let monitors: Vec<_> =
        config.monitors.iter().map(|it| (&*it.formula, it.tests.as_deref())).collect();
    let test = |name: &str| vec![name.to_owned()];
    assert_eq!(
        monitors,
        [
            ("always(q < 2rad)", None),
            ("always(q < 1rad)", Some(&*test("A[limit=1]"))),
            ("always(q < 3rad)", Some(&*test("A[limit=3]"))),
        ]
    );
    let shown = bench.shown(
        "<suite><signal name='q' unit='rad' test='sample'/>
         <test>A.lua<matrix name='limit' values='1 3'/>
         <monitor name='own'>always(q &lt; ${param:limit}kg)</monitor></test></suite>",
    );
    assert_snapshot!(shown, @"
    unit-mismatch: the units do not match: `rad` and `kg`
      3:30 always(q &lt; ${param:limit}kg)
      note: with its parameters, the formula is `always(q < 1kg)`
    unit-mismatch: the units do not match: `rad` and `kg`
      3:30 always(q &lt; ${param:limit}kg)
      note: with its parameters, the formula is `always(q < 3kg)`
    ");
}

#[test]
fn sources_of_other_kinds_are_planned() {
    let bench = bench();
    for program in ["ros2_signals", "yarp_signals", "recorded_signals"] {
        bench.file(&format!("share/rtf/fixtures/rtf_fixtures/{program}.py"), "");
    }
    bench.file("cell/run.mcap", "");
    bench.file("share/rtf/fixtures/clock.py", "");
    bench.file(
        "cell/s.xml",
        "<suite clock='ros2'><signal name='v' unit='m/s' ros2='/odom.twist.twist.linear.x'/>
         <signal name='roll' yarp='/imu:o[0][2]'/>
         <signal name='level' file='run.mcap' topic='/level'/>
         <signal name='pitch' yarp='/imu:o[0][3]'/>
         <signal name='limit' file='run.mcap' topic='/limits.data[0]'/>
         <signal name='lag' test='measurement'/><test>A.lua</test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    let (plugin, config) = signals(&plan);
    let words: Vec<_> = plugin
        .args
        .iter()
        .map(|word| word.rsplit_once("/rtf_fixtures/").map_or(&**word, |(_, name)| name))
        .filter(|word| !word.ends_with("python3"))
        .collect();
    assert_eq!(
        words,
        [
            "ros2_signals.py",
            "--clock",
            "/odom.twist.twist.linear.x",
            "yarp_signals.py",
            "--clock",
            "/imu:o[0][2]",
            "/imu:o[0][3]",
            "recorded_signals.py",
            "run.mcap",
            "/level",
            "/limits.data[0]",
        ]
    );
    let [SignalSource::Test(lag), SignalSource::Program(_), SignalSource::Program(imu), recorded] =
        &*config.sources
    else {
        panic!("{config:?}")
    };
    assert_eq!((&*lag.signal.name, lag.quantity), ("lag", TestQuantity::Measurement));
    assert_eq!((imu.words, imu.signals.len()), (5, 2));
    let SignalSource::Recording(recorded) = recorded else { panic!("{recorded:?}") };
    assert_eq!((recorded.words, recorded.signals.len()), (5, 2));
}

#[test]
fn all_problems_of_sources_are_reported() {
    let bench = bench();
    for program in ["ros1_signals", "recorded_signals"] {
        bench.file(&format!("share/rtf/fixtures/rtf_fixtures/{program}.py"), "");
    }
    let shown = bench.shown(
        "<suite><signal name='a' ros2='/odom'/>
         <signal name='b' yarp='/arm/state:o'/>
         <signal name='c' file='run.mcap'/>
         <signal name='d' file='run.mcap' topic='level' time='own'/>
         <signal name='e' test='samples' topic='/level'/>
         <signal name='f' file='run.mcap' topic='/level'/>
         <signal name='g' yarp='/arm/state:o[0]' ros='/a.b'/>
         <test>A.lua</test></suite>",
    );
    assert_snapshot!(shown, @"
    invalid-value: `ros2` is not a field of a topic: `/odom`
      1:31 /odom
      hint: write a topic and a field: `/joint_states.position[elbow]`, `/odom.twist.twist.linear.x`
    invalid-value: `yarp` is not a value of a port: `/arm/state:o`
      2:33 /arm/state:o
      hint: write a port and the position of a value in its bottle: `/arm/state:o[3]`, `/imu:o[0][2]`
    incomplete: `<signal>` needs the attribute `topic`: the value in the recording
      3:10 <signal
    invalid-value: `topic` is not a value in a recording: `level`
      4:50 level
      hint: write a topic, and the field of a message or the position in a bottle: `/level`, `/joint_states.position[elbow]`, `/arm/state:o[3]`
    wrong-type: `time` is only for a signal with a `<command>`
      4:57 time
    invalid-value: `test` has to be `sample` or `measurement`: `samples`
      5:33 samples
      hint: did you mean `sample`?
    wrong-type: `topic` is only for a signal with `file`
      5:42 topic
    no-such-file: there is no recording `run.mcap`
      6:33 run.mcap
      note: looked for [ROOT]/cell/run.mcap
    several-sources: a signal has one source: a `<command>`, `ros`, `ros2`, `yarp`, `file`, `test` or `fixture`
      7:27 yarp a second source
    ");
}
