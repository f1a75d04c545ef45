//! Known failures, quarantines, and skips that count.

use insta::assert_snapshot;

use crate::support::Folder;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("P.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder.file("F.lua", "TestCase = {}\nfunction TestCase.run() rtf.fail('stuck') end\n");
    folder.file("S.lua", "TestCase = {}\nfunction TestCase.run() rtf.skip('no gripper') end\n");
    folder
}

fn code_of(folder: &Folder, test: &str) -> Option<i32> {
    folder.file("s.xml", &format!("<suite name=\"s\">{test}</suite>"));
    folder.rtf(&["run", "s.xml"]).code
}

#[test]
fn a_known_failure_is_green_until_its_last_day() {
    let folder = folder();
    assert_eq!(code_of(&folder, "<test expect=\"failed\">F.lua</test>"), Some(0));
    assert_eq!(code_of(&folder, "<test expect=\"failed\">P.lua</test>"), Some(1));
    assert_eq!(code_of(&folder, "<test expect=\"error\">F.lua</test>"), Some(1));
    assert_eq!(
        code_of(&folder, "<test expect=\"failed\" until=\"2999-12-31\">F.lua</test>"),
        Some(0)
    );
    assert_eq!(
        code_of(&folder, "<test expect=\"failed\" until=\"2000-01-31\">F.lua</test>"),
        Some(1)
    );
    let record = folder.journal().record;
    let warnings: Vec<_> = record.warnings.iter().map(|it| it.message.as_str()).collect();
    assert_eq!(warnings, ["this known failure expired after 2000-01-31: the verdict counts"]);
}

#[test]
fn a_quarantined_test_does_not_gate() {
    let folder = folder();
    folder.file("rtf.toml", "[[quarantine]]\nfilter = \"name(=F) | name(=P)\"\nissue = \"#7\"\n");
    assert_eq!(code_of(&folder, "<test>F.lua</test><test>P.lua</test>"), Some(0));
    let finished = folder.rtf(&["list", "s.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    s/F  (quarantined: failed, #7)
    s/P  (quarantined: failed, #7)
    ----- stderr
    ");
}

#[test]
fn skips_count_on_request_also_in_a_rerun() {
    let folder = folder();
    assert_eq!(code_of(&folder, "<test>S.lua</test>"), Some(0));
    assert_ne!(folder.rtf(&["run", "s.xml", "--no-skips"]).code, Some(0));
    assert_ne!(folder.rtf(&["run", "--rerun", "interrupted"]).code, Some(0));
    folder.file("s.xml", "<suite skips=\"fail\"><test>S.lua</test></suite>");
    assert_ne!(folder.rtf(&["run", "s.xml"]).code, Some(0));
}
