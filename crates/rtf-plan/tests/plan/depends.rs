//! The dependencies between fixtures.

use std::time::Duration;

use insta::assert_snapshot;
use rtf_plan::plan::Plan;

use crate::bench::Bench;

/// A bench with a plug-in and a program.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.program("cell/sim", "");
    bench
}

/// Returns a suite of fixtures with these attributes.
fn suite(fixtures: &[&str]) -> String {
    let fixtures: String = fixtures
        .iter()
        .map(|attributes| format!(" <fixture {attributes}>A.lua</fixture>\n"))
        .collect();
    format!("<suite>\n{fixtures} <test>A.lua</test>\n</suite>")
}

/// Formats each fixture and its dependencies, in the order of set-up.
fn shown(plan: &Plan) -> Vec<String> {
    let fixtures = &plan.suites[0].fixtures;
    let needed = |place: &usize| fixtures[*place].name.as_str();
    fixtures
        .iter()
        .map(|fixture| {
            let depends: Vec<_> = fixture.depends.iter().map(needed).collect();
            format!("{} <- {}", fixture.name, depends.join(" "))
        })
        .collect()
}

fn planned(fixtures: &[&str]) -> Vec<String> {
    let bench = bench();
    bench.file("cell/s.xml", &suite(fixtures));
    shown(&bench.plan(&["s.xml"]))
}

#[test]
fn without_depends_each_needs_the_one_before_it() {
    assert_eq!(planned(&["name='a'", "name='b'", "name='c'"]), ["a <- ", "b <- a", "c <- b"]);
}

#[test]
fn depends_replaces_the_implicit_dependency() {
    let fixtures = ["name='a'", "name='b' depends=''", "name='c' depends='a'", "name='d'"];
    assert_eq!(planned(&fixtures), ["a <- ", "b <- ", "c <- a", "d <- c"]);
}

#[test]
fn fixtures_come_after_their_dependencies_regardless_of_the_order_in_the_file() {
    let fixtures = [
        "name='arm' depends='driver, simulator driver'",
        "name='camera' depends='simulator'",
        "name='driver' depends='simulator'",
        "name='simulator' depends=''",
        "depends=''",
        "",
    ];
    assert_eq!(
        planned(&fixtures),
        [
            "simulator <- ",
            "camera <- simulator",
            "driver <- simulator",
            "arm <- simulator driver",
            "A <- ",
            "A#2 <- A",
        ]
    );
}

#[test]
fn an_order_of_many_fixtures_is_found_quickly_and_without_recursion() {
    let many: Vec<String> = (0..5000)
        .map(|n| {
            if n == 4999 {
                format!("name='f{n}' depends=''")
            } else {
                format!("name='f{n}' depends='f{}'", n + 1)
            }
        })
        .collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    let planned = planned(&many);
    assert_eq!((planned[0].as_str(), planned[4999].as_str()), ("f4999 <- ", "f0 <- f1"));
}

#[test]
fn unknown_names() {
    let text = suite(&["name='simulator' depends='arm'", "name='b' depends='simulater b'"]);
    assert_snapshot!(bench().shown(&text), @"
    unknown-dependency: there is no fixture `arm`
      2:37 arm
    unknown-dependency: there is no fixture `simulater`
      3:29 simulater
      hint: did you mean `simulator`?
    circular-dependency: the fixture `b` depends on itself
      3:39 b
    ");
}

#[test]
fn a_cycle_is_reported_once_and_completely() {
    let text = suite(&[
        "name='x'",
        "name='c' depends='a'",
        "name='a' depends='x b'",
        "name='b' depends='c'",
    ]);
    assert_snapshot!(bench().shown(&text), @"
    circular-dependency: fixtures depend on each other in a circle: `c` → `a` → `b` → `c`
      3:29 a `c` depends on `a`
      4:31 b `a` depends on `b`
      5:29 c `b` depends on `c`
    ");
}

#[test]
fn a_cycle_through_a_fixture_without_depends() {
    let text = suite(&["name='arm' depends='simulator'", "name='simulator'"]);
    assert_snapshot!(bench().shown(&text), @r#"
    circular-dependency: fixtures depend on each other in a circle: `arm` → `simulator` → `arm`
      2:31 simulator `arm` depends on `simulator`
      3:2 <fixture without `depends`, it depends on `arm`, the one before it
      hint: if `simulator` needs no other fixture, give it `depends=""`
    "#);
}

#[test]
fn two_cycles_and_a_long_one() {
    let mut fixtures = vec![
        "name='a' depends='b'".to_owned(),
        "name='b' depends='a'".to_owned(),
        "name='long' depends='f11'".to_owned(),
    ];
    fixtures.extend((0..12).map(|n| format!("name='f{n}'")));
    let fixtures: Vec<&str> = fixtures.iter().map(String::as_str).collect();
    assert_snapshot!(bench().shown(&suite(&fixtures)), @r#"
    circular-dependency: fixtures depend on each other in a circle: `a` → `b` → `a`
      2:29 b `a` depends on `b`
      3:29 a `b` depends on `a`
    circular-dependency: fixtures depend on each other in a circle: `long` → `f11` → `f10` → `f9` → … 6 more … → `f2` → `f1` → `f0` → `long`
      4:32 f11 `long` depends on `f11`
      16:2 <fixture without `depends`, it depends on `f10`, the one before it
      hint: if `f11` needs no other fixture, give it `depends=""`
    "#);
}

#[test]
fn restart_delays() {
    let bench = bench();
    bench.file("cell/s.xml", &suite(&["restart-delay='2s'", ""]));
    let plan = bench.plan(&["s.xml"]);
    let delays: Vec<_> = plan.suites[0].fixtures.iter().map(|f| f.restart_delay).collect();
    assert_eq!(delays, [Duration::from_secs(2), Duration::from_millis(100)]);
    let text = suite(&["restart-delay='11s'", "restart-delay='0'"]);
    assert_snapshot!(bench.shown(&text), @"
    invalid-value: `restart-delay` is longer than 10s, the maximum delay before a restart: `11s`
      2:26 11s
    invalid-value: `restart-delay` must be longer than zero: `0`
      3:26 0
    ");
}

#[test]
fn probes_speak_plain_http() {
    let text = "<suite><fixture type='process'><command>./sim</command>\n\
                <ready http='HTTPS://127.0.0.1/up'/></fixture><test>A.lua</test></suite>";
    assert_snapshot!(bench().shown(text), @r#"
    invalid-value: `http` supports only plain HTTP, not TLS: `HTTPS://127.0.0.1/up`
      2:14 HTTPS://127.0.0.1/up
      hint: probe it with `command="curl -fsS HTTPS://127.0.0.1/up"`
    "#);
}
