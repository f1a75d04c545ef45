//! All processes of a run that had to be killed.

use super::Record;
use crate::LeakedProcess;

impl Record {
    /// Everything that had to be killed, with its owner as far as that is known:
    /// what tests, fixtures and hooks left, then what the guard found after the
    /// runner had died.
    #[must_use]
    pub fn left_behind(&self) -> Vec<LeakedProcess> {
        let mut all = Vec::new();
        for test in &self.tests {
            let owner = format!("test {}", self.full_name(test.plan.test));
            all.extend(test.attempts.iter().flat_map(|attempt| owned(&attempt.leaked, &owner)));
        }
        for fixture in &self.fixtures {
            let name = self.within(fixture.plan.suite, &fixture.plan.name);
            all.extend(owned(&fixture.leaked, &format!("fixture {name}")));
        }
        for hook in &self.hooks {
            let owner = format!("hook {}", self.full_hook_name(hook.plan.hook));
            all.extend(hook.runs.iter().flat_map(|run| owned(&run.leaked, &owner)));
        }
        all.extend_from_slice(&self.leaked);
        all
    }
}

fn owned(left: &[LeakedProcess], owner: &str) -> impl Iterator<Item = LeakedProcess> {
    left.iter().cloned().map(move |mut process| {
        process.owner.get_or_insert_with(|| owner.to_owned());
        process
    })
}
