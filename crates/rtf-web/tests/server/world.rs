//! A results directory, a run that is being written, and their server.

use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use jiff::Timestamp;
use rtf_history::{Store, StoreError};
use rtf_model::{
    Attachment, Event, EventKind, Measurement, Message, MessageKind, Micros, Output, Phase, Record,
    RunStarted, Samples, Source, Stream, SuiteId, SuitePlanned, TestFinished, TestId, TestPlanned,
    Verdict,
};
use rtf_report::Reporter;
use rtf_report::console::TestCommands;
use rtf_report::journal::Journal;
use rtf_report::logs::Logs;
use rtf_web::{
    AnswerRequest, BoundServer, CampaignReport, CampaignSource, Capabilities, FinishedRun,
    HistorySource, JournalNotifier, Limits, RerunRejected, RunControl, RunStarter, Service,
    Settings, TestCondition, WebServer, WrongToken,
};

use crate::client::{self, Answer};

pub const TEST: TestId = TestId(0);

/// What the control was asked for.
/// And which wrong tokens were reported.
#[derive(Debug, Default)]
pub struct Asked(pub Mutex<Vec<String>>, pub Mutex<Vec<(IpAddr, u64)>>);

impl RunControl for Asked {
    fn stop_run(&self) {
        self.0.lock().unwrap().push("stop".to_owned());
    }

    fn stop_test(&self, test: TestId) {
        self.0.lock().unwrap().push(format!("stop test {test}"));
    }

    fn skip_suite(&self, suite: SuiteId) {
        self.0.lock().unwrap().push(format!("skip suite {suite}"));
    }

    fn answer(&self, answer: AnswerRequest) {
        let AnswerRequest { test, question, answer, by } = answer;
        let what = format!("answer {answer} to question {question} of test {test} by {by}");
        self.0.lock().unwrap().push(what);
    }
}

/// Starts what is called so; anything else is refused.
pub const STARTED: &str = "anew";

impl RunStarter for Asked {
    fn rerun_failed(&self, run: &FinishedRun<'_>) -> Result<String, RerunRejected> {
        self.0.lock().unwrap().push(format!("rerun {} in {}", run.name, run.folder.display()));
        match run.name {
            "own" => Ok(STARTED.to_owned()),
            _ => {
                Err(RerunRejected { reason: "nothing failed".into(), hint: Some("so what".into()) })
            }
        }
    }

    fn started(&self) -> Option<String> {
        let asked = self.0.lock().unwrap();
        asked.iter().any(|asked| asked.starts_with("rerun own")).then(|| STARTED.to_owned())
    }

    fn stop(&self) {
        self.0.lock().unwrap().push("stop what was started".to_owned());
    }
}

/// A run that is written as a runner writes it.
pub struct Writer {
    pub folder: PathBuf,
    journal: Journal,
    logs: Logs,
    live: Option<JournalNotifier>,
    record: Record,
}

impl Writer {
    pub fn new(results: &Path, name: &str) -> Self {
        let folder = results.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        let journal = Journal::create(&folder.join("events.jsonl")).unwrap();
        let logs = Logs::new(&folder);
        Self { folder, journal, logs, live: None, record: Record::default() }
    }

    pub fn emit(&mut self, kind: EventKind) {
        let seq = self.record.events;
        let event = Event { seq, at: Micros(seq * 10), kind };
        self.record.apply(&event);
        self.journal.event(&event, &self.record).unwrap();
        self.logs.event(&event, &self.record).unwrap();
    }

    /// As a runner does when nothing happens for a moment.
    pub fn flush(&mut self) {
        self.journal.idle(&self.record).unwrap();
        self.logs.idle(&self.record).unwrap();
        if let Some(live) = &mut self.live {
            live.idle(&self.record).unwrap();
        }
    }

    /// The plan: one suite, and tests of these names.
    pub fn plan(&mut self, suite: &str, tests: &[&str]) {
        self.plan_of(suite, tests, &|_| ());
    }

    /// The plan of a run about which more is known.
    pub fn plan_of(&mut self, suite: &str, tests: &[&str], more: &dyn Fn(&mut RunStarted)) {
        self.plan_with(suite, tests, more, &|_| ());
    }

    /// The plan of a run about whose tests more is known.
    pub fn plan_tests(&mut self, suite: &str, tests: &[&str], more: &dyn Fn(&mut TestPlanned)) {
        self.plan_with(suite, tests, &|_| (), more);
    }

    fn plan_with(
        &mut self,
        suite: &str,
        tests: &[&str],
        more: &dyn Fn(&mut RunStarted),
        of_test: &dyn Fn(&mut TestPlanned),
    ) {
        let mut started = RunStarted {
            version: 1,
            run: self.folder.file_name().unwrap().to_string_lossy().into_owned(),
            rtf: "0.1.0".to_owned(),
            started_at: "2026-11-21T06:30:12+00:00".to_owned(),
            command: vec!["rtf".to_owned()],
            working_dir: "/robot".to_owned(),
            suites: 1,
            tests: u32::try_from(tests.len()).unwrap(),
            manifest: Default::default(),
        };
        more(&mut started);
        self.emit(EventKind::RunStarted(started));
        self.emit(EventKind::SuitePlanned(SuitePlanned {
            suite: SuiteId(0),
            name: suite.to_owned(),
            file: String::new(),
            description: String::new(),
            environment: String::new(),
            tolerates_collapse: false,
            parallel: 1,
            requires: Vec::new(),
            skips_fail: false,
        }));
        for (id, name) in (0..).zip(tests) {
            let mut plan = TestPlanned {
                learned: Vec::new(),
                test: TestId(id),
                suite: SuiteId(0),
                name: (*name).to_owned(),
                plugin_type: "lua".to_owned(),
                plugin: "/robot/test.lua".to_owned(),
                repetitions: 1,
                timed: false,
                tags: Vec::new(),
                plugin_hash: None,
                source_hash: None,
                was: None,
                expected: None,
                parameters: Vec::new(),
            };
            of_test(&mut plan);
            self.emit(EventKind::TestPlanned(plan));
        }
        self.emit(EventKind::SuiteStarted { suite: SuiteId(0) });
    }

    pub fn start(&mut self, test: TestId) {
        self.emit(EventKind::TestStarted { test, repetition: 1, attempt: 1 });
    }

    pub fn say(&mut self, kind: MessageKind, text: &str) {
        let source = Source::Test(TEST);
        let text = text.to_owned();
        let message = Message {
            kind,
            text,
            location: None,
            comparison: None,
            critical: false,
            case: None,
            interval: None,
        };
        self.emit(EventKind::Message { source, message, test: None });
    }

    pub fn print(&mut self, text: &str) {
        let (source, stream, text) = (Source::Test(TEST), Stream::Stdout, text.to_owned());
        self.emit(EventKind::Output(Output { source, stream, omitted_bytes: 0, text }));
    }

    pub fn measure(&mut self, value: f64, high: f64) {
        let (name, unit) = ("settling".to_owned(), "s".to_owned());
        let (value, high) = (Some(value), Some(high));
        let measurement = Measurement {
            learned: false,
            name,
            value,
            unit,
            low: None,
            high,
            location: None,
            case: None,
        };
        self.emit(EventKind::Measured { test: TEST, fixture: None, measurement });
    }

    /// Samples a signal: its values, 0.5 s apart from `from` on.
    pub fn sample(&mut self, from: f64, values: &[f64]) {
        let (name, unit) = ("elbow".to_owned(), "rad".to_owned());
        let time = |(n, value): (usize, &f64)| (from + 0.5 * n as f64, Some(*value));
        let points = values.iter().enumerate().map(time).collect();
        let (low, high, location) = (None, Some(1.5), None);
        let samples = Samples { name, unit, low, high, location, points, case: None, since: None };
        self.emit(EventKind::Sampled { test: TEST, samples });
    }

    /// Attaches a file that holds this.
    pub fn attach(&mut self, name: &str, what: &[u8]) {
        self.attach_as(name, name, "", what);
    }

    /// Attaches a file that the test calls otherwise.
    pub fn attach_as(&mut self, file: &str, name: &str, media_type: &str, what: &[u8]) {
        let path = format!("attachments/{file}");
        std::fs::create_dir_all(self.folder.join("attachments")).unwrap();
        std::fs::write(self.folder.join(&path), what).unwrap();
        let (name, media_type) = (name.to_owned(), media_type.to_owned());
        let attachment =
            Attachment { name, path, media_type, case: None, picture: None, omitted: false };
        self.emit(EventKind::Attached { test: TEST, fixture: None, attachment });
    }

    pub fn finish(&mut self, test: TestId, verdict: Verdict) {
        let reason = (!verdict.is_green()).then(|| "because".to_owned());
        let phase = Phase::Run;
        self.emit(EventKind::TestFinished(TestFinished {
            test,
            verdict,
            reason,
            phase,
            exit: None,
            rerun: false,
            decided_by: None,
        }));
    }

    pub fn end(mut self) -> Record {
        self.emit(EventKind::SuiteFinished { suite: SuiteId(0) });
        self.emit(EventKind::RunFinished { interrupted: None });
        self.flush();
        self.record
    }
}

/// A server with a separate results directory.
pub struct World {
    pub temp: tempfile::TempDir,
    pub server: WebServer,
    pub asked: Arc<Asked>,
}

/// A results directory without campaigns.
struct NoCampaigns;

impl CampaignSource for NoCampaigns {
    fn report(&self, _: &str) -> Result<Option<CampaignReport>, String> {
        Ok(None)
    }
}

/// A history whose filters are the name of a test.
struct History(PathBuf);

impl HistorySource for History {
    fn open(&self) -> Result<Store, StoreError> {
        Store::open_existing(&self.0)
    }

    fn parse_filter(&self, text: &str) -> Result<TestCondition, String> {
        let name = text.to_owned();
        match name.starts_with('!') {
            true => Err("no filter".to_owned()),
            false => Ok(Box::new(move |test| test.identity.test == name)),
        }
    }

    fn parse_since(&self, text: &str) -> Result<Timestamp, String> {
        text.parse().map_err(|error| format!("{error}"))
    }
}

fn served<'a>(results: &'a Path, role: Capabilities, asked: &Arc<Asked>) -> Service<'a> {
    let asked = asked.clone();
    let wrong_token = Box::new(move |wrong: WrongToken| {
        asked.1.lock().unwrap().push((wrong.client, wrong.count));
    });
    let commands: fn() -> TestCommands = || TestCommands {
        rerun: Box::new(|_, test, _| Some(format!("rtf run suite.xml::{test}"))),
        replay: Box::new(|_, test, path| Some(format!("replay {test} {}", path.display()))),
    };
    let history = Arc::new(History(results.join("history.db")));
    let metrics = role.own().is_none();
    let campaigns = Arc::new(NoCampaigns);
    Service { results, history, campaigns, metrics, role, commands, wrong_token }
}

pub fn settings() -> Settings {
    Settings {
        address: "127.0.0.1:0".parse().unwrap(),
        allow_remote: false,
        token_file: None,
        tls: None,
        hosts: Vec::new(),
        limits: Limits::default(),
    }
}

impl World {
    /// A server that makes the run `own`.
    pub fn new() -> (Self, Writer) {
        Self::with(&settings())
    }

    pub fn with(settings: &Settings) -> (Self, Writer) {
        let temp = tempfile::tempdir().unwrap();
        let mut writer = Writer::new(temp.path(), "own");
        let asked = Arc::new(Asked::default());
        let role = Capabilities::Runner("own".to_owned(), asked.clone());
        let bound = BoundServer::new(settings).unwrap();
        let server = bound.serve(served(temp.path(), role, &asked)).unwrap();
        writer.live = Some(server.live());
        (Self { temp, server, asked }, writer)
    }

    /// A server that makes no run, over one that another process makes.
    pub fn showing() -> (Self, Writer) {
        let temp = tempfile::tempdir().unwrap();
        let writer = Writer::new(temp.path(), "own");
        let asked = Arc::new(Asked::default());
        let bound = BoundServer::new(&settings()).unwrap();
        let role = Capabilities::Viewer(asked.clone());
        let server = bound.serve(served(temp.path(), role, &asked)).unwrap();
        (Self { temp, server, asked }, writer)
    }

    pub fn address(&self) -> SocketAddr {
        self.server.address
    }

    pub fn token(&self) -> String {
        self.server.url().split_once("#token=").unwrap().1.to_owned()
    }

    pub fn get(&self, path: &str) -> Answer {
        client::get(self.address(), path)
    }

    pub fn post(&self, path: &str, lines: &[&str], body: &str) -> Answer {
        client::ask(self.address(), &format!("POST {path}"), lines, body)
    }

    /// The counts of wrong tokens that were reported, once there are so many reports.
    pub fn wrong_tokens(&self, reports: usize) -> Vec<u64> {
        let start = std::time::Instant::now();
        loop {
            let wrong = self.asked.1.lock().unwrap().clone();
            if wrong.len() >= reports {
                assert!(wrong.iter().all(|(client, _)| client.is_loopback()));
                return wrong.into_iter().map(|(_, count)| count).collect();
            }
            assert!(start.elapsed().as_secs() < 30, "{wrong:?} of {reports} reports");
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
    }

    pub fn asked(&self) -> Vec<String> {
        self.asked.0.lock().unwrap().clone()
    }
}
