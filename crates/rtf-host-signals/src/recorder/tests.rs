//! Samples with invented times, and what the runner gets.

use std::io::{BufRead, BufReader};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rtf_model::protocol::{Notification, RpcMessage};
use rtf_model::{FindingSeverity, SignalConfig};
use rtf_monitor::Formula;

use super::*;
use crate::settings::{MonitorSettings, ProgramSettings};

/// A recorder of a program with the signals `q` and `limit`, and the runner's end of its channel.
struct Bench {
    recorder: Recorder,
    runner: BufReader<UnixStream>,
    start: Instant,
}

fn monitor(name: &str, formula: &str, tests: Option<&str>) -> Arc<MonitorSettings> {
    let formula = Formula::parse(formula).unwrap();
    let names = ["q", "limit"];
    let index = |name: &str| names.iter().position(|known| *known == name).unwrap();
    Arc::new(MonitorSettings {
        name: name.to_owned(),
        severity: FindingSeverity::Fail,
        location: Some(rtf_model::Location { file: "s.xml".to_owned(), line: 4 }),
        origin: None,
        tests: tests.map(|test| vec![test.to_owned()]),
        signals: formula.signals().iter().map(|signal| index(&signal.name)).collect(),
        formula,
    })
}

impl Bench {
    fn new(time: SignalTime, monitors: Vec<Arc<MonitorSettings>>) -> Self {
        let signal = |name: &str| SignalConfig { name: name.to_owned(), unit: String::new() };
        let program = ProgramSettings {
            words: Vec::new(),
            first_signal: 0,
            count: 2,
            time,
            wait: true,
            other_clock: String::new(),
        };
        let settings = Settings {
            signals: vec![signal("q"), signal("limit")],
            programs: vec![program],
            monitors,
            ..Settings::default()
        };
        let (host, runner) = UnixStream::pair().unwrap();
        let recorder = Recorder::new(Arc::new(settings), Vec::new(), Session::over(host));
        Self { recorder, runner: BufReader::new(runner), start: Instant::now() }
    }

    fn test(&mut self, id: u32, name: &str) {
        let (id, name) = (TestId(id), name.to_owned());
        let test = TestAttempt { id, name, repetition: 1, attempt: 1 };
        self.recorder.start(&test).unwrap();
    }

    /// A line of the program: its time, and both values.
    fn line(&mut self, written: Option<f64>, values: [Option<f64>; 2]) {
        let arrival = self.start + Duration::from_secs_f64(written.unwrap_or_default());
        let time = SampleTime { written, arrival };
        for (signal, value) in values.into_iter().enumerate() {
            let Some(value) = value else { continue };
            self.recorder.sample(SignalSample { source: 0, signal, time, value });
        }
    }

    /// Ends a test, and returns everything that was sent, each message as a line.
    fn end(&mut self, id: u32) -> String {
        self.recorder.finish(TestId(id), false).unwrap();
        self.runner.get_ref().set_nonblocking(true).unwrap();
        let mut sent = Vec::new();
        let mut line = String::new();
        while self.runner.read_line(&mut line).is_ok_and(|count| count > 0) {
            let message: RpcMessage<Notification> = serde_json::from_str(&line).unwrap();
            sent.push(shown(message.body));
            line.clear();
        }
        sent.join("\n")
    }
}

fn shown(notification: Notification) -> String {
    match notification {
        Notification::Observed { test, samples } => {
            format!("{test}: {} {:?}", samples.name, samples.points)
        }
        Notification::Finding(finding) => {
            format!("{}: {:?} {}", finding.test, finding.severity, finding.text)
        }
        Notification::Measured(it) => format!("{} = {}", it.name, it.value.unwrap()),
        Notification::Message(message) => message.text,
        other => format!("{other:?}"),
    }
}

#[test]
fn times_that_do_not_increase_are_reported_once() {
    let mut bench = Bench::new(SignalTime::Own, Vec::new());
    bench.line(Some(1.0), [Some(0.0), Some(0.0)]);
    bench.test(0, "A");
    let began = bench.recorder.tests[0].zero_of(0).unwrap();
    for (time, value) in [(0.25, 1.0), (0.5, 2.0), (0.5, 3.0), (0.125, 4.0), (0.0625, 5.0)] {
        bench.line(Some(began + time), [Some(value), None]);
    }
    assert_eq!(
        bench.end(0),
        "0: Error the time of signal `q` went back from 0.5 s to 0.125 s\n\
         0: q [(0.25, Some(1.0)), (0.5, Some(2.0))]"
    );
}

#[test]
fn lines_that_arrive_together_have_different_times() {
    let mut bench = Bench::new(SignalTime::Arrival, Vec::new());
    bench.test(0, "A");
    bench.start = Instant::now();
    for value in 0..600 {
        bench.line(None, [Some(f64::from(value)), None]);
    }
    let sent = bench.end(0);
    let batches: Vec<_> = sent.lines().collect();
    assert_eq!(batches.len(), 3, "{sent}");
    assert!(batches[2].contains("Some(599.0)"), "{sent}");
}

#[test]
fn each_test_has_its_monitors_and_its_time() {
    let monitors = vec![
        monitor("all", "always(q < limit)", None),
        monitor("of B", "eventually(q > 9)", Some("B")),
    ];
    let mut bench = Bench::new(SignalTime::Own, monitors);
    bench.test(0, "A");
    // The first sample of a test without an earlier one determines its time.
    bench.start = Instant::now();
    bench.line(Some(0.0), [Some(1.0), Some(2.0)]);
    bench.test(1, "B");
    bench.line(Some(100.0), [Some(3.0), Some(2.0)]);
    let first = bench.end(0);
    assert!(first.contains("0: Fail monitor `all`: `q < limit` does not hold at "), "{first}");
    assert!(first.contains("q = 3, limit = 2 (robustness -1); its formula is"), "{first}");
    assert!(first.contains("monitor/all = -1"), "{first}");
    assert!(!first.contains("of B"), "{first}");
    let second = bench.end(1);
    assert!(second.contains("1: Fail monitor `of B`: `q > 9` does not hold"), "{second}");
    assert!(second.contains("monitor/of B = -6"), "{second}");
    // It has the second line only.
    assert_eq!(second.matches("Some(3.0)").count(), 1);
    assert!(!second.contains("Some(1.0)"), "{second}");
}

#[test]
fn a_signal_without_a_sample_is_an_error() {
    let mut bench = Bench::new(SignalTime::Own, vec![monitor("m", "always(q < 5)", None)]);
    bench.test(0, "A");
    bench.line(Some(0.0), [None, Some(1.0)]);
    let sent = bench.end(0);
    assert!(sent.contains("0: Error monitor `m` was not judged: no sample of `q`"), "{sent}");
}
