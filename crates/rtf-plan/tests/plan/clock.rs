//! The additional fixture of a suite with a clock.

use rtf_plan::plan::{FixtureBody, Plan};

use crate::bench::Bench;

fn plan(inside: &str) -> (Bench, Plan) {
    let bench = Bench::new();
    for file in ["cell/A.lua", "cell/F.lua", "share/rtf/fixtures/rtf_fixtures/__init__.py"] {
        bench.file(file, "");
    }
    bench.file("share/rtf/fixtures/clock.py", "");
    // Ignored: only the shipped `clock.py` is used.
    bench.file("cell/clock.py", "");
    bench.file("cell/s.xml", &format!("<suite {inside}<test>A.lua</test></suite>"));
    let plan = bench.plan(&["s.xml"]);
    (bench, plan)
}

#[test]
fn the_shipped_clock_comes_after_all_other_fixtures() {
    let fixture = "<fixture name='clock' depends=''>F</fixture>";
    let fixtures =
        format!("clock='yarp' clock-backstop='3'>{fixture}<fixture depends=''>F</fixture>");
    let (bench, plan) = plan(&fixtures.replace(">F<", ">F.lua<"));
    let suite = &plan.suites[0];
    let names: Vec<_> = suite.fixtures.iter().map(|fixture| fixture.name.as_str()).collect();
    assert_eq!(names, ["clock", "F", "clock#2"]);
    let FixtureBody::Plugin(plugin) = &suite.fixtures[2].body else { panic!("no plug-in") };
    assert_eq!(bench.relative(&plugin.file), "share/rtf/fixtures/clock.py");
    assert_eq!(plugin.args, ["--source", "yarp"]);
    assert_eq!(suite.fixtures[2].depends, [0, 1]);
    assert_eq!(suite.clock.as_ref().map(|clock| clock.backstop), Some(3));
}

#[test]
fn the_wall_clock_needs_no_fixture() {
    let (_, plan) = plan("clock='wall'>");
    assert!(plan.suites[0].fixtures.is_empty());
    assert_eq!(plan.suites[0].clock, None);
}

#[test]
fn a_missing_clock_py_is_reported() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/s.xml", "<suite clock='ros'><test>A.lua</test></suite>");
    let problems = bench.problems(&["s.xml"]);
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(problems[0].1.contains("`clock.py` is missing"), "{problems:?}");
}
