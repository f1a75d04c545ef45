//! Faults, and the additional fixture of a suite that has some.

use insta::assert_snapshot;
use rtf_model::{FaultAction, FaultAmount, FaultKind, FaultTarget, FaultsConfig};
use rtf_plan::plan::FixtureBody;

use crate::bench::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    for file in ["cell/A.lua", "cell/B.lua"] {
        bench.file(file, "");
    }
    bench.program("cell/sim", "");
    bench.program("cell/read", "");
    bench
}

const SIMULATOR: &str = "<fixture type='process' name='sim'><command>./sim</command></fixture>";

#[test]
fn faults_become_a_fixture_that_depends_on_all_others() {
    let bench = bench();
    bench.file(
        "cell/s.xml",
        &format!(
            "<suite>{SIMULATOR}<fixture type='process' name='arm'><command>./sim</command></fixture>
             <signal name='q'><command>./read</command></signal>
             <fault name='drop' kind='stop' fixture='sim' process='camera' for='500ms'/>
             <fault name='full' kind='disk' dir='${{port:sim}}/a b' leave='0' at='0'/>
             <test>A.lua<fault name='crash' kind='kill' fixture='arm' at='1s'/></test>
             <test>B.lua<matrix name='n' values='1 2'/>
             <fault name='crash' kind='slow' cpu='5%' fixture='arm' at='1s..2s' seed='3'/></test></suite>"
        ),
    );
    let plan = bench.plan(&["s.xml"]);
    let [.., faults, signals] = &*plan.suites[0].fixtures else { panic!("no fixtures") };
    assert_eq!((faults.name.as_str(), &*faults.depends), ("faults", &[0, 1][..]));
    assert_eq!(signals.name, "signals");
    let FixtureBody::Plugin(plugin) = &faults.body else { panic!("no plug-in") };
    assert_eq!(plugin.host.command, [bench.path("bin/rtf-host-faults")]);
    assert_eq!(plugin.args, ["${port:sim}/a b"]);
    let config: FaultsConfig = serde_json::from_str(&plugin.param).unwrap();
    let [drop, full, crash, slow] = &*config.faults else { panic!("{config:?}") };
    let target = FaultTarget { fixture: "sim".to_owned(), process: Some("camera".to_owned()) };
    assert_eq!(drop.action, FaultAction::Stop(target));
    assert_eq!((drop.at, drop.tests.as_ref()), (None, None));
    assert_eq!(full.action, FaultAction::Disk(FaultAmount::Leave(0)));
    assert_eq!((crash.action.kind(), crash.location.line), (FaultKind::Kill, 5));
    assert!(crash.belongs_to("A") && !crash.belongs_to("B[n=1]"), "{crash:?}");
    assert!(slow.belongs_to("B[n=1]") && slow.belongs_to("B[n=2]"), "{slow:?}");
    assert_eq!(slow.seed, 3);
}

#[test]
fn a_suite_without_faults_has_no_such_fixture() {
    let bench = bench();
    bench.file("cell/s.xml", &format!("<suite>{SIMULATOR}<test>A.lua</test></suite>"));
    assert_eq!(bench.plan(&["s.xml"]).suites[0].fixtures.len(), 1);
}

#[test]
fn every_problem_is_reported_at_its_place() {
    let bench = bench();
    let shown = bench.shown(
        "<suite>
  <fixture type='process' name='faults'><command>./sim</command></fixture>
  <fixture type='process' name='real' attach='true'><alive tcp='1.2.3.4:5'/></fixture>
  <fault name='a' kind='stop' fixture='real'/>
  <fault name='a' kind='stop' fixture='fault'/>
  <fault name='b' kind='kill' fixture='faults' for='1s' cpu='5%'/>
  <fault name='c' kind='stop'/>
  <fault name='d' kind='memory' size='1GB' leave='0' seed='1'/>
  <fault name='e' kind='disk' dir='.'/>
  <test>A.lua</test>
</suite>",
    );
    assert_snapshot!(shown, @"
    reserved-name: a suite with a `<fault>` cannot name a fixture `faults`
      4:3 <fault `rtf` adds a fixture with this name
      hint: give the fixture another `name`
    wrong-type: `real` cannot be broken by a fault: it is attached: `rtf` does not know its processes
      4:40 real
    duplicate-name: two faults are named `a`
      5:16 a the second one
      4:16 a the first one
      hint: give one of them another `name`
    unknown-fixture: there is no fixture `fault`
      5:40 fault
      hint: did you mean `faults`?
    wrong-type: `for` has no effect on a fault of the kind `kill`
      6:48 for
      note: this kind has `fixture`, `process`
    wrong-type: `cpu` has no effect on a fault of the kind `kill`
      6:57 cpu
      note: this kind has `fixture`, `process`
    incomplete: `<fault>` needs the attribute `fixture`: the fixture whose processes are affected
      7:3 <fault
    incomplete: `<fault>` needs one of the attributes `size` and `leave`
      8:3 <fault
    wrong-type: `seed` has no effect without a range in `at` or `for`
      8:54 seed
    incomplete: `<fault>` needs one of the attributes `size` and `leave`
      9:3 <fault
    ");
}

#[test]
fn attributes_of_a_network_that_have_no_effect_are_reported() {
    let bench = bench();
    let shown = bench.shown(
        "<suite isolate='network'>
  <fault name='a' kind='network' jitter='1ms' loss='1%'/>
  <fault name='b' kind='network' refuse='true' port='80' delay='1ms' rate='1Mbit'/>
  <fault name='c' kind='network' port='80'/>
  <fault name='d' kind='network' refuse='perhaps'/>
  <test>A.lua</test>
</suite>",
    );
    assert_snapshot!(shown, @"
    wrong-type: `jitter` has no effect without `delay`
      2:34 jitter
    wrong-type: `delay` has no effect with `refuse`
      3:58 delay
    wrong-type: `rate` has no effect with `refuse`
      3:70 rate
    incomplete: `<fault>` needs one of the attributes `delay`, `loss`, `duplicate`, `rate` and `refuse`
      4:3 <fault
    invalid-value: `refuse` has to be `true` or `false`: `perhaps`
      5:42 perhaps
    ");
}

#[test]
fn a_fault_of_values_needs_a_proxy_and_a_change() {
    let bench = bench();
    bench.file("cell/proxy.py", "");
    let shown = bench.shown(
        "<suite>
  <fixture type='process' name='sim'><command>./sim</command></fixture>
  <fixture type='python' name='proxy'>proxy.py</fixture>
  <fault name='a' kind='values' fixture='sim' field='x' set='1'/>
  <fault name='b' kind='values' fixture='prox' loss='1%'/>
  <fault name='c' kind='values' fixture='proxy' field='x' loss='1%'/>
  <fault name='d' kind='values' fixture='proxy' field='x' freeze='true' offset='1'/>
  <fault name='e' kind='values' fixture='proxy' offset='much' delay='1s'/>
  <fault name='f' kind='values' fixture='proxy' field='x' noise='-1' scale='INF'/>
  <fault name='g' kind='values'/>
  <fault name='h' kind='values' fixture='proxy' field='x' set='NaN' seed='3'/>
  <test>A.lua</test>
</suite>",
    );
    assert_snapshot!(shown, @"
    wrong-type: `sim` is not a proxy: it is no plug-in
      4:42 sim
    unknown-fixture: there is no fixture `prox`
      5:42 prox
      hint: did you mean `proxy`?
    incomplete: `<fault>` needs one of the attributes `set`, `scale`, `offset`, `noise` and `freeze` for `field`
      6:3 <fault
    wrong-type: `offset` has no effect with `freeze`
      7:73 offset
    wrong-type: `offset` has no effect without `field`
      8:49 offset
    invalid-value: `offset` is not a finite number: `much`
      8:57 much
    invalid-value: `noise` is not a standard deviation, 0 or more: `-1`
      9:66 -1
    invalid-value: `scale` is not a finite number: `INF`
      9:77 INF
    incomplete: `<fault>` needs the attribute `fixture`: the proxy whose messages are changed
      10:3 <fault
    incomplete: `<fault>` needs one of the attributes `field`, `loss` and `delay`
      10:3 <fault
    ");
}
