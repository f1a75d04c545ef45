//! Hooks in the console: each when it finishes, and at the end of the run those
//! after which the robot may not be in a safe state.

use rtf_model::{HookId, HookRunRecord, Record, Source};

use super::options::{Verbosity, View};
use super::page::ConsoleLines;
use super::result_details::{self, EXTENT};
use super::style::{self, BAD, BOLD, DIM, GOOD};
use crate::explain::{self, Tone};
use crate::{cause, escape, logs, words};

/// Shows the result of a run of a hook.
pub(super) fn finished(page: &mut ConsoleLines, view: View<'_>, id: HookId) {
    let View { options, record } = view;
    let Some(hook) = record.hooks.get(id.index()) else { return };
    let Some(run) = hook.runs.last() else { return };
    let time = words::time(run.duration().unwrap_or_default());
    let title = title(record, id, run);
    if run.problem().is_some() {
        page.entry((BAD, "HOOK FAILED"), &time, &title);
        return failed(page, view, id, run);
    }
    if options.verbosity > Verbosity::Quiet {
        let reason = style::paint(DIM, &words::short_line(cause::short(record, &run.reason)));
        page.entry((GOOD, "hook"), &time, &format!("{title}: done  {reason}"));
    }
    result_details::leaked(page, &title, &run.leaked);
}

/// `arm/park (collapse)`.
fn title(record: &Record, id: HookId, run: &HookRunRecord) -> String {
    format!("{} ({})", escape::line(&record.full_hook_name(id)), run.trigger)
}

fn failed(page: &mut ConsoleLines, view: View<'_>, id: HookId, run: &HookRunRecord) {
    let View { options, record } = view;
    let sink = &mut |tone, line: &str| page.detail(tone, line);
    explain::hook(run, EXTENT, sink);
    explain::block(Tone::Dim, &run.reason, "reason: ", sink);
    if let Some(test) = run.test {
        sink(Tone::Dim, &format!("about: {}", escape::line(&record.full_name(test))));
    }
    if !run.output.is_empty() && options.verbosity < Verbosity::Verbose {
        result_details::output(
            &run.output,
            options.shown(&logs::log(record, Source::Hook(id))),
            sink,
        );
    }
}

/// Lists the runs of hooks that failed.
pub(super) fn summary(page: &mut ConsoleLines, View { options, record }: View<'_>) {
    if !record.hook_failed() {
        return;
    }
    page.heading(BAD, "hooks that failed: the robot may not be in a safe state");
    for hook in &record.hooks {
        for (number, run) in (1..).zip(&hook.runs) {
            if let Some(problem) = run.problem() {
                let log = logs::hook_run_log(record, hook.plan.hook, number);
                let log = Some(log).filter(|_| !run.output.is_empty());
                let title = style::paint(BOLD, &title(record, hook.plan.hook, run));
                page.line(&format!("  {title}"));
                page.fact("reason", &words::short_line(problem));
                if let Some(log) = log.and_then(|log| options.shown(&log)) {
                    page.fact("log", &log);
                }
            }
        }
    }
}
