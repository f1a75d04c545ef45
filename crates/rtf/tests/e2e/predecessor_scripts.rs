//! Scripts for robot-testing-framework 1.x and 2.x run unchanged: the same test in each language,
//! with each name of its functions.

use rtf_model::{MessageKind, Record, Verdict};

use crate::support::Folder;

/// How a language writes what all of these tests do.
struct Language {
    kind: &'static str,
    extension: &'static str,
    /// What stands before a function's name.
    prefixes: &'static [&'static str],
    /// True, false and nothing.
    words: [&'static str; 3],
    /// The test, with `SETUP` (what it returns), `RUN` and `P.` to be replaced.
    template: &'static str,
}

const LUA: Language = Language {
    kind: "lua",
    extension: "lua",
    prefixes: &["robottestingframework.", "TestCase.", "RTF."],
    words: ["true", "false", "nil"],
    template: "TestCase.setup = function(param)
  P.setName('MyTest')
  P.testReport('setup: ' .. param)
  return SETUP
end
TestCase.run = function()
  RUN
end
TestCase.tearDown = function()
  P.testReport('torn down')
end
",
};

const PYTHON: Language = Language {
    kind: "python",
    extension: "py",
    prefixes: &["robottestingframework."],
    words: ["True", "False", "None"],
    template: "class TestCase:
    def setup(self, param):
        P.setName('MyTest')
        P.testReport('setup: ' + param)
        return SETUP

    def run(self):
        RUN

    def tearDown(self):
        P.testReport('torn down')
",
};

const RUBY: Language = Language {
    kind: "ruby",
    extension: "rb",
    prefixes: &["RobotTestingFramework.", "RTF.", "robottestingframework."],
    words: ["true", "false", "nil"],
    template: "class TestCase
  def setup(param)
    P.setName('MyTest')
    P.testReport('setup: ' + param)
    return SETUP
  end

  def run
    RUN
  end

  def tearDown
    P.testReport('torn down')
  end
end
",
};

/// What one test does in `run`, and what comes of it.
struct Case {
    name: &'static str,
    run: &'static str,
    verdict: Verdict,
    told: &'static [(MessageKind, &'static str)],
}

use MessageKind::{Check, Error, Failure, Report};

const ON: (MessageKind, &str) = (Report, "on");

const CASES: [Case; 9] = [
    Case {
        name: "report",
        run: "P.testReport('100% sure: %s %n')",
        verdict: Verdict::Passed,
        told: &[(Report, "100% sure: %s %n"), ON],
    },
    Case {
        name: "check-true",
        run: "P.testCheck(TRUE, 'closed')",
        verdict: Verdict::Passed,
        told: &[(Check, "closed"), ON],
    },
    Case {
        name: "check-false",
        run: "P.testCheck(FALSE, 'closed')",
        verdict: Verdict::Failed,
        told: &[(Failure, "closed"), ON],
    },
    Case {
        name: "check-nothing",
        run: "P.testCheck(NOTHING, 'closed')",
        verdict: Verdict::Failed,
        told: &[(Failure, "closed"), ON],
    },
    Case {
        name: "fail-if-true",
        run: "P.testFailIf(TRUE, 'closed')",
        verdict: Verdict::Passed,
        told: &[ON],
    },
    Case {
        name: "fail-if-false",
        run: "P.testFailIf(FALSE, 'closed')",
        verdict: Verdict::Failed,
        told: &[(Failure, "closed"), ON],
    },
    Case {
        name: "assert-fail",
        run: "P.assertFail('50% too fast')",
        verdict: Verdict::Failed,
        told: &[(Failure, "50% too fast")],
    },
    Case {
        name: "assert-error",
        run: "P.assertError('no bus %d')",
        verdict: Verdict::Error,
        told: &[(Error, "no bus %d")],
    },
    Case {
        name: "environment",
        run: "P.testReport(P.getEnvironment())",
        verdict: Verdict::Passed,
        told: &[(Report, "--robot simulator"), ON],
    },
];

const PARAM: &str = "--file \"a b.ini\" c";

impl Language {
    fn test(&self, prefix: &str, setup: &str, run: &str) -> String {
        let run = format!("{run}\n  P.testReport('on')");
        let [yes, no, nothing] = self.words;
        self.template
            .replace("RUN", &run.replace('\n', &format!("\n{}", self.indentation())))
            .replace("SETUP", setup)
            .replace("P.", prefix)
            .replace("TRUE", yes)
            .replace("FALSE", no)
            .replace("NOTHING", nothing)
    }

    /// The blanks before `RUN`, beyond the two of the second line.
    fn indentation(&self) -> String {
        let line = self.template.lines().find(|line| line.trim() == "RUN").expect("a line");
        " ".repeat(line.len() - line.trim_start().len() - 2)
    }

    /// Runs tests in one suite: their names and sources.
    fn run(&self, tests: &[(String, String)]) -> (Folder, Record) {
        let folder = Folder::new();
        let mut suite =
            String::from("<suite name='old'>\n<environment>--robot simulator</environment>\n");
        for (name, source) in tests {
            folder.file(&format!("{name}.{}", self.extension), source);
            let param = PARAM.replace('"', "&quot;");
            suite += &format!("<test type='{}' param='{param}'> {name} </test>\n", self.kind);
        }
        folder.file("s.xml", &(suite + "</suite>\n"));
        let finished = folder.rtf(&["run", "s.xml"]);
        assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
        let record = folder.journal().record;
        (folder, record)
    }
}

/// Kind, text and place of all that a test told.
fn told(record: &Record, test: usize) -> Vec<(MessageKind, String, bool)> {
    let messages = record.tests[test].attempts[0].messages.iter();
    messages.map(|m| (m.kind, m.text.clone(), m.location.is_some())).collect()
}

/// Each function, called in each way: the verdict, what is told, and a
/// tear-down in any case.
fn check_functions(language: &Language) {
    for prefix in language.prefixes {
        let source = |case: &Case| language.test(prefix, language.words[0], case.run);
        let tests: Vec<_> = CASES.iter().map(|case| (case.name.to_owned(), source(case))).collect();
        let (_folder, record) = language.run(&tests);
        for (index, case) in CASES.iter().enumerate() {
            let what = format!("{} {prefix}: {}", language.kind, case.name);
            let setup = format!("setup: {PARAM}");
            let before = [(Report, "test name: MyTest"), (Report, setup.as_str())];
            let after = [(Report, "torn down")];
            let expected = before.iter().chain(case.told).chain(&after);
            let expected: Vec<_> = expected.map(|(k, t)| (*k, (*t).to_owned(), true)).collect();
            assert_eq!(told(&record, index), expected, "{what}");
            assert_eq!(record.tests[index].verdict(), Some(case.verdict), "{what}");
        }
    }
}

/// The predecessor's `setup` has to return true; `run` is not called otherwise.
fn check_setup(language: &Language) {
    let [yes, no, nothing] = language.words;
    let returned = [("yes", yes), ("number", "1"), ("no", no), ("nothing", nothing)];
    let source = |result| language.test(language.prefixes[0], result, "P.testCheck(TRUE, 'ran')");
    let tests: Vec<_> =
        returned.iter().map(|(name, result)| ((*name).to_owned(), source(result))).collect();
    let (_folder, record) = language.run(&tests);
    let verdicts: Vec<_> = record.tests.iter().map(|test| test.verdict().expect("one")).collect();
    let (passed, error) = (Verdict::Passed, Verdict::Error);
    assert_eq!(verdicts, [passed, passed, error, error], "{}", language.kind);
    assert_eq!(record.tests[2].reason(), Some("setup returned false"));
    assert_eq!(
        record.tests[3].reason().and_then(|reason| reason.lines().next()),
        Some("setup returned nothing, it has to return true")
    );
    for test in 2..4 {
        let texts: Vec<_> = told(&record, test).into_iter().map(|(_, text, _)| text).collect();
        assert!(!texts.contains(&"ran".to_owned()), "{texts:?}");
        assert_eq!(texts.last().map(String::as_str), Some("torn down"), "{}", language.kind);
    }
}

#[test]
fn lua() {
    check_functions(&LUA);
    check_setup(&LUA);
}

#[test]
fn python() {
    check_functions(&PYTHON);
    check_setup(&PYTHON);
}

#[test]
fn ruby() {
    check_functions(&RUBY);
    check_setup(&RUBY);
}

/// What only makes sense in Lua: a table of one's own, and a file without `setup`.
#[test]
fn lua_tables() {
    let table = "TestCase = {}\nfunction TestCase.run() TestCase.testCheck(false, 'own') end\n";
    let fields = "TestCase.run = function()
  for name in pairs(TestCase) do RTF.testReport(name) end
  TestCase.assertFail('end')
end\n";
    let tests = [("table".to_owned(), table.to_owned()), ("fields".to_owned(), fields.to_owned())];
    let (_folder, record) = LUA.run(&tests);
    assert_eq!(told(&record, 0), [(Failure, "own".to_owned(), true)]);
    let expected = [(Report, "run".to_owned(), true), (Failure, "end".to_owned(), true)];
    assert_eq!(told(&record, 1), expected);
}
