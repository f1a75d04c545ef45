//! Cases and skips as the host reports them, driven over a socket pair.
#![expect(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::channel;
use std::time::Duration;

use rtf_host::{CaseEnd, HostPlugin, LoadError, PluginKind, Sample, Session, Step, StepEnd, serve};
use rtf_model::protocol::{Initialized, Plugin, StackSupport};
use rtf_model::{Measurement, Message, MessageKind, Parameter};
use serde_json::{Value, json};

/// A plug-in's functions.
type Script = fn(&Session, Step) -> StepEnd;

struct ScriptHost {
    session: Session,
    script: Script,
}

impl HostPlugin for ScriptHost {
    fn describe(&self) -> Initialized {
        Initialized {
            protocol: 1,
            host: "script".into(),
            stack: StackSupport::None,
            supports_shared: false,
            selects_cases: true,
        }
    }

    fn load(&mut self, _kind: PluginKind, _plugin: &Plugin) -> Result<(), LoadError> {
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        (self.script)(&self.session, step)
    }
}

/// A host that was initialised, and the runner's end of its channel.
struct Runner {
    channel: UnixStream,
    lines: std::io::Lines<BufReader<UnixStream>>,
}

impl Runner {
    fn start(script: Script) -> Self {
        let (ours, theirs) = UnixStream::pair().unwrap();
        ours.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let session = Session::over(theirs);
        let host = ScriptHost { session: session.clone(), script };
        std::thread::spawn(move || serve(&session, host));
        let lines = BufReader::new(ours.try_clone().unwrap()).lines();
        let mut runner = Self { channel: ours, lines };
        let params = json!({"protocol": 1, "rtf": "x"});
        runner.send(&json!({"id": 0, "method": "initialize", "params": params}));
        assert_eq!(runner.line()["result"]["selects_cases"], true);
        runner
    }

    fn send(&mut self, message: &Value) {
        writeln!(self.channel, "{message}").unwrap();
    }

    fn line(&mut self) -> Value {
        serde_json::from_str(&self.lines.next().unwrap().unwrap()).unwrap()
    }

    /// Sends a request. Returns the notifications, without phases, and the result.
    fn ask(&mut self, method: &str, cases: &Value) -> (Vec<String>, Value) {
        let params = json!({"file": "f", "name": "T", "cases": cases});
        self.send(&json!({"id": 1, "method": method, "params": params}));
        let mut lines = Vec::new();
        loop {
            let line = self.line();
            if line["id"] == 1 {
                return (lines, line["result"].clone());
            }
            if line["method"] != "phase" {
                lines.push(describe(&line));
            }
        }
    }
}

/// A notification in few words.
fn describe(line: &Value) -> String {
    let params = &line["params"];
    let text = |name: &str| params[name].as_str().unwrap_or_default().to_owned();
    let case = params["case"].as_u64().map_or("-".to_owned(), |case| case.to_string());
    match line["method"].as_str().unwrap() {
        "case-started" => {
            let parent = params["parent"].as_u64().map_or("-".to_owned(), |id| id.to_string());
            format!("start {case} in {parent}: {}", text("name"))
        }
        "case-finished" => {
            format!("end {case} {} {}", text("outcome"), text("reason")).trim_end().to_owned()
        }
        "cases-planned" => format!("plan {}", params["names"]),
        "message" => format!("{} in {case}: {}", text("kind"), text("text")),
        "sampled" => format!("{} samples in {case}", params["points"].as_array().unwrap().len()),
        method => format!("{method} in {case}"),
    }
}

fn send(session: &Session, kind: MessageKind, text: &str) {
    let text = text.to_owned();
    let (location, comparison, case) = (None, None, None);
    session.message(Message { kind, text, location, comparison, critical: false, case });
}

fn report(session: &Session, text: &str) {
    send(session, MessageKind::Report, text);
}

/// Runs a body as a case, as SDKs do.
fn case(session: &Session, name: &str, body: impl FnOnce() -> CaseEnd) {
    if session.begin_case(name.to_owned(), Vec::new(), None) {
        session.end_case(body());
    }
}

fn done(session: &Session, name: &str) {
    case(session, name, || CaseEnd::Done);
}

fn run(script: Script, cases: &Value) -> (Vec<String>, Value) {
    Runner::start(script).ask("run-test", cases)
}

fn all(script: Script) -> (Vec<String>, Value) {
    run(script, &json!([]))
}

/// Calls a function in `run` only.
macro_rules! in_run {
    ($session:ident, $body:expr) => {
        |$session: &Session, step: Step| {
            if step == Step::Run {
                $body
            }
            StepEnd::Done
        }
    };
}

#[test]
fn a_case_has_a_number_parameters_and_a_location() {
    let mut runner = Runner::start(in_run!(session, {
        let parameter = Parameter { name: "joint".to_owned(), value: "3".to_owned() };
        let location = rtf_model::Location { file: "arm.cpp".to_owned(), line: 7 };
        assert!(session.begin_case("pose".to_owned(), vec![parameter], Some(location)));
        session.end_case(CaseEnd::Done);
    }));
    runner.send(&json!({"id": 1, "method": "run-test", "params": {"file": "f", "name": "T"}}));
    let started = std::iter::repeat_with(|| runner.line())
        .find(|line| line["method"] == "case-started")
        .unwrap();
    let expected = json!({
        "case": 1, "name": "pose", "parameters": [{"name": "joint", "value": "3"}],
        "location": {"file": "arm.cpp", "line": 7},
    });
    assert_eq!(started["params"], expected);
    let expected = json!({"jsonrpc": "2.0", "method": "case-finished", "params": {"case": 1}});
    assert_eq!(runner.line(), expected);
    while runner.line()["id"] != 1 {}
}

#[test]
fn nested_cases_know_their_parent_and_messages_their_case() {
    let (lines, _) = all(in_run!(session, {
        report(session, "before");
        case(session, "Arm", || {
            case(session, "Moves", || {
                report(session, "moving");
                CaseEnd::Done
            });
            report(session, "moved");
            CaseEnd::Done
        });
        report(session, "after");
    }));
    let expected = [
        "report in -: before",
        "start 1 in -: Arm",
        "start 2 in 1: Moves",
        "report in 2: moving",
        "end 2",
        "report in 1: moved",
        "end 1",
        "report in -: after",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn samples_and_measurements_belong_to_their_case() {
    let (lines, _) = all(in_run!(session, {
        let sample = || {
            let (low, high, time, place) = (None, None, None, None);
            session.sample(&Sample { name: "I", value: 1.0, unit: "A", low, high, time, place })
        };
        sample();
        case(session, "a", || {
            sample();
            sample();
            let (low, high, location, case) = (None, None, None, None);
            let (name, unit) = ("t".to_owned(), "s".to_owned());
            let value = Some(1.0);
            session.measure(Measurement { name, value, unit, low, high, location, case });
            sample();
            CaseEnd::Done
        });
        sample();
    }));
    let expected = [
        "1 samples in -",
        "start 1 in -: a",
        "2 samples in 1",
        "measured in 1",
        "1 samples in 1",
        "end 1",
        "1 samples in -",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn a_skip_ends_the_innermost_case_or_the_test() {
    let (lines, result) = all(in_run!(session, {
        case(session, "gripper", || {
            session.skip("it is not mounted");
            CaseEnd::Stopped
        });
        done(session, "arm");
    }));
    let expected = ["start 1 in -: gripper", "end 1 skipped it is not mounted"];
    assert_eq!(lines[..2], expected);
    assert_eq!(result, json!({"outcome": "passed"}));
    let (_, result) = all(|session, step| {
        assert_ne!(step, Step::Run, "a skipped set-up is not followed by run");
        if step == Step::Setup {
            session.skip("no camera");
        }
        StepEnd::Stopped
    });
    assert_eq!(result, json!({"outcome": "skipped", "reason": "no camera"}));
}

#[test]
fn a_problem_before_or_after_a_skip_has_precedence() {
    let (_, result) = all(in_run!(session, {
        send(session, MessageKind::Failure, "it moves");
        session.skip("no camera");
    }));
    assert_eq!(result, json!({"outcome": "failed"}));
    let (_, result) = all(|session, step| {
        match step {
            Step::Run => session.skip("no camera"),
            Step::TearDown => send(session, MessageKind::Error, "no power"),
            Step::Setup | Step::Check => {}
        }
        StepEnd::Done
    });
    assert_eq!(result, json!({"outcome": "error"}));
}

#[test]
fn cases_and_skips_are_errors_elsewhere() {
    for (wrong, script) in [
        (
            "cases are allowed in `run` only",
            (|session, step| {
                if step == Step::Setup {
                    case(session, "early", || panic!("the body must not run"));
                }
                StepEnd::Done
            }) as Script,
        ),
        ("`skip` is allowed in `setup` and `run` only", |session, step| {
            if step == Step::TearDown {
                session.skip("late");
            }
            StepEnd::Done
        }),
        ("cases are planned in `setup` and `run` only", |session, step| {
            if step == Step::TearDown {
                session.plan_cases(vec!["late".to_owned()]);
            }
            StepEnd::Done
        }),
        ("a case was finished on a thread that has no open case", |session, step| {
            if step == Step::Run {
                session.end_case(CaseEnd::Done);
            }
            StepEnd::Done
        }),
    ] {
        let (lines, result) = all(script);
        assert_eq!(lines, [format!("error in -: {wrong}")]);
        assert_eq!(result, json!({"outcome": "error"}));
    }
    let mut fixture = Runner::start(|session, step| {
        if step == Step::Setup {
            case(session, "in a fixture", || panic!("the body must not run"));
            session.skip("no robot");
        }
        StepEnd::Done
    });
    let (lines, result) = fixture.ask("set-up-fixture", &json!([]));
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert_eq!(result, json!({"outcome": "error"}));
    fixture.ask("tear-down-fixture", &json!([]));
}

#[test]
fn only_selected_cases_run() {
    let script: Script = in_run!(session, {
        session.plan_cases(["Arm", "Hand", "Head"].map(str::to_owned).to_vec());
        for outer in ["Arm", "Hand", "Head"] {
            case(session, outer, || {
                done(session, "Moves");
                done(session, "Stops");
                CaseEnd::Done
            });
        }
    });
    let (lines, _) = run(script, &json!([{"equals": "Arm/Moves"}, {"equals": "Hand"}]));
    let expected = [
        r#"plan ["Arm","Hand"]"#,
        "start 1 in -: Arm",
        "start 2 in 1: Moves",
        "end 2",
        "end 1",
        "start 3 in -: Hand",
        "start 4 in 3: Moves",
        "end 4",
        "start 5 in 3: Stops",
        "end 5",
        "end 3",
    ];
    assert_eq!(lines, expected);
    let (lines, result) = run(script, &json!([{"contains": "no such case"}]));
    assert_eq!((lines, result), (Vec::new(), json!({"outcome": "passed"})));
}

#[test]
fn a_case_that_stops_without_a_reason_is_an_error() {
    let (lines, _) = all(in_run!(session, {
        case(session, "silent", || CaseEnd::Stopped);
        case(session, "outer", || {
            case(session, "inner", || {
                send(session, MessageKind::Failure, "it moves");
                CaseEnd::Stopped
            });
            CaseEnd::Stopped
        });
    }));
    assert_eq!(lines[1], "end 1 error the case stopped without a reason");
    assert_eq!(lines[4..], ["failure in 3: it moves", "end 3", "end 2"]);
}

#[test]
fn a_thread_without_a_case_reports_in_that_of_the_test() {
    let (lines, _) = all(in_run!(session, {
        case(session, "main", || {
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    report(session, "a");
                    case(session, "own", || {
                        report(session, "b");
                        CaseEnd::Done
                    });
                    report(session, "c");
                });
            });
            CaseEnd::Done
        });
    }));
    let expected = [
        "start 1 in -: main",
        "report in 1: a",
        "start 2 in -: own",
        "report in 2: b",
        "end 2",
        "report in 1: c",
        "end 1",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn numbers_of_cases_on_several_threads_arrive_in_order() {
    let (lines, _) = all(in_run!(session, {
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..200).for_each(|number| done(session, &number.to_string())));
            }
        });
    }));
    let number = |line: &String| line.strip_prefix("start ")?.split(' ').next()?.parse().ok();
    let numbers: Vec<u32> = lines.iter().filter_map(number).collect();
    assert_eq!(numbers, (1..=800).collect::<Vec<_>>());
    assert_eq!(lines.len(), 2 * 800);
}

#[test]
fn after_a_stop_request_no_case_starts_and_none_finishes() {
    let mut runner = Runner::start(in_run!(session, {
        case(session, "open", || {
            report(session, "waiting");
            assert!(session.wait(Duration::from_secs(20)));
            CaseEnd::Stopped
        });
        case(session, "next", || panic!("the body must not run"));
    }));
    runner.send(&json!({"id": 1, "method": "run-test", "params": {"file": "f", "name": "T"}}));
    while runner.line()["params"]["text"] != "waiting" {}
    runner.send(&json!({"method": "interrupt", "params": {"reason": "Ctrl-C"}}));
    let mut lines = Vec::new();
    let result = loop {
        let line = runner.line();
        if line["id"] == 1 {
            break line["result"].clone();
        }
        lines.push(line);
    };
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert_eq!(lines[0]["params"]["phase"], "tear-down");
    assert_eq!(result, json!({"outcome": "interrupted", "reason": "Ctrl-C"}));
}

/// A thread that outlives its test finishes its case during the next test.
#[test]
fn a_case_of_an_earlier_test_is_not_reported() {
    use std::sync::Mutex;
    static FINISH: Mutex<Option<std::sync::mpsc::Sender<()>>> = Mutex::new(None);
    static FINISHED: Mutex<Option<std::sync::mpsc::Receiver<()>>> = Mutex::new(None);
    let mut runner = Runner::start(in_run!(session, {
        let finish = FINISH.lock().unwrap().take();
        if let Some(finish) = finish {
            finish.send(()).unwrap();
            FINISHED.lock().unwrap().take().unwrap().recv().unwrap();
            done(session, "second");
        } else {
            let ((finish, wait), (ended, finished)) = (channel(), channel());
            let (opened, is_open) = channel();
            let session = session.clone();
            std::thread::spawn(move || {
                case(&session, "first", || {
                    opened.send(()).unwrap();
                    wait.recv().unwrap();
                    CaseEnd::Done
                });
                ended.send(()).unwrap();
            });
            is_open.recv().unwrap();
            *FINISH.lock().unwrap() = Some(finish);
            *FINISHED.lock().unwrap() = Some(finished);
        }
    }));
    let (lines, _) = runner.ask("run-test", &json!([]));
    assert_eq!(lines, ["start 1 in -: first"]);
    let (lines, _) = runner.ask("run-test", &json!([]));
    assert_eq!(lines, ["start 1 in -: second", "end 1"]);
}

#[test]
fn a_name_that_is_too_long_for_a_line_is_an_error() {
    let (lines, result) = all(in_run!(session, {
        case(session, &"x".repeat(17 * 1024 * 1024), || panic!("the body must not run"));
        done(session, "next");
    }));
    let error = "the names or parameters of cases are longer than a line of the protocol";
    assert_eq!(lines, [&format!("error in -: {error}"), "start 1 in -: next", "end 1"]);
    assert_eq!(result, json!({"outcome": "error"}));
}
