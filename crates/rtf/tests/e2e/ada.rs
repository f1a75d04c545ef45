//! Plug-ins in Ada: `sdk/ada/tests` and its example. `conformance.rs` has the tests for all
//! languages.

use std::path::PathBuf;

use rtf_model::{Record, TestId, Verdict};

use crate::support::{Folder, build_ada, gprbuild, nothing_left, root};

fn plugin(name: &str) -> PathBuf {
    let project = root().canonicalize().expect("a path").join("sdk/ada/tests/tests.gpr");
    let built = build_ada(&project, "PLUGIN", &[name.to_owned()]);
    built.join(name).join(format!("lib{name}.so"))
}

fn texts(record: &Record, test: usize) -> Vec<String> {
    let messages = record.tests[test].attempts[0].messages.iter();
    messages.map(|m| format!("{:?}: {}", m.kind, m.text)).collect()
}

/// A source for 2.x, which exports the procedure that makes its test.
#[test]
fn a_test_of_the_predecessor() {
    let folder = Folder::new();
    let file = plugin("predecessor");
    folder.file(
        "s.xml",
        &format!("<suite><test param='--rate 100'>{}</test></suite>", file.display()),
    );
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    let expected = [
        "Report: test name: AdaTest",
        "Report: test name: MyTest",
        "Report: setup: --rate 100",
        "Check: checked 100% %s",
        "Failure: not so",
        "Failure: loud",
        "Failure: the end",
        "Report: torn down",
    ];
    assert_eq!(texts(&record, 0), expected);
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Failed));
    assert_eq!(record.tests[0].reason(), Some("not so"));
    let places = record.tests[0].attempts[0].messages.iter().map(|message| {
        let place = message.location.as_ref().expect("a place");
        format!("{}:{}", place.file, place.line)
    });
    let lines = ["15", "28", "29", "31", "34"].map(|line| format!("predecessor.adb:{line}"));
    let places: Vec<_> = places.collect();
    assert_eq!([&places[2..5], &places[5..7]].concat(), lines);
}

/// Each library has copies of the SDK's types. One process checks several libraries, and runs tests
/// that share their host.
#[test]
fn several_plugins_in_one_process() {
    let folder = Folder::new();
    let tests: String = ["predecessor", "endings", "case_steps", "children"]
        .map(|name| format!("<test isolation='shared'>{}</test>", plugin(name).display()))
        .concat();
    folder.file("s.xml", &format!("<suite>{tests}</suite>"));
    let checked = folder.rtf(&["check", "s.xml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    folder.rtf(&["run", "s.xml"]);
    let record = folder.journal().record;
    for test in &record.tests {
        assert_ne!(test.final_verdict(), Verdict::Crashed, "{}", test.plan.name);
    }
}

/// Each ending of one plug-in: the verdict, and what is told before the tear-down.
#[test]
fn endings() {
    let cases: [(&str, Verdict, &[&str]); 7] = [
        (
            "session 'a b'",
            Verdict::Passed,
            &["Report: session, session 'a b', --robot sim, 1, 2", "Report: a b"],
        ),
        ("beyond", Verdict::Error, &["Error: CONSTRAINT_ERROR: endings.adb:21 index check failed"]),
        ("catch", Verdict::Failed, &["Failure: caught", "Report: went on"]),
        ("wait", Verdict::Passed, &["Check: four turns"]),
        (
            "numbers",
            Verdict::Failed,
            &[
                "Failure: length: got 2 values, expected 1",
                "Failure: sensor: got nan, expected 0 ± 0.1",
                "Check: nothing",
                "Failure: yaw: got 0, expected 1 ± 0.1 (off by 1)",
            ],
        ),
        (
            "tolerance",
            Verdict::Error,
            &["Error: CONSTRAINT_ERROR: the tolerance -1 is not a finite number from 0"],
        ),
        (
            "attach",
            Verdict::Error,
            &[
                "Error: `/nowhere/trace.csv` cannot be attached: No such file or directory (os error 2)",
            ],
        ),
    ];
    let folder = Folder::new();
    let file = plugin("endings");
    let tests = cases.iter().map(|(param, ..)| {
        let name = param.split(' ').next().expect("a word");
        let param = param.replace('\'', "&quot;");
        format!("<test name='{name}' param='{param}'>{}</test>\n", file.display())
    });
    let environment = "<environment>--robot sim</environment>";
    folder.file("s.xml", &format!("<suite>{environment}{}</suite>", tests.collect::<String>()));
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    for (index, (ending, verdict, told)) in cases.iter().enumerate() {
        let told = told.iter().map(|text| text.replace('\'', "\""));
        let expected: Vec<_> = told.chain(["Report: torn down".to_owned()]).collect();
        assert_eq!(texts(&record, index), expected, "{ending}");
        assert_eq!(record.tests[index].verdict(), Some(*verdict), "{ending}");
    }
    let beyond = &record.tests[1].attempts[0].messages[0];
    let place = beyond.location.as_ref().expect("the compiler's own place");
    assert_eq!((place.file.as_str(), place.line), ("endings.adb", 21));
}

/// Cases with values, in a test with a matrix: their verdicts, and the messages in them.
#[test]
fn cases_and_values() {
    let folder = Folder::new();
    let file = plugin("case_steps").display().to_string();
    let matrix = "<matrix name='side' values='left'/><matrix name='joint' values='3'/>";
    folder.file(
        "s.xml",
        &format!(
            "<suite><test name='nested' param='nested'>{file}</test>\
             <test name='matrix' param='matrix'>{file}{matrix}</test>\
             <test name='wait' param='wait' timeout='300ms'>{file}</test>\
             <test name='late' param='late'>{file}</test></suite>"
        ),
    );
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    let cases = |test: usize| {
        let kept = record.tests[test].attempts[0].cases.kept();
        let values = |case: &rtf_model::CaseRecord| {
            let values = case.start.parameters.iter();
            values.map(|own| format!(" {}={}", own.name, own.value)).collect::<String>()
        };
        let line = |case: &rtf_model::CaseRecord| {
            format!("{}{}: {}", case.path, values(case), case.verdict().expect("a verdict"))
        };
        kept.iter().map(line).collect::<Vec<_>>()
    };
    let index = "Error: CONSTRAINT_ERROR: case_steps.adb:15 index check failed";
    assert_eq!(texts(&record, 0), [index, "Report: moved 1", index, "Report: moved 2"]);
    let nested = [
        "arm joint=-3 side=left: error",
        "arm/moves: error",
        "hand empty=: error",
        "hand/moves: error",
    ];
    assert_eq!(cases(0), nested);
    let unknown = "Error: there is no parameter \"speed\"; this test has side, joint";
    assert_eq!(texts(&record, 1), ["Report: left, 2", unknown]);
    assert_eq!(record.verdict(TestId(2)), Some(Verdict::TimedOut));
    assert_eq!((cases(2), texts(&record, 2)), (vec!["waits: timed-out".to_owned()], vec![]));
    let late = [
        "Error: cases are allowed in `run` only",
        "Error: `skip` is allowed in `setup` and `run` only",
    ];
    assert_eq!((cases(3), texts(&record, 3)), (vec![], late.map(str::to_owned).to_vec()));
}

/// A watchdog task reports the collapse; a second fixture of the same library
/// fails to set up.
#[test]
fn a_fixture_with_a_task() {
    let folder = Folder::new();
    let file = plugin("fixture").display().to_string();
    folder.file(
        "Breaks.lua",
        "function TestCase.run() io.open('collapse', 'w'):close() rtf.sleep(60) end\n",
    );
    folder.file(
        "s.xml",
        &format!("<suite><fixture name='arm'>{file}</fixture><test>Breaks.lua</test></suite>"),
    );
    folder.file("Passes.lua", "function TestCase.run() end\n");
    let told =
        format!("<suite><fixture>{file}</fixture><test repetition='2'>Passes.lua</test></suite>");
    folder.file("told.xml", &told);
    assert_eq!(folder.rtf(&["run", "told.xml"]).code, Some(0));
    let attempts = &folder.journal().record.tests[0].attempts;
    assert_eq!(attempts[1].messages[0].text, " 0 Passes 2 1 passed: ");
    let bad =
        format!("<suite><fixture param='fails'>{file}</fixture><test>Breaks.lua</test></suite>");
    folder.file("t.xml", &bad);
    let finished = folder.rtf(&["run", "s.xml", "t.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    assert_eq!(record.tests[0].verdict(), Some(Verdict::Collapsed));
    assert!(record.tests[0].reason().is_some_and(|reason| reason.contains("the arm fell")));
    assert_eq!(record.tests[1].verdict(), Some(Verdict::Skipped));
    assert!(nothing_left(&folder));
}

/// Numbers keep all their digits; a number that JSON does not have is an error.
#[test]
fn a_fixture_provides_values() {
    let folder = Folder::new();
    let file = plugin("fixture").display().to_string();
    folder.file("Passes.lua", "function TestCase.run() end\n");
    let suite = |param: &str| {
        format!("<suite><fixture param='{param}'>{file}</fixture><test>Passes.lua</test></suite>")
    };
    folder.file("s.xml", &suite(""));
    folder.file("t.xml", &suite("infinite"));
    folder.file("u.xml", &suite("no JSON"));
    assert_eq!(folder.rtf(&["run", "s.xml", "t.xml", "u.xml"]).code, Some(1));
    let record = folder.journal().record;
    let values = record.fixtures[0].values.iter();
    let values: Vec<_> =
        values.map(|own| (own.name.as_str(), own.value.clone().expect("a value"))).collect();
    let expected = [
        ("model", serde_json::json!("arm \"1\"")),
        ("joints", serde_json::json!(-6)),
        ("gain", serde_json::json!(40.0)),
        ("rate", serde_json::json!(0.1)),
        ("least", serde_json::json!(f64::MIN_POSITIVE)),
        ("ready", serde_json::json!(false)),
        ("limits", serde_json::json!([-1.5, 1.5])),
    ];
    assert_eq!(values, expected);
    let errors = [
        "the value of `bad` is not a finite number",
        "the value of `bad` is not JSON: EOF while parsing a list at line 1 column 5",
    ];
    for (fixture, error) in record.fixtures[1..].iter().zip(errors) {
        let texts: Vec<&str> = fixture.messages.iter().map(|own| own.text.as_str()).collect();
        assert!(texts.contains(&error), "{texts:?}");
    }
}

/// A fixture is no test, and a plug-in that cannot be made says why.
#[test]
fn plug_ins_that_are_none() {
    let folder = Folder::new();
    folder.file("s.xml", &format!("<suite><test>{}</test></suite>", plugin("fixture").display()));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(2));
    assert!(finished.stderr.contains("is a fixture, not a test"), "{}", finished.stderr);
    folder
        .file("s.xml", &format!("<suite><test>{}</test></suite>", plugin("elaboration").display()));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(2));
    assert!(
        finished.stderr.contains("elaborated: raised PROGRAM_ERROR : no calibration"),
        "{}",
        finished.stderr
    );
    folder.file("s.xml", &format!("<suite><test>{}</test></suite>", plugin("no_test").display()));
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.tests[0].verdict(), Some(Verdict::Error));
    let reason = record.tests[0].reason().expect("a reason");
    assert!(reason.contains("the plug-in has no test"), "{reason}");
}

/// The example is built where its user would: in a folder of their own.
#[test]
fn the_example() {
    let folder = Folder::new();
    let sources = root().join("sdk/ada/examples");
    for name in ["move_test.ads", "move_test.adb", "move_test.gpr"] {
        folder.file(name, &std::fs::read_to_string(sources.join(name)).expect("a source"));
    }
    gprbuild(&folder.path().join("move_test.gpr"), &[]);
    folder.file("s.xml", "<suite><test param='0.4'>build/AdaMoveTest</test></suite>");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(texts(&folder.journal().record, 0)[1], "Check: elbow");
}
