//! Cases that are listed before the run: selected by `cases`, by name and by a filter.

use std::collections::HashMap;

use rtf_model::protocol::CaseSelector;
use rtf_plan::plan::{CheckAnswer, CheckReport, ListedCase, Plan, PlanOutcome};
use rtf_plan::select::{Selected, Selection, parse, select};
use rtf_plan::suite::SourceText;

use crate::bench::Bench;

const CASES: [&str; 6] = [
    "Arm.Moves",
    "Arm.IsSlow",
    "Speeds/Arm.Reaches/0",
    "Speeds/Arm.Reaches/1",
    "load",
    "a,b[\"ü\"]",
];

fn bench(attributes: &str) -> Bench {
    let bench = Bench::new();
    bench.program("cell/arm_test", "exit 0");
    bench.file(
        "cell/s.xml",
        &format!("<suite>\n<test type='gtest' {attributes}>arm_test</test>\n</suite>"),
    );
    bench
}

/// Completes a plan with hosts that list `cases` for each file.
fn finish(bench: &Bench, paths: &[&str], cases: Option<&[&str]>) -> PlanOutcome {
    let draft = bench.draft(paths);
    let case = |name: &&str| ListedCase { name: (*name).to_owned(), ..ListedCase::default() };
    let report = |file: &std::path::Path| CheckReport {
        file: file.display().to_string(),
        ok: true,
        message: None,
        line: None,
        kinds: None,
        cases: cases.map(|cases| cases.iter().map(case).collect()),
    };
    let answers = draft
        .check_groups()
        .iter()
        .map(|group| group.files().map(|file| CheckAnswer::Report(report(file))).collect());
    let answers = answers.collect();
    draft.finish(answers)
}

fn plan(attributes: &str, path: &str) -> Plan {
    let outcome = finish(&bench(attributes), &[path], Some(&CASES));
    outcome.plan.unwrap_or_else(|| panic!("{:#?}", outcome.diagnostics))
}

/// Returns the selected cases of all tests; one without a selection runs all of them.
fn selected(plan: &Plan) -> Vec<String> {
    let tests = plan.suites.iter().flat_map(|suite| &suite.tests);
    tests
        .flat_map(|test| match &test.cases {
            None => vec!["all".to_owned()],
            Some(cases) => cases
                .selectors
                .iter()
                .map(|selector| match selector {
                    CaseSelector::Equals(path) => path.clone(),
                    CaseSelector::Contains(text) => format!("~{text}"),
                })
                .collect(),
        })
        .collect()
}

fn problems(attributes: &str, path: &str) -> Vec<String> {
    let outcome = finish(&bench(attributes), &[path], Some(&CASES));
    assert!(outcome.plan.is_none());
    let shown = |found: rtf_model::Diagnostic| {
        let place = found.labels.first().map(|it| format!("{}:{}: ", it.line, it.column));
        let hint = found.hint.map(|hint| format!(" ({hint})"));
        format!("{}{}{}", place.unwrap_or_default(), found.message, hint.unwrap_or_default())
    };
    outcome.diagnostics.into_iter().map(shown).collect()
}

#[test]
fn all_cases_are_listed_and_none_is_selected() {
    let plan = plan("", "s.xml");
    assert_eq!(selected(&plan), ["all"]);
    let listed = plan.suites[0].tests[0].listed_cases().unwrap();
    assert_eq!(listed.len(), CASES.len());
}

#[test]
fn patterns_select_cases() {
    assert_eq!(selected(&plan("cases='Arm.* !*Slow load'", "s.xml")), ["Arm.Moves", "load"]);
    assert_eq!(
        selected(&plan("cases='!Speeds/* !a,*'", "s.xml")),
        ["Arm.Moves", "Arm.IsSlow", "load"]
    );
    let parameters = "cases='${param:joint}.Mo*'";
    let bench = bench(parameters);
    bench.file("cell/rtf.toml", "[param]\njoint = 'Arm'\n");
    let outcome = finish(&bench, &["s.xml"], Some(&CASES));
    assert_eq!(selected(&outcome.plan.unwrap()), ["Arm.Moves"]);
}

#[test]
fn a_pattern_that_matches_nothing_is_an_error() {
    assert_eq!(
        problems("cases='Arm.* Amr.*'", "s.xml"),
        ["2:27: no case of the test `arm_test` matches `Amr.*` (did you mean `Arm.*`?)"]
    );
    // Once for all combinations of a matrix.
    let bench = bench("cases='nothing'");
    bench.file(
        "cell/s.xml",
        "<suite><test type='gtest' cases='nothing'>arm_test\
         <matrix name='a' values='1 2 3'/></test></suite>",
    );
    assert_eq!(finish(&bench, &["s.xml"], Some(&CASES)).diagnostics.len(), 1);
}

#[test]
fn a_host_without_a_list_cannot_select_by_patterns() {
    let outcome = finish(&bench("cases='Arm.*'"), &["s.xml"], None);
    assert_eq!(outcome.diagnostics[0].code, "no-cases");
    assert_eq!(outcome.diagnostics[0].labels[0].line, 2);
    let outcome = finish(&bench(""), &["s.xml::arm_test/any"], None);
    assert_eq!(selected(&outcome.plan.unwrap()), ["any"]);
}

#[test]
fn a_named_case_must_be_listed() {
    let named = |case: &str| selected(&plan("", &format!("s.xml::arm_test/{case}")));
    for case in CASES {
        assert_eq!(named(case), [case]);
    }
    assert_eq!(named("Speeds"), CASES[2..4]);
    assert_eq!(named("Arm.Moves/a section"), ["Arm.Moves/a section"]);
    assert_eq!(
        problems("", "s.xml::arm_test/Arm.Mvoes"),
        ["there is no case `Arm.Mvoes` in the test `arm_test` (did you mean `Arm.Moves`?)"]
    );
    let outcome = finish(&bench(""), &["s.xml::arm_test/Arm"], Some(&CASES));
    let found = &outcome.diagnostics[0];
    assert_eq!(found.message, "there is no case `Arm` in the test `arm_test`");
    assert_eq!(
        found.notes,
        ["its cases are `Arm.Moves`, `Arm.IsSlow`, `Speeds/Arm.Reaches/0`, \
          `Speeds/Arm.Reaches/1`, `load` and 1 more"]
    );
}

#[test]
fn patterns_and_names_select_common_cases() {
    let both =
        |case: &str| selected(&plan("cases='Speeds/* !*1'", &format!("s.xml::arm_test/{case}")));
    assert_eq!(both("Speeds"), ["Speeds/Arm.Reaches/0"]);
    assert_eq!(
        problems("cases='Speeds/* !*1'", "s.xml::arm_test/load"),
        ["2:27: `cases` of the test `arm_test` excludes the case `load`"]
    );
}

fn filtered(attributes: &str, path: &str, filter: &str) -> Selected {
    let filters = vec![parse(&SourceText::new("filter", filter)).unwrap()];
    select(plan(attributes, path), &Selection { filters, ..Selection::default() })
}

#[test]
fn a_filter_selects_common_cases() {
    let both = |attributes: &str, path: &str, filter: &str| {
        let selection = filtered(attributes, path, filter);
        assert!(selection.problems.is_empty());
        selected(&selection.plan)
    };
    assert_eq!(both("", "s.xml", "case(~Arm)"), CASES[..4]);
    assert_eq!(both("cases='Speeds/*'", "s.xml", "case(~Arm)"), CASES[2..4]);
    assert_eq!(both("", "s.xml::arm_test/Arm.Moves", "case(~Arm)"), ["Arm.Moves"]);
    assert_eq!(both("", "s.xml", "case(=load)"), ["load"]);
    // A test without a selected case does not run.
    assert_eq!(both("", "s.xml", "case(~nothing)"), [""; 0]);
    assert_eq!(both("cases='load'", "s.xml", "case(~Arm)"), [""; 0]);
}

#[test]
fn a_rerun_keeps_cases_that_vanished() {
    let cases = ["load", "gone"].map(|path| CaseSelector::Equals(path.to_owned())).to_vec();
    let only = HashMap::from([(("s".to_owned(), "arm_test".to_owned()), cases)]);
    let selection = Selection { only: Some(only), ..Selection::default() };
    assert_eq!(selected(&select(plan("", "s.xml"), &selection).plan), ["load", "gone"]);
}
