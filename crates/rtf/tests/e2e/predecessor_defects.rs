//! Regression tests for the defects of robot-testing-framework 2.x. The numbers are those in
//! `docs/how-to/migrating-rtf2.md`.

use rtf_model::{MessageKind, TestId, Verdict};

use crate::support::{Folder, nothing_left};

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() rtf.check(true, 'fine') end\n";
const FAILS: &str = "TestCase = {}\nfunction TestCase.run() rtf.check(false, 'broken') end\n";

fn junit(folder: &Folder) -> junit_parser::TestSuites {
    let file = std::fs::File::open(folder.path().join("junit.xml")).expect("a JUnit file");
    junit_parser::from_reader(std::io::BufReader::new(file)).expect("valid JUnit")
}

/// Defect 1: plug-ins that could not be loaded were skipped, exit code 0.
#[test]
fn defect_1_a_plug_in_that_is_missing_is_red() {
    let folder = Folder::new();
    folder.file(
        "s.xml",
        "<suite name='s'><test type='dll'>A</test><test type='lua'>B</test></suite>",
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(2));
    assert!(
        finished.stderr.contains("`A`") && finished.stderr.contains("`B`"),
        "{}",
        finished.stderr
    );
    std::fs::create_dir(folder.path().join("empty")).expect("a folder");
    assert_eq!(folder.rtf(&["run", "empty"]).code, Some(2));
}

/// Defect 2: `repetition` in a suite dropped the test; `--repetition 3` ran it four times.
#[test]
fn defect_2_a_repetition_runs_that_often() {
    let folder = Folder::new();
    folder.file("T.lua", FAILS);
    folder.file("s.xml", "<suite name='s'><test type='lua' repetition='3'>T</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    assert_eq!(folder.journal().record.tests[0].attempts.len(), 3);
    assert_eq!(folder.rtf(&["run", "--repetition", "3", "T.lua"]).code, Some(1));
    assert_eq!(folder.journal().record.tests[0].attempts.len(), 3);
}

/// Defect 3: a crash ended the run or blamed another test, and left no results file.
#[test]
fn defect_3_a_crash_is_blamed_on_its_test_and_the_results_are_there() {
    let folder = Folder::new();
    folder.file("1-Passes.lua", PASSES);
    folder.file("2-Crashes.py", "import ctypes, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        ctypes.string_at(0)\n");
    folder.file("3-Exits.py", "import os, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.check(False, 'no')\n        os._exit(0)\n");
    folder.file("4-Passes.lua", PASSES);
    let finished = folder.rtf(&["run", ".", "--report", "junit=junit.xml"]);
    assert_eq!(finished.code, Some(1), "{}", finished.stderr);
    let record = folder.journal().record;
    let verdicts: Vec<_> = record.tests.iter().map(|t| t.verdict().expect("a verdict")).collect();
    assert_eq!(verdicts, [Verdict::Passed, Verdict::Crashed, Verdict::Crashed, Verdict::Passed]);
    let junit = junit(&folder);
    let cases: Vec<_> = junit.suites.iter().flat_map(|suite| &suite.cases).collect();
    assert_eq!(cases.len(), 4);
    assert_eq!(cases.iter().filter(|case| case.status.is_error()).count(), 2);
}

const COLLAPSES: &str = "import rtf, threading\n\
class F(rtf.FixtureManager):\n    def setup(self, args):\n        threading.Thread(target=self.watch, daemon=True).start()\n    \
def watch(self):\n        import os, time\n        while not os.path.exists('go'):\n            time.sleep(0.005)\n        self.collapsed('the motor driver is gone')\n";

/// Defect 4: a collapse during the last or only test was never reported.
#[test]
fn defect_4_a_collapse_during_the_only_test_is_red_everywhere() {
    let folder = Folder::new();
    folder.file("Driver.py", COLLAPSES);
    folder.file("T.py", "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        open('go', 'w').close()\n        self.sleep(60)\n");
    folder.file("s.xml", "<suite name='s'><fixture type='python'>Driver</fixture><test type='python'>T</test></suite>");
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=junit.xml"]);
    assert_eq!(finished.code, Some(1));
    assert!(finished.stdout.contains("the motor driver is gone"), "{}", finished.stdout);
    assert_eq!(folder.journal().record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let junit = junit(&folder);
    assert!(junit.suites.iter().flat_map(|suite| &suite.cases).any(|case| case.status.is_error()));
}

/// Defect 5: when the second fixture's set-up failed, the first was never torn down.
#[test]
fn defect_5_what_was_set_up_is_torn_down() {
    let folder = Folder::new();
    folder.file("First.lua", "FixtureManager = {}\nfunction FixtureManager.setup() return true end\nfunction FixtureManager.tearDown() io.open('torn-down', 'w'):close() end\n");
    folder.file(
        "Second.lua",
        "FixtureManager = {}\nfunction FixtureManager.setup() return false end\n",
    );
    folder.file("T.lua", PASSES);
    folder.file("s.xml", "<suite name='s'><fixture type='lua'>First</fixture><fixture type='lua'>Second</fixture><test type='lua'>T</test></suite>");
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=junit.xml"]);
    assert_eq!(finished.code, Some(1));
    assert!(folder.path().join("torn-down").exists(), "the first fixture was torn down");
    assert_eq!(folder.journal().record.verdict(TestId(0)), Some(Verdict::Skipped));
    let junit = junit(&folder);
    assert!(junit.suites.iter().any(|suite| suite.errors + suite.failures > 0), "{junit:?}");
    assert!(nothing_left(&folder));
}

/// Defect 7: an output that cannot be written was noticed after the run, with exit code 0;
/// `result.txt` in the current folder was overwritten; JUnit had no times.
#[test]
fn defect_7_reports_are_checked_before_the_run_and_complete_after_it() {
    let folder = Folder::new();
    folder.file("T.lua", FAILS);
    for report in ["junit=/proc/nowhere/junit.xml", "xml=junit.xml", "junit="] {
        let finished = folder.rtf(&["run", "T.lua", "--report", report]);
        assert_eq!(finished.code, Some(2), "{report}: {}", finished.stderr);
    }
    assert!(!folder.path().join("rtf-results").exists(), "nothing was started");
    folder.file("result.txt", "mine");
    folder.rtf(&["run", "T.lua", "--report", "junit=junit.xml"]);
    assert_eq!(std::fs::read_to_string(folder.path().join("result.txt")).expect("a file"), "mine");
    let junit = junit(&folder);
    let case = &junit.suites[0].cases[0];
    assert!(case.time > 0.0);
    assert!(case.status.failure_as_ref().message.contains("broken"));
}

/// Defect 8: messages were cut at 254 characters, a name with a blank shifted
/// the arguments, and 128 of them wrote past an array.
#[test]
fn defect_8_texts_names_and_parameters_arrive_whole() {
    let folder = Folder::new();
    folder.file("T.py", "import rtf\nclass T(rtf.TestCase):\n    def setup(self, args):\n        self.report(repr(args[:4]))\n        self.report(str(len(args)))\n        self.report(self.name)\n    def run(self):\n        self.report('x' * 100_000)\n");
    let many: String = (0..300).map(|i| format!(" {i}")).collect();
    folder.file("s.xml", &format!("<suite name='s'><test type='python' name='joint test' param='--from &quot;a b.ini&quot; --colour #ff0000{many}'>T</test></suite>"));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    let texts: Vec<&str> =
        record.tests[0].attempts[0].messages.iter().map(|m| m.text.as_str()).collect();
    assert_eq!(texts[0], "['--from', 'a b.ini', '--colour', '#ff0000']");
    assert_eq!(texts[1..3], ["304", "joint test"]);
    assert_eq!(texts[3].len(), 100_000);
}

/// Defect 9: `%` in an error text aborted the runner, a check of nil passed, there was no
/// tear-down after an assertion, and a second Python plug-in broke the first.
#[test]
fn defect_9_scripts_mean_what_they_say() {
    let folder = Folder::new();
    folder.file(
        "Percent.lua",
        "TestCase = {}\nfunction TestCase.run() rtf.error('100% sure: %s %n') end\n",
    );
    folder.file(
        "Nil.lua",
        "TestCase = {}\nfunction TestCase.run() rtf.check(nil, 'nil is not true') end\n",
    );
    folder.file("TearDown.lua", "TestCase = {}\nfunction TestCase.run() rtf.require(false, 'stop') end\nfunction TestCase.tearDown() rtf.report('torn down') end\n");
    let python = |text: &str| {
        format!(
            "import rtf\nSTATE = []\nclass T(rtf.TestCase):\n    def run(self):\n        STATE.append('{text}')\n        self.report(repr(STATE))\n"
        )
    };
    folder.file("A.py", &python("a")).file("B.py", &python("b"));
    folder.file("s.xml", "<suite name='s'><test>Percent.lua</test><test>Nil.lua</test><test>TearDown.lua</test><test>A.py</test><test>B.py</test></suite>");
    folder.rtf(&["run", "s.xml"]);
    let record = folder.journal().record;
    let verdicts: Vec<_> = record.tests.iter().map(|t| t.verdict().expect("a verdict")).collect();
    assert_eq!(
        verdicts,
        [Verdict::Error, Verdict::Failed, Verdict::Failed, Verdict::Passed, Verdict::Passed]
    );
    assert_eq!(record.tests[0].reason(), Some("100% sure: %s %n"));
    let reports = |test: usize| -> Vec<String> {
        let messages = record.tests[test].attempts[0].messages.iter();
        messages.filter(|m| m.kind == MessageKind::Report).map(|m| m.text.clone()).collect()
    };
    assert_eq!(reports(2), ["torn down"]);
    assert_eq!((reports(3), reports(4)), (vec!["['a']".to_owned()], vec!["['b']".to_owned()]));
}

/// Defect 11: a plug-in under a folder with a dot was not found, and a folder's
/// tests ran in the order of the file system.
#[test]
fn defect_11_dots_in_folders_are_no_extensions_and_folders_are_sorted() {
    let folder = Folder::new();
    for name in ["c", "a", "d", "b"] {
        folder.file(&format!("my.sources/{name}.lua"), PASSES);
    }
    folder.file("s.xml", "<suite name='s'><test type='lua'>my.sources/c</test></suite>");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(0));
    let finished = folder.rtf(&["run", "my.sources"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    let names: Vec<_> = folder.journal().record.tests.iter().map(|t| t.plan.name.clone()).collect();
    assert_eq!(names, ["a", "b", "c", "d"]);
}
