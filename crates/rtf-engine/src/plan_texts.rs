//! Substitutes references in the texts of a plan.

use std::cell::Cell;
use std::sync::Arc;

use rtf_plan::plan::{
    FixtureBody, HookBody, PluginPlan, Probe, ProbeKind, ProbePlans, ProcessPlan, SuitePlan,
};
use rtf_plan::suite::episode_reference;

/// Whether a text of a suite contains a parameter of a campaign.
#[must_use]
pub fn refers_to_episode(plan: &SuitePlan) -> bool {
    let finder = EpisodeFinder::default();
    finder.suite(&mut plan.clone());
    finder.0.get()
}

/// Finds references, and replaces none.
#[derive(Default)]
struct EpisodeFinder(Cell<bool>);

impl Substitution for EpisodeFinder {
    fn is_in(&self, text: &str) -> bool {
        self.0.set(self.0.get() || episode_reference::mentions(text));
        false
    }

    fn expand(&self, text: &str) -> String {
        text.to_owned()
    }
}

/// Replaces references of one kind.
pub trait Substitution {
    /// Checks whether a text contains a reference, or an escaped one.
    fn is_in(&self, text: &str) -> bool;

    /// Returns a text with all references replaced.
    fn expand(&self, text: &str) -> String;

    fn text(&self, text: &mut String) {
        if self.is_in(text) {
            *text = self.expand(text);
        }
    }

    fn texts(&self, texts: &mut [String]) {
        texts.iter_mut().for_each(|text| self.text(text));
    }

    /// Substitutes in the values of variables.
    fn env(&self, env: &mut [(String, String)]) {
        env.iter_mut().for_each(|(_, value)| self.text(value));
    }

    fn suite(&self, plan: &mut SuitePlan) {
        self.text(&mut plan.settings.environment);
        self.env(Arc::make_mut(&mut plan.env).as_mut_slice());
        for fixture in &mut plan.fixtures {
            self.env(&mut fixture.env);
            if let Some(reset) = &mut fixture.reset {
                self.hook(&mut reset.body);
            }
            self.fixture(&mut fixture.body);
        }
        for hook in &mut plan.hooks {
            self.env(&mut hook.env);
            self.hook(&mut hook.body);
        }
        for test in &mut plan.tests {
            self.env(&mut test.env);
            self.plugin(&mut test.plugin);
        }
    }

    fn fixture(&self, body: &mut FixtureBody) {
        match body {
            FixtureBody::Plugin(plugin) => self.plugin(plugin),
            FixtureBody::Process(process) => self.process(Arc::make_mut(process)),
            FixtureBody::Attached(probes) => self.probes(Arc::make_mut(probes)),
        }
    }

    /// Substitutes in a hook or a reset.
    fn hook(&self, body: &mut HookBody) {
        match body {
            HookBody::Plugin(plugin) => self.plugin(plugin),
            HookBody::Command(command) => self.texts(command),
        }
    }

    fn plugin(&self, plugin: &mut PluginPlan) {
        self.text(&mut plugin.param);
        self.texts(&mut plugin.args);
        // The host's environment repeats some variables of the suite, such as `PATH`.
        if plugin.host.env.iter().any(|(_, value)| self.is_in(value)) {
            self.env(&mut Arc::make_mut(&mut plugin.host).env);
        }
    }

    fn process(&self, process: &mut ProcessPlan) {
        self.texts(&mut process.command);
        if let Some(remote) = &mut process.remote {
            self.text(&mut remote.host);
            self.texts(&mut remote.ssh);
        }
        self.probes(&mut process.probes);
    }

    fn probes(&self, probes: &mut ProbePlans) {
        let values = probes.values.iter_mut().map(|value| &mut value.probe);
        let all = probes.ready.iter_mut().chain(&mut probes.alive).chain(values);
        all.for_each(|probe| self.probe(probe));
    }

    fn probe(&self, probe: &mut Probe) {
        match &mut probe.kind {
            ProbeKind::Tcp(text) | ProbeKind::Http(text) => self.text(text),
            ProbeKind::Command(command) => self.texts(command),
            ProbeKind::Middleware { command, subject } => {
                self.texts(command);
                self.text(subject);
            }
            ProbeKind::File(path) => {
                if let Some(text) = path.to_str().filter(|text| self.is_in(text)) {
                    *path = self.expand(text).into();
                }
            }
            ProbeKind::Log(_) => {}
        }
    }
}
