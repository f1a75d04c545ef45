//! Which fixtures have processes that `rtf` started on this machine.

use rtf_model::Diagnostic;

use super::{FixtureBody, FixturePlan};
use crate::suite::Spanned;
use crate::wording::suggest;

#[derive(Clone, Copy)]
pub(super) struct SuiteFixtures<'f> {
    pub planned: &'f [FixturePlan],
    /// The names of those that were declared.
    pub declared: &'f [String],
}

impl SuiteFixtures<'_> {
    /// Why the processes of a fixture cannot be `verb`ed. The problem has no position yet.
    pub fn process_problem(&self, name: &Spanned<String>, verb: &str) -> Option<Diagnostic> {
        let plan = match self.find(name) {
            Ok(plan) => plan?,
            Err(problem) => return Some(*problem),
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

    /// Why a fixture cannot be `what`, which only a plug-in is. The problem has no position yet.
    pub fn plugin_problem(&self, name: &Spanned<String>, what: &str) -> Option<Diagnostic> {
        match self.find(name) {
            Ok(plan) => {
                let is_plugin = matches!(plan?.body, FixtureBody::Plugin(_));
                let message = format!("`{}` is not {what}: it is no plug-in", name.value);
                (!is_plugin).then(|| Diagnostic::error("wrong-type", message))
            }
            Err(problem) => Some(*problem),
        }
    }

    /// The fixture with a name; `None` if it could not be planned, which was reported.
    fn find(&self, name: &Spanned<String>) -> Result<Option<&FixturePlan>, Box<Diagnostic>> {
        let plan = self.planned.iter().find(|plan| plan.name == name.value);
        if plan.is_some() || self.declared.contains(&name.value) {
            return Ok(plan);
        }
        let message = format!("there is no fixture `{}`", name.value);
        let known = self.planned.iter().map(|plan| plan.name.as_str());
        let problem = suggest(Diagnostic::error("unknown-fixture", message), &name.value, known);
        Err(Box::new(problem))
    }
}
