//! Reports the results of probes and liveness checks.

use std::sync::Arc;

use super::ProcessTask;
use super::event::{EventSender, HostId, ProcessEvent};
use crate::liveness::LivenessCheck;
use crate::probe::{FileVersions, ProbeSpec, Prober, Probes, ValueSpec};
use crate::usage;

/// Evaluates the probes of one process, and reports the results as its events.
#[derive(Clone, Debug)]
pub(super) struct ProbeReporter {
    pub(super) host: HostId,
    pub(super) events: EventSender,
    pub(super) prober: Arc<Prober>,
}

impl ProbeReporter {
    /// Reports when each of these probes has passed once, after the values, and each new
    /// reason why one does not pass. A file must have changed since `before`.
    pub(super) async fn watch_ready(
        self,
        (probes, values): (Vec<ProbeSpec>, Vec<ValueSpec>),
        before: FileVersions,
    ) {
        let mut reported = String::new();
        for probe in &probes {
            while let Err(reason) = self.prober.check(probe, &before).await {
                self.report_pending(reason, &mut reported).await;
                tokio::time::sleep(probe.interval).await;
            }
        }
        for spec in values {
            let value = loop {
                match self.prober.read(&spec, &before).await {
                    Ok(value) => break value,
                    Err(reason) => {
                        let reason = format!("it did not provide `{}`: {reason}", spec.name);
                        self.report_pending(reason, &mut reported).await;
                    }
                }
                tokio::time::sleep(spec.interval).await;
            };
            self.report(ProcessEvent::ValueRead { name: spec.name, value }).await;
        }
        self.report(ProcessEvent::ProbesPassed).await;
    }

    async fn report_pending(&self, reason: String, reported: &mut String) {
        if reason != *reported {
            reported.clone_from(&reason);
            self.report(ProcessEvent::ProbePending(reason)).await;
        }
    }

    /// Reports when one of these probes fails.
    pub(super) async fn watch_alive(self, probes: Vec<ProbeSpec>) {
        let reason = self.prober.wait_for_failure(&probes).await;
        self.report(ProcessEvent::ProbeFailed(reason)).await;
    }

    /// Reports whether all these probes pass, and `check`, if any, finds the process alive.
    pub(super) async fn check_alive(self, probes: Vec<ProbeSpec>, check: Option<LivenessCheck>) {
        let event = match (self.prober.check_all(&probes).await, check) {
            (Ok(()), Some(mut check)) => liveness_event(check.wait().await),
            (Ok(()), None) => ProcessEvent::Alive,
            (Err(reason), _) => ProcessEvent::ProbeFailed(reason),
        };
        self.report(event).await;
    }

    async fn report(&self, event: ProcessEvent) {
        drop(self.events.send((self.host, event)).await);
    }
}

impl ProcessTask {
    /// Carries out the requested liveness check. The task continues to read the process
    /// and to wait for its end while probes are evaluated.
    pub(super) async fn check_alive(&mut self) {
        let Some(selection) = self.check.take() else { return };
        if self.job.is_measured {
            self.report_usage(None).await;
        }
        let probes = self.job.probes.as_ref().map(|Probes { alive, .. }| selection.of(alive));
        let probes = probes.unwrap_or_default();
        let mut check = LivenessCheck::new(self.process.pid);
        if let (true, Some(is_alive)) = (probes.is_empty(), check.poll()) {
            return self.report(liveness_event(is_alive)).await;
        }
        self.background.spawn(self.probe_reporter().check_alive(probes, Some(check)));
    }

    pub(super) fn watch_ready(&mut self, before: FileVersions) {
        if let Some(Probes { ready, values, .. }) = self.job.probes.clone() {
            self.background.spawn(self.probe_reporter().watch_ready((ready, values), before));
        }
    }

    pub(super) fn watch_alive(&mut self) {
        if let Some(Probes { alive, .. }) = self.job.probes.clone() {
            self.background.spawn(self.probe_reporter().watch_alive(alive));
        }
    }

    pub(super) async fn report_usage(&self, tests_served: Option<u32>) {
        let usage = usage::measure(self.process.pid, &self.job.launch.scope);
        self.report(ProcessEvent::ResourcesMeasured { usage, tests_served }).await;
    }

    fn probe_reporter(&self) -> ProbeReporter {
        let prober = Prober {
            spawner: self.context.spawner.clone(),
            template: self.job.launch.full_request(),
            network: self.job.probes.as_ref().and_then(|probes| probes.network.clone()),
        };
        let prober = Arc::new(prober);
        ProbeReporter { host: self.job.host, events: self.events.clone(), prober }
    }
}

fn liveness_event(is_alive: bool) -> ProcessEvent {
    if is_alive { ProcessEvent::Alive } else { ProcessEvent::Dying }
}
