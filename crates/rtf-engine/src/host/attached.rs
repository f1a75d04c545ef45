//! The task around what runs already: it asks its probes, and neither starts
//! nor stops anything.

use std::sync::Arc;

use rtf_model::ExitStatus;
use tokio::sync::mpsc;
use tokio::task::JoinSet;

use super::launch::Launch;
use super::task::liveness::asked;
use super::task::{Inputs, Order, Shared};
use super::tree;
use crate::run::machine::{HostId, HostInput};
use crate::run::probe::{Asker, Files, Watch};
use rtf_plan::plan::AttachedPlan;

/// What is attached, and for whom.
#[derive(Debug)]
pub struct Attached {
    /// Its id in the suite.
    pub host: HostId,
    /// Its probes.
    pub plan: Arc<AttachedPlan>,
    /// The folder and environment of commands that are asked.
    pub launch: Launch,
}

/// Watches until it is told to end.
pub async fn run(
    attached: Attached,
    shared: Arc<Shared>,
    mut orders: mpsc::UnboundedReceiver<Order>,
    inputs: Inputs,
) {
    let Attached { host, plan, launch } = attached;
    let asker = Asker { spawner: shared.spawner.clone(), like: launch.full_request() };
    let watch = Watch { host, inputs: inputs.clone(), asker };
    let mut side = JoinSet::new();
    side.spawn(watch.clone().until_ready(plan.ready.clone(), Files::default()));
    loop {
        match orders.recv().await {
            Some(Order::WatchAlive) => {
                side.spawn(watch.clone().until_unwell(plan.alive.clone()));
            }
            Some(Order::LookAlive(probes)) => {
                let (watch, alive) = (watch.clone(), asked(&plan.alive, probes));
                side.spawn(async move {
                    let input = match watch.all_hold(&alive).await {
                        Ok(()) => HostInput::Lives,
                        Err(reason) => HostInput::ProbeFailed(reason),
                    };
                    watch.tell(input).await;
                });
            }
            Some(Order::Send(..) | Order::TakeStack(_) | Order::ServeNext(_)) => {}
            Some(Order::CloseChannel | Order::Signal(_) | Order::KillTree) | None => break,
        }
    }
    side.shutdown().await;
    let left = tree::sweep(&launch.scope, tree::Effort::Once);
    drop(inputs.send((host, HostInput::Exited(ExitStatus::Code(0), left))).await);
}
