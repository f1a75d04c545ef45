//! Which fixtures have processes that `rtf` started on this machine.

use rtf_model::Diagnostic;

use super::{FixtureBody, FixturePlan};
use crate::suite::Spanned;
use crate::wording::suggest;

/// The fixtures of a suite.
#[derive(Clone, Copy)]
pub(super) struct SuiteFixtures<'f> {
    /// Those that were planned.
    pub planned: &'f [FixturePlan],
    /// The names of those that were declared.
    pub declared: &'f [String],
}

impl SuiteFixtures<'_> {
    /// Why the processes of a fixture cannot be `verb`ed. The problem has no position yet.
    pub fn process_problem(&self, name: &Spanned<String>, verb: &str) -> Option<Diagnostic> {
        let Some(plan) = self.planned.iter().find(|plan| plan.name == name.value) else {
            // One that could not be planned was reported.
            if self.declared.contains(&name.value) {
                return None;
            }
            let message = format!("there is no fixture `{}`", name.value);
            let known = self.planned.iter().map(|plan| plan.name.as_str());
            let problem = Diagnostic::error("unknown-fixture", message);
            return Some(suggest(problem, &name.value, known));
        };
        let what = match &plan.body {
            FixtureBody::Plugin(_) => return None,
            FixtureBody::Process(process) if process.remote.is_none() => return None,
            FixtureBody::Process(_) => "runs on another machine",
            FixtureBody::Attached(_) => "is attached: `rtf` does not know its processes",
        };
        let message = format!("`{}` cannot be {verb}: it {what}", name.value);
        Some(Diagnostic::error("wrong-type", message))
    }
}
