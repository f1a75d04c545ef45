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
    assert_snapshot!(Bench::new().write("arm.xml", "").shown("arm"), @"");
    assert_snapshot!(Bench::new().shown("robot.xml"), @"");
}

#[test]
fn malformed_xml() {
    assert_snapshot!(shown("<suite name=\"a\">\n  <test> ArmTest.lua </tset>\n</suite>\n"), @"");
    assert_snapshot!(shown("<suite>\n  <test> a & b </test>\n</suite>"), @"");
    assert_snapshot!(shown("<suite>\n  <test>ArmTest.lua</test>\n"), @"");
    assert_snapshot!(shown(""), @"");
    assert_snapshot!(shown("<robot/>"), @"");
}

#[test]
fn dashes_in_a_comment() {
    let suite = "<suite>\n  <!-- <test param=\"--from x.ini\"> Off </test> -->\n  \
                 <test>ArmTest.lua</test>\n</suite>\n";
    assert_snapshot!(shown(suite), @"");
}

#[test]
fn unknown_element() {
    assert_snapshot!(shown("<suite>\n  <tets>ArmTest.lua</tets>\n  <test>ArmTest.lua</test></suite>"), @"");
}

#[test]
fn unknown_attribute() {
    let suite = "<suite>\n  <description>An arm</description>\n\n  \
                 <test tiemout=\"3s\">ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @"");
}

#[test]
fn not_supported_yet() {
    let suite = "<suite isolate=\"network\">\n  <hook on=\"failure\"> Park.lua </hook>\n  \
                 <test isolation=\"shared\" retries=\"2\">ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @"");
}

#[test]
fn wrong_values() {
    let suite = "<suite tolerate-collapse=\"yes\">\n  \
                 <test timeout=\"soon\" repetition=\"0\" slow=\"-1s\" after-collapse=\"return\">\
                 ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @"");
}

#[test]
fn duplicate_names() {
    let suite = "<suite>\n  <test name=\"reach\">ArmTest.lua</test>\n  \
                 <test>SensorTest</test>\n  <test name=\"reach\">SensorTest</test>\n</suite>";
    assert_snapshot!(shown(suite), @"");
}

#[test]
fn missing_plugin() {
    let suite = "<suite>\n  <test type=\"dll\"> SensrTest </test>\n  \
                 <test> ArmTest </test>\n  <test> SensrTest </test>\n</suite>";
    assert_snapshot!(shown(suite), @"");
}

#[test]
fn doctype() {
    let suite = "<?xml version=\"1.0\"?>\n<!DOCTYPE suite [<!ENTITY a \"b\">]>\n\
                 <suite><test>&a;</test></suite>";
    assert_snapshot!(shown(suite), @"");
}

#[test]
fn unknown_type() {
    assert_snapshot!(shown("<suite>\n  <test type=\"pyton\"> ArmTest </test>\n</suite>"), @"");
}

#[test]
fn interpreter_that_is_not_there() {
    let mut bench = Bench::new()
        .write("RateTest.py", "")
        .write("suite.xml", "<suite>\n  <test> RateTest.py </test>\n</suite>");
    let variables = &mut bench.options.surroundings.variables;
    variables.insert("RTF_PYTHON".into(), "python3.99".into());
    assert_snapshot!(bench.shown("suite.xml"), @"");
    bench.options.surroundings.variables.clear();
    assert_snapshot!(bench.shown("suite.xml"), @"");
}

#[test]
fn missing_program() {
    let suite = "<suite>\n  <fixture type=\"process\">\n    <command>simulator --fast</command>\n    \
                 <ready command=\"./probe\"/>\n  </fixture>\n  <test>ArmTest.lua</test>\n</suite>";
    assert_snapshot!(shown(suite), @"");
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
    assert_snapshot!(bench.shown("suite.xml"), @"");
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
