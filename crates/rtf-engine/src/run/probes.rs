//! Converts planned probes. The state machine itself evaluates the probes of logs.

use rtf_plan::plan;
use rtf_process::network::Network;
use rtf_process::probe::{Probe, ProbeKind, Probes};

pub(super) fn convert(
    ready: &[plan::Probe],
    alive: &[plan::Probe],
    network: Option<Network>,
) -> Probes {
    let convert = |probes: &[plan::Probe]| probes.iter().filter_map(probe).collect();
    Probes { ready: convert(ready), alive: convert(alive), network }
}

fn probe(plan: &plan::Probe) -> Option<Probe> {
    let kind = match plan.kind.clone() {
        plan::ProbeKind::Tcp(address) => ProbeKind::Tcp(address),
        plan::ProbeKind::Http(url) => ProbeKind::Http(url),
        plan::ProbeKind::Command(command) => ProbeKind::Command(command),
        plan::ProbeKind::File(path) => ProbeKind::File(path),
        plan::ProbeKind::Middleware { command, subject } => {
            ProbeKind::ExplainingCommand { command, subject }
        }
        plan::ProbeKind::Log(_) => return None,
    };
    Some(Probe { kind, interval: plan.every, timeout: plan.timeout })
}
