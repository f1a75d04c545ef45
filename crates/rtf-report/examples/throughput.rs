//! How many events a second go through the fan-out into a journal and the console.
//!
//! `cargo run --release -p rtf-report --example throughput [EVENTS]`
//!
//! One test floods with reports, the most that a single plug-in can do to the
//! runner. The journal goes to a temporary directory, the console output is discarded.

use std::io::{self, Write};
use std::time::Instant;

use rtf_model::{
    Event, EventKind, Message, MessageKind, Micros, Phase, RunStarted, Source, SuiteId,
    SuitePlanned, TestFinished, TestId, TestPlanned, Verdict,
};
use rtf_report::console::{Console, ConsoleOptions};
use rtf_report::journal::{self, Journal};
use rtf_report::{Fanout, Reporter};

const TEST: TestId = TestId(0);
const SUITE: SuiteId = SuiteId(0);
/// How much may wait: as much as the runner lets wait of a test.
const BACKLOG: usize = 1024 * 1024;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let reports = std::env::args().nth(1).map_or(Ok(1_000_000), |count| count.parse::<u64>())?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("events.jsonl");
    let options = ConsoleOptions { progress: false, ..ConsoleOptions::default() };
    let reporters: Vec<Box<dyn Reporter>> = vec![
        Box::new(Journal::create(&path)?),
        Box::new(Console::new(Box::new(io::sink()), options)),
    ];
    let begin = Instant::now();
    let fanout = Fanout::start(reporters)?;
    let to_reports = fanout.handle();
    let flood = (0..reports).map(report);
    for (seq, kind) in (0..).zip(before().into_iter().chain(flood).chain(after())) {
        while to_reports.backlog(Source::Test(TEST)) > BACKLOG {
            std::thread::yield_now();
        }
        to_reports.send(Event { seq, at: Micros(seq), kind });
    }
    drop(to_reports);
    let finished = fanout.join();
    let took = begin.elapsed();
    let read = Instant::now();
    let stored = journal::read(&path)?;
    let rate = |seconds: f64| finished.record.events as f64 / seconds;
    let mut out = io::stdout().lock();
    writeln!(out, "written: {:.0} events/s", rate(took.as_secs_f64()))?;
    writeln!(out, "read:    {:.0} events/s", rate(read.elapsed().as_secs_f64()))?;
    let intact = finished.errors.is_empty()
        && finished.record.is_green()
        && stored.record.events == finished.record.events;
    if intact { Ok(()) } else { Err("the journal does not hold what was sent".into()) }
}

fn before() -> Vec<EventKind> {
    vec![
        EventKind::RunStarted(RunStarted {
            version: rtf_model::EVENTS_VERSION,
            run: "throughput".into(),
            rtf: env!("CARGO_PKG_VERSION").into(),
            started_at: "2026-01-01T00:00:00+00:00".into(),
            command: vec!["throughput".into()],
            working_dir: String::new(),
            suites: 1,
            tests: 1,
            manifest: Box::default(),
        }),
        EventKind::SuitePlanned(SuitePlanned {
            suite: SUITE,
            name: "flood".into(),
            file: String::new(),
            description: String::new(),
            environment: String::new(),
            tolerates_collapse: false,
            parallel: 1,
            requires: Vec::new(),
            skips_fail: false,
        }),
        EventKind::TestPlanned(TestPlanned {
            learned: Vec::new(),
            test: TEST,
            suite: SUITE,
            name: "FloodTest".into(),
            plugin_type: "dll".into(),
            plugin: "libFloodTest.so".into(),
            repetitions: 1,
            timed: false,
            tags: Vec::new(),
            plugin_hash: None,
            source_hash: None,
            was: None,
            expected: None,
            parameters: Vec::new(),
        }),
        EventKind::SuiteStarted { suite: SUITE },
        EventKind::TestStarted { test: TEST, repetition: 1, attempt: 1 },
    ]
}

fn report(number: u64) -> EventKind {
    let message = Message {
        kind: MessageKind::Report,
        text: format!("joint {} is at {number}", number % 7),
        location: None,
        comparison: None,
        critical: false,
        case: None,
        interval: None,
    };
    EventKind::Message { source: Source::Test(TEST), message, test: None }
}

fn after() -> [EventKind; 3] {
    let (verdict, reason, phase) = (Verdict::Passed, None, Phase::Exit);
    let finished = TestFinished {
        test: TEST,
        verdict,
        reason,
        phase,
        exit: None,
        rerun: false,
        decided_by: None,
    };
    [
        EventKind::TestFinished(finished),
        EventKind::SuiteFinished { suite: SUITE },
        EventKind::RunFinished { interrupted: None },
    ]
}
