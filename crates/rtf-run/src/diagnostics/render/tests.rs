//! Tests how problems of input are printed. The end-to-end tests cover common mistakes;
//! these tests cover special cases of printing them.

use std::path::PathBuf;

use insta::assert_snapshot;
use rtf_plan::plan::{self, InputPath, Options, PlanOutcome, RunnerEnvironment};

/// A directory with suites, whose hosts do nothing.
struct Bench {
    dir: tempfile::TempDir,
    options: Options,
}

impl Bench {
    fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        let root = dir.path().canonicalize().unwrap();
        for host in ["bin/rtf-host-native", "bin/rtf-host-lua", "bin/python3"] {
            let file = root.join(host);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(&file, "#!/bin/sh\n").unwrap();
            let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
            std::fs::set_permissions(&file, mode).unwrap();
        }
        std::fs::create_dir(root.join("suites")).unwrap();
        let variables = [("PATH".to_owned(), root.join("bin").display().to_string())];
        let surroundings = RunnerEnvironment {
            current_dir: root.join("suites"),
            executable: root.join("bin/rtf"),
            variables: variables.into_iter().collect(),
        };
        let options = Options::new(surroundings, jiff::civil::date(2026, 7, 1));
        let bench = Self { dir, options };
        bench.write("ArmTest.lua", "").write("SensorTest.so", "")
    }

    fn write(self, name: &str, text: &str) -> Self {
        std::fs::write(self.options.runner.current_dir.join(name), text).unwrap();
        self
    }

    fn outcome(&self, name: &str) -> PlanOutcome {
        plan::draft(&[InputPath::Any(PathBuf::from(name))], &self.options).unchecked()
    }

    /// Returns the printed problems of the file `name`.
    fn shown(&self, name: &str) -> String {
        let outcome = self.outcome(name);
        let mut out = Vec::new();
        super::write(&mut out, &outcome.diagnostics, &outcome.sources, false).unwrap();
        let root = self.dir.path().canonicalize().unwrap().display().to_string();
        String::from_utf8(out).unwrap().replace(&root, "[ROOT]")
    }
}

/// Returns the printed problems of a suite.
fn shown(text: &str) -> String {
    Bench::new().write("suite.xml", text).shown("suite.xml")
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
      |          ---------
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

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let problem = rtf_model::Diagnostic::error("x", "a \u{1b}[31mred\u{7} message\nof two lines");
    let mut out = Vec::new();
    super::write(&mut out, &[problem], &rtf_plan::suite::SourceMap::default(), false).unwrap();
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
