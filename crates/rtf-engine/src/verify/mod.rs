//! Checks before a run that the hosts can load the plug-ins of a plan.
//! [`rtf_plan::plan::PlanDraft`] lists the files and judges the results; this module runs the
//! hosts.

mod host_check;
mod unix;

use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use rtf_plan::plan::{CheckAnswer, CheckGroup, PlanDraft, PlanOutcome};

/// The default limit for the check of one plug-in.
pub const DEFAULT_LIMIT: Duration = Duration::from_secs(30);

/// The number of files for one start of a host. Limited by the longest command line.
const MAX_FILES: usize = 256;

/// Checks all plug-ins of a draft with as many parallel hosts as processors, and completes the
/// plan. Blocks until all hosts have reported.
///
/// A host that reports nothing for `limit` is killed, and the plug-in that it was loading is
/// reported.
pub fn verify(draft: PlanDraft, limit: Duration) -> PlanOutcome {
    let answers = check(draft.check_groups(), limit);
    draft.finish(answers)
}

fn check(groups: &[CheckGroup], limit: Duration) -> Vec<Vec<CheckAnswer>> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let queue = Mutex::new(batches(groups, workers));
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| work(&queue, &done, limit));
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    // In the order of the plan.
    done.sort_by_key(|(number, ..)| *number);
    let mut answers = vec![Vec::new(); groups.len()];
    for (_, group, of_batch) in done {
        let group: &mut Vec<CheckAnswer> = &mut answers[group];
        group.extend(of_batch);
    }
    answers
}

/// Files of one group for one start of a host.
struct CheckBatch<'a> {
    number: usize,
    /// The index of the group.
    index: usize,
    group: &'a CheckGroup,
    files: Vec<&'a Path>,
}

fn batches(groups: &[CheckGroup], workers: usize) -> VecDeque<CheckBatch<'_>> {
    let mut batches = VecDeque::new();
    for (index, group) in groups.iter().enumerate() {
        let files: Vec<&Path> = group.files().collect();
        let size = files.len().div_ceil(workers).clamp(1, MAX_FILES);
        for files in files.chunks(size) {
            batches.push_back(CheckBatch {
                number: batches.len(),
                index,
                group,
                files: files.to_vec(),
            });
        }
    }
    batches
}

/// The number of a batch, the index of its group, and the answers.
type Done = Vec<(usize, usize, Vec<CheckAnswer>)>;

fn work(queue: &Mutex<VecDeque<CheckBatch<'_>>>, done: &Mutex<Done>, limit: Duration) {
    loop {
        let batch = queue.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
        let Some(batch) = batch else { return };
        let answers = host_check::check(batch.group, &batch.files, limit);
        let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
        done.push((batch.number, batch.index, answers));
    }
}
