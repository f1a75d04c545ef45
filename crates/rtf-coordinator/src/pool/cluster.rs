//! Workers as tasks of jobs in a cluster, one job at a time. Episodes that are repeated, and
//! those that tasks have left, wait for the next job.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::path::Path;
use std::time::{Duration, Instant};

use rtf_cluster::{Job, JobArray};
use rtf_executor::follow::{PollTimer, warn_once};
use rtf_executor::stop::{CANCELLED, Stop};
use rtf_executor::task_progress::TaskProgress;
use rtf_executor::{EXIT_CODE, cluster_failure, last_attempt, print_manifest};
use rtf_model::Episode;
use rtf_run::campaign::arrays::CampaignArray;
use rtf_run::campaign::directory::{CampaignDir, CampaignJobs};
use rtf_run::campaign::read_list;
use rtf_run::error::Failure;
use rtf_run::{exit, terminal};

use super::{EndedWorker, Pool, WorkerEvent};
use crate::assignment::Assignment;
use crate::worker;

/// SIGTERM.
const TERM: i32 = 15;

/// The tasks on a cluster.
pub struct ClusterPool<'a> {
    dir: &'a CampaignDir,
    /// The locked file of the campaign.
    lock: &'a File,
    settings: &'a CampaignJobs,
    shutdown_timeout: Duration,
    next_worker: u32,
    array: Option<ActiveArray>,
}

/// An array with tasks that have not ended.
struct ActiveArray {
    array: CampaignArray,
    job: Job,
    /// The tasks that have not ended, by number.
    tasks: BTreeMap<u32, Assignment>,
    stop: Stop,
    progress: TaskProgress,
    timer: PollTimer,
    is_warned: bool,
    /// Whether the tasks were stopped before this process followed them.
    was_cancelled: bool,
}

impl<'a> ClusterPool<'a> {
    /// No task runs.
    pub fn new(
        dir: &'a CampaignDir,
        lock: &'a File,
        settings: &'a CampaignJobs,
        shutdown_timeout: Duration,
    ) -> Self {
        let next_worker = dir.next_worker();
        Self { dir, lock, settings, shutdown_timeout, next_worker, array: None }
    }

    /// Follows the array that a killed process has left, if there is one.
    pub async fn open(
        dir: &'a CampaignDir,
        lock: &'a File,
        settings: &'a CampaignJobs,
        shutdown_timeout: Duration,
    ) -> Result<Self, Failure> {
        let mut pool = Self::new(dir, lock, settings, shutdown_timeout);
        if let Some(array) = CampaignArray::find_active(dir)? {
            let mut tasks = BTreeMap::new();
            for task in array.tasks() {
                let worker = array.worker(task);
                let list = read_list(&dir.worker_list(worker))?;
                let ids = list.episodes.iter().map(|episode| episode.id);
                tasks.insert(task, Assignment::new(dir, worker, ids));
            }
            pool.follow(array, tasks).await?;
        }
        Ok(pool)
    }

    /// The episodes that its tasks have, and the workers whose results are still to be read.
    pub fn assignments(&self) -> impl Iterator<Item = &Assignment> {
        self.array.iter().flat_map(|array| array.tasks.values())
    }

    /// Creates the workers for lists of episodes, and the array whose tasks they are.
    fn create(
        &mut self,
        lists: &[Vec<Episode>],
    ) -> Result<(CampaignArray, BTreeMap<u32, Assignment>), Failure> {
        let first = self.next_worker;
        let mut tasks = BTreeMap::new();
        for (task, episodes) in (1..).zip(lists) {
            self.dir.create_worker(self.next_worker, episodes)?;
            let ids = episodes.iter().map(|episode| episode.id);
            tasks.insert(task, Assignment::new(self.dir, self.next_worker, ids));
            self.next_worker += 1;
        }
        Ok((CampaignArray::create(self.dir, first, self.next_worker - first)?, tasks))
    }

    /// Prints the manifest of the first job of a campaign, which the user submits.
    pub fn print(mut self, lists: &[Vec<Episode>]) -> Result<(), Failure> {
        let (array, _) = self.create(lists)?;
        let (numbers, command) = self.job_parts(&array);
        print_manifest(&self.settings.cluster, &self.job_array(&array, &numbers, &command))
    }

    /// The numbers of the tasks, and what they execute.
    fn job_parts(&self, array: &CampaignArray) -> (Vec<u32>, [String; 2]) {
        let limit = self.shutdown_timeout.as_millis();
        let command = ["campaign-task".to_owned(), format!("--shutdown-timeout={limit}ms")];
        (array.tasks().collect(), command)
    }

    fn job_array<'b>(
        &'b self,
        array: &'b CampaignArray,
        tasks: &'b [u32],
        command: &'b [String],
    ) -> JobArray<'b> {
        JobArray {
            dir: &array.dir,
            name: &array.stored.name,
            tasks,
            working_dir: &self.dir.description.working_dir,
            command,
            resources: &self.settings.resources,
        }
    }

    /// Submits an array, unless another process has done so, and follows it.
    async fn follow(
        &mut self,
        array: CampaignArray,
        tasks: BTreeMap<u32, Assignment>,
    ) -> Result<(), Failure> {
        let (numbers, command) = self.job_parts(&array);
        let job_array = self.job_array(&array, &numbers, &command);
        // A new one has no job yet, and a name that no job has.
        let cluster = &self.settings.cluster;
        let submitted = cluster.submit(&job_array, true, self.lock).await;
        let job = submitted.map_err(|error| cluster_failure(cluster, error))?;
        let mut stop = Stop::new(&job, &array.dir, self.shutdown_timeout);
        let was_cancelled = array.dir.join(CANCELLED).exists();
        if was_cancelled {
            stop.request(TERM).await;
        }
        let path = self.dir.path.to_string_lossy();
        let path = shell_words::quote(&path);
        terminal::notice(format!("{job}: `rtf campaign run --resume {path}` resumes"));
        let progress = TaskProgress::new(&job, numbers.len());
        let (timer, is_warned) = (PollTimer::now(), false);
        let active =
            ActiveArray { array, job, tasks, stop, progress, timer, is_warned, was_cancelled };
        self.array = Some(active);
        Ok(())
    }
}

impl Pool for ClusterPool<'_> {
    const POLL: Duration = Duration::from_secs(1);
    const PRINTS: bool = true;

    fn free(&self) -> usize {
        if self.array.is_some() { 0 } else { self.settings.shards as usize }
    }

    fn is_empty(&self) -> bool {
        self.array.is_none()
    }

    async fn start(&mut self, lists: Vec<Vec<Episode>>) -> Result<(), Failure> {
        if lists.is_empty() {
            return Ok(());
        }
        let (array, tasks) = self.create(&lists)?;
        self.follow(array, tasks).await
    }

    async fn collect(&mut self) -> Result<Vec<WorkerEvent>, Failure> {
        let Some(active) = &mut self.array else { return Ok(Vec::new()) };
        // Before the results are read, so that none is missed.
        let left = active.poll().await;
        let mut events = Vec::new();
        for assignment in active.tasks.values_mut() {
            let results = assignment.new_results();
            events.extend(results.into_iter().map(WorkerEvent::Result));
        }
        if let Some(left) = left {
            let tasks = std::mem::take(&mut active.tasks).into_iter();
            let (still, ended) = tasks.partition(|(task, _)| left.contains(task));
            active.tasks = still;
            let mut ended_workers = Vec::new();
            let ended: BTreeMap<u32, Assignment> = ended;
            for (task, assignment) in ended {
                let output = active.array.dir.join(format!("output/{task}.txt"));
                ended_workers.push(EndedWorker {
                    code: exit_code(&active.array.dir, task),
                    is_cancelled: active.was_cancelled,
                    outputs: vec![output, worker::output(self.dir, assignment.worker)],
                    assignment,
                });
            }
            // A failed hook ends the other tasks, whose episodes are then not the bench's.
            ended_workers.sort_by_key(|ended| ended.code != Some(exit::HOOK_FAILED));
            events.extend(ended_workers.into_iter().map(WorkerEvent::Ended));
        }
        if active.tasks.is_empty() {
            active.array.end()?;
            self.array = None;
        }
        Ok(events)
    }

    async fn stop(&mut self, signal: i32) {
        if let Some(active) = &mut self.array {
            active.stop.request(signal).await;
            active.timer = PollTimer::now();
        }
    }
}

impl ActiveArray {
    /// Asks the scheduler for the tasks that have not ended, if it is time, and stops those that should
    /// stop.
    async fn poll(&mut self) -> Option<BTreeSet<u32>> {
        if !self.timer.is_due() {
            return None;
        }
        let begin = Instant::now();
        let state = self.job.state().await;
        self.timer = PollTimer::after(begin);
        match state {
            Ok(state) => {
                self.is_warned = false;
                self.stop.stop_tasks(&state.tasks).await;
                self.progress.print(&state, "");
                Some(state.tasks.iter().map(|task| task.number).collect::<BTreeSet<u32>>())
            }
            Err(error) => {
                warn_once(&mut self.is_warned, &error);
                None
            }
        }
    }
}

/// The exit code of the last attempt of a task, unless it was killed.
fn exit_code(dir: &Path, task: u32) -> Option<u8> {
    let text = fs::read_to_string(last_attempt(dir, task)?.join(EXIT_CODE)).ok()?;
    text.trim().parse().ok()
}
