//! Substitutes the leased ports in the texts of a suite's plan, and adds its variables.

use std::sync::Arc;

use rtf_model::{SuitePort, SuitePrepared};

use rtf_plan::plan::{
    FixtureBody, HookBody, PluginPlan, Preparation, Probe, ProbeKind, ProbePlans, ProcessPlan,
    SuitePlan,
};
use rtf_plan::suite::port_reference;

/// Completes a plan.
pub fn substitute(plan: &mut SuitePlan, preparation: Preparation) {
    if let Preparation::Done(prepared) = &preparation {
        // Even without ports, a text may contain an escaped reference.
        Substitution(&prepared.ports).suite(plan);
        let env = with_variables(prepared, &plan.env);
        plan.env = Arc::new(env);
    }
    plan.preparation = preparation;
}

/// Puts the variables before the suite's environment, which overrides them.
fn with_variables(prepared: &SuitePrepared, own: &[(String, String)]) -> Vec<(String, String)> {
    let ids = prepared.variables.iter().filter(|variable| !variable.inherited);
    let ids = ids.map(|variable| (variable.name.clone(), variable.value.clone()));
    let ports = prepared.ports.iter();
    let ports = ports.map(|own| (SuitePort::variable(&own.name), own.port.to_string()));
    ids.chain(ports).chain(own.iter().cloned()).collect()
}

struct Substitution<'a>(&'a [SuitePort]);

impl Substitution<'_> {
    fn text(&self, text: &mut String) {
        if port_reference::mentions(text) {
            let number = |name: &str| {
                let own = self.0.iter().find(|own| own.name == name);
                own.map_or_else(|| format!("${{port:{name}}}"), |own| own.port.to_string())
            };
            *text = port_reference::expand(text, number);
        }
    }

    fn texts(&self, texts: &mut [String]) {
        texts.iter_mut().for_each(|text| self.text(text));
    }

    fn env(&self, env: &mut [(String, String)]) {
        env.iter_mut().for_each(|(_, value)| self.text(value));
    }

    fn suite(&self, plan: &mut SuitePlan) {
        self.text(&mut plan.settings.environment);
        self.env(Arc::make_mut(&mut plan.env).as_mut_slice());
        for fixture in &mut plan.fixtures {
            self.env(&mut fixture.env);
            match &mut fixture.body {
                FixtureBody::Plugin(plugin) => self.plugin(plugin),
                FixtureBody::Process(process) => self.process(Arc::make_mut(process)),
                FixtureBody::Attached(probes) => self.probes(Arc::make_mut(probes)),
            }
        }
        for hook in &mut plan.hooks {
            self.env(&mut hook.env);
            match &mut hook.body {
                HookBody::Plugin(plugin) => self.plugin(plugin),
                HookBody::Command(command) => self.texts(command),
            }
        }
        for test in &mut plan.tests {
            self.env(&mut test.env);
            self.plugin(&mut test.plugin);
        }
    }

    fn plugin(&self, plugin: &mut PluginPlan) {
        self.text(&mut plugin.param);
        self.texts(&mut plugin.args);
        // The host's environment repeats some variables of the suite, such as `PATH`.
        if plugin.host.env.iter().any(|(_, value)| port_reference::mentions(value)) {
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
        probes.ready.iter_mut().chain(&mut probes.alive).for_each(|probe| self.probe(probe));
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
                if let Some(text) = path.to_str().filter(|text| port_reference::mentions(text)) {
                    let mut text = text.to_owned();
                    self.text(&mut text);
                    *path = text.into();
                }
            }
            ProbeKind::Log(_) => {}
        }
    }
}
