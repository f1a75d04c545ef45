//! The selection of tests.

use std::collections::HashMap;
use std::sync::OnceLock;
use std::time::Duration;

use insta::assert_snapshot;
use proptest::prelude::*;
use rtf_plan::plan::Plan;
use rtf_plan::select::{
    PastResult, PastResults, Selection, Shard, ShardBy, TestOrder, parse, select,
};
use rtf_plan::suite::SourceText;

use crate::bench::Bench;

/// Returns two suites with tests of several types and tags.
fn plan() -> Plan {
    let bench = Bench::new();
    for file in ["cell/Joint.lua", "cell/Motor.py", "cell/libArm.so"] {
        bench.file(file, "");
    }
    bench.file(
        "cell/arm.xml",
        "<suite name='arm' tags='sim'>
           <test name='JointLimits' tags='slow'>Joint.lua</test>
           <test name='JointSpeed'>Joint.lua</test>
           <test name='a)b' tags='quick'>Motor.py</test>
         </suite>",
    );
    bench.file(
        "cell/hand.xml",
        "<suite name='hand'><test name='Grasp' tags='slow'>libArm.so</test><test>Motor.py</test></suite>",
    );
    bench.plan(&["arm.xml", "hand.xml"])
}

fn tests(plan: &Plan) -> Vec<String> {
    let suites = plan.suites.iter();
    suites
        .flat_map(|suite| suite.tests.iter().map(|test| format!("{}/{}", suite.name, test.name)))
        .collect()
}

fn selected(filter: &str) -> String {
    let filter = parse(&SourceText::new("filter", filter)).unwrap();
    let selection = Selection { filters: vec![filter], ..Selection::default() };
    tests(&select(plan(), &selection).plan).join(" ")
}

#[test]
fn each_subject_is_compared() {
    assert_eq!(selected("tag(slow)"), "arm/JointLimits hand/Grasp");
    assert_eq!(selected("type(lua)"), "arm/JointLimits arm/JointSpeed");
    assert_eq!(selected("suite(han)"), "hand/Grasp hand/Motor");
    assert_eq!(selected("suite(=han)"), "");
    assert_eq!(selected("file(arm.xml)"), "arm/JointLimits arm/JointSpeed arm/a)b");
    assert_eq!(selected("name(~Joint)"), selected("name( Joint )"));
    assert_eq!(selected("tag(~lo)"), "arm/JointLimits hand/Grasp");
    assert_eq!(selected("tag(lo)"), "");
    assert_eq!(selected(r"name(/^Joint(Li|Sp)\w+$/)"), "arm/JointLimits arm/JointSpeed");
    assert_eq!(selected(r"name(=a\)b)"), "arm/a)b");
    assert_eq!(selected("none()"), "");
}

#[test]
fn and_binds_tighter_than_or_and_not_tightest() {
    let all = selected("all()");
    assert_eq!(selected("tag(slow) & !type(lua) | name(Speed)"), "arm/JointSpeed hand/Grasp");
    assert_eq!(selected("tag(slow) and not type(lua) or name(Speed)"), "arm/JointSpeed hand/Grasp");
    assert_eq!(selected("tag(slow) & !(type(lua) | name(Speed))"), "hand/Grasp");
    assert_eq!(selected("!!all()"), all);
    assert_eq!(selected("not(none())"), all);
}

#[test]
fn suites_without_tests_are_removed_and_the_rest_is_renumbered() {
    let filter = parse(&SourceText::new("filter", "suite(hand)")).unwrap();
    let selection = Selection { filters: vec![filter], ..Selection::default() };
    let selected = select(plan(), &selection);
    assert_eq!((selected.total, selected.plan.tests, selected.plan.suites.len()), (5, 2, 1));
    assert_eq!(selected.plan.suites[0].tests[0].id.0, 0);
}

fn syntax_error(filter: &str) -> String {
    let problem = parse(&SourceText::new("filter", filter)).unwrap_err();
    let label = &problem.labels[0];
    let rest = problem.hint.iter().chain(&problem.notes).map(|more| format!("; {more}"));
    format!("{}-{}: {}{}\n", label.start, label.end, label.text, rest.collect::<String>())
}

#[test]
fn every_syntax_error_has_a_position() {
    let deep = "!".repeat(200) + "all()";
    let invalid = [
        "",
        "tag",
        "tag(",
        "tag(slow",
        "tag()",
        "tga(slow)",
        "tag(slow) tag(quick)",
        "tag(a) &",
        "(tag(a)",
        "name(/x)",
        "name(/[/)",
        "& tag(a)",
        "all(x)",
        "tag(a) | | tag(b)",
        &deep,
    ];
    assert_snapshot!(invalid.map(syntax_error).concat(), @"
    0-0: expected a condition; for example `tag(slow)` or `name(/joint.*/)`
    3-3: expected `(` after `tag`
    4-4: expected a tag
    8-8: expected `)`
    4-5: expected a tag
    0-3: there is no condition `tga`; did you mean `tag`?
    10-13: expected `&`, `|` or the end
    8-8: expected a condition; for example `tag(slow)` or `name(/joint.*/)`
    7-7: expected `)`
    5-6: this `/` is never closed
    5-8: this is not a regular expression; error: unclosed character class
    0-1: expected a condition; for example `tag(slow)` or `name(/joint.*/)`
    4-5: expected `)`
    9-10: expected a condition; for example `tag(slow)` or `name(/joint.*/)`
    100-101: too deeply nested
    ");
}

#[test]
fn unknown_values_are_warned_about() {
    let filter = parse(&SourceText::new("filter", "!tag(slwo) & suite(=Arm)")).unwrap();
    let selection = Selection { filters: vec![filter], ..Selection::default() };
    let warnings = select(plan(), &selection).problems;
    let shown: Vec<_> = warnings.iter().map(|w| (w.message.as_str(), w.hint.as_deref())).collect();
    assert_eq!(
        shown,
        [
            ("no test has the tag `slwo`", Some("did you mean `slow`?")),
            ("no test has the suite `Arm`", Some("did you mean `arm`?"))
        ]
    );
}

#[test]
fn a_seed_determines_the_order_also_of_a_part() {
    let shuffled = |seed, filter: &str| {
        let filters = vec![parse(&SourceText::new("filter", filter)).unwrap()];
        let selection = Selection { filters, shuffle: Some(seed), ..Selection::default() };
        tests(&select(plan(), &selection).plan)
    };
    let all = shuffled(7, "all()");
    assert_eq!(all, shuffled(7, "all()"));
    assert!((0..20).any(|seed| shuffled(seed, "all()") != all));
    let part = shuffled(7, "tag(sim)");
    let of_all: Vec<_> = all.into_iter().filter(|name| name.starts_with("arm/")).collect();
    assert_eq!(part, of_all);
    // The same in every version and on every machine.
    assert_snapshot!(shuffled(42, "all()").join(" "), @"hand/Grasp hand/Motor arm/JointLimits arm/JointSpeed arm/a)b");
}

fn lasts(duration: Duration) -> PastResult {
    PastResult { duration: Some(duration), failed: false }
}

fn by() -> impl Strategy<Value = ShardBy> {
    let time = (0_u64..100).prop_map(Duration::from_secs);
    let times = proptest::collection::vec(time, 40).prop_map(|times| {
        let of = |(place, time)| (("s".to_owned(), format!("t{place}")), lasts(time));
        times.into_iter().enumerate().map(of).collect::<HashMap<_, _>>()
    });
    prop_oneof![Just(ShardBy::Hash), Just(ShardBy::Count), times.prop_map(ShardBy::Duration)]
}

proptest! {
    #[test]
    fn the_parts_make_up_the_whole(count in 1_usize..40, of in 1_u32..9, by in by()) {
        static PLAN: OnceLock<Plan> = OnceLock::new();
        let mut whole = PLAN.get_or_init(plan).clone();
        whole.suites.truncate(1);
        let like = whole.suites[0].tests[0].clone();
        let named = |n| { let mut test = like.clone(); test.name = format!("t{n}"); test };
        whole.suites[0].name = "s".to_owned();
        whole.suites[0].tests = (0..count).map(named).collect();
        let mut parts = Vec::new();
        for index in 1..=of {
            let shard = Some(Shard { index, count: of, by: by.clone() });
            let selection = Selection { shard, ..Selection::default() };
            let part = tests(&select(whole.clone(), &selection).plan);
            if by == ShardBy::Count {
                prop_assert!(part.len().abs_diff(count / of as usize) <= 1);
            }
            parts.extend(part);
        }
        let mut all = tests(&whole);
        all.sort();
        parts.sort();
        prop_assert_eq!(parts, all);
    }
}

#[test]
fn parts_take_about_equally_long() {
    let mut whole = plan();
    let times = [("JointLimits", 50), ("JointSpeed", 30), ("a)b", 20)];
    let times = times.map(|(name, secs)| {
        (("arm".to_owned(), name.to_owned()), lasts(Duration::from_secs(secs)))
    });
    whole.suites.truncate(1);
    let part = |index| {
        let by = ShardBy::Duration(times.clone().into());
        let selection =
            Selection { shard: Some(Shard { index, count: 2, by }), ..Selection::default() };
        tests(&select(whole.clone(), &selection).plan).join(" ")
    };
    assert_eq!((part(1).as_str(), part(2).as_str()), ("arm/JointLimits", "arm/JointSpeed arm/a)b"));
}

#[test]
fn a_test_is_selected_by_file_and_name() {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file(
        "cell/s.xml",
        "<suite><test name='x'>A.lua</test><test name='a::b'>A.lua</test></suite>",
    );
    assert_eq!(tests(&bench.plan(&["s.xml::a::b"])), ["s/a::b"]);
    assert_eq!(tests(&bench.plan(&["s.xml::a::b", "s.xml::x"])), ["s/x", "s/a::b"]);
    assert_eq!(tests(&bench.plan(&["s.xml::x", "s.xml"])).len(), 3);
    let problems = bench.problems(&["s.xml::y", "s.xml::x"]);
    assert_eq!(
        problems,
        [("unknown-test".to_owned(), "there is no test `y` in `s.xml`".to_owned())]
    );
    assert_eq!(bench.problems(&["t.xml::y"])[0].0, "no-such-file");
}

/// Returns the tests of a suite `s` after they are ordered by past results: `t1` … in `suites`;
/// `past`: the test, whether it has failed, and its duration in seconds.
fn ordered(order: TestOrder, suites: &str, past: &[(&str, bool, u64)]) -> String {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file("cell/B.py", "");
    let suites: Vec<_> = suites.split("---").collect();
    let names: Vec<_> = (0..suites.len()).map(|number| format!("{number}.xml")).collect();
    for (name, suite) in names.iter().zip(suites) {
        bench.file(&format!("cell/{name}"), suite);
    }
    let plan = bench.plan(&names.iter().map(String::as_str).collect::<Vec<_>>());
    let past: PastResults = past
        .iter()
        .map(|(name, failed, secs)| {
            let (suite, test) = name.split_once('/').unwrap();
            let duration = Some(Duration::from_secs(*secs)).filter(|time| !time.is_zero());
            ((suite.to_owned(), test.to_owned()), PastResult { failed: *failed, duration })
        })
        .collect();
    let selection = Selection { order: Some((order, past)), ..Selection::default() };
    tests(&select(plan, &selection).plan).join(" ")
}

const THREE: &str = "<suite name='s'><test name='a'>A.lua</test><test name='b'>A.lua</test>
                     <test name='c'>A.lua</test></suite>";

#[test]
fn failed_tests_run_first_and_the_others_keep_their_order() {
    let order = |past: &[_]| ordered(TestOrder::FailedFirst, THREE, past);
    assert_eq!(order(&[]), "s/a s/b s/c");
    assert_eq!(order(&[("s/c", true, 1), ("s/b", false, 9)]), "s/c s/a s/b");
    assert_eq!(order(&[("s/c", true, 1), ("s/b", true, 1)]), "s/b s/c s/a");
}

#[test]
fn slow_tests_run_first_and_unknown_ones_are_of_medium_duration() {
    let order = |past: &[_]| ordered(TestOrder::SlowestFirst, THREE, past);
    assert_eq!(order(&[]), "s/a s/b s/c");
    assert_eq!(order(&[("s/a", true, 1), ("s/b", false, 2), ("s/c", false, 9)]), "s/c s/b s/a");
    assert_eq!(order(&[("s/a", false, 1), ("s/c", false, 2)]), "s/b s/c s/a");
}

#[test]
fn nothing_crosses_a_critical_test() {
    let suite = "<suite name='s'><test name='a'>A.lua</test><test name='b'>A.lua</test>
                 <test name='c' critical='true'>A.lua</test><test name='d'>A.lua</test>
                 <test name='e'>A.lua</test></suite>";
    let past = [("s/c", true, 1), ("s/b", true, 1), ("s/e", true, 1)];
    assert_eq!(ordered(TestOrder::FailedFirst, suite, &past), "s/b s/a s/c s/e s/d");
}

#[test]
fn tests_with_one_host_stay_together() {
    let suite = "<suite name='s'><test name='a' isolation='shared'>A.lua</test>
                 <test name='b' isolation='shared'>A.lua</test>
                 <test name='c' isolation='shared'>B.py</test><test name='d'>A.lua</test></suite>";
    let past = [("s/a", false, 2), ("s/b", false, 4), ("s/c", false, 7), ("s/d", false, 5)];
    assert_eq!(ordered(TestOrder::SlowestFirst, suite, &past), "s/c s/b s/a s/d");
    let past = [("s/b", true, 1)];
    assert_eq!(ordered(TestOrder::FailedFirst, suite, &past), "s/b s/a s/c s/d");
}

#[test]
fn suites_are_ordered_unless_one_of_them_stops_the_run() {
    let suites = "<suite name='x'><test name='a'>A.lua</test></suite>---
                  <suite name='y'><test name='a'>A.lua</test></suite>---
                  <suite name='z'><test name='a'>A.lua</test></suite>";
    let past = [("z/a", true, 3), ("y/a", false, 2)];
    assert_eq!(ordered(TestOrder::FailedFirst, suites, &past), "z/a x/a y/a");
    assert_eq!(ordered(TestOrder::SlowestFirst, suites, &past), "x/a z/a y/a");
    let stops = suites.replace(
        "<suite name='y'><test",
        "<suite name='y' critical-stops='run'><test critical='true'",
    );
    assert_eq!(ordered(TestOrder::FailedFirst, &stops, &past), "x/a y/a z/a");
}

#[test]
fn shards_know_whether_they_were_computed_from_equal_durations() {
    let assignment = |by, index| {
        let shard = Some(Shard { index, count: 2, by });
        let mut plan = plan();
        plan.suites.truncate(1);
        select(plan, &Selection { shard, ..Selection::default() }).shard_assignment
    };
    let by = |limits| {
        let times = [("JointLimits", limits), ("JointSpeed", 30), ("a)b", 20)];
        let past = times.map(|(name, secs)| {
            (("arm".to_owned(), name.to_owned()), lasts(Duration::from_secs(secs)))
        });
        ShardBy::Duration(past.into())
    };
    assert_eq!(assignment(by(50), 1), assignment(by(50), 2));
    assert_ne!(assignment(by(50), 1), assignment(by(1), 1));
    assert_eq!(assignment(ShardBy::Hash, 1), None);
}

/// A chain of operands once was a tree of their depth, which overflowed the stack when it was
/// applied or dropped.
#[test]
fn a_filter_may_have_many_operands() {
    let check = || {
        for (operator, expected) in [("|", 5), ("&", 0)] {
            let filter = ["name(Joint)", "all()"].repeat(20_000).join(operator);
            let filter = parse(&SourceText::new("filter", format!("{filter}{operator}none()")));
            let selection = Selection { filters: vec![filter.unwrap()], ..Selection::default() };
            assert_eq!(tests(&select(plan(), &selection).plan).len(), expected, "{operator}");
        }
    };
    let thread = std::thread::Builder::new().stack_size(512 * 1024).spawn(check);
    thread.unwrap().join().unwrap();
}
