//! All processes of a run that had to be killed.

use super::Record;
use crate::LeftProcess;

impl Record {
    /// Everything that had to be killed, with its owner as far as that is known:
    /// what tests, fixtures and hooks left, then what the guard found after the
    /// runner had died.
    #[must_use]
    pub fn left_behind(&self) -> Vec<LeftProcess> {
        let mut all = Vec::new();
        for test in &self.tests {
            let owner = format!("test {}", self.full_name(test.plan.test));
            all.extend(test.attempts.iter().flat_map(|attempt| owned(&attempt.left, &owner)));
        }
        for fixture in &self.fixtures {
            let name = self.within(fixture.plan.suite, &fixture.plan.name);
            all.extend(owned(&fixture.left, &format!("fixture {name}")));
        }
        for hook in &self.hooks {
            let owner = format!("hook {}", self.full_hook_name(hook.plan.hook));
            all.extend(hook.runs.iter().flat_map(|run| owned(&run.left, &owner)));
        }
        all.extend_from_slice(&self.left);
        all
    }
}

fn owned(left: &[LeftProcess], owner: &str) -> impl Iterator<Item = LeftProcess> {
    left.iter().cloned().map(move |mut process| {
        process.owner.get_or_insert_with(|| owner.to_owned());
        process
    })
}
