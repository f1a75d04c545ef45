//! A process that is to be started, or was started ahead of its need.

use std::io;
use std::path::{Path, PathBuf};

use rtf_model::LeakedProcess;
use rtf_model::protocol::SCOPE_VARIABLE;
use tokio::sync::oneshot;

use super::cgroup::{Cgroup, Cgroups};
use super::spawner::{Process, SpawnRequest, Spawner};
use super::tree::Effort;
use super::{codec, tree};

/// A process of a scope of its own, started already or not. A host is greeted
/// with `initialize` as it starts, so that it can get ready while it waits.
#[derive(Debug)]
pub struct Launch {
    /// What is started; without the scope variable.
    pub request: SpawnRequest,
    /// The value of its scope variable: unique on this machine.
    pub scope: String,
    /// Where a host that answers a signal with a stack dump writes it.
    pub stack_file: PathBuf,
    /// Its control group, once it was started.
    pub cgroup: Option<Cgroup>,
    ahead: Option<oneshot::Receiver<io::Result<Process>>>,
}

impl Launch {
    /// A process that will be started by [`Launch::start`].
    #[must_use]
    pub fn new(request: SpawnRequest, scope: String, scratch: &Path) -> Self {
        let stack_file = scratch.join(format!("{scope}.stack"));
        Self { request, scope, stack_file, cgroup: None, ahead: None }
    }

    /// Starts it now, for a need that is to come.
    pub fn start_ahead(&mut self, spawner: &Spawner) {
        self.ahead = Some(spawner.begin(self.full_request()));
    }

    /// The process: started now, unless it was before.
    ///
    /// # Errors
    /// It cannot be started.
    pub async fn start(
        &mut self,
        spawner: &Spawner,
        groups: Option<&Cgroups>,
    ) -> io::Result<Process> {
        let started = match self.ahead.take() {
            Some(started) => started,
            None => spawner.begin(self.full_request()),
        };
        let process = Spawner::started(started).await?;
        self.cgroup = groups.and_then(|groups| groups.enter(&self.scope, process.pid));
        Ok(process)
    }

    /// Kills a process that was started and everything below it.
    pub fn kill(&self, process: &Process) {
        if let Some(group) = &self.cgroup {
            group.kill();
        }
        tree::kill_tree(process.pid);
    }

    /// Kills what a process that has ended left. Returns what was killed.
    pub async fn sweep(&mut self, effort: Effort) -> Vec<LeakedProcess> {
        let mut left = Vec::new();
        if let Some(group) = self.cgroup.take() {
            left = group.clear().await;
        }
        // They come here when they have ended, and are taken in by this.
        tree::add(&mut left, tree::sweep(&self.scope, effort));
        left
    }

    /// Ends a process that was started ahead and is not needed.
    pub async fn discard(mut self) {
        let Some(started) = self.ahead.take() else { return };
        if let Ok(mut process) = Spawner::started(started).await {
            tree::kill_tree(process.pid);
            let _ = process.end.wait().await;
            let _ = tree::sweep(&self.scope, Effort::Once);
        }
    }

    /// The request with the scope variable.
    #[must_use]
    pub fn full_request(&self) -> SpawnRequest {
        let mut request = self.request.clone();
        request.env.push((SCOPE_VARIABLE.to_owned(), self.scope.clone()));
        if let Some(greeting) = &mut request.channel {
            // A host that is not greeted says so by not answering.
            *greeting = codec::greeting(&self.stack_file).unwrap_or_default();
        }
        request
    }
}
