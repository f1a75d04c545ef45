//! A run of 2000 tests with 10 reports each: folded, written to the journal,
//! and reported as JUnit.

use std::error::Error;
use std::path::Path;

use rtf_model::{
    Event, EventKind, ExitStatus, Location, Message, MessageKind, Micros, Output, Phase, Record,
    RunStarted, Source, Stream, SuiteId, SuitePlanned, TestFinished, TestId, TestPlanned, Verdict,
};
use rtf_report::journal::Journal;
use rtf_report::{Reporter, junit};

const SUITE: SuiteId = SuiteId(0);
const TESTS: u32 = 2000;
const REPORTS: u32 = 10;

/// Does it.
pub fn run(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut journal = Journal::create(&folder.join("events.jsonl"))?;
    let mut record = Record::default();
    let kinds = before().into_iter().chain((0..TESTS).flat_map(test)).chain([
        EventKind::SuiteFinished { suite: SUITE },
        EventKind::RunFinished { interrupted: None },
    ]);
    for (seq, kind) in (0..).zip(kinds) {
        let event = Event { seq, at: Micros(seq * 10), kind };
        record.apply(&event);
        journal.event(&event, &record)?;
    }
    journal.finish(&record)?;
    let mut report = Vec::new();
    junit::write(&mut report, &record, None)?;
    let whole = record.totals().done() == TESTS && report.ends_with(b"</testsuites>\n");
    if whole { Ok(()) } else { Err("the record or the report is not whole".into()) }
}

fn before() -> Vec<EventKind> {
    let mut kinds = vec![
        EventKind::RunStarted(RunStarted {
            version: rtf_model::EVENTS_VERSION,
            run: "counted".into(),
            rtf: "0".into(),
            started_at: "2026-01-01T00:00:00+00:00".into(),
            command: vec!["counted".into()],
            working_dir: String::new(),
            suites: 1,
            tests: TESTS,
            manifest: Box::default(),
        }),
        EventKind::SuitePlanned(SuitePlanned {
            suite: SUITE,
            name: "counted".into(),
            file: "counted.xml".into(),
            description: String::new(),
            environment: String::new(),
            tolerates_collapse: false,
            parallel: 1,
            requires: Vec::new(),
            skips_fail: false,
        }),
    ];
    kinds.extend((0..TESTS).map(|test| {
        EventKind::TestPlanned(TestPlanned {
            learned: Vec::new(),
            test: TestId(test),
            suite: SUITE,
            name: format!("test-{test:05}"),
            plugin_type: "lua".into(),
            plugin: "T.lua".into(),
            repetitions: 1,
            tags: vec!["quick".into()],
            timed: false,
            plugin_hash: None,
            source_hash: None,
            was: None,
            expected: None,
            parameters: Vec::new(),
        })
    }));
    kinds.push(EventKind::SuiteStarted { suite: SUITE });
    kinds
}

fn test(number: u32) -> Vec<EventKind> {
    let test = TestId(number);
    let source = Source::Test(test);
    let failed = number % 10 == 9;
    let mut kinds = vec![EventKind::TestStarted { test, repetition: 1, attempt: 1 }];
    let phases = [Phase::Setup, Phase::Run, Phase::TearDown];
    kinds.extend(phases.map(|phase| EventKind::TestPhase { test, phase }));
    for report in 0..REPORTS {
        let is_last = report + 1 == REPORTS;
        let kind = if failed && is_last { MessageKind::Failure } else { MessageKind::Report };
        let text = format!("joint {report} is at {number}");
        let location = Some(Location { file: "T.lua".into(), line: report });
        let message = Message {
            kind,
            text,
            location,
            comparison: None,
            critical: false,
            case: None,
            interval: None,
        };
        kinds.push(EventKind::Message { source, message, test: None });
    }
    let text = format!("a line of test {number}\n");
    kinds.push(EventKind::Output(Output {
        source,
        stream: Stream::Stdout,
        omitted_bytes: 0,
        text,
    }));
    kinds.push(EventKind::TestFinished(TestFinished {
        test,
        verdict: if failed { Verdict::Failed } else { Verdict::Passed },
        reason: failed.then(|| format!("joint 9 is at {number}")),
        phase: if failed { Phase::Run } else { Phase::Exit },
        exit: Some(ExitStatus::Code(0)),
        rerun: false,
        decided_by: None,
    }));
    kinds
}
