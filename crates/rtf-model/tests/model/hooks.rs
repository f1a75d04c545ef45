//! Hooks and the death of the runner: where their events may come, and what is
//! known after them.

use std::time::Duration;

use rtf_model::{
    EventKind, Message, MessageKind, Output, Record, Source, Stream, Trigger, Verdict,
};

use crate::order::{check, left};
use crate::record::record;
use crate::support::*;

fn all(body: impl IntoIterator<Item = EventKind>) -> Vec<EventKind> {
    let passed = [started(1, 1), finished(Verdict::Passed)];
    opened_with_hook(1).into_iter().chain(passed).chain(body).chain(closed()).collect()
}

fn check_body(body: impl IntoIterator<Item = EventKind>) -> Result<(), String> {
    check(&stream(all(body)))
}

/// What happens until the runner dies.
fn dying(body: impl IntoIterator<Item = EventKind>) -> Vec<EventKind> {
    opened_with_hook(1).into_iter().chain(body).chain([runner_died()]).collect()
}

fn printed(text: &str, omitted_bytes: u64) -> EventKind {
    let source = Source::Hook(PARK);
    EventKind::Output(Output { source, stream: Stream::Stdout, omitted_bytes, text: text.into() })
}

fn told(kind: MessageKind, text: &str) -> EventKind {
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
    EventKind::Message { source: Source::Hook(PARK), message, test: None }
}

#[test]
fn a_hook_may_run_several_times_and_says_what_it_says_in_between() {
    let body = [
        hook_started(Trigger::Collapse),
        printed("parking\n", 0),
        left(Source::Hook(PARK)),
        hook_finished(Some("no power")),
        hook_started(Trigger::End),
        hook_finished(None),
    ];
    assert_eq!(check_body(body), Ok(()));
}

#[test]
fn a_hook_is_open_or_closed() {
    let wrong = |body: &[EventKind]| check_body(body.to_vec()).expect_err("out of order");
    let start = || hook_started(Trigger::End);
    let twice = "hook 0 started or finished twice";
    assert_eq!(wrong(&[start(), start()]), format!("event 9: {twice}"));
    assert_eq!(wrong(&[hook_finished(None)]), format!("event 8: {twice}"));
    let closed_again = [start(), hook_finished(None), hook_finished(None)];
    assert_eq!(wrong(&closed_again), format!("event 10: {twice}"));
    assert_eq!(wrong(&[printed("x", 0)]), "event 8: hook 0 is not running");
    let late = [start(), hook_finished(None), told(MessageKind::Report, "late")];
    assert_eq!(wrong(&late), "event 10: hook 0 is not running");
}

#[test]
fn a_suite_does_not_finish_before_its_hooks() {
    let open = check_body([hook_started(Trigger::End)]);
    assert_eq!(open, Err("event 9: hook 0 still runs".to_owned()));
}

#[test]
fn a_hook_belongs_to_the_suite_planned_last_and_runs_in_it() {
    let wrong = |kinds: &[EventKind]| check(&stream(kinds.to_vec())).expect_err("out of order");
    let start = || hook_started(Trigger::End);
    assert_eq!(wrong(&[run_started(), suite(0), hook(1, 0)]), "event 2: hook 1 out of order");
    let other = [run_started(), suite(0), suite(1), hook(0, 0)];
    assert_eq!(wrong(&other), "event 3: suite 0 is not the one planned last");
    let mut unplanned = opened(1);
    unplanned.push(start());
    assert_eq!(wrong(&unplanned), "event 5: hook 0 was not planned");
    let mut late = opened(1);
    late.push(hook(0, 0));
    assert_eq!(wrong(&late), "event 5: plans precede the start of the first suite");
    let mut after = all([]);
    after.insert(after.len() - 1, start());
    assert_eq!(wrong(&after), "event 9: suite 0 is not running");
}

#[test]
fn the_runner_may_die_while_anything_is_open() {
    let fixture = SIMULATOR;
    let open = [EventKind::FixtureStarting { fixture, attempt: 1 }, started(1, 1)];
    assert_eq!(check(&stream(dying(open.clone()))), Ok(()));
    let in_a_hook = open.into_iter().chain([hook_started(Trigger::Failure)]);
    assert_eq!(check(&stream(dying(in_a_hook))), Ok(()));
    let in_the_plans = [run_started(), suite(0), runner_died()];
    assert_eq!(check(&stream(in_the_plans)), Ok(()));
}

#[test]
fn the_guard_may_run_hooks_before_its_last_word() {
    let parked = [hook_started(Trigger::Interrupt), printed("parked\n", 0), hook_finished(None)];
    let body = [started(1, 1)].into_iter().chain(parked);
    assert_eq!(check(&stream(dying(body))), Ok(()));
}

#[test]
fn nothing_follows_the_death_of_the_runner() {
    for next in [finished(Verdict::Passed), closed()[1].clone(), runner_died()] {
        let mut kinds = dying([started(1, 1)]);
        kinds.push(next);
        let error = check(&stream(kinds)).expect_err("something follows");
        assert!(error.starts_with("event 8: nothing follows"), "{error}");
    }
    assert!(check(&stream([runner_died()])).is_err(), "it died, but nothing began");
}

#[test]
fn a_hook_that_did_its_work_leaves_a_run_green() {
    let record = record(all([hook_started(Trigger::End), hook_finished(None)]));
    assert!(record.is_green() && !record.hook_failed());
    let run = &record.hooks[0].runs[0];
    assert_eq!((run.problem(), run.duration()), (None, Some(Duration::from_millis(1))));
    assert_eq!((run.trigger, &*run.reason, run.test), (Trigger::End, "for a reason", Some(TEST)));
    assert_eq!(record.full_hook_name(PARK), "suite-0/hook-0");
}

#[test]
fn a_hook_that_failed_once_speaks_against_the_run_although_each_test_passed() {
    let failed = [hook_started(Trigger::Collapse), hook_finished(Some("no power"))];
    let parked = [hook_started(Trigger::End), hook_finished(None)];
    let record = record(all(failed.into_iter().chain(parked)));
    assert!(record.hook_failed() && !record.is_green() && record.is_complete());
    assert_eq!(record.failed_hooks().count(), 1);
    assert_eq!(record.suite_problems(SUITE), ["hook `hook-0` on collapse: no power"]);
    assert!(record.fixture_problems(SUITE).is_empty());
    assert_eq!(record.verdict(TEST), Some(Verdict::Passed));
}

#[test]
fn a_hook_that_was_never_called_for_is_no_problem() {
    assert!(record(all([])).is_green());
}

#[test]
fn a_hook_keeps_what_explains_its_failure() {
    let dump =
        |text: &str| EventKind::StackDumped { source: Source::Hook(PARK), text: text.into() };
    let processes = vec![process(8, None), process(9, Some("test suite-0/test-0"))];
    let record = record(all([
        hook_started(Trigger::End),
        printed("a\n", 0),
        printed("z\n", 26),
        told(MessageKind::Report, "22 joints"),
        told(MessageKind::Error, "no bus"),
        dump("poll"),
        EventKind::ProcessesLeaked { source: Source::Hook(PARK), processes },
        hook_finished(Some("no bus")),
    ]));
    let run = &record.hooks[0].runs[0];
    assert_eq!(run.output, "a\n\n[… 26 bytes left out …]\nz\n");
    assert_eq!(run.messages.iter().map(|m| &*m.text).collect::<Vec<_>>(), ["no bus"]);
    assert_eq!(run.stacks, ["poll"]);
    assert_eq!(
        owners(&record),
        [(8, Some("hook suite-0/hook-0")), (9, Some("test suite-0/test-0"))]
            .map(|(pid, owner): (i32, Option<&str>)| (pid, owner.map(str::to_owned)))
    );
}

fn owners(record: &Record) -> Vec<(i32, Option<String>)> {
    record.leaked_processes().into_iter().map(|process| (process.pid, process.owner)).collect()
}

#[test]
fn a_run_whose_runner_died_is_over_but_not_complete() {
    let record = record(dying([started(1, 1), finished(Verdict::Passed)]));
    assert!(!record.is_complete() && !record.is_green());
    assert_eq!(record.runner_death(), Some("signal 9 (SIGKILL)"));
    assert_eq!(record.interrupted(), None);
    assert_eq!(owners(&record), [(7, Some("test suite-0/test-0".to_owned()))]);
    assert!(!record.hook_failed(), "no hook was called for");
}

#[test]
fn a_hook_that_the_runner_died_in_did_not_do_its_work() {
    let record = record(dying([started(1, 1), hook_started(Trigger::Failure)]));
    assert!(record.hook_failed());
    assert_eq!(record.suite_problems(SUITE), ["hook `hook-0` on failure: it did not finish"]);
    assert_eq!(record.final_verdict(TEST), Verdict::Interrupted);
}

/// A line of the journal with a hook's plan is damaged.
#[test]
fn a_lost_plan_does_not_shift_the_hooks_after_it() {
    let kinds = [run_started(), suite(0), hook(1, 0), EventKind::SuiteStarted { suite: SUITE }];
    let record = record(kinds.into_iter().chain([hook_started(Trigger::End), hook_finished(None)]));
    assert_eq!(record.hooks[1].plan.name, "hook-1");
    assert_eq!(record.hooks[0].plan.name, "unknown-hook-0");
    assert_eq!(record.hooks[0].runs.len(), 1);
}
