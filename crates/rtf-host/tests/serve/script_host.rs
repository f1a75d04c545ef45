//! A host whose plug-ins are scripts, and the runner at the other end of its channel.

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
            interval: None,
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

    fn attach(&self, text: &str) {
        let (name, path) = text.split_once('@').unwrap();
        let (name, path) = (name.to_owned(), path.to_owned());
        let (media_type, case, picture, omitted) = (String::new(), None, None, false);
        self.session.attach(Attachment { name, path, media_type, case, picture, omitted }).unwrap();
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
                    learned: false,
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
            "attach" => self.attach(rest),
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
            runs_episodes: false,
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
pub struct Runner {
    channel: UnixStream,
    lines: std::io::Lines<BufReader<UnixStream>>,
}

impl Runner {
    /// A runner that has initialised its host.
    pub fn start() -> (Self, std::thread::JoinHandle<std::io::Result<()>>) {
        let (mut runner, host) = Self::silent();
        runner.send(
            r#"{"jsonrpc":"2.0","id":0,"method":"initialize","params":{"protocol":1,"rtf":"x"}}"#,
        );
        let expected = r#"{"jsonrpc":"2.0","id":0,"result":{"protocol":1,"host":"script 1","stack":"message","supports_shared":true}}"#;
        assert_eq!(runner.line(), expected);
        (runner, host)
    }

    pub fn silent() -> (Self, std::thread::JoinHandle<std::io::Result<()>>) {
        let (ours, theirs) = UnixStream::pair().unwrap();
        ours.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let session = Session::over(theirs);
        let host = Script { session: session.clone(), steps: HashMap::new() };
        let thread = std::thread::spawn(move || serve(&session, host));
        let lines = BufReader::new(ours.try_clone().unwrap()).lines();
        (Self { channel: ours, lines }, thread)
    }

    pub fn send(&mut self, line: &str) {
        writeln!(self.channel, "{line}").unwrap();
    }

    pub fn line(&mut self) -> String {
        self.lines.next().unwrap().unwrap()
    }

    pub fn ask(&mut self, method: &str, script: &str) {
        let params = format!(r#"{{"file":"{script}","name":"T"}}"#);
        self.send(&format!(r#"{{"jsonrpc":"2.0","id":1,"method":"{method}","params":{params}}}"#));
    }

    /// The result of the next answer; earlier lines are ignored.
    pub fn result(&mut self) -> String {
        loop {
            let line = self.line();
            if let Some((_, result)) = line.split_once(r#""id":1,"result":"#) {
                return result.trim_end_matches('}').trim_start_matches('{').to_owned();
            }
        }
    }

    pub fn run_test(&mut self, script: &str) -> String {
        self.ask("run-test", script);
        self.result()
    }
}
