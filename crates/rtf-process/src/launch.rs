//! The start of a process, on demand or ahead of time, and its cleanup.

use std::io;
use std::path::{Path, PathBuf};

use rtf_model::LeakedProcess;
use rtf_model::protocol::SCOPE_VARIABLE;
use tokio::sync::oneshot;

use crate::cgroup::{Cgroup, Cgroups};
use crate::process::StartedProcess;
use crate::spawn_request::SpawnRequest;
use crate::spawner::Spawner;
use crate::tree::Effort;
use crate::{codec, tree};

/// A process with a unique scope, started or not. A host receives `initialize` as its
/// greeting, so that a host started ahead of time gets ready while it waits.
#[derive(Debug)]
pub struct Launch {
    /// The request, without the scope variable.
    pub request: SpawnRequest,
    /// The value of its scope variable: unique on this machine.
    pub scope: String,
    /// The file to which a host dumps its stacks on a signal.
    pub stack_file: PathBuf,
    /// Its control group, once started.
    pub cgroup: Option<Cgroup>,
    ahead: Option<oneshot::Receiver<io::Result<StartedProcess>>>,
}

impl Launch {
    /// A process that [`Launch::start`] will start.
    pub fn new(request: SpawnRequest, scope: String, scratch_dir: &Path) -> Self {
        let stack_file = scratch_dir.join(format!("{scope}.stack"));
        Self { request, scope, stack_file, cgroup: None, ahead: None }
    }

    pub fn start_ahead(&mut self, spawner: &Spawner) {
        self.ahead = Some(spawner.begin(self.full_request()));
    }

    /// Starts the process, unless it was started ahead of time.
    ///
    /// # Errors
    /// It cannot be started.
    pub async fn start(
        &mut self,
        spawner: &Spawner,
        groups: Option<&Cgroups>,
    ) -> io::Result<StartedProcess> {
        let started = match self.ahead.take() {
            Some(started) => started,
            None => spawner.begin(self.full_request()),
        };
        let process = Spawner::started(started).await?;
        self.cgroup = groups.and_then(|groups| groups.enter(&self.scope, process.pid));
        Ok(process)
    }

    /// Waits for the leftover processes of an ended process that are about to end.
    pub async fn await_helpers(&self) {
        match &self.cgroup {
            // A process that is ending has no environment any more.
            Some(group) => tree::await_ending_of(|| group.members()).await,
            None => tree::await_ending_of(|| tree::orphans_of(&self.scope)).await,
        }
    }

    /// Kills the leftover processes of an ended process, and returns them.
    pub async fn sweep(&mut self, effort: Effort) -> Vec<LeakedProcess> {
        let mut left = Vec::new();
        if let Some(group) = self.cgroup.take() {
            left = group.clear().await;
        }
        // This also reaps them: the runner has adopted them.
        tree::add_new(&mut left, tree::sweep(&self.scope, effort));
        left
    }

    /// Kills a process that was started ahead of time and is not needed.
    pub async fn discard(mut self) {
        let Some(started) = self.ahead.take() else { return };
        if let Ok(mut process) = Spawner::started(started).await {
            tree::kill_tree(process.pid);
            let _ = process.end.wait().await;
            let _ = tree::sweep(&self.scope, Effort::Once);
        }
    }

    /// Returns the request with the scope variable.
    pub fn full_request(&self) -> SpawnRequest {
        let mut request = self.request.clone();
        request.env.push((SCOPE_VARIABLE.to_owned(), self.scope.clone()));
        if let Some(greeting) = &mut request.channel {
            // A host without a greeting does not reply, which is reported.
            *greeting = codec::greeting(Some(&self.stack_file)).unwrap_or_default();
        }
        request
    }
}
