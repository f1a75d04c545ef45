//! Converts planned probes and sources of values. The state machine itself evaluates those of
//! logs.

use rtf_plan::plan;
use rtf_process::network::Network;
use rtf_process::probe::{ProbeSpec, ProbeTarget, Probes, ValueSource, ValueSpec};

pub(super) fn convert(plan: &plan::ProbePlans, network: Option<Network>) -> Probes {
    let convert = |probes: &[plan::Probe]| probes.iter().filter_map(probe).collect();
    let values = plan.values.iter().filter_map(value).collect();
    Probes { ready: convert(&plan.ready), alive: convert(&plan.alive), values, network }
}

fn probe(plan: &plan::Probe) -> Option<ProbeSpec> {
    let target = match plan.kind.clone() {
        plan::ProbeKind::Tcp(address) => ProbeTarget::Tcp(address),
        plan::ProbeKind::Http(url) => ProbeTarget::Http(url),
        plan::ProbeKind::Command(command) => ProbeTarget::Command { command, subject: None },
        plan::ProbeKind::File(path) => ProbeTarget::File(path),
        plan::ProbeKind::Middleware { command, subject } => {
            ProbeTarget::Command { command, subject: Some(subject) }
        }
        plan::ProbeKind::Log(_) => return None,
    };
    Some(ProbeSpec { target, interval: plan.every, timeout: plan.timeout })
}

fn value(plan: &plan::ValueProbe) -> Option<ValueSpec> {
    let source = match plan.probe.kind.clone() {
        plan::ProbeKind::File(path) => ValueSource::File(path),
        plan::ProbeKind::Command(command) => ValueSource::Command(command),
        // The state machine reads logs, and the planner makes no other source.
        plan::ProbeKind::Log(_)
        | plan::ProbeKind::Tcp(_)
        | plan::ProbeKind::Http(_)
        | plan::ProbeKind::Middleware { .. } => return None,
    };
    let plan::Probe { every: interval, timeout, .. } = plan.probe;
    Some(ValueSpec { name: plan.name.clone(), source, interval, timeout })
}
