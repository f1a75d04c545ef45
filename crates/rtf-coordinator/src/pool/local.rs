//! Workers as processes of this machine.

use std::process::{Child, ChildStdin};
use std::time::Duration;

use rtf_model::Episode;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::error::Failure;
use rtf_run::spawn_self;

use super::{EndedWorker, Pool, WorkerEvent};
use crate::assignment::Assignment;
use crate::worker;

/// The workers on this machine.
pub struct LocalPool<'a> {
    dir: &'a CampaignDir,
    /// The largest number of workers.
    most: usize,
    shutdown_timeout: Duration,
    next_worker: u32,
    workers: Vec<LocalWorker>,
}

struct LocalWorker {
    assignment: Assignment,
    child: Child,
    /// The run ends when this is closed, also if this process is killed.
    _lifeline: Option<ChildStdin>,
}

impl<'a> LocalPool<'a> {
    /// No worker runs.
    pub fn new(dir: &'a CampaignDir, most: usize, shutdown_timeout: Duration) -> Self {
        let next_worker = dir.next_worker();
        Self { dir, most, shutdown_timeout, next_worker, workers: Vec::new() }
    }
}

impl Pool for LocalPool<'_> {
    const POLL: Duration = Duration::from_millis(20);
    const PRINTS: bool = false;

    fn free(&self) -> usize {
        self.most - self.workers.len()
    }

    fn is_empty(&self) -> bool {
        self.workers.is_empty()
    }

    async fn start(&mut self, lists: Vec<Vec<Episode>>) -> Result<(), Failure> {
        for episodes in lists {
            let number = self.next_worker;
            self.next_worker += 1;
            let list = self.dir.create_worker(number, &episodes)?;
            let mut command =
                worker::command_with_list(self.dir, number, &list, self.shutdown_timeout)?;
            let mut child = command.spawn().map_err(Failure::internal)?;
            let ids = episodes.iter().map(|episode| episode.id);
            self.workers.push(LocalWorker {
                assignment: Assignment::new(self.dir, number, ids),
                _lifeline: child.stdin.take(),
                child,
            });
        }
        Ok(())
    }

    async fn collect(&mut self) -> Result<Vec<WorkerEvent>, Failure> {
        let mut events = Vec::new();
        let mut index = 0;
        while let Some(worker) = self.workers.get_mut(index) {
            // Before the results are read, so that none is missed.
            let ended = worker.child.try_wait().ok().flatten();
            let results = worker.assignment.new_results();
            events.extend(results.into_iter().map(WorkerEvent::Result));
            match ended {
                Some(status) => {
                    let assignment = self.workers.remove(index).assignment;
                    events.push(WorkerEvent::Ended(EndedWorker {
                        code: Some(spawn_self::exit_code(status)),
                        is_cancelled: false,
                        outputs: vec![worker::output(self.dir, assignment.worker)],
                        assignment,
                    }));
                }
                None => index += 1,
            }
        }
        Ok(events)
    }

    async fn stop(&mut self, signal: i32) {
        for worker in &self.workers {
            if let Some(pid) = spawn_self::pid(worker.child.id()) {
                spawn_self::signal(pid, signal);
            }
        }
    }
}
