//! The host's side of the protocol, driven over a socket pair as the runner drives it.
#![expect(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rtf_host::{
    HostPlugin, LoadError, PluginKind, Reaction, Sample, Session, Step, StepEnd, serve,
};
use rtf_model::protocol::{Initialized, Plugin, StackSupport};
use rtf_model::{Attachment, Measurement, Message, MessageKind};

/// A host whose plug-ins are scripts: for each step, a list of words in the file's name.
struct Script {
    session: Session,
    steps: HashMap<&'static str, Vec<String>>,
}

impl Script {
    fn send(&self, kind: MessageKind, text: &str) {
        let text = text.to_owned();
        self.session.message(Message {
            kind,
            text,
            location: None,
            comparison: None,
            critical: false,
            case: None,
        });
    }

    fn provide(&self, value: &str) {
        let (name, value) = value.split_once('=').unwrap();
        let value = match value {
            "huge" => "x".repeat(17 * 1024 * 1024).into(),
            json => serde_json::from_str(json).unwrap(),
        };
        self.session.provide(name.to_owned(), value);
    }

    fn act(&self, word: &str) -> Option<StepEnd> {
        let (verb, rest) = word.split_once(':').unwrap_or((word, ""));
        match verb {
            "report" => self.send(MessageKind::Report, rest),
            "fail" => self.send(MessageKind::Failure, rest),
            "error" => self.send(MessageKind::Error, rest),
            "measure" => {
                let value = rest.parse().ok();
                let (name, unit) = ("rate".to_owned(), "Hz".to_owned());
                let (low, high) = (Some(1.0), Some(2.0));
                self.session.measure(Measurement {
                    name,
                    value,
                    unit,
                    low,
                    high,
                    location: None,
                    case: None,
                });
            }
            "sample" => {
                let (value, time) = rest.split_once('@').unwrap_or((rest, ""));
                let (value, time) = (value.parse().unwrap(), time.parse().ok());
                let (low, high) = (None, Some(2.0));
                let place = Some(("script", 7));
                let sample = Sample { name: "rate", value, unit: "Hz", low, high, time, place };
                self.session.sample(&sample);
            }
            "sleep" => {
                if self.session.wait(Duration::from_secs(1000)) {
                    return Some(StepEnd::Stopped);
                }
            }
            "attach" => {
                let (name, path) = rest.split_once('@').unwrap();
                let (name, path) = (name.to_owned(), path.to_owned());
                self.session
                    .attach(Attachment { name, path, media_type: String::new(), case: None })
                    .unwrap();
            }
            "provide" => self.provide(rest),
            "fork" => {
                // SAFETY: the child only sends and ends, in this thread.
                #[expect(unsafe_code, reason = "what plug-ins do")]
                if unsafe { libc::fork() } == 0 {
                    self.act("sample:1@7");
                    self.act("provide:port=1");
                } else {
                    std::thread::sleep(Duration::from_millis(200));
                }
            }
            "false" => return Some(StepEnd::Refused),
            "throw" => return Some(StepEnd::Broken(rest.to_owned(), None)),
            "stop" => return Some(StepEnd::Stopped),
            _ => panic!("no such verb: {verb}"),
        }
        None
    }
}

impl HostPlugin for Script {
    fn describe(&self) -> Initialized {
        let stack = StackSupport::Message;
        Initialized {
            protocol: 1,
            host: "script 1".into(),
            stack,
            supports_shared: true,
            selects_cases: false,
        }
    }

    fn load(&mut self, _kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError> {
        if plugin.file == "missing" {
            return Err(LoadError { message: "no such script".into(), location: None });
        }
        let steps = plugin.file.split(';').filter(|part| !part.is_empty());
        for (part, step) in steps.zip(["setup", "run", "tear-down"]) {
            self.steps.insert(step, part.split(',').map(str::to_owned).collect());
        }
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        let words = match step {
            Step::Setup => &self.steps["setup"],
            Step::Run | Step::Check => &self.steps["run"],
            Step::TearDown => &self.steps["tear-down"],
        };
        words.iter().find_map(|word| self.act(word)).unwrap_or(StepEnd::Done)
    }

    fn stack_dumper(&self) -> Option<Reaction> {
        Some(Box::new(|session| session.stack("here".into())))
    }
}

/// The runner's end. A test reads every answer before it drops the runner: the end of
/// the channel ends the whole process while a plug-in is loaded.
struct Runner {
    channel: UnixStream,
    lines: std::io::Lines<BufReader<UnixStream>>,
}

impl Runner {
    /// A runner that has initialised its host.
    fn start() -> (Self, std::thread::JoinHandle<std::io::Result<()>>) {
        let (mut runner, host) = Self::silent();
        runner.send(
            r#"{"jsonrpc":"2.0","id":0,"method":"initialize","params":{"protocol":1,"rtf":"x"}}"#,
        );
        let expected = r#"{"jsonrpc":"2.0","id":0,"result":{"protocol":1,"host":"script 1","stack":"message","supports_shared":true}}"#;
        assert_eq!(runner.line(), expected);
        (runner, host)
    }

    fn silent() -> (Self, std::thread::JoinHandle<std::io::Result<()>>) {
        let (ours, theirs) = UnixStream::pair().unwrap();
        ours.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let session = Session::over(theirs);
        let host = Script { session: session.clone(), steps: HashMap::new() };
        let thread = std::thread::spawn(move || serve(&session, host));
        let lines = BufReader::new(ours.try_clone().unwrap()).lines();
        (Self { channel: ours, lines }, thread)
    }

    fn send(&mut self, line: &str) {
        writeln!(self.channel, "{line}").unwrap();
    }

    fn line(&mut self) -> String {
        self.lines.next().unwrap().unwrap()
    }

    fn ask(&mut self, method: &str, script: &str) {
        let params = format!(r#"{{"file":"{script}","name":"T"}}"#);
        self.send(&format!(r#"{{"jsonrpc":"2.0","id":1,"method":"{method}","params":{params}}}"#));
    }

    /// The result of the next answer; earlier lines are ignored.
    fn result(&mut self) -> String {
        loop {
            let line = self.line();
            if let Some((_, result)) = line.split_once(r#""id":1,"result":"#) {
                return result.trim_end_matches('}').trim_start_matches('{').to_owned();
            }
        }
    }

    fn run_test(&mut self, script: &str) -> String {
        self.ask("run-test", script);
        self.result()
    }
}

#[test]
fn a_test_announces_its_phases_and_passes() {
    let (mut runner, host) = Runner::start();
    runner.ask("run-test", "report:a;report:b;report:c");
    let expected = [
        r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"setup"}}"#,
        r#"{"jsonrpc":"2.0","method":"message","params":{"kind":"report","text":"a"}}"#,
        r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"}}"#,
        r#"{"jsonrpc":"2.0","method":"message","params":{"kind":"report","text":"b"}}"#,
        r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"tear-down"}}"#,
        r#"{"jsonrpc":"2.0","method":"message","params":{"kind":"report","text":"c"}}"#,
        r#"{"jsonrpc":"2.0","id":1,"result":{"outcome":"passed"}}"#,
    ];
    for line in expected {
        assert_eq!(runner.line(), line);
    }
    drop(runner);
    host.join().unwrap().unwrap();
}

#[test]
fn the_answer_has_a_reason_only_for_problems_that_were_not_reported() {
    let (mut runner, _host) = Runner::start();
    for (script, result) in [
        ("report:;fail:f,error:e;error:t", r#""outcome":"failed""#),
        ("report:;error:e,fail:f;report:", r#""outcome":"error""#),
        ("fail:f;stop;report:", r#""outcome":"failed""#),
        ("false;fail:never;report:", r#""outcome":"error","reason":"setup returned false""#),
        ("report:;false;report:", r#""outcome":"failed","reason":"run returned false""#),
        ("report:;report:;fail:t", r#""outcome":"failed""#),
        ("report:;throw:int;report:", r#""outcome":"error""#),
        ("report:;stop;report:", r#""outcome":"error","reason":"run stopped without a reason""#),
        ("report:;measure:1.5,measure:3;report:", r#""outcome":"failed""#),
        ("report:;measure:x;report:", r#""outcome":"failed""#),
        ("report:;sample:1@0.5,sample:3@1.25;report:", r#""outcome":"failed""#),
        ("missing", r#""outcome":"error""#),
        ("report:;report:;report:", r#""outcome":"passed""#),
    ] {
        assert_eq!(runner.run_test(script), result, "{script}");
    }
}

#[test]
fn samples_come_in_batches_and_before_later_messages() {
    let (mut runner, _host) = Runner::start();
    let many = vec!["sample:1@0.5"; 600].join(",");
    runner.ask("run-test", &format!("report:;sample:NaN@0,{many},report:r,sample:2@9;report:"));
    let (mut notifications, mut sampled, mut batches) = (Vec::new(), 0, 0);
    loop {
        let line = runner.line();
        if line.contains("\"id\"") {
            break;
        }
        let line: serde_json::Value = serde_json::from_str(&line).unwrap();
        if let Some(points) = line["params"]["points"].as_array() {
            assert!(points.len() <= 256, "{line}");
            (sampled, batches) = (sampled + points.len(), batches + 1);
        } else {
            notifications.push(format!("{sampled} {}", line["method"].as_str().unwrap()));
        }
    }
    let expected = ["0 phase", "0 message", "0 phase", "601 message", "602 phase", "602 message"];
    assert_eq!(notifications, expected);
    assert!((4..300).contains(&batches), "{batches} batches");
}

#[test]
fn a_forked_child_sends_only_its_own_samples_and_provides_no_values() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "report:;sample:1@3,fork;report:");
    let mut times = Vec::new();
    loop {
        let line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
        let points = line["params"]["points"].as_array().cloned().unwrap_or_default();
        times.extend(points.iter().map(|point| point[0].as_f64().unwrap()));
        assert_ne!(line["method"], "provided", "{line}");
        if !line["id"].is_null() {
            break;
        }
    }
    times.sort_by(f64::total_cmp);
    assert_eq!(times, [3.0, 7.0]);
}

/// The runner checks names and values: the host sends any.
#[test]
fn a_value_is_sent_at_once_and_unchecked() {
    let (mut runner, _host) = Runner::start();
    runner.ask("set-up-fixture", "provide:port=40123,report:up,provide:=[null];report:;report:");
    let mut lines = Vec::new();
    loop {
        let mut line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
        if !line["id"].is_null() {
            break;
        }
        lines.push((line["method"].take(), line["params"].take()));
    }
    let port = serde_json::json!({"name": "port", "value": 40123});
    let nameless = serde_json::json!({"name": "", "value": [null]});
    assert_eq!((&lines[0].0, &lines[0].1), (&"provided".into(), &port));
    assert_eq!(lines[1].1["text"], "up");
    assert_eq!((&lines[2].0, &lines[2].1), (&"provided".into(), &nameless));
    assert_eq!(lines.len(), 3);
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
}

#[test]
fn a_value_that_is_too_long_for_a_line_is_an_error() {
    let (mut runner, _host) = Runner::start();
    runner.ask("set-up-fixture", "provide:image=huge;report:;report:");
    let line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
    let error = "a value and its name are longer than a line of the protocol";
    assert_eq!(line["params"]["text"], error);
    assert_eq!(runner.result(), r#""outcome":"error""#);
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
}

#[test]
fn an_attachment_without_an_extension_gets_that_of_its_file() {
    let dir = std::env::temp_dir().join(format!("rtf-host-attach-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let (file, attachments) = (dir.join("plot.png"), dir.join("kept"));
    std::fs::write(&file, "x").unwrap();
    let (mut runner, _host) = Runner::start();
    let script = format!("report:;attach:arm 3@{0},attach:run.txt@{0};report:", file.display());
    let params = serde_json::json!({"file": script, "name": "T", "attachments_dir": attachments});
    runner.send(&serde_json::json!({"id": 1, "method": "run-test", "params": params}).to_string());
    let mut attached = Vec::new();
    while attached.len() < 2 {
        let line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
        attached.extend((line["method"] == "attached").then(|| line["params"].clone()));
    }
    runner.result();
    let paths = ["1-arm_3.png", "2-run.txt"].map(|name| serde_json::json!(attachments.join(name)));
    assert_eq!([&attached[0]["path"], &attached[1]["path"]], [&paths[0], &paths[1]]);
    assert_eq!(attached[0]["name"], "arm 3");
    std::fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn samples_are_sent_before_a_long_wait() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "sample:1@0.5,sleep;report:;report:");
    let sampled = (0..2).map(|_| runner.line()).last().unwrap();
    let expected = r#""params":{"name":"rate","unit":"Hz","high":2.0,"location":{"file":"script","line":7},"points":[[0.5,1.0]]}"#;
    assert!(sampled.contains(expected), "{sampled}");
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"enough"}}"#);
    assert!(runner.result().contains("enough"));
}

#[test]
fn after_a_failed_set_up_the_test_is_only_torn_down() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "false;report:never;report:torn down");
    let phases: Vec<String> = (0..3).map(|_| runner.line()).collect();
    assert!(phases[0].contains("setup") && phases[1].contains("tear-down"), "{phases:?}");
    assert!(phases[2].contains("torn down"), "{phases:?}");
    assert!(runner.result().contains("setup returned false"));
}

#[test]
fn a_stop_request_ends_a_sleep_but_not_the_one_in_tear_down() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "report:;report:sleeping,sleep;report:parking,sleep");
    while !runner.line().contains("sleeping") {}
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"Ctrl-C"}}"#);
    while !runner.line().contains("parking") {}
    runner.send(r#"{"method":"dump-stack"}"#);
    assert!(runner.line().contains(r#""method":"stack""#), "it still sleeps");
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"again"}}"#);
    assert_eq!(runner.result(), r#""outcome":"interrupted","reason":"Ctrl-C""#);
    assert_eq!(runner.run_test("report:;report:;report:"), r#""outcome":"passed""#);
}

#[test]
fn a_stop_request_that_crosses_the_answer_stops_nothing() {
    let (mut runner, _host) = Runner::start();
    assert_eq!(runner.run_test("report:;report:;report:"), r#""outcome":"passed""#);
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"late"}}"#);
    assert_eq!(runner.run_test("report:;report:;report:"), r#""outcome":"passed""#);
}

#[test]
fn a_fixture_is_set_up_checked_and_torn_down() {
    let (mut runner, _host) = Runner::start();
    runner.ask("set-up-fixture", "report:;false;report:");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
    runner.ask("check-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"failed","reason":"check returned false""#);
    runner.ask("run-test", "report:;report:;report:");
    assert!(runner.result().contains("a fixture is still set up"));
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
    runner.ask("check-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"error","reason":"no fixture is set up""#);
    runner.ask("set-up-fixture", "error:no power;report:;report:");
    assert_eq!(runner.result(), r#""outcome":"error""#);
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
}

#[test]
fn invalid_lines_are_refused_and_the_host_continues() {
    let (mut runner, _host) = Runner::silent();
    for (line, code) in [
        (r#"{"id":1,"method":"check-fixture","params":{}}"#, "-32600"),
        (r#"{"id":1,"method":"initialize","params":{"protocol":2,"rtf":"9"}}"#, "-32001"),
        (r#"{"id":1,"method":"initialize"}"#, "-32602"),
        (r#"{"id":1,"method":"dance"}"#, "-32601"),
        ("]", "-32700"),
    ] {
        runner.send(line);
        let answer = runner.line();
        assert!(answer.contains(&format!(r#""error":{{"code":{code},"#)), "{line} → {answer}");
    }
    runner.send(r#"{"id":1,"method":"initialize","params":{"protocol":1,"rtf":"9"}}"#);
    assert!(runner.line().contains("result"));
}

#[test]
fn stacks_are_dumped_while_the_plugin_hangs() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "report:;report:hanging,sleep;report:");
    while !runner.line().contains("hanging") {}
    runner.send(r#"{"method":"dump-stack"}"#);
    let stack = r#"{"jsonrpc":"2.0","method":"stack","params":{"text":"here"}}"#;
    assert_eq!(runner.line(), stack);
    runner.send(r#"{"method":"interrupt","params":{"reason":"too slow"}}"#);
    assert_eq!(runner.result(), r#""outcome":"interrupted","reason":"too slow""#);
}

#[test]
fn the_last_test_ends_the_host() {
    let (mut runner, host) = Runner::start();
    let params = r#"{"file":"report:;report:;report:","name":"T","is_last":true}"#;
    runner.send(&format!(r#"{{"id":1,"method":"run-test","params":{params}}}"#));
    assert_eq!(runner.result(), r#""outcome":"passed""#);
    host.join().unwrap().unwrap();
}

#[test]
fn a_text_longer_than_a_line_arrives_in_several_messages() {
    let (ours, theirs) = UnixStream::pair().unwrap();
    let session = Session::over(theirs);
    let text = "é".repeat(9 * 1024 * 1024);
    let sent = text.clone();
    let thread = std::thread::spawn(move || {
        let kind = MessageKind::Report;
        let (location, comparison) = (None, None);
        session.message(Message {
            kind,
            text: sent,
            location,
            comparison,
            critical: false,
            case: None,
        });
    });
    let mut arrived = String::new();
    for line in BufReader::new(ours).lines() {
        let line = line.unwrap();
        assert!(line.len() < 16 * 1024 * 1024);
        let value: serde_json::Value = serde_json::from_str(&line).unwrap();
        arrived.push_str(value["params"]["text"].as_str().unwrap());
        if arrived.len() >= text.len() {
            break;
        }
    }
    thread.join().unwrap();
    assert!(arrived == text);
}
