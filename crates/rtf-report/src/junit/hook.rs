//! A run of a hook as a JUnit case.

use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus};
use rtf_model::{HookRecord, HookRunRecord, Record};

use super::{described, first_line, text, time};
use crate::explain::{self, Extent};

/// A case for each run of a hook. One that failed is an error: the robot may
/// not be in a safe state, which says nothing about the software under test.
pub(super) fn of(record: &Record, hook: &HookRecord) -> impl Iterator<Item = TestCase> {
    hook.runs.iter().enumerate().map(move |(index, run)| {
        let earlier = hook.runs[..index].iter().filter(|r| r.trigger == run.trigger).count();
        let mut name = format!("hook {} ({})", hook.plan.name, run.trigger);
        // Servers identify cases by name, from build to build.
        if earlier > 0 {
            name += &format!(" {}", earlier + 1);
        }
        case(record, hook, (name, run))
    })
}

fn case(record: &Record, hook: &HookRecord, (name, run): (String, &HookRunRecord)) -> TestCase {
    let mut case = TestCase::new(text(&name), status(run));
    let suite = record.suites.get(hook.plan.suite.index()).map_or("", |s| &s.plan.name);
    case.set_classname(text(suite));
    case.set_time(run.duration().unwrap_or_default());
    case.timestamp = time::at(record, run.started);
    case.add_property(("reason", text(&run.reason).as_str()));
    if let Some(test) = run.test {
        case.add_property(("test", text(&record.full_name(test)).as_str()));
    }
    super::leaked(&mut case, &run.leaked, run.problem().is_none());
    if !run.output.is_empty() {
        case.set_system_out(text(&run.output));
    }
    case
}

fn status(run: &HookRunRecord) -> TestCaseStatus {
    let Some(problem) = run.problem() else { return TestCaseStatus::success() };
    let lines = explain::lines(|sink| {
        explain::hook(run, Extent::ALL, sink);
        explain::block(explain::Tone::Dim, &run.reason, "reason: ", sink);
    });
    let status = TestCaseStatus::non_success(NonSuccessKind::Error);
    described(status, "hook", first_line(problem), lines.join("\n"))
}
