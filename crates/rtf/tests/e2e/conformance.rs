//! Every scenario of `conformance/` in every language, with the real hosts.

mod checkers;
mod faults;
mod suites;

use std::path::PathBuf;

use rtf_model::{
    AttemptRecord, CaseRecord, Event, EventKind, ExitStatus, Record, SuiteId, TestId, TestRecord,
    Verdict,
};
use serde_json::{Value, json};

use self::suites::{Plugins, suite};
use crate::clock::SIMULATOR;
use crate::host_modes::{FORKED, Mode, PROCESS, SHARED};
use crate::support::{Finished, Folder, Journal, nothing_left, root};

struct Language {
    name: &'static str,
    plugin_type: &'static str,
    file: &'static str,
}

const LANGUAGES: [Language; 5] = [
    Language { name: "cpp", plugin_type: "dll", file: "plugin.so" },
    Language { name: "lua", plugin_type: "lua", file: "plugin.lua" },
    Language { name: "python", plugin_type: "python", file: "plugin.py" },
    Language { name: "ruby", plugin_type: "ruby", file: "plugin.rb" },
    Language { name: "ada", plugin_type: "dll", file: "libplugin.so" },
];

#[test]
fn cpp() {
    check(&LANGUAGES[0], PROCESS);
}

#[test]
fn cpp_forked() {
    check(&LANGUAGES[0], FORKED);
}

#[test]
fn cpp_shared() {
    check(&LANGUAGES[0], SHARED);
}

#[test]
fn lua() {
    check(&LANGUAGES[1], PROCESS);
}

#[test]
fn lua_forked() {
    check(&LANGUAGES[1], FORKED);
}

#[test]
fn lua_shared() {
    check(&LANGUAGES[1], SHARED);
}

#[test]
fn python() {
    check(&LANGUAGES[2], PROCESS);
}

#[test]
fn python_forked() {
    check(&LANGUAGES[2], FORKED);
}

#[test]
fn python_shared() {
    check(&LANGUAGES[2], SHARED);
}

#[test]
fn ruby() {
    check(&LANGUAGES[3], PROCESS);
}

#[test]
fn ruby_shared() {
    check(&LANGUAGES[3], SHARED);
}

#[test]
fn ada() {
    check(&LANGUAGES[4], PROCESS);
}

#[test]
fn ada_forked() {
    check(&LANGUAGES[4], FORKED);
}

#[test]
fn ada_shared() {
    check(&LANGUAGES[4], SHARED);
}

fn folder() -> PathBuf {
    root().join("conformance").canonicalize().expect("the conformance folder")
}

fn scenarios() -> Vec<String> {
    let entries = std::fs::read_dir(folder().join("scenarios")).expect("scenarios").flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    assert!(names.len() >= 14, "scenarios are missing: {names:?}");
    names
}

fn is_excepted(scenario: &str, language: &str) -> bool {
    let text = std::fs::read_to_string(folder().join("exceptions.json")).expect("exceptions.json");
    let list: Vec<Value> = serde_json::from_str(&text).expect("a list of exceptions");
    list.iter().any(|entry| {
        assert!(entry["reason"].as_str().is_some_and(|reason| reason.len() > 20), "{entry}");
        entry["scenario"] == scenario && entry["language"] == language
    })
}

fn check(language: &Language, mode: Mode) {
    check_with(language, mode, &Folder::new(), "", Folder::rtf);
}

/// Builds C++ plug-ins with these compiler flags, and starts `rtf` with `start`.
fn check_with(
    language: &Language,
    mode: Mode,
    temp: &Folder,
    flags: &str,
    start: impl Fn(&Folder, &[&str]) -> Finished,
) {
    let scenarios: Vec<String> =
        scenarios().into_iter().filter(|name| !is_excepted(name, language.name)).collect();
    let plugins = Plugins::build(language, &scenarios, flags);
    for scenario in &scenarios {
        temp.file(&format!("{scenario}.xml"), &suite(scenario, &plugins, mode.isolation));
    }
    temp.file("simulator.py", SIMULATOR).file("camera.py", faults::CAMERA);
    for picture in ["scene.png", "stored.png"] {
        let path = folder().join("scenarios/picture").join(picture);
        std::fs::copy(path, temp.path().join(picture)).expect("a picture");
    }
    let finished = start(temp, &["run", "--fork", mode.fork, "."]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let journal = temp.journal();
    let problems: Vec<String> = scenarios
        .iter()
        .flat_map(|name| {
            let expected = expectations(name, language.name, mode);
            check_scenario(name, (mode, expected), &journal, temp)
        })
        .collect();
    assert!(problems.is_empty(), "{}: \n{}", language.name, problems.join("\n"));
    assert!(nothing_left(temp), "processes are left");
}

fn check_scenario(
    scenario: &str,
    (mode, expected): (Mode, Vec<Value>),
    Journal { events, record }: &Journal,
    temp: &Folder,
) -> Vec<String> {
    let Some(suite) = record.suites.iter().find(|suite| suite.plan.name == scenario) else {
        return vec![format!("{scenario}: was not run")];
    };
    let [before_it, scenarios, after_it] = suite.tests[..] else { panic!("three tests") };
    let test = &record.tests[scenarios.index()];
    let attempt = test.attempts.last().expect("an attempt");
    let told = told(events, suite.plan.suite, record, temp);
    let mut problems = compare_told(scenario, &expected, &told);
    problems.extend(compare_cases(
        scenario,
        &expected,
        &finished_cases(events, scenarios, attempt),
    ));
    problems.extend(faults::compare(scenario, &expected, &attempt.faults));
    problems.extend(check_before(scenario, mode, &record.tests[before_it.index()]));
    let mut after = "passed";
    for line in &expected {
        if let Some(verdict) = line.get("after").and_then(Value::as_str) {
            after = verdict;
        } else if let Some(problem) = check_fact(line, attempt) {
            problems.push(format!("{scenario}: {problem}"));
        } else if line.get("stdout_starts").is_some() {
            problems.extend(check_output(line, events, scenarios));
        }
    }
    let found = record.final_verdict(after_it);
    if found.as_str() != after {
        problems.push(format!("{scenario}: the test after it is {found}, expected {after}"));
    }
    problems
}

/// A test that passes in a shared host has no exit status: the host lives.
fn check_before(scenario: &str, mode: Mode, before: &TestRecord) -> Option<String> {
    let (_, finished) = before.attempts.last()?.finished.as_ref()?;
    let exit = (!mode.shares()).then_some(ExitStatus::Code(0));
    let holds = (finished.verdict, finished.exit) == (Verdict::Passed, exit);
    (!holds).then(|| format!("{scenario}: the test before it: {finished:?}"))
}

fn expectations(scenario: &str, language: &str, mode: Mode) -> Vec<Value> {
    let path = folder().join("scenarios").join(scenario).join("expect.jsonl");
    let text = std::fs::read_to_string(path).expect("expect.jsonl");
    let lines = text.lines().map(|line| {
        let mut line = serde_json::from_str::<Value>(line).expect("a JSON line");
        if mode.shares() && line["verdict"] == "passed" {
            line.as_object_mut().map(|line| line.remove("exit"));
        }
        line
    });
    lines
        .filter(|line| {
            line.get("languages").is_none_or(|only| {
                only.as_array().is_some_and(|only| only.iter().any(|name| name == language))
            })
        })
        .collect()
}

/// What the scenario's test told, in order, as in `expect.jsonl`.
fn told(events: &[Event], suite: SuiteId, record: &Record, temp: &Folder) -> Vec<Value> {
    let test = record.suites[suite.index()].tests[1];
    let attempt = record.tests[test.index()].attempts.last().expect("an attempt");
    let mut told = Vec::new();
    for event in events {
        match &event.kind {
            EventKind::Message { source, message, .. }
                if *source == rtf_model::Source::Test(test) =>
            {
                let mut line = serde_json::to_value(message).expect("a message");
                line["message"] = line["kind"].take();
                let case = message.case.and_then(|case| attempt.cases.get(case));
                line["case"] = json!(case.map(|case| &case.path));
                told.push(line);
            }
            EventKind::Measured { test: of, measurement, .. } if *of == test => {
                let mut line = serde_json::to_value(measurement).expect("a measurement");
                line["measured"] = line["name"].take();
                told.push(line);
            }
            EventKind::Sampled { test: of, samples } if *of == test => {
                add_samples(&mut told, samples);
            }
            EventKind::Attached { test: of, attachment, .. } if *of == test => {
                let path = temp.path().join("rtf-results/latest").join(&attachment.path);
                let content = std::fs::read(path).expect("the attached file");
                let content = String::from_utf8_lossy(&content);
                let (name, kind) = (&attachment.name, &attachment.media_type);
                told.push(json!({"attached": name, "media_type": kind, "content": content}));
            }
            EventKind::QuestionAsked(asked) if asked.test == test => {
                let mut line = serde_json::to_value(&asked.question).expect("a question");
                let case = asked.question.case.and_then(|case| attempt.cases.get(case));
                line["asked"] = line["text"].take();
                line["case"] = json!(case.map(|case| &case.path));
                line["has_picture"] = json!(asked.question.picture.is_some());
                told.push(line);
            }
            EventKind::QuestionClosed(closed) if closed.test == test => {
                let mut line = serde_json::to_value(closed).expect("an end");
                line["answer"] = json!(closed.answer);
                told.push(line);
            }
            _ => {}
        }
    }
    told
}

/// Samples of a signal under the same limits are one fact, however many batches.
fn add_samples(told: &mut Vec<Value>, samples: &rtf_model::Samples) {
    let mut line = serde_json::to_value(samples).expect("samples");
    line["sampled"] = line["name"].take();
    let points = line["points"].take();
    let is_same = |other: &&mut Value| {
        ["sampled", "unit", "low", "high"].iter().all(|key| other[*key] == line[*key])
    };
    let line = match told.iter_mut().find(is_same) {
        Some(line) => line,
        None => {
            (line["times"], line["values"]) = (json!([]), json!([]));
            told.push(line);
            told.last_mut().expect("the last line")
        }
    };
    for point in points.as_array().expect("points") {
        for (index, key) in ["times", "values"].into_iter().enumerate() {
            line[key].as_array_mut().expect("a list").push(point[index].clone());
        }
    }
}

fn compare_told(scenario: &str, expected: &[Value], told: &[Value]) -> Vec<String> {
    let is_told = |line: &&Value| {
        ["message", "measured", "sampled", "attached", "asked", "answer"]
            .iter()
            .any(|key| line.get(*key).is_some())
    };
    let expected: Vec<&Value> = expected.iter().filter(is_told).collect();
    let mut problems = Vec::new();
    if expected.len() != told.len() {
        problems.push(format!("{scenario}: expected {} messages, got {told:#?}", expected.len()));
    }
    for (expected, told) in expected.iter().zip(told) {
        if let Some(problem) = mismatch(expected, told) {
            problems.push(format!("{scenario}: {problem} in {told}"));
        }
    }
    problems
}

/// The cases of the scenario's test, in the order in which they finished.
fn finished_cases(events: &[Event], test: TestId, attempt: &AttemptRecord) -> Vec<Value> {
    let finished = events.iter().filter_map(|event| match &event.kind {
        EventKind::CaseFinished(end) if end.test == test => attempt.cases.get(end.case),
        _ => None,
    });
    let line = |case: &CaseRecord| {
        let (verdict, parameters) = (case.verdict(), &case.start.parameters);
        json!({
            "case": case.path, "verdict": verdict, "reason": case.reason(),
            "parameters": parameters,
        })
    };
    finished.map(line).collect()
}

fn compare_cases(scenario: &str, expected: &[Value], finished: &[Value]) -> Vec<String> {
    let expected: Vec<&Value> = expected.iter().filter(|line| is_case(line)).collect();
    let mut problems = Vec::new();
    if expected.len() != finished.len() {
        problems.push(format!("{scenario}: expected {} cases, got {finished:#?}", expected.len()));
    }
    for (expected, finished) in expected.iter().zip(finished) {
        if let Some(problem) = mismatch(expected, finished) {
            problems.push(format!("{scenario}: {problem} in {finished}"));
        }
    }
    problems
}

/// Whether a line of `expect.jsonl` describes a finished case.
fn is_case(line: &Value) -> bool {
    line.get("case").is_some() && line.get("verdict").is_some()
}

/// The first entry of `expected` that `found` does not have.
fn mismatch(expected: &Value, found: &Value) -> Option<String> {
    let entries = expected.as_object().expect("an object");
    entries.iter().filter(|(key, _)| *key != "languages").find_map(|(key, value)| {
        let holds = match key.strip_suffix("_contains") {
            Some(key) => found[key]
                .as_str()
                .is_some_and(|text| text.contains(value.as_str().expect("a text"))),
            None if value.is_object() => mismatch(value, &found[key]).is_none(),
            None => same(value, &found[key]),
        };
        (!holds).then(|| format!("expected {key} = {value}"))
    })
}

/// JSON equality in which 95 and 95.0 are the same.
fn same(a: &Value, b: &Value) -> bool {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => a == b,
        _ => a == b,
    }
}

fn check_fact(line: &Value, attempt: &AttemptRecord) -> Option<String> {
    if let Some(expected) = line.get("not_run").and_then(Value::as_u64) {
        let not_run = attempt.cases.not_run();
        return (not_run.len() as u64 != expected)
            .then(|| format!("expected {expected} cases that did not run, got {not_run:?}"));
    }
    if line.get("verdict").is_some() && !is_case(line) {
        let (_, finished) = attempt.finished.as_ref()?;
        let found = serde_json::to_value(finished).expect("a finish");
        return mismatch(line, &found).map(|problem| format!("{problem} in {found}"));
    }
    if line.get("stack").is_some() {
        return attempt.stacks.is_empty().then(|| "no stack dump".to_owned()).or_else(|| {
            let text = attempt.stacks.join("\n");
            text.contains("no stack dump").then_some(text)
        });
    }
    if let Some(command) = line.get("left").and_then(Value::as_str) {
        let found = attempt.leaked.iter().any(|process| process.command.contains(command));
        return (!found).then(|| format!("no process was left: {:?}", attempt.leaked));
    }
    None
}

fn check_output(line: &Value, events: &[Event], test: TestId) -> Vec<String> {
    let outputs = events.iter().filter_map(|event| match &event.kind {
        EventKind::Output(output) if output.source == rtf_model::Source::Test(test) => Some(output),
        _ => None,
    });
    let (mut text, mut omitted) = (String::new(), 0);
    for output in outputs {
        text += &output.text;
        omitted += output.omitted_bytes;
    }
    let wanted = |key: &str| line[key].as_str().unwrap_or_default();
    let mut problems = Vec::new();
    if !text.starts_with(wanted("stdout_starts")) || !text.ends_with(wanted("stdout_ends")) {
        problems.push(format!("output-flood: {} bytes of other output", text.len()));
    }
    if line["stdout_omits"] == true && omitted == 0 {
        problems.push("output-flood: nothing was left out".to_owned());
    }
    problems
}
