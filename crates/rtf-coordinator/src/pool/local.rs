//! Workers as processes of this machine.

use std::os::fd::OwnedFd;
use std::path::Path;
use std::process::{Child, ChildStdin};
use std::time::Duration;

use rtf_model::Episode;
use rtf_report::console::AskedHere;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::error::Failure;
use rtf_run::operator::campaign::{CampaignAnswer, WorkerQuestions};
use rtf_run::spawn_self;

use super::{EndedWorker, Pool, WorkerEvent};
use crate::assignment::Assignment;
use crate::worker::{self, Answers};

/// The workers on this machine.
pub struct LocalPool<'a> {
    dir: &'a CampaignDir,
    /// The largest number of workers.
    most: usize,
    shutdown_timeout: Duration,
    answers: Answers,
    /// Whether the plug-ins were checked just before.
    is_checked: bool,
    next_worker: u32,
    workers: Vec<LocalWorker>,
}

struct LocalWorker {
    assignment: Assignment,
    child: Child,
    lifeline: WorkerLifeline,
}

/// The run ends when this is closed, also if this process is killed.
enum WorkerLifeline {
    Input {
        _open: Option<ChildStdin>,
    },
    /// Its questions are answered over it.
    Questions(Box<WorkerQuestions>),
}

impl<'a> LocalPool<'a> {
    /// No worker runs.
    pub fn new(
        dir: &'a CampaignDir,
        most: usize,
        (shutdown_timeout, answers): (Duration, Answers),
    ) -> Self {
        let next_worker = dir.next_worker();
        let (is_checked, workers) = (false, Vec::new());
        Self { dir, most, shutdown_timeout, answers, is_checked, next_worker, workers }
    }

    /// The plug-ins were checked just before: the first workers start no hosts for that.
    #[must_use]
    pub fn checked(self) -> Self {
        Self { is_checked: true, ..self }
    }

    fn spawn(
        &self,
        number: u32,
        list: &Path,
        is_checked: bool,
    ) -> Result<(Child, WorkerLifeline), Failure> {
        let options = (self.shutdown_timeout, self.answers);
        let mut command = worker::command_with_list(self.dir, number, list, options)?;
        if is_checked {
            command.arg(worker::CHECKED);
        }
        if self.answers != Answers::Operator {
            let mut child = command.spawn().map_err(Failure::internal)?;
            let _open = child.stdin.take();
            return Ok((child, WorkerLifeline::Input { _open }));
        }
        let (questions, socket) = WorkerQuestions::open().map_err(Failure::internal)?;
        command.stdin(OwnedFd::from(socket));
        let child = command.spawn().map_err(Failure::internal)?;
        Ok((child, WorkerLifeline::Questions(Box::new(questions))))
    }
}

impl Pool for LocalPool<'_> {
    const POLL: Duration = Duration::from_millis(5);
    const PRINTS: bool = false;

    fn free(&self) -> usize {
        self.most - self.workers.len()
    }

    fn is_empty(&self) -> bool {
        self.workers.is_empty()
    }

    async fn start(&mut self, lists: Vec<Vec<Episode>>) -> Result<(), Failure> {
        let is_checked = std::mem::take(&mut self.is_checked);
        for episodes in lists {
            let number = self.next_worker;
            self.next_worker += 1;
            let list = self.dir.create_worker(number, &episodes)?;
            let (child, lifeline) = self.spawn(number, &list, is_checked)?;
            let ids = episodes.iter().map(|episode| episode.id);
            self.workers.push(LocalWorker {
                assignment: Assignment::new(self.dir, number, ids),
                child,
                lifeline,
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

    fn questions(&mut self) -> Vec<(u32, AskedHere)> {
        let question = |worker: &mut LocalWorker| match &mut worker.lifeline {
            WorkerLifeline::Input { .. } => None,
            WorkerLifeline::Questions(it) => {
                Some((worker.assignment.worker, it.current()?.clone()))
            }
        };
        self.workers.iter_mut().filter_map(question).collect()
    }

    fn answer(&mut self, worker: u32, answer: &CampaignAnswer) {
        let worker = self.workers.iter_mut().find(|it| it.assignment.worker == worker);
        if let Some(WorkerLifeline::Questions(questions)) = worker.map(|it| &mut it.lifeline) {
            questions.answer(answer);
        }
    }

    async fn stop(&mut self, signal: i32) {
        for worker in &self.workers {
            if let Some(pid) = spawn_self::pid(worker.child.id()) {
                spawn_self::signal(pid, signal);
            }
        }
    }
}
