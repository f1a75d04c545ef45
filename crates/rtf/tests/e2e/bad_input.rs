//! Invalid input: the error names the place, the expected input and a solution; the exit code
//! is 2, and nothing is started.

use insta::assert_snapshot;

use crate::support::Folder;

pub const LUA_TEST: &str = "TestCase = {}\nfunction TestCase.run() rtf.check(true, 'fine') end\n";

/// What is printed for an input that is refused. Standard output stays empty,
/// and there is no trace of a run.
pub fn refused(folder: &Folder, args: &[&str]) -> String {
    let finished = folder.rtf(args);
    assert_eq!(finished.code, Some(2), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.stdout, "");
    assert!(!folder.path().join("rtf-results").exists(), "nothing was started");
    folder.redact_paths(&finished.stderr)
}

/// What is printed for a suite that is refused.
pub fn refused_suite(text: &str) -> String {
    let folder = Folder::new();
    folder.file("EncoderTest.lua", LUA_TEST).file("arm.xml", text);
    refused(&folder, &["run", "arm.xml"])
}

#[test]
fn a_suite_that_is_not_there() {
    assert_snapshot!(refused(&Folder::new(), &["run", "arm.xml"]), @"
    error: there is no file or directory `arm.xml`
     |
     = note: looked for [FOLDER]/arm.xml

    1 error; nothing was started
    ");
}

#[test]
fn a_suite_without_its_extension() {
    let folder = Folder::new();
    folder.file("arm.xml", "<suite/>");
    assert_snapshot!(refused(&folder, &["run", "arm"]), @"
    error: there is no file or directory `arm`
     |
     = note: looked for [FOLDER]/arm
     = help: did you mean `arm.xml`?

    1 error; nothing was started
    ");
}

#[test]
fn an_ampersand_alone() {
    assert_snapshot!(refused_suite("<suite name=\"arm & leg\">\n  <test>EncoderTest.lua</test>\n</suite>\n"), @r#"
    error: malformed XML: `&` must be written `&amp;`
     --> arm.xml:1:18
      |
    1 | <suite name="arm & leg">
      |                  ^

    1 error; nothing was started
    "#);
}

#[test]
fn a_comparison_in_a_text() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <monitor name=\"q\">q < 3</monitor>\n</suite>\n"), @r#"
    error: malformed XML: `<` in a text must be written `&lt;`
     --> arm.xml:2:24
      |
    2 |   <monitor name="q">q < 3</monitor>
      |                        ^

    1 error; nothing was started
    "#);
}

#[test]
fn two_suites_in_one_file() {
    assert_snapshot!(refused_suite("<suite name=\"arm\"/>\n<suite name=\"leg\"/>\n"), @r#"
    error: malformed XML: a second first element, `<suite>`
     --> arm.xml:2:1
      |
    2 | <suite name="leg"/>
      | ^
      |
      = help: an XML file has one element that contains all others: for several suites, write several files

    1 error; nothing was started
    "#);
}

#[test]
fn an_end_tag_that_does_not_fit() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <test>EncoderTest.lua</tset>\n</suite>\n"), @"
    error: malformed XML: expected `</test>`, found `</tset>`
     --> arm.xml:2:24
      |
    2 |   <test>EncoderTest.lua</tset>
      |                        ^

    1 error; nothing was started
    ");
}

#[test]
fn a_file_that_ends_too_early() {
    assert_snapshot!(refused_suite("<suite name=\"arm\">\n  <test>EncoderTest.lua</test>\n"), @"
    error: malformed XML: the file ends before its first element is closed
     --> arm.xml:2:31
      |
    2 |   <test>EncoderTest.lua</test>
      |                               ^

    1 error; nothing was started
    ");
}

#[test]
fn an_empty_file() {
    assert_snapshot!(refused_suite(""), @"
    error: malformed XML: the file contains no element
     --> arm.xml:1:1
      |
    1 |
      | ^

    1 error; nothing was started
    ");
}

#[test]
fn an_attribute_twice() {
    assert_snapshot!(refused_suite("<suite name=\"arm\" name=\"leg\">\n  <test>EncoderTest.lua</test>\n</suite>\n"), @r#"
    error: malformed XML: duplicate attribute `name`
     --> arm.xml:1:19
      |
    1 | <suite name="arm" name="leg">
      |                   ^

    1 error; nothing was started
    "#);
}

#[test]
fn another_xml_file() {
    assert_snapshot!(refused_suite("<project/>\n"), @"
    error: `arm.xml` is not a suite: its first element is `<project>`
     --> arm.xml:1:1
      |
    1 | <project/>
      | ^^^^^^^^ `<suite>` is expected here

    1 error; nothing was started
    ");
}

#[test]
fn a_dtd() {
    assert_snapshot!(refused_suite("<!DOCTYPE suite [<!ENTITY name SYSTEM \"/etc/passwd\">]>\n<suite name=\"&name;\">\n  <test>EncoderTest.lua</test>\n</suite>\n"), @r#"
    error: the file cannot have a DTD
     --> arm.xml:1:1
      |
    1 | <!DOCTYPE suite [<!ENTITY name SYSTEM "/etc/passwd">]>
      | ^^^^^^^^^ refused for safety
      |
      = help: remove the `<!DOCTYPE …>`

    1 error; nothing was started
    "#);
}

#[test]
fn a_folder_without_tests() {
    let folder = Folder::new();
    folder.file("tests/readme.txt", "none yet");
    assert_snapshot!(refused(&folder, &["run", "tests"]), @"
    error: the directory `tests` contains neither a suite nor a plug-in
     |
     = help: `--recursive` also searches subdirectories

    1 error; nothing was started
    ");
}

#[test]
fn a_folder_in_which_only_a_fixture_is() {
    let folder = Folder::new();
    folder.file("tests/Driver.lua", "FixtureManager = {}\nfunction FixtureManager.setup() end\n");
    assert_snapshot!(refused(&folder, &["run", "tests"]), @"
    error: there is no test to run
     |
     = note: [FOLDER]/tests/Driver.lua contains no test

    1 error; nothing was started
    ");
}

/// Nine of 39 suite files that people use have such comments.
#[test]
fn dashes_in_a_comment_are_accepted_with_a_warning() {
    let folder = Folder::new();
    folder.file("EncoderTest.lua", LUA_TEST);
    folder.file("arm.xml", "<suite name=\"arm\">\n  <!-- was: --robot icub -->\n  <test>EncoderTest.lua</test>\n</suite>\n");
    let finished = folder.rtf(&["run", "arm.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
        warning  arm.xml:2:13: `--` in a comment is not legal XML; accepted
                 hint: remove the dashes: other programs refuse the file
    suite arm  1 test  arm.xml
         passed     [TIME]  arm/EncoderTest

    results: rtf-results/[RUN]
    PASSED  1 test in 1 suite, [TIME]: 1 passed
    ----- stderr
    ");
}
