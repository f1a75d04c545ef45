//! Cases of tests of other frameworks before a run: `rtf list`, `rtf check`, and the errors
//! of selections. The program here is a script that lists tests as GoogleTest does.

use insta::assert_snapshot;
use serde_json::json;

use crate::support::Folder;

/// Writes the list to the file after `--gtest_output=json:`.
const PROGRAM: &str = r#"#!/bin/sh
for argument; do case $argument in --gtest_output=json:*) file=${argument#*:};; esac; done
cat > "$file" <<'END'
{"testsuites": [
  {"name": "Arm", "testsuite": [
    {"name": "Moves", "file": "arm_test.cpp", "line": 12},
    {"name": "DISABLED_Grasps", "file": "arm_test.cpp", "line": 20},
    {"name": "Mo\u001b[31mves", "file": "arm_test.cpp", "line": 30}]},
  {"name": "Speeds/Arm", "testsuite": [
    {"name": "Reaches/0", "file": "arm_test.cpp", "line": 40},
    {"name": "Reaches/1", "file": "arm_test.cpp", "line": 40}]}]}
END
"#;

const SUITE: &str = "<suite name=\"arm\">
  <test type=\"gtest\" tags=\"slow\"> arm_test </test>
  <test type=\"gtest\" name=\"Fast\" cases=\"Speeds/* !*1\"> arm_test </test>
</suite>
";

fn folder(suite: &str) -> Folder {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    folder.file("arm_test", PROGRAM).file("arm.xml", suite);
    let program = folder.path().join("arm_test");
    std::fs::set_permissions(program, std::fs::Permissions::from_mode(0o755)).expect("a program");
    folder
}

#[test]
fn cases_are_listed_below_their_test() {
    let folder = folder(SUITE);
    assert_snapshot!(folder.rtf(&["list", "arm.xml"]).stdout, @r"
    arm/arm_test  (#slow)
      Arm.Moves
      Arm.DISABLED_Grasps  (disabled)
      Arm.Mo\x1b[31mves
      Speeds/Arm.Reaches/0
      Speeds/Arm.Reaches/1
    arm/Fast
      Speeds/Arm.Reaches/0
    ");
    let case = ["list", "arm.xml::arm_test/Speeds"];
    assert_snapshot!(folder.rtf(&case).stdout, @r"
    arm/arm_test  (#slow)
      Speeds/Arm.Reaches/0
      Speeds/Arm.Reaches/1
    ");
    assert_snapshot!(folder.shown(&folder.rtf(&["check", "arm.xml"])), @r"
    exit code 0
    ----- stdout
    1 suite, 0 fixtures, 2 tests, 6 cases: no errors
    ----- stderr
    ");
}

#[test]
fn cases_are_listed_for_programs() {
    let folder = folder(SUITE);
    let json =
        folder.rtf(&["list", "--format", "json", "arm.xml", "-E", "case(=Arm.Moves)"]).stdout;
    let list: serde_json::Value = serde_json::from_str(&json).unwrap();
    let tests = list["tests"].as_array().unwrap();
    assert_eq!(tests.len(), 1);
    let moves = json!({"name": "Arm.Moves", "location": {"file": "arm_test.cpp", "line": 12}});
    assert_eq!(tests[0]["cases"], json!([moves]));
}

#[test]
fn unknown_cases_are_errors() {
    let folder = folder(SUITE);
    let named = folder.rtf(&["run", "arm.xml::arm_test/Arm.Mvoes"]);
    assert_snapshot!(folder.shown(&named), @r"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no case `Arm.Mvoes` in the test `arm_test`
     |
     = help: did you mean `Arm.Moves`?

    1 error; nothing was started
    ");
    folder.file("arm.xml", &SUITE.replace("Speeds/*", "Speed/*"));
    assert_snapshot!(folder.shown(&folder.rtf(&["check", "arm.xml"])), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: no case of the test `Fast` matches `Speed/*`
     --> arm.xml:3:41
      |
    3 |   <test type="gtest" name="Fast" cases="Speed/* !*1"> arm_test </test>
      |                                         ^^^^^^^^^^^
      |
      = help: did you mean `Speeds/*`?

    1 error; nothing was started
    "#);
}
