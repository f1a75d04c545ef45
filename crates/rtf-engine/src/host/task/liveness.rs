//! Whether a fixture lives: its probes hold, and the kernel has not begun to end its
//! process.

use super::Task;
use crate::host::dying::Sight;
use crate::host::usage;
use crate::run::machine::{HostInput, Probes};
use rtf_plan::plan::{Probe, ProbeKind};

impl Task {
    /// Examines the process, and reports what was seen. Probes may take a while: the
    /// process is read and waited for meanwhile.
    pub(super) async fn look_alive(&mut self) {
        let Some(probes) = self.looked_at.take() else { return };
        if self.job.measured {
            let usage = usage::of(self.process.pid, &self.job.launch.scope);
            self.tell(HostInput::Uses { usage, tests_served: None }).await;
        }
        let plan = self.job.process.as_deref();
        let alive = plan.map(|plan| asked(&plan.alive, probes)).unwrap_or_default();
        let mut sight = Sight::of(self.process.pid);
        if let (true, Some(lives)) = (alive.is_empty(), sight.look()) {
            return self.tell(seen(lives)).await;
        }
        let watch = self.watch();
        self.side.spawn(async move {
            let input = match watch.all_hold(&alive).await {
                Ok(()) => seen(sight.wait().await),
                Err(reason) => HostInput::ProbeFailed(reason),
            };
            watch.tell(input).await;
        });
    }
}

/// The probes that are to be asked. Of a log, each line is looked at as it comes.
pub(in crate::host) fn asked(alive: &[Probe], probes: Probes) -> Vec<Probe> {
    let is_asked = |probe: &&Probe| match probe.kind {
        ProbeKind::Log(_) => false,
        ProbeKind::Tcp(_) | ProbeKind::Http(_) | ProbeKind::File(_) => true,
        ProbeKind::Command(_) | ProbeKind::Middleware { .. } => probes == Probes::All,
    };
    alive.iter().filter(is_asked).cloned().collect()
}

fn seen(lives: bool) -> HostInput {
    if lives { HostInput::Lives } else { HostInput::Dies }
}
