use std::time::Duration;

use rtf_model::{HookPlanned, RunStarted, SuitePlanned, Trigger};

use super::*;

const HOOK: HookId = HookId(0);
const SUITE: SuiteId = SuiteId(0);

/// The first events of a run with a hook, as many as are asked for.
fn beginning(events: usize) -> String {
    let run = RunStarted {
        version: rtf_model::EVENTS_VERSION,
        run: "r".into(),
        rtf: "0".into(),
        started_at: String::new(),
        command: Vec::new(),
        working_dir: String::new(),
        suites: 1,
        tests: 0,
        manifest: Box::default(),
    };
    let suite = SuitePlanned {
        suite: SUITE,
        name: "s".into(),
        file: String::new(),
        description: String::new(),
        environment: String::new(),
        tolerates_collapse: false,
        parallel: 1,
        requires: Vec::new(),
        skips_fail: false,
    };
    let on = vec![Trigger::Interrupt];
    let kinds = [
        EventKind::RunStarted(run),
        EventKind::SuitePlanned(suite),
        EventKind::HookPlanned(HookPlanned { hook: HOOK, suite: SUITE, name: "h".into(), on }),
        EventKind::SuiteStarted { suite: SUITE },
        started(),
        finished(),
    ];
    let lines = kinds.into_iter().take(events).zip(0..).map(|(kind, seq)| {
        serde_json::to_string(&Event { seq, at: Micros(1000 * seq), kind }).unwrap() + "\n"
    });
    lines.collect()
}

fn started() -> EventKind {
    let (trigger, reason) = (Trigger::Interrupt, "it died".to_owned());
    EventKind::HookStarted { hook: HOOK, trigger, reason, test: None }
}

fn finished() -> EventKind {
    EventKind::HookFinished { hook: HOOK, problem: None }
}

fn died() -> EventKind {
    EventKind::RunnerDied { reason: "signal 9 (SIGKILL)".into(), leaked: Vec::new() }
}

/// Closes a journal with this text; returns what it holds then.
fn closed(text: &str, finished_hooks: Vec<FinishedHook>, events: Vec<EventKind>) -> String {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    let start = Instant::now();
    let events = events.into_iter().map(|kind| TimedEvent { at: start, kind }).collect();
    close(file.path(), start, MissingEvents { finished_hooks, events }).unwrap();
    std::fs::read_to_string(file.path()).unwrap()
}

/// The types of the events, which must be in order.
fn types(journal: &str) -> Vec<String> {
    let mut order = OrderChecker::default();
    let events = journal.lines().map(|line| {
        order.check(&serde_json::from_str(line).unwrap()).unwrap();
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        value["type"].as_str().unwrap().to_owned()
    });
    events.collect()
}

fn end_of_first_run() -> Vec<FinishedHook> {
    let at = Instant::now() + Duration::from_millis(1);
    vec![FinishedHook {
        hook: HOOK,
        number: 1,
        started: TimedEvent { at, kind: started() },
        finished: TimedEvent { at, kind: finished() },
    }]
}

#[test]
fn a_torn_line_is_cut_off_and_the_numbers_go_on() {
    let whole = beginning(4);
    let torn = whole.clone() + "{\"seq\":4,\"at\":5";
    let journal = closed(&torn, Vec::new(), vec![started(), finished(), died()]);
    assert!(journal.starts_with(&whole));
    let expected = ["hook-started", "hook-finished", "runner-died"];
    assert_eq!(types(&journal)[4..], expected);
}

#[test]
fn events_that_the_runner_did_not_write_are_appended() {
    // The hook started, but the journal lacks the start of the suite.
    let journal = closed(&beginning(3), Vec::new(), vec![started(), finished(), died()]);
    let expected = ["suite-started", "hook-started", "hook-finished", "runner-died"];
    assert_eq!(types(&journal)[3..], expected);
    // It was started before the runner died, and ended after.
    let journal = closed(&beginning(5), Vec::new(), vec![started(), finished(), died()]);
    assert_eq!(types(&journal)[5..], ["hook-finished", "runner-died"]);
    // The journal lacks the plan of the hook: only a warning is possible.
    let journal = closed(&beginning(2), Vec::new(), vec![started(), finished(), died()]);
    assert_eq!(types(&journal)[2..], ["warning", "runner-died"]);
}

#[test]
fn the_end_of_a_hook_is_appended_unless_the_journal_has_it() {
    for (there, missing) in [(4, 2), (5, 1), (6, 0)] {
        let journal = closed(&beginning(there), end_of_first_run(), vec![died()]);
        let expected = ["hook-started", "hook-finished", "runner-died"];
        assert_eq!(types(&journal)[there..], expected[2 - missing..]);
    }
}

#[test]
fn the_journal_of_a_finished_or_unstarted_run_is_unchanged() {
    let finished =
        Event { seq: 1, at: Micros(1), kind: EventKind::RunFinished { interrupted: None } };
    let finished = beginning(1) + &serde_json::to_string(&finished).unwrap() + "\n";
    for text in [finished.as_str(), "", "{\"seq\":0,"] {
        assert_eq!(closed(text, Vec::new(), vec![died()]), text);
    }
}
