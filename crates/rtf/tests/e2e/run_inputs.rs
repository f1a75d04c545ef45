//! Arguments of `rtf run`, and the parameters and variables that plug-ins get.

use insta::assert_snapshot;
use rtf_model::{MessageKind, Record, Verdict};

use crate::support::Folder;

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() rtf.check(true, 'fine') end\n";

/// Reports what it was given.
const LUA: &str = "TestCase = {}\nfunction TestCase.setup(args)\n  \
    rtf.report(table.concat({rtf.name(), rtf.param(), rtf.environment(), rtf.repetition(), #args, args[2]}, '|'))\n\
    end\nfunction TestCase.run() end\n";
const PYTHON: &str = "import rtf\n\n\nclass Told(rtf.TestCase):\n    def setup(self, args):\n        \
    self.report('|'.join(map(str, [self.name, self.param, self.environment, self.repetition, len(args), args[1]])))\n\n    \
    def run(self):\n        pass\n";

fn names(record: &Record) -> Vec<String> {
    record.tests.iter().map(|test| record.full_name(test.plan.test)).collect()
}

/// The information that each attempt of a test reported, in order.
fn reports(record: &Record, test: usize) -> Vec<String> {
    let messages = record.tests[test].attempts.iter().flat_map(|attempt| &attempt.messages);
    let reports = messages.filter(|message| message.kind == MessageKind::Report);
    reports.map(|message| message.text.clone()).collect()
}

#[test]
fn a_folder_stands_for_its_suites_and_with_r_for_those_below_it() {
    let folder = Folder::new();
    let suite = "<suite><test>T.lua</test></suite>";
    for place in ["tests", "tests/arm", "tests/arm/left"] {
        folder.file(&format!("{place}/T.lua"), PASSES).file(&format!("{place}/s.xml"), suite);
    }
    folder.file("tests/leg/Knee.lua", PASSES).file("tests/pom.xml", "<project/>");
    assert_eq!(folder.rtf(&["run", "tests"]).code, Some(0));
    assert_eq!(names(&folder.journal().record), ["s/T"]);
    let finished = folder.rtf(&["run", "-r", "tests"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    assert_snapshot!(folder.shown(&folder.rtf(&["list", "-r", "tests"])), @"
    exit code 0
    ----- stdout
    s/T
    s#2/T
    s#3/T
    ----- stderr
    ");
}

#[test]
fn suites_plug_ins_and_folders_in_one_run() {
    let folder = Folder::new();
    folder.file("single.lua", PASSES).file("more/b.lua", PASSES).file("more/a.py", PYTHON);
    folder
        .file("suites/T.lua", PASSES)
        .file("suites/s.xml", "<suite name=\"suite\"><test>T.lua</test></suite>");
    let finished = folder.rtf(&["run", "single.lua", "suites/s.xml", "more", "--param", "x y"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    assert_eq!(names(&record), ["suite/T", "plug-ins/single", "plug-ins/a", "plug-ins/b"]);
}

#[test]
fn parameters_of_single_plug_ins_arrive() {
    let folder = Folder::new();
    folder.file("told.lua", LUA).file("told.py", PYTHON);
    let given =
        ["--param", "--from \"a b.ini\" -v", "--environment", "--robot icub", "--repetition", "2"];
    let finished = folder.rtf(&[["run", "told.lua", "told.py"].as_slice(), &given].concat());
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    let told = |name: &str, repetition: u32| {
        format!("{name}|--from \"a b.ini\" -v|--robot icub|{repetition}|3|a b.ini")
    };
    assert_eq!(reports(&record, 0), [told("told", 1), told("told", 2)]);
    assert_eq!(reports(&record, 1), [told("told#2", 1), told("told#2", 2)]);
}

#[test]
fn the_command_that_runs_a_plug_in_again_has_its_parameters() {
    let folder = Folder::new();
    let fails =
        "TestCase = {}\nfunction TestCase.run() rtf.fail(rtf.param() .. rtf.environment()) end\n";
    folder.file("fails.lua", fails);
    let run = folder.rtf(&["run", "fails.lua", "--param", "it's", "--environment=--robot icub"]);
    let lines = |text: &str| -> Vec<String> {
        text.lines()
            .filter_map(|line| Some(line.split_once("rerun  ")?.1.trim().to_owned()))
            .collect()
    };
    let again = lines(&run.stdout);
    assert_snapshot!(folder.redact(&again.join("\n")), @r"rtf run [FOLDER]/fails.lua --param 'it'\''s' --environment '--robot icub'");
    assert_eq!(lines(&folder.rtf(&["show"]).stdout), again);
    let words = shell_words::split(&again[0]).expect("a command");
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    assert_eq!(folder.rtf(&words[1..]).code, Some(1));
    assert_eq!(folder.journal().record.tests[0].reason(), Some("it's--robot icub"));
}

#[test]
fn variables_of_a_test_go_over_those_of_its_suite_and_these_over_the_users() {
    let folder = Folder::new();
    let text = "import os\nimport rtf\n\n\nclass T(rtf.TestCase):\n    def run(self):\n        \
        self.report(' '.join(os.environ.get(name, '-') for name in ['ARM', 'LEG', 'EYE', 'EAR']))\n";
    folder.file("T.py", text);
    let lua = "TestCase = {}\nfunction TestCase.run() rtf.report(os.getenv('ARM') .. os.getenv('LEG')) end\n";
    folder.file("T.lua", lua);
    folder.file(
        "s.xml",
        "<suite>\n  <env name=\"ARM\" value=\"suite\"/>\n  <env name=\"LEG\" value=\"suite\"/>\n  \
         <test>T.py<env name=\"ARM\" value=\"test\"/><env name=\"EAR\" value=\"\"/></test>\n  \
         <test>T.py</test>\n  <test>T.lua<env name=\"LEG\" value=\"${ARM}\"/></test>\n</suite>\n",
    );
    let mut command = folder.command(&["run", "s.xml"]);
    command.env("ARM", "user").env("EYE", "user").env_remove("EAR");
    let output = command.output().expect("rtf runs");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let record = folder.journal().record;
    assert_eq!(reports(&record, 0), ["test suite user "]);
    assert_eq!(reports(&record, 1), ["suite suite user -"]);
    assert_eq!(reports(&record, 2), ["suite${ARM}"]);
}

#[test]
fn the_rest_is_skipped_when_a_critical_test_does_not_pass() {
    let folder = Folder::new();
    folder.file("Passes.lua", PASSES);
    folder.file(
        "Fails.lua",
        "TestCase = {}\nfunction TestCase.run() rtf.check(false, 'the brake is open') end\n",
    );
    folder.file(
        "1.xml",
        "<suite name=\"arm\">\n  <test critical=\"true\">Passes.lua</test>\n  \
         <test critical=\"true\">Fails.lua</test>\n  <test name=\"moves\">Passes.lua</test>\n</suite>\n",
    );
    folder.file("2.xml", "<suite name=\"leg\">\n  <test>Passes.lua</test>\n</suite>\n");
    let finished = folder.rtf(&["run", "1.xml", "2.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    suite arm  3 tests  1.xml
         passed     [TIME]  arm/Passes
         failed     [TIME]  arm/Fails
                 failure: the brake is open
                   at [FOLDER]/Fails.lua:2
        skipped              arm/moves: the critical test `Fails` did not pass: it is failed
    suite leg  1 test  2.xml
         passed     [TIME]  leg/Passes

    tests that did not pass:
      arm/Fails  failed
        reason  the brake is open
        at      [FOLDER]/Fails.lua:2
        rerun   rtf run 1.xml::Fails

    skipped tests:
      1 test: the critical test `Fails` did not pass: it is failed
        arm/moves

    results: rtf-results/[RUN]
    FAILED  4 tests in 2 suites, [TIME]: 2 passed, 1 failed, 1 skipped
    ----- stderr
    ");
    let record = folder.journal().record;
    let verdicts: Vec<_> = record.tests.iter().map(|test| test.final_verdict()).collect();
    assert_eq!(verdicts, [Verdict::Passed, Verdict::Failed, Verdict::Skipped, Verdict::Passed]);
}

/// The interpreter searches the working directory first, where the host would find it.
#[test]
fn a_module_named_rtf_beside_the_tests_does_not_replace_the_hosts() {
    for module in ["rtf.py", "rtf/__init__.py"] {
        let folder = Folder::new();
        let test = "import unittest\nclass Case(unittest.TestCase):\n    def test(self): pass\n";
        let tests = "<test param='x y'>told.py</test><test type='unittest'>test_case.py</test>";
        folder.file(module, "raise RuntimeError('the module of the user')\n");
        folder.file("told.py", PYTHON).file("test_case.py", test);
        folder.file("s.xml", &format!("<suite>{tests}</suite>"));
        let finished = folder.rtf(&["run", "s.xml"]);
        assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
        let warning =
            format!("tests cannot import `[FOLDER]/{module}`: the module `rtf` is that of rtf");
        let shown = folder.shown(&folder.rtf(&["check", "s.xml"]));
        assert_eq!(shown.matches(&warning).count(), 1, "{shown}");
    }
}

#[test]
fn a_suite_whose_name_is_not_utf_8_is_refused() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    folder.file("T.lua", PASSES);
    let name = std::ffi::OsStr::from_bytes(b"arm-\xff.xml");
    std::fs::write(folder.path().join(name), "<suite><test>T.lua</test></suite>").expect("a file");
    for input in [name, std::ffi::OsStr::new(".")] {
        let mut command = folder.command(&["run"]);
        let output = command.arg(input).output().expect("rtf runs");
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{told}");
        let reason = "cannot be used: its path is not UTF-8";
        assert!(told.contains(reason) && told.contains("arm-\u{fffd}.xml"), "{told}");
    }
}
