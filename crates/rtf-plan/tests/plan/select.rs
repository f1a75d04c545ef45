//! The selection of tests.

use std::collections::HashMap;
use std::sync::OnceLock;
use std::time::Duration;

use insta::assert_snapshot;
use proptest::prelude::*;
use rtf_plan::plan::Plan;
use rtf_plan::select::{Selection, Shard, ShardBy, parse, select};
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

fn by() -> impl Strategy<Value = ShardBy> {
    let time = (0_u64..100).prop_map(Duration::from_secs);
    let times = proptest::collection::vec(time, 40).prop_map(|times| {
        let of = |(place, time)| (("s".to_owned(), format!("t{place}")), time);
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
    let times =
        times.map(|(name, secs)| (("arm".to_owned(), name.to_owned()), Duration::from_secs(secs)));
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
