//! A host whose plug-ins are functions, and the runner at the other end of its channel.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rtf_host::{CaseEnd, HostPlugin, LoadError, PluginKind, Session, Step, StepEnd, serve};
use rtf_model::protocol::{Initialized, Plugin, StackSupport};
use rtf_model::{Message, MessageKind};
use serde_json::{Value, json};

/// A plug-in's functions.
pub type Script = fn(&Session, Step) -> StepEnd;

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
            runs_episodes: true,
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
pub struct Runner {
    channel: UnixStream,
    lines: std::io::Lines<BufReader<UnixStream>>,
}

impl Runner {
    pub fn start(script: Script) -> Self {
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

    pub fn send(&mut self, message: &Value) {
        writeln!(self.channel, "{message}").unwrap();
    }

    pub fn line(&mut self) -> Value {
        serde_json::from_str(&self.lines.next().unwrap().unwrap()).unwrap()
    }

    /// Sends a request. Returns the notifications, without phases, and the result.
    pub fn ask(&mut self, method: &str, cases: &Value) -> (Vec<String>, Value) {
        let params = json!({"file": "f", "name": "T", "cases": cases});
        self.send(&json!({"id": 1, "method": method, "params": params}));
        self.finish()
    }

    /// Starts a test with slots, and returns when its `run` has begun.
    pub fn start_episodes(script: Script, slots: u32) -> Self {
        Self::start_with_limits(script, &json!({"slots": slots}))
    }

    /// Does the same with these settings of `episodes`.
    pub fn start_with_limits(script: Script, settings: &Value) -> Self {
        let mut runner = Self::start(script);
        let params = json!({"file": "f", "name": "T", "episodes": settings});
        runner.send(&json!({"id": 1, "method": "run-test", "params": params}));
        while runner.line()["params"]["phase"] != "run" {}
        runner
    }

    /// Sends episodes with these ids.
    pub fn send_episodes(&mut self, ids: impl IntoIterator<Item = u64>) {
        let episode = |id| json!({"id": id, "seed": id + 100, "parameters": {"payload": "1.2"}});
        let episodes: Vec<Value> = ids.into_iter().map(episode).collect();
        self.send(&json!({"method": "episodes", "params": {"episodes": episodes}}));
    }

    pub fn end_episodes(&mut self) {
        self.send(&json!({"method": "end-of-episodes", "params": {}}));
    }

    /// Returns the notifications until the answer, without phases, and the result.
    pub fn finish(&mut self) -> (Vec<String>, Value) {
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
            let episode = params["episode"]["id"].as_u64();
            let episode = episode.map_or(String::new(), |id| format!(", episode {id}"));
            format!("start {case} in {parent}: {}{episode}", text("name"))
        }
        "case-finished" => {
            // Another crate of the workspace decides whether the maps of serde_json are sorted.
            let end = params.get("episode").and_then(Value::as_object).map(BTreeMap::from_iter);
            let end = end.map_or(String::new(), |end| format!(" {}", json!(end)));
            let words = format!("end {case} {} {}", text("outcome"), text("reason"));
            format!("{}{end}", words.trim_end())
        }
        "cases-planned" => format!("plan {}", params["names"]),
        "message" => format!("{} in {case}: {}", text("kind"), text("text")),
        "sampled" => format!("{} samples in {case}", params["points"].as_array().unwrap().len()),
        method => format!("{method} in {case}"),
    }
}

pub fn send(session: &Session, kind: MessageKind, text: &str) {
    let text = text.to_owned();
    let (location, comparison, case) = (None, None, None);
    session.message(Message {
        kind,
        text,
        location,
        comparison,
        critical: false,
        case,
        interval: None,
    });
}

pub fn report(session: &Session, text: &str) {
    send(session, MessageKind::Report, text);
}

/// Runs a body as a case, as SDKs do.
pub fn case(session: &Session, name: &str, body: impl FnOnce() -> CaseEnd) {
    if session.begin_case(name.to_owned(), Vec::new(), None) {
        session.end_case(body());
    }
}

pub fn done(session: &Session, name: &str) {
    case(session, name, || CaseEnd::Done);
}

pub fn run(script: Script, cases: &Value) -> (Vec<String>, Value) {
    Runner::start(script).ask("run-test", cases)
}

pub fn all(script: Script) -> (Vec<String>, Value) {
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

pub(crate) use in_run;
