//! The fixtures that `rtf` adds to a suite, after all others.

use super::{FixtureBody, FixturePlan, PluginPlan, defaults};

/// Returns the fixture of a plug-in, which depends on all others.
pub(super) fn plan(name: String, plugin: PluginPlan, others: &[FixturePlan]) -> FixturePlan {
    FixturePlan {
        id: rtf_model::FixtureId(0),
        name,
        provides: Vec::new(),
        depends: (0..others.len()).collect(),
        body: FixtureBody::Plugin(plugin),
        env: Vec::new(),
        limits: defaults::FIXTURE,
        reset: None,
        restarts: defaults::RESTARTS,
        restart_delay: defaults::RESTART_DELAY,
        check_every: None,
    }
}

/// Returns the first of `base`, `base#2`, `base#3`, … that no other fixture has.
pub(super) fn free_name(base: &str, others: &[FixturePlan]) -> String {
    let is_taken = |name: &String| others.iter().any(|other| other.name == *name);
    let numbered = (2..).map(|number| format!("{base}#{number}"));
    let mut names = std::iter::once(base.to_owned()).chain(numbered);
    names.find(|name| !is_taken(name)).unwrap_or_default()
}
