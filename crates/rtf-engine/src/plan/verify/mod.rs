//! Asks the hosts whether they could load the plug-ins of a plan.
//!
//! Each host is started with `--check` and all of its files, several at once,
//! in the folder and with the variables that its processes will have. This
//! finds missing symbols, wrong ABI versions, syntax errors, fixtures used as
//! tests, before anything has moved.

mod ask;
mod judge;

use std::collections::{BTreeSet, HashMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rtf_model::Diagnostic;

use super::HostPlan;
use super::context::{Place, Role};
use super::scope::Scope;
use crate::suite::Sources;
use ask::{Answer, Request};

/// The use of a plug-in that is to be checked.
pub(super) struct Wanted<'a> {
    pub host: &'a Arc<HostPlan>,
    pub scope: &'a Scope<'a>,
    pub file: &'a Path,
    pub role: Role,
    pub place: &'a Place,
    /// Whether it may turn out not to be what `role` says.
    pub optional: bool,
}

/// All files that are to be checked, each once for each way of loading it.
#[derive(Default)]
pub(super) struct Checks {
    groups: Vec<Group>,
}

/// Files that are loaded by the same host in the same way.
struct Group {
    host: Arc<HostPlan>,
    folder: PathBuf,
    env: Vec<(String, String)>,
    files: Vec<FileUse>,
    index: HashMap<PathBuf, usize>,
}

/// A file and its uses.
struct FileUse {
    file: PathBuf,
    tests: Places,
    fixtures: Places,
    hooks: Places,
    optional: bool,
}

/// The first places of a use, and how many there are.
#[derive(Default)]
struct Places {
    shown: Vec<Place>,
    count: usize,
}

/// Places of one problem that are shown; the others are counted.
const SHOWN_PLACES: usize = 3;

/// Files for one start of a host: enough to make the start cheap, few enough
/// for the longest command line.
const MOST_FILES: usize = 256;

/// What came out.
#[derive(Default)]
pub(super) struct Verified {
    /// What is wrong.
    pub problems: Vec<Diagnostic>,
    /// The plug-ins' own texts that problems point at.
    pub sources: Sources,
    /// Files from folders that hold no test.
    pub left_out: BTreeSet<PathBuf>,
}

impl Checks {
    /// Notes a use.
    pub fn want(&mut self, wanted: Wanted<'_>) {
        let group = self.group(wanted.host, wanted.scope);
        let index = match group.index.get(wanted.file) {
            Some(index) => *index,
            None => {
                let index = group.files.len();
                group.index.insert(wanted.file.to_path_buf(), index);
                group.files.push(FileUse {
                    file: wanted.file.to_path_buf(),
                    tests: Places::default(),
                    fixtures: Places::default(),
                    hooks: Places::default(),
                    optional: wanted.optional,
                });
                index
            }
        };
        let entry = &mut group.files[index];
        entry.optional &= wanted.optional;
        let places = match wanted.role {
            Role::Test => &mut entry.tests,
            Role::Fixture => &mut entry.fixtures,
            Role::Hook => &mut entry.hooks,
        };
        places.count += 1;
        if places.shown.len() < SHOWN_PLACES {
            places.shown.push(wanted.place.clone());
        }
    }

    fn group(&mut self, host: &Arc<HostPlan>, scope: &Scope<'_>) -> &mut Group {
        let same = |group: &Group| {
            Arc::ptr_eq(&group.host, host)
                && group.folder == scope.folder
                && group.env.iter().eq(scope.suite.iter().chain(scope.own))
        };
        // Most uses follow one of the same group.
        let index = match self.groups.iter().rposition(same) {
            Some(index) => index,
            None => {
                self.groups.push(Group {
                    host: Arc::clone(host),
                    folder: scope.folder.to_path_buf(),
                    env: scope.suite.iter().chain(scope.own).cloned().collect(),
                    files: Vec::new(),
                    index: HashMap::new(),
                });
                self.groups.len() - 1
            }
        };
        &mut self.groups[index]
    }

    /// Asks all hosts, as many at once as there are processors. A host that
    /// says nothing for `limit` is killed, and the plug-in that it was at is
    /// blamed.
    pub fn run(self, limit: Duration) -> Verified {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let jobs = Mutex::new(self.jobs(workers));
        let answers = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for _ in 0..workers {
                scope.spawn(|| work(&jobs, &answers, limit));
            }
        });
        let mut answers = answers.into_inner().unwrap_or_else(PoisonError::into_inner);
        // In the order of the plan, however fast each host was.
        answers.sort_by_key(|(group, first, _)| (*group, *first));
        let mut verified = Verified::default();
        for (group, first, answers) in answers {
            let group = &self.groups[group];
            judge::judge(group, first, answers, &mut verified);
        }
        verified
    }

    fn jobs(&self, workers: usize) -> VecDeque<Job<'_>> {
        let mut jobs = VecDeque::new();
        for (index, group) in self.groups.iter().enumerate() {
            let size = group.files.len().div_ceil(workers).clamp(1, MOST_FILES);
            for (number, files) in group.files.chunks(size).enumerate() {
                let request = Request {
                    host: &group.host,
                    folder: &group.folder,
                    env: &group.env,
                    files: files.iter().map(|entry| entry.file.as_path()).collect(),
                };
                jobs.push_back(Job { group: index, first: number * size, request });
            }
        }
        jobs
    }
}

struct Job<'a> {
    group: usize,
    first: usize,
    request: Request<'a>,
}

type Answers = Vec<(usize, usize, Vec<Answer>)>;

fn work(jobs: &Mutex<VecDeque<Job<'_>>>, answers: &Mutex<Answers>, limit: Duration) {
    loop {
        let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
        let Some(job) = job else { return };
        let said = ask::ask(&job.request, limit);
        let mut answers = answers.lock().unwrap_or_else(PoisonError::into_inner);
        answers.push((job.group, job.first, said));
    }
}
