//! Merges several runs into one, for example the shards of `--shard`.
//!
//! The runs stay as they are. The new run has a separate journal, from which its logs
//! and its console output are created, and copies of the attachments. Everything is written as
//! the journals are read, so that memory does not depend on their size.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

use crate::error::Failure;
use crate::outputs::console_options;
use crate::request::past_run;
use crate::{history, terminal};
use rtf_model::Record;
use rtf_report::console::{Console, ConsoleOptions, drop_details};
use rtf_report::journal::{Journal, JournalError};
use rtf_report::logs::Logs;
use rtf_report::merge::{
    self, AttachedFile, Header, MergeInput, MergeOptions, MergeProblem, Mergeable,
};
use rtf_report::run_dir::{self, RunDir};
use rtf_report::{ReportError, Reporter};

/// Merges runs into a new run in `results`, and prints it.
pub fn merge(
    results: &Path,
    runs: &[String],
    options: MergeOptions,
) -> Result<(RunDir, Record), Failure> {
    let runs = find_journals(results, runs)?;
    let merged = merge::merge(runs, options).map_err(refuse)?;
    let dir = run_dir::create(results).map_err(|error| {
        Failure::input(error).hint("choose another directory with `--results DIR`")
    })?;
    let header = Header {
        run: dir.name.clone(),
        rtf: env!("CARGO_PKG_VERSION").to_owned(),
        command: std::env::args_os()
            .map(|arg| history::without_password(&arg.to_string_lossy()))
            .collect(),
    };
    let record = write(merged, header, &dir).map_err(Failure::internal)?;
    Ok((dir, record))
}

/// The journals of the runs. `results/*` also names the history, which is left out, and the
/// newest run by its link.
fn find_journals(results: &Path, runs: &[String]) -> Result<Vec<MergeInput>, Failure> {
    let runs = runs.iter().filter(|run| !history::is_database(Path::new(run)));
    let find = |run: &String| {
        Ok(MergeInput { name: run.clone(), journal: past_run::find_journal(results, run)? })
    };
    let found = runs.map(find).collect::<Result<Vec<_>, Failure>>()?;
    if found.is_empty() {
        return Err(Failure::input("there are no runs to merge"));
    }
    let is_link = |run: &MergeInput| Path::new(&run.name).is_symlink();
    let named: HashSet<_> =
        found.iter().filter(|run| !is_link(run)).map(|run| run.journal.clone()).collect();
    let is_new = |run: &MergeInput| !(is_link(run) && named.contains(&run.journal));
    Ok(found.into_iter().filter(is_new).collect())
}

/// Prints all problems.
fn refuse(problems: Vec<MergeProblem>) -> Failure {
    let hints: Vec<_> = problems.iter().map(hint).collect();
    let next_hints = hints.iter().skip(1).map(Option::as_ref).chain([None]);
    for ((problem, hint), next_hint) in problems.into_iter().zip(&hints).zip(next_hints) {
        // A hint of several consecutive problems is printed once.
        let hint = hint.as_ref().filter(|hint| next_hint != Some(hint));
        Failure::input(problem).maybe_hint(hint).print();
    }
    Failure::printed()
}

fn hint(problem: &MergeProblem) -> Option<String> {
    match problem {
        MergeProblem::Damaged { run, .. } => Some(past_run::damage_hint(run)),
        MergeProblem::Running { .. } => Some("wait until it has finished".to_owned()),
        MergeProblem::Twice { .. } => {
            Some("merge runs of different tests, as those of `--shard` are".to_owned())
        }
        MergeProblem::Missing { .. } => Some("`--partial` merges without them".to_owned()),
        _ => None,
    }
}

/// Copies an attachment to the directory of the merged run.
fn copy(file: &AttachedFile, dir: &RunDir) -> Result<(), ReportError> {
    let Some(source) = file.resolve() else {
        let path = file.dir.join(&file.source);
        terminal::notice(format_args!("warning: missing attachment: {}", path.display()));
        return Ok(());
    };
    let target = dir.path.join(&file.target);
    let created = target.parent().map_or(Ok(()), fs::create_dir_all);
    let copied = created.and_then(|()| fs::copy(source, &target));
    copied.map(drop).map_err(|source| ReportError { what: "the attachment", path: target, source })
}

fn write(merged: Mergeable, header: Header, dir: &RunDir) -> Result<Record, JournalError> {
    let mut journal = Journal::create(&dir.journal())?;
    let mut logs = Logs::new(&dir.path);
    let options = ConsoleOptions { progress: false, ..console_options(&dir.path, false) };
    let mut console = Console::stdout(options);
    let mut record = Record::default();
    let mut reporters: [&mut dyn Reporter; 3] = [&mut journal, &mut logs, &mut console];
    merged.write(header, &mut |event, file| {
        file.map_or(Ok(()), |file| copy(file, dir))?;
        record.apply(event);
        reporters.iter_mut().try_for_each(|reporter| reporter.event(event, &record))?;
        drop_details(&mut record, &event.kind);
        Ok(())
    })?;
    reporters.iter_mut().try_for_each(|reporter| reporter.finish(&record))?;
    Ok(record)
}
