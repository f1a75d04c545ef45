//! All processes of a run that had to be killed.

use super::Record;
use crate::LeakedProcess;

impl Record {
    /// All leaked processes, with their owners as far as these are known:
    /// those of tests, fixtures and hooks, then those that the guard found after the
    /// runner had died.
    #[must_use]
    pub fn leaked_processes(&self) -> Vec<LeakedProcess> {
        let mut all = Vec::new();
        for test in &self.tests {
            let owner = format!("test {}", self.full_name(test.plan.test));
            all.extend(
                test.attempts.iter().flat_map(|attempt| with_owner(&attempt.leaked, &owner)),
            );
        }
        for fixture in &self.fixtures {
            let name = self.within(fixture.plan.suite, &fixture.plan.name);
            all.extend(with_owner(&fixture.leaked, &format!("fixture {name}")));
        }
        for hook in &self.hooks {
            let owner = format!("hook {}", self.full_hook_name(hook.plan.hook));
            all.extend(hook.runs.iter().flat_map(|run| with_owner(&run.leaked, &owner)));
        }
        all.extend_from_slice(&self.leaked);
        all
    }
}

fn with_owner(leaked: &[LeakedProcess], owner: &str) -> impl Iterator<Item = LeakedProcess> {
    leaked.iter().cloned().map(move |mut process| {
        process.owner.get_or_insert_with(|| owner.to_owned());
        process
    })
}
