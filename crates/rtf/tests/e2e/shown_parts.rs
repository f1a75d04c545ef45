//! `rtf show --single-test` and `--without-tests`, and links to runs.

use insta::assert_snapshot;

use crate::support::Folder;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("P.lua", "TestCase = {}\nfunction TestCase.run() rtf.report('moves') end\n");
    folder.file("F.lua", "TestCase = {}\nfunction TestCase.run() rtf.fail('stuck') end\n");
    folder.file("S.lua", "TestCase = {}\nfunction TestCase.run() rtf.skip('no gripper') end\n");
    folder
}

fn code_of(folder: &Folder, args: &[&str]) -> Option<i32> {
    folder.rtf(&[&["show"], args].concat()).code
}

#[test]
fn each_test_has_its_own_exit_code() {
    let folder = folder();
    let tests = "<test>P.lua</test><test>F.lua</test><test>S.lua</test>\
                 <test name=\"known\" expect=\"failed\">F.lua</test>";
    folder.file("s.xml", &format!("<suite name=\"the arm\">{tests}</suite>"));
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    for (test, code) in [("P", 0), ("F", 1), ("S", 77), ("known", 0), ("none", 2)] {
        let name = format!("the arm/{test}");
        assert_eq!(code_of(&folder, &["--single-test", &name]), Some(code), "{test}");
    }
    assert_eq!(code_of(&folder, &["--without-tests"]), Some(0));
    let shown = folder.rtf(&["show", "--single-test", "the arm/F"]);
    let part = shown.stdout.split("suite: ").nth(1).unwrap_or_default();
    assert!(part.contains("verdict: failed") && part.contains("failure: stuck"), "{part}");
    assert!(!part.contains("test: P") && !part.contains("result:"), "{part}");
    let unknown = folder.rtf(&["show", "--single-test", "P"]);
    assert_snapshot!(folder.shown(&unknown), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the run has no test `P`
    hint: tests of the run: the arm/P, the arm/F, the arm/S, the arm/known
    ");
}

#[test]
fn problems_apart_from_tests() {
    let folder = folder();
    let hook = "<hook on=\"failure\" name=\"park\"><command>sh -c 'exit 9'</command></hook>";
    folder.file("s.xml", &format!("<suite>{hook}<test>F.lua</test></suite>"));
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(4));
    let shown = folder.rtf(&["show", "--without-tests"]);
    assert_eq!(shown.code, Some(4));
    assert!(shown.stdout.contains("problem: ") && !shown.stdout.contains("test: F"));
}

#[test]
fn a_link_leads_to_the_run() {
    let folder = folder();
    folder.file("s.xml", "<suite><test>P.lua</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml", "--symlink", "mine"]).code, Some(0));
    assert_eq!(code_of(&folder, &["mine", "--single-test", "s/P"]), Some(0));
    let refused = folder.rtf(&["run", "s.xml", "--symlink", "P.lua"]);
    assert_snapshot!(folder.shown(&refused), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: cannot make `P.lua` lead to this run
    caused by: entity already exists
    hint: choose another path with `--symlink PATH`
    ");
    assert!(folder.read("P.lua").contains("TestCase"));
}

#[test]
fn a_results_directory_stands_for_its_newest_run() {
    let folder = folder();
    assert_eq!(folder.rtf(&["run", "--results", "out", "F.lua"]).code, Some(1));
    assert_eq!(folder.rtf(&["run", "--results", "out", "P.lua"]).code, Some(0));
    let shown = folder.rtf(&["show", "out"]);
    assert_eq!(shown.code, Some(0), "{}{}", shown.stdout, shown.stderr);
    assert!(shown.stdout.contains("P"), "{}", shown.stdout);
}
