//! Converts planned probes. The state machine itself evaluates the probes of logs.

use rtf_plan::plan;
use rtf_process::network::Network;
use rtf_process::probe::{ProbeSpec, ProbeTarget, Probes, ValueSpec};

pub(super) fn convert(plan: &plan::ProbePlans, network: Option<Network>) -> Probes {
    let convert = |probes: &[plan::Probe]| probes.iter().filter_map(probe).collect();
    let values = plan.values.iter().filter_map(|value| {
        Some(ValueSpec { name: value.name.clone(), probe: probe(&value.probe)? })
    });
    let values = values.collect();
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
