//! Some cases of a test: named with `::`, by a filter, and in a rerun.

use rtf_model::Verdict;

use crate::support::Folder;

const TEST: &str = "TestCase = {}
function TestCase.run()
  rtf.case('left', function()
    rtf.case('low', function() end)
    rtf.case('high', function() rtf.check(os.getenv('FIXED') == '1', 'stuck') end)
  end)
  rtf.case('right', function() end)
end
";

const SUITE: &str = "<suite name=\"arm\"><test name=\"Reach\">T.lua</test>\
                     <test name=\"Home\">P.lua</test></suite>";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("T.lua", TEST).file("P.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder.file("arm.xml", SUITE);
    folder
}

/// The verdict of the first test of the newest run, and the paths of its cases.
fn cases(folder: &Folder) -> (Verdict, Vec<String>) {
    let record = folder.journal().record;
    let test = &record.tests[0];
    let kept = test.attempts[0].cases.kept().iter().map(|case| case.path.clone());
    (test.final_verdict(), kept.collect())
}

#[test]
fn a_path_selects_a_case_and_those_that_contain_it() {
    let folder = folder();
    assert_eq!(folder.rtf(&["run", "arm.xml::Reach/left/low"]).code, Some(0));
    assert_eq!(cases(&folder), (Verdict::Passed, vec!["left".into(), "left/low".into()]));
    assert_eq!(folder.rtf(&["run", "arm.xml", "-E", "name(Reach) & case(right)"]).code, Some(0));
    assert_eq!(cases(&folder), (Verdict::Passed, vec!["right".into()]));
    assert_eq!(folder.rtf(&["run", "arm.xml::Reach/rigth"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.tests[0].reason(), Some("the test has no case `rigth`"));
}

#[test]
fn a_rerun_runs_only_the_cases_that_failed() {
    let folder = folder();
    assert_eq!(folder.rtf(&["run", "arm.xml"]).code, Some(1));
    assert_eq!(folder.rtf(&["run", "--rerun", "failed"]).code, Some(1));
    assert_eq!(cases(&folder), (Verdict::Failed, vec!["left".into(), "left/high".into()]));
    let mut command = folder.command(&["run", "--rerun", "failed"]);
    assert!(command.env("FIXED", "1").output().unwrap().status.success());
    assert_eq!(cases(&folder), (Verdict::Passed, vec!["left".into(), "left/high".into()]));
    let record = folder.journal().record;
    let manifest = &record.run.as_ref().unwrap().manifest;
    let names = ("arm".to_owned(), "Reach".to_owned());
    assert_eq!(manifest.only, Some(vec![names.clone()]));
    assert_eq!(manifest.only_cases, [(names.0, names.1, vec!["left/high".to_owned()])]);
}

#[test]
fn a_test_that_failed_outside_of_its_cases_is_rerun_as_a_whole() {
    let folder = folder();
    let text = TEST.replace("\nend\n", "\n  rtf.check(false, 'at the end')\nend\n");
    folder.file("T.lua", &text);
    assert_eq!(folder.rtf(&["run", "arm.xml::Reach"]).code, Some(1));
    assert_eq!(folder.rtf(&["run", "--rerun", "failed"]).code, Some(1));
    assert_eq!(cases(&folder).1, ["left", "left/low", "left/high", "right"]);
}
