//! Substitutes the leased ports in the texts of a suite's plan, and adds its variables.

use std::sync::Arc;

use rtf_model::{SuitePort, SuitePrepared};

use rtf_plan::plan::{Preparation, SuitePlan};
use rtf_plan::suite::port_reference;

use crate::plan_texts::Substitution;

pub fn substitute(plan: &mut SuitePlan, preparation: Preparation) {
    if let Preparation::Done(prepared) = &preparation {
        // Even without ports, a text may contain an escaped reference.
        Ports(&prepared.ports).suite(plan);
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

struct Ports<'a>(&'a [SuitePort]);

impl Substitution for Ports<'_> {
    fn is_in(&self, text: &str) -> bool {
        port_reference::mentions(text)
    }

    fn expand(&self, text: &str) -> String {
        port_reference::expand(text, |name| {
            let own = self.0.iter().find(|own| own.name == name);
            own.map_or_else(|| format!("${{port:{name}}}"), |own| own.port.to_string())
        })
    }
}
