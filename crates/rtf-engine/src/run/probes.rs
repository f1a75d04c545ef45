//! Converts planned probes and sources of values. The state machine itself evaluates those of
//! logs.

use std::time::Duration;

use rtf_plan::plan;
use rtf_process::network::Network;
use rtf_process::probe::{ProbeSpec, ProbeTarget, Probes, ValueSource, ValueSpec};

/// How long the program of a middleware's probe may take in addition, to start, to report the
/// reason, and to leave the middleware: others see a killed node of ROS 2 for 20 s.
const LEAVE_LIMIT: Duration = Duration::from_secs(3);

pub(super) fn convert(plan: &plan::ProbePlans, network: Option<Network>) -> Probes {
    let convert = |probes: &[plan::Probe]| probes.iter().filter_map(probe).collect();
    let values = plan.values.iter().filter_map(value).collect();
    Probes { ready: convert(&plan.ready), alive: convert(&plan.alive), values, network }
}

fn probe(plan: &plan::Probe) -> Option<ProbeSpec> {
    let mut timeout = plan.timeout;
    let target = match plan.kind.clone() {
        plan::ProbeKind::Tcp(address) => ProbeTarget::Tcp(address),
        plan::ProbeKind::Http(url) => ProbeTarget::Http(url),
        plan::ProbeKind::Command(command) => ProbeTarget::Command { command, subject: None },
        plan::ProbeKind::File(path) => ProbeTarget::File(path),
        plan::ProbeKind::Middleware { command, subject } => {
            // Its arguments contain the limit.
            timeout += LEAVE_LIMIT;
            ProbeTarget::Command { command, subject: Some(subject) }
        }
        plan::ProbeKind::Log(_) => return None,
    };
    Some(ProbeSpec { target, interval: plan.every, timeout })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_asks_middleware_can_report_that_its_limit_was_reached() {
        let limit = Duration::from_secs(5);
        let spec = |kind| {
            probe(&plan::Probe { kind, every: Duration::from_secs(1), timeout: limit }).unwrap()
        };
        let command = vec!["probe.py".to_owned()];
        assert_eq!(spec(plan::ProbeKind::Command(command.clone())).timeout, limit);
        let subject = "ros2-topic `/chatter`".to_owned();
        let asked = spec(plan::ProbeKind::Middleware { command, subject });
        assert!(asked.timeout > limit, "{asked:?}");
    }
}
