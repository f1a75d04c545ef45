//! Which details of a record the console still needs after an event.

use rtf_model::{
    AttemptRecord, EventKind, HookId, Message, MessageKind, Record, Source, TestId, Verdict,
};

/// Removes details from the record that neither the console's next lines nor its summary show:
/// its memory then depends on the tests and their failures, not on how much they reported. For
/// consoles that are not verbose, and after `kind` was shown.
pub fn drop_details(record: &mut Record, kind: &EventKind) {
    match kind {
        EventKind::Message { source: Source::Test(test), .. }
        | EventKind::Message { test: Some(test), .. }
        | EventKind::Measured { test, .. }
        | EventKind::Attached { test, .. } => with_attempt(record, *test, drop_last_report),
        EventKind::TestFinished(finished) => with_attempt(record, finished.test, drop_shown),
        EventKind::HookFinished { hook, .. } => drop_shown_of_hook(record, *hook),
        _ => {}
    }
}

fn with_attempt(record: &mut Record, test: TestId, change: fn(&mut AttemptRecord)) {
    let test = record.tests.get_mut(test.index());
    test.and_then(|test| test.attempts.last_mut()).into_iter().for_each(change);
}

/// Drops the last message, measurement and attachment, if they are no problems.
fn drop_last_report(attempt: &mut AttemptRecord) {
    let fails =
        |message: &mut Message| matches!(message.kind, MessageKind::Failure | MessageKind::Error);
    attempt.messages.pop_if(|message| !fails(message));
    attempt.measurements.pop_if(|measurement| measurement.is_within_limits());
    attempt.attachments.clear();
}

/// An attempt that has finished is shown with all details, and later with its first problems.
fn drop_shown(attempt: &mut AttemptRecord) {
    attempt.series = Vec::new();
    attempt.stacks = Vec::new();
    drop_output(&mut attempt.output);
    if attempt.verdict().is_some_and(Verdict::is_green) && attempt.cases.total() == 0 {
        attempt.messages = Vec::new();
        attempt.faults = Vec::new();
        attempt.measurements = Vec::new();
    }
}

fn drop_shown_of_hook(record: &mut Record, hook: HookId) {
    let hook = record.hooks.get_mut(hook.index());
    if let Some(run) = hook.and_then(|hook| hook.runs.last_mut()) {
        run.messages = Vec::new();
        run.stacks = Vec::new();
        drop_output(&mut run.output);
    }
}

/// The summary names the log of what has printed anything.
fn drop_output(output: &mut String) {
    *output = output.chars().take(1).collect();
}
