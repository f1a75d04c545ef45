//! Cases of tests, named on the command line or by a filter.

use std::collections::HashMap;

use rtf_model::protocol::CaseSelector;
use rtf_plan::plan::{CaseSelectionOrigin, Plan};
use rtf_plan::select::{Selection, parse, select};
use rtf_plan::suite::SourceText;

use crate::bench::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("cell/A.lua", "");
    bench.file(
        "cell/s.xml",
        "<suite><test name='Arm' isolation='shared'>A.lua</test><test name='Arm/Left'>A.lua</test>\
         <test name='Move'>A.lua<matrix name='joint' values='0 1'/></test></suite>",
    );
    bench
}

fn shown(plan: &Plan) -> Vec<String> {
    let tests = plan.suites.iter().flat_map(|suite| &suite.tests);
    tests
        .map(|test| {
            let cases =
                test.cases.iter().flat_map(|cases| &cases.selectors).map(
                    |selector| match selector {
                        CaseSelector::Equals(path) => format!(" ={path}"),
                        CaseSelector::Contains(text) => format!(" ~{text}"),
                    },
                );
            format!("{}{}", test.name, cases.collect::<String>())
        })
        .collect()
}

#[test]
fn a_path_after_a_test_names_a_case() {
    let bench = bench();
    assert_eq!(shown(&bench.plan(&["s.xml::Arm"])), ["Arm"]);
    assert_eq!(shown(&bench.plan(&["s.xml::Arm/up/slow"])), ["Arm =up/slow"]);
    assert_eq!(shown(&bench.plan(&["s.xml::Arm/Left/up"])), ["Arm/Left =up"]);
    assert_eq!(shown(&bench.plan(&["s.xml::Arm/Left"])), ["Arm/Left"]);
    assert_eq!(shown(&bench.plan(&["s.xml::Arm/a", "s.xml::Arm/b::c"])), ["Arm =a =b::c"]);
    assert_eq!(shown(&bench.plan(&["s.xml::Arm/a", "s.xml::Arm"])), ["Arm"]);
    assert_eq!(bench.problems(&["s.xml::Amr/up"])[0].0, "unknown-test");
    assert_eq!(bench.problems(&["s.xml::Arm/"])[0].0, "unknown-test");
}

/// Only the first test of a shared host knows whether the host can select cases.
#[test]
fn a_test_with_selected_cases_shares_no_host() {
    let bench = bench();
    assert!(bench.plan(&["s.xml::Arm"]).suites[0].tests[0].settings.shared);
    assert!(!bench.plan(&["s.xml::Arm/up"]).suites[0].tests[0].settings.shared);
}

#[test]
fn a_matrix_names_all_its_combinations() {
    let bench = bench();
    let both = ["Move[joint=0]", "Move[joint=1]"];
    assert_eq!(shown(&bench.plan(&["s.xml::Move"])), both);
    assert_eq!(shown(&bench.plan(&["s.xml::Move[joint=1]"])), ["Move[joint=1]"]);
    assert_eq!(shown(&bench.plan(&["s.xml::Move[joint=1]/up"])), ["Move[joint=1] =up"]);
    assert_eq!(shown(&bench.plan(&["s.xml::Move/up"])), both.map(|name| format!("{name} =up")));
}

fn filtered(filter: &str) -> Vec<String> {
    let filters = vec![parse(&SourceText::new("filter", filter)).unwrap()];
    let selection = Selection { filters, ..Selection::default() };
    shown(&select(bench().plan(&["s.xml"]), &selection).plan)
}

#[test]
fn a_filter_selects_parameters() {
    assert_eq!(filtered("param(joint=1)"), ["Move[joint=1]"]);
    assert_eq!(filtered("param(joint)"), ["Move[joint=0]", "Move[joint=1]"]);
    assert_eq!(filtered("!param(~joint)"), ["Arm", "Arm/Left"]);
    assert!(filtered("param(joint=2)").is_empty());
}

#[test]
fn a_filter_selects_cases_of_the_tests_that_it_matches() {
    assert_eq!(filtered("name(=Arm) & case(up)"), ["Arm ~up"]);
    assert_eq!(filtered("name(=Arm) & (case(=up) | case(~slow))"), ["Arm =up ~slow"]);
    assert_eq!(filtered("name(=Arm) | name(/Left/) & case(up)"), ["Arm", "Arm/Left ~up"]);
    assert_eq!(filtered("name(/Arm/) & (name(=Arm) | case(up))"), ["Arm", "Arm/Left ~up"]);
    assert_eq!(filtered("case(up) & none()").len(), 0);
}

#[test]
fn a_filter_cannot_negate_or_intersect_cases() {
    let error = |filter: &str| {
        let problem = parse(&SourceText::new("filter", filter)).unwrap_err();
        let label = &problem.labels[0];
        format!(
            "{}-{}: {}; {}",
            label.start,
            label.end,
            label.text,
            problem.hint.unwrap_or_default()
        )
    };
    let shown = [
        "!case(a)",
        "all() & not (tag(x) | case(a))",
        "case(a) & case(b)",
        "(case(a) | tag(x)) & (tag(y) | case(b))",
        "case(/a.*/)",
        "case()",
    ]
    .map(error);
    insta::assert_snapshot!(shown.join("\n"), @"
    0-8: `case` cannot be negated; select the other cases instead
    8-30: `case` cannot be negated; select the other cases instead
    10-17: `&` cannot combine two conditions on cases; use `|`
    21-39: `&` cannot combine two conditions on cases; use `|`
    5-6: `case` has no regular expressions; `case(~text)` selects cases that contain a text
    5-6: expected a case;
    ");
}

#[test]
fn several_selections_of_cases_conflict() {
    let filters = || vec![parse(&SourceText::new("filter", "case(up)")).unwrap()];
    let named = bench().plan(&["s.xml::Arm/down"]);
    let selected = select(named, &Selection { filters: filters(), ..Selection::default() });
    assert_eq!(selected.problems[0].code, "conflicting-cases");
    let arm = ("s".to_owned(), "Arm".to_owned());
    let down = vec![CaseSelector::Equals("down".to_owned())];
    let only = Some(HashMap::from([(arm, down)]));
    let selection = Selection { filters: filters(), only, ..Selection::default() };
    let selected = select(bench().plan(&["s.xml"]), &selection);
    assert_eq!(selected.problems[0].code, "conflicting-cases");
    let rerun = Selection { filters: Vec::new(), ..selection };
    let selected = select(bench().plan(&["s.xml"]), &rerun);
    assert!(selected.problems.is_empty());
    let cases = &selected.plan.suites[0].tests[0].cases.as_ref().unwrap();
    assert_eq!((cases.origin, cases.needs_support()), (CaseSelectionOrigin::Rerun, false));
}
