//! Merges the runs of the tasks, and decides the exit code.

use std::fs::File;
use std::path::PathBuf;

use rtf_model::RunState;
use rtf_report::journal;
use rtf_report::merge::MergeOptions;
use rtf_report::run_dir::{self, JOURNAL, RunDir};
use rtf_run::error::Failure;
use rtf_run::{VerbResult, exit, merge, outputs, terminal};

use crate::CollectRequest;
use crate::submission::Submission;

/// The last attempt of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TaskResult {
    /// Its journal has an end.
    Finished,
    /// Its journal has no end, but can be merged.
    Incomplete,
    /// Its journal is damaged.
    Damaged,
    /// There is no journal.
    Missing,
}

/// Merges the runs of the tasks. `stopped_by` is the signal that ended the submission.
pub fn collect(
    submission: &Submission,
    request: &CollectRequest,
    stopped_by: Option<i32>,
) -> VerbResult {
    let mut runs = Vec::new();
    let mut is_lost = false;
    for task in &submission.stored.tasks {
        let run = submission.last_run(*task);
        let result = run.as_ref().map_or(TaskResult::Missing, |run| examine(run));
        if let Some(run) = run
            && matches!(result, TaskResult::Finished | TaskResult::Incomplete)
        {
            runs.push(run.to_string_lossy().into_owned());
        }
        is_lost |= result != TaskResult::Finished;
        report(submission, *task, result, stopped_by)?;
    }
    if runs.is_empty() {
        return Ok(exit::of_array(None, stopped_by, is_lost));
    }
    let options = MergeOptions { partial: true, ..MergeOptions::default() };
    let (dir, record) = merge::merge(&request.output.results, &runs, options)?;
    if !is_lost && record.tests.len() != submission.stored.tests as usize {
        let (found, all) = (record.tests.len(), submission.stored.tests);
        let error = format!("the tasks ran {found} of {all} tests: the suites have changed");
        Failure::internal(error).print();
        is_lost = true;
    }
    finish(request, &dir)?;
    Ok(exit::of_array(Some(&record), stopped_by, is_lost))
}

fn examine(run: &std::path::Path) -> TaskResult {
    let path = run.join(JOURNAL);
    if File::open(&path).is_err() {
        return TaskResult::Missing;
    }
    match journal::read(&path) {
        Ok(stored) if stored.record.is_damaged() => TaskResult::Damaged,
        Ok(stored) if stored.record.run.is_none() => TaskResult::Missing,
        Ok(stored) if stored.record.state == RunState::Running => TaskResult::Incomplete,
        Ok(_) => TaskResult::Finished,
        Err(_) => TaskResult::Damaged,
    }
}

fn report(
    submission: &Submission,
    task: u32,
    result: TaskResult,
    stopped_by: Option<i32>,
) -> Result<(), Failure> {
    let problem = match result {
        TaskResult::Finished => return Ok(()),
        TaskResult::Missing if stopped_by.is_some() => return Ok(()),
        TaskResult::Incomplete => "its run has no end",
        TaskResult::Damaged => "its journal is damaged",
        TaskResult::Missing => "it has no journal",
    };
    let output: PathBuf = submission.output(task);
    terminal::stderr(|err| {
        writeln!(err, "error: task {task} died: {problem}")?;
        writeln!(err, "hint: its output is in `{}`", output.display())
    })
}

/// Writes and sends what `rtf run` does at the end.
fn finish(request: &CollectRequest, dir: &RunDir) -> Result<(), Failure> {
    if let Some(link) = &request.symlink {
        run_dir::link(dir, link).map_err(Failure::input)?;
    }
    // The record of `merge` has no details.
    let stored = journal::read(&dir.journal()).map_err(Failure::internal)?;
    let record = &stored.record;
    outputs::complete(&request.output, &dir.journal(), record);
    request.targets.finish(record);
    Ok(())
}
