//! The task of an attached fixture: evaluates its probes, and neither starts nor stops
//! anything.

use std::sync::Arc;

use rtf_model::ExitStatus;
use tokio::sync::mpsc;
use tokio::task::JoinSet;

use super::command::ProcessCommand;
use super::event::{EventSender, HostId, ProcessEvent};
use super::probing::ProbeReporter;
use crate::launch::Launch;
use crate::probe::{FileVersions, Prober, Probes};
use crate::spawner::Spawner;
use crate::tree;

#[derive(Debug)]
pub struct AttachedJob {
    pub host: HostId,
    pub probes: Probes,
    /// The working directory and the environment of probe commands.
    pub launch: Launch,
}

/// Watches an attached fixture until a command detaches it.
pub async fn watch_attached(
    job: AttachedJob,
    spawner: Spawner,
    mut commands: mpsc::UnboundedReceiver<ProcessCommand>,
    events: EventSender,
) {
    let AttachedJob { host, probes: Probes { ready, alive, values, network }, launch } = job;
    let prober = Arc::new(Prober { spawner, template: launch.full_request(), network });
    let reporter = ProbeReporter { host, events: events.clone(), prober };
    let mut background = JoinSet::new();
    background.spawn(reporter.clone().watch_ready((ready, values), FileVersions::default()));
    loop {
        match commands.recv().await {
            Some(ProcessCommand::WatchAlive) => {
                background.spawn(reporter.clone().watch_alive(alive.clone()));
            }
            Some(ProcessCommand::CheckAlive(selection)) => {
                background.spawn(reporter.clone().check_alive(selection.of(&alive), None));
            }
            Some(
                ProcessCommand::Send(..)
                | ProcessCommand::DumpStack(..)
                | ProcessCommand::Assign(_),
            ) => {}
            Some(
                ProcessCommand::CloseChannel
                | ProcessCommand::Signal(..)
                | ProcessCommand::KillTree,
            )
            | None => break,
        }
    }
    background.shutdown().await;
    let left = tree::sweep(&launch.scope, tree::Effort::Once);
    drop(events.send((host, ProcessEvent::Exited(ExitStatus::Code(0), left))).await);
}
