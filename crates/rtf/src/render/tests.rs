//! What users see of bad input, as it is printed.

use std::path::PathBuf;

use insta::assert_snapshot;
use rtf_engine::plan::{self, Options, Outcome, Surroundings};

/// A folder with suites, whose hosts do not exist and need not.
struct Bench {
    folder: tempfile::TempDir,
    options: Options,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        for host in ["bin/rtf-host-native", "bin/rtf-host-lua", "bin/python3"] {
            let file = root.join(host);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(&file, "#!/bin/sh\n").unwrap();
            let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
            std::fs::set_permissions(&file, mode).unwrap();
        }
        std::fs::create_dir(root.join("suites")).unwrap();
        let variables = [("PATH".to_owned(), root.join("bin").display().to_string())];
        let surroundings = Surroundings {
            current_folder: root.join("suites"),
            executable: root.join("bin/rtf"),
            variables: variables.into_iter().collect(),
        };
        let options = Options { verify: None, ..Options::new(surroundings) };
        let bench = Self { folder, options };
        bench.write("ArmTest.lua", "").write("SensorTest.so", "")
    }

    fn write(self, name: &str, text: &str) -> Self {
        std::fs::write(self.options.surroundings.current_folder.join(name), text).unwrap();
        self
    }

    fn outcome(&self, name: &str) -> Outcome {
        plan::build(&[PathBuf::from(name)], &self.options)
    }

    /// What is printed for the file `name`.
    fn shown(&self, name: &str) -> String {
        let outcome = self.outcome(name);
        let mut out = Vec::new();
        super::write(&mut out, &outcome.diagnostics, &outcome.sources, false).unwrap();
        let root = self.folder.path().canonicalize().unwrap().display().to_string();
        String::from_utf8(out).unwrap().replace(&root, "[ROOT]")
    }
}

/// What is printed for a suite.
fn shown(text: &str) -> String {
    Bench::new().write("suite.xml", text).shown("suite.xml")
}

#[test]
fn missing_suite() {
    assert_snapshot!(Bench::new().write("arm.xml", "").shown("arm"), @"
    error: there is no file or folder `arm`
     |
     = note: looked for [ROOT]/suites/arm
     = help: did you mean `arm.xml`?
    ");
    assert_snapshot!(Bench::new().shown("robot.xml"), @"
    error: there is no file or folder `robot.xml`
     |
     = note: looked for [ROOT]/suites/robot.xml
    ");
}

#[test]
fn malformed_xml() {
    assert_snapshot!(shown("<suite name=\"a\">\n  <test> ArmTest.lua </tset>\n</suite>\n"), @"
    error: malformed XML: `</tset>` where `<test>` has to be closed
     --> suite.xml:2:22
      |
    2 |   <test> ArmTest.lua </tset>
      |                      ^
    ");
    assert_snapshot!(shown("<suite>\n  <test> a & b </test>\n</suite>"), @"
    error: malformed XML: `&` is written `&amp;`
     --> suite.xml:2:12
      |
    2 |   <test> a & b </test>
      |            ^
    ");
    assert_snapshot!(shown("<suite>\n  <test>ArmTest.lua</test>\n"), @"
    error: malformed XML: the file ends before its first element does
     --> suite.xml:2:27
      |
    2 |   <test>ArmTest.lua</test>
      |                           ^
    ");
    assert_snapshot!(shown(""), @"
    error: malformed XML: there is no element in the file
     --> suite.xml:1:1
      |
    1 |
      | ^
    ");
    assert_snapshot!(shown("<robot/>"), @"
    error: `suite.xml` is not a suite: its first element is `<robot>`
     --> suite.xml:1:1
      |
    1 | <robot/>
      | ^^^^^^ `<suite>` is expected here
    ");
}

#[test]
fn dashes_in_a_comment() {
    let suite = "<suite>\n  <!-- <test param=\"--from x.ini\"> Off </test> -->\n  \
                 <test>ArmTest.lua</test>\n</suite>\n";
    assert_snapshot!(shown(suite), @r#"
    warning: `--` in a comment is not legal XML; accepted
     --> suite.xml:2:21
      |
    2 |   <!-- <test param="--from x.ini"> Off </test> -->
      |                     ^^
      |
      = help: write the option without its dashes in comments, other programs refuse the file
    "#);
}

#[test]
fn unknown_element() {
    assert_snapshot!(shown("<suite>\n  <tets>ArmTest.lua</tets>\n  <test>ArmTest.lua</test></suite>"), @"
    error: unknown element `<tets>`
     --> suite.xml:2:3
      |
    2 |   <tets>ArmTest.lua</tets>
      |   ^^^^^ not known in `<suite>`
      |
      = note: `<suite>` can have the elements `description`, `environment`, `env`, `fixture`, `test`
      = help: did you mean `test`?
    ");
}

#[test]
fn unknown_attribute() {
    let suite = "<suite>\n  <description>An arm</description>\n\n  \
                 <test tiemout=\"3s\">ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @r#"
    error: unknown attribute `tiemout`
     --> suite.xml:4:9
      |
    4 |   <test tiemout="3s">ArmTest.lua</test>
      |         ^^^^^^^ not known in `<test>`
      |
      = note: `<test>` can have the attributes `name`, `type`, `param`, `repetition`, `tags`, `timeout`, `load-timeout`, `setup-timeout`, `teardown-timeout`, `slow`, `grace`, `after-collapse`, `critical`, `isolation`
      = help: did you mean `timeout`?
    "#);
}

#[test]
fn not_supported_yet() {
    let suite = "<suite isolate=\"network\">\n  <hook on=\"failure\"> Park.lua </hook>\n  \
                 <test isolation=\"shared\" retries=\"2\">ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @r#"
    error: `isolate` is not supported by this version of rtf
     --> suite.xml:1:8
      |
    1 | <suite isolate="network">
      |        ^^^^^^^

    error: `<hook>` is not supported by this version of rtf
     --> suite.xml:2:3
      |
    2 |   <hook on="failure"> Park.lua </hook>
      |   ^^^^^

    error: `isolation="shared"` is not supported by this version of rtf
     --> suite.xml:3:20
      |
    3 |   <test isolation="shared" retries="2">ArmTest.lua</test>
      |                    ^^^^^^

    error: `retries` is not supported by this version of rtf
     --> suite.xml:3:28
      |
    3 |   <test isolation="shared" retries="2">ArmTest.lua</test>
      |                            ^^^^^^^
    "#);
}

#[test]
fn wrong_values() {
    let suite = "<suite tolerate-collapse=\"yes\">\n  \
                 <test timeout=\"soon\" repetition=\"0\" slow=\"-1s\" after-collapse=\"return\">\
                 ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @r#"
    error: `tolerate-collapse` has to be `true` or `false`: `yes`
     --> suite.xml:1:27
      |
    1 | <suite tolerate-collapse="yes">
      |                           ^^^

    error: `timeout` is not a duration: `soon`
     --> suite.xml:2:18
      |
    2 |   <test timeout="soon" repetition="0" slow="-1s" after-collapse="return">ArmTest.lua</test>
      |                  ^^^^
      |
      = help: write it like `250ms`, `1.5s`, `2min` or `1h 30m`; a bare number is seconds

    error: `repetition` is not a whole number from 1 to 1000000: `0`
     --> suite.xml:2:36
      |
    2 |   <test timeout="soon" repetition="0" slow="-1s" after-collapse="return">ArmTest.lua</test>
      |                                    ^

    error: `slow` must be longer than zero: `-1s`
     --> suite.xml:2:45
      |
    2 |   <test timeout="soon" repetition="0" slow="-1s" after-collapse="return">ArmTest.lua</test>
      |                                             ^^^

    error: `after-collapse` has to be `rerun` or `fail` or `skip`: `return`
     --> suite.xml:2:66
      |
    2 |   <test timeout="soon" repetition="0" slow="-1s" after-collapse="return">ArmTest.lua</test>
      |                                                                  ^^^^^^
    "#);
}

#[test]
fn duplicate_names() {
    let suite = "<suite>\n  <test name=\"reach\">ArmTest.lua</test>\n  \
                 <test>SensorTest</test>\n  <test name=\"reach\">SensorTest</test>\n</suite>";
    assert_snapshot!(shown(suite), @r#"
    error: two tests are named `reach`
     --> suite.xml:4:15
      |
    2 |   <test name="reach">ArmTest.lua</test>
      |               ----- the first one
    3 |   <test>SensorTest</test>
    4 |   <test name="reach">SensorTest</test>
      |               ^^^^^ the second one
    "#);
}

#[test]
fn missing_plugin() {
    let suite = "<suite>\n  <test type=\"dll\"> SensrTest </test>\n  \
                 <test> ArmTest </test>\n  <test> SensrTest </test>\n</suite>";
    assert_snapshot!(shown(suite), @r#"
    error: there is no plug-in `SensrTest` of type `dll`
     --> suite.xml:2:21
      |
    2 |   <test type="dll"> SensrTest </test>
      |                     ^^^^^^^^^
    3 |   <test> ArmTest </test>
    4 |   <test> SensrTest </test>
      |          --------- and here
      |
      = note: looked for `SensrTest.so`, `libSensrTest.so`, `SensrTest` in
                [ROOT]/suites
                [ROOT]/lib/rtf/plugins
      = help: did you mean `SensorTest`?

    error: there is no plug-in `ArmTest` of type `dll`
     --> suite.xml:3:10
      |
    3 |   <test> ArmTest </test>
      |          ^^^^^^^
      |
      = note: looked for `ArmTest.so`, `libArmTest.so`, `ArmTest` in
                [ROOT]/suites
                [ROOT]/lib/rtf/plugins
      = help: there is `ArmTest.lua`; write `type="lua"`
    "#);
}

#[test]
fn doctype() {
    let suite = "<?xml version=\"1.0\"?>\n<!DOCTYPE suite [<!ENTITY a \"b\">]>\n\
                 <suite><test>&a;</test></suite>";
    assert_snapshot!(shown(suite), @r#"
    error: a suite file cannot have a DTD
     --> suite.xml:2:1
      |
    2 | <!DOCTYPE suite [<!ENTITY a "b">]>
      | ^^^^^^^^^ not read, for safety
      |
      = help: remove the `<!DOCTYPE …>`
    "#);
}

#[test]
fn unknown_type() {
    assert_snapshot!(shown("<suite>\n  <test type=\"pyton\"> ArmTest </test>\n</suite>"), @r#"
    error: unknown type `pyton`
     --> suite.xml:2:15
      |
    2 |   <test type="pyton"> ArmTest </test>
      |               ^^^^^
      |
      = note: known types are `dll`, `lua`, `python`
      = help: did you mean `python`?
    "#);
}

#[test]
fn interpreter_that_is_not_there() {
    let mut bench = Bench::new()
        .write("RateTest.py", "")
        .write("suite.xml", "<suite>\n  <test> RateTest.py </test>\n</suite>");
    let variables = &mut bench.options.surroundings.variables;
    variables.insert("RTF_PYTHON".into(), "python3.99".into());
    assert_snapshot!(bench.shown("suite.xml"), @"
    error: the interpreter `python3.99` is not there
     --> suite.xml:2:10
      |
    2 |   <test> RateTest.py </test>
      |          ^^^^^^^^^^^ needed here
      |
      = note: searched `PATH`:
                [ROOT]/bin
      = note: `RTF_PYTHON` names it
    ");
    bench.options.surroundings.variables.clear();
    assert_snapshot!(bench.shown("suite.xml"), @"
    error: plug-ins of type `python` need `python3`, which is not there
     --> suite.xml:2:10
      |
    2 |   <test> RateTest.py </test>
      |          ^^^^^^^^^^^ needed here
      |
      = note: `PATH` names no folder
      = help: install it, or name another one in `RTF_PYTHON`
    ");
}

#[test]
fn missing_program() {
    let suite = "<suite>\n  <fixture type=\"process\">\n    <command>simulator --fast</command>\n    \
                 <ready command=\"./probe\"/>\n  </fixture>\n  <test>ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @r#"
    error: there is no program `simulator`
     --> suite.xml:3:14
      |
    3 |     <command>simulator --fast</command>
      |              ^^^^^^^^^^^^^^^^
      |
      = note: searched `PATH`:
                [ROOT]/bin

    error: there is no program `./probe`
     --> suite.xml:4:21
      |
    4 |     <ready command="./probe"/>
      |                     ^^^^^^^
      |
      = note: looked for [ROOT]/suites/probe
    "#);
}

/// The issue's own words: five different mistakes print five messages.
#[test]
fn five_mistakes_are_five_messages() {
    let suite = "<suite name=\"five\" tag=\"a\">\n  \
                 <fixture depends=\"sim\"> ArmTest.lua </fixture>\n  \
                 <test timeout=\"3 apples\"> ArmTest.lua </test>\n  \
                 <test type=\"matlab\"> ArmTest </test>\n  \
                 <test> GripperTest </test>\n</suite>";
    let bench = Bench::new().write("suite.xml", suite);
    assert_eq!(bench.outcome("suite.xml").diagnostics.len(), 5);
    assert!(bench.outcome("suite.xml").plan.is_none());
    assert_snapshot!(bench.shown("suite.xml"), @r#"
    error: unknown attribute `tag`
     --> suite.xml:1:20
      |
    1 | <suite name="five" tag="a">
      |                    ^^^ not known in `<suite>`
      |
      = note: `<suite>` can have the attributes `name`, `timeout`, `tags`, `tolerate-collapse`, `after-collapse`, `test-timeout`, `test-load-timeout`, `test-setup-timeout`, `test-teardown-timeout`, `test-slow`, `test-grace`
      = help: did you mean `tags`?

    error: there is no fixture `sim`
     --> suite.xml:2:21
      |
    2 |   <fixture depends="sim"> ArmTest.lua </fixture>
      |                     ^^^

    error: `timeout` is not a duration: `3 apples`
     --> suite.xml:3:18
      |
    3 |   <test timeout="3 apples"> ArmTest.lua </test>
      |                  ^^^^^^^^
      |
      = help: write it like `250ms`, `1.5s`, `2min` or `1h 30m`; a bare number is seconds

    error: unknown type `matlab`
     --> suite.xml:4:15
      |
    4 |   <test type="matlab"> ArmTest </test>
      |               ^^^^^^
      |
      = note: known types are `dll`, `lua`, `python`

    error: there is no plug-in `GripperTest` of type `dll`
     --> suite.xml:5:10
      |
    5 |   <test> GripperTest </test>
      |          ^^^^^^^^^^^
      |
      = note: looked for `GripperTest.so`, `libGripperTest.so`, `GripperTest` in
                [ROOT]/suites
                [ROOT]/lib/rtf/plugins
    "#);
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let problem = rtf_model::Diagnostic::error("x", "a \u{1b}[31mred\u{7} message\nof two lines");
    let mut out = Vec::new();
    super::write(&mut out, &[problem], &rtf_engine::suite::Sources::default(), false).unwrap();
    let text = String::from_utf8(out).unwrap();
    assert!(!text.contains('\u{1b}') && !text.contains('\u{7}'), "{text:?}");
}

#[test]
fn colour_only_when_asked_for() {
    let bench = Bench::new().write("suite.xml", "<robot/>");
    let outcome = bench.outcome("suite.xml");
    let mut out = Vec::new();
    super::write(&mut out, &outcome.diagnostics, &outcome.sources, true).unwrap();
    assert!(String::from_utf8(out).unwrap().contains("\u{1b}["));
    assert!(!bench.shown("suite.xml").contains('\u{1b}'));
}
