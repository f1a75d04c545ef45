//! `rtf merge`: merges several runs into one, for example the shards of `--shard`.
//!
//! The runs stay as they are. The new run has a separate journal, from which its logs
//! and its console output are created, and copies of the attachments.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use rtf_model::{Event, EventKind, Record, RunState};
use rtf_report::console::{Console, ConsoleOptions};
use rtf_report::journal::{self, Journal};
use rtf_report::logs::Logs;
use rtf_report::merge::{self, Header, MergeInput, MergeProblem};
use rtf_report::run_dir::{self, RunDir};
use rtf_report::{ReportError, Reporter};

use super::VerbResult;
use crate::cli::MergeArgs;
use crate::error::Failure;
use crate::outputs::console_options;
use crate::request::{config, past_run};
use crate::{exit, history, terminal};

/// A file that a test attached.
struct AttachedFile {
    dir: PathBuf,
    /// The path in the run directory.
    source: String,
    /// The path in the directory of the merged run.
    target: String,
}

/// Merges runs and prints the merged run.
pub fn run(mut args: MergeArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let results = &args.results.results;
    let mut parts = Vec::new();
    let mut attached = Vec::new();
    for (run, journal) in find_journals(results, &args.runs)? {
        let number = parts.len();
        let events = read_events(run, &journal)?;
        let dir = journal.parent().unwrap_or(Path::new("."));
        attached.extend(attached_files(number, dir, &events));
        parts.push(MergeInput { name: run.to_owned(), events });
    }
    let merged = merge::merge(parts, args.partial).map_err(|problems| refuse(&problems))?;
    let dir = run_dir::create(results).map_err(|error| {
        Failure::input(error).hint("choose another directory with `--results DIR`")
    })?;
    attached.iter().try_for_each(|file| file.copy(&dir))?;
    let header = Header {
        run: dir.name.clone(),
        rtf: env!("CARGO_PKG_VERSION").to_owned(),
        command: std::env::args_os()
            .map(|arg| history::without_password(&arg.to_string_lossy()))
            .collect(),
    };
    let record = write(&merged.events(header), &dir).map_err(Failure::internal)?;
    Ok(exit::of_run(&record))
}

/// The journals of the runs. `results/*` also names the history, which is left out, and the
/// newest run by its link.
fn find_journals<'a>(
    results: &Path,
    runs: &'a [String],
) -> Result<Vec<(&'a str, PathBuf)>, Failure> {
    let runs = runs.iter().filter(|run| !history::is_database(Path::new(run)));
    let find = |run: &'a String| Ok((run.as_str(), past_run::find_journal(results, run)?));
    let found = runs.map(find).collect::<Result<Vec<_>, Failure>>()?;
    if found.is_empty() {
        return Err(Failure::input("there are no runs to merge"));
    }
    let is_link = |run: &str| Path::new(run).is_symlink();
    let is_named = |(run, journal): &(&str, PathBuf)| {
        is_link(run) && found.iter().any(|other| !is_link(other.0) && other.1 == *journal)
    };
    Ok(found.iter().filter(|it| !is_named(it)).cloned().collect())
}

/// Reads a run that has ended.
fn read_events(run: &str, journal: &Path) -> Result<Vec<Event>, Failure> {
    let mut events = Vec::new();
    let stored = journal::read_with(journal, |event, _| {
        events.push(event.clone());
        Ok(())
    });
    let stored = stored.map_err(past_run::unreadable)?;
    past_run::refuse_damaged(run, &stored.record)?;
    let is_active = stored.record.state == RunState::Running
        && File::open(journal).is_ok_and(|journal| journal::is_written(&journal));
    if is_active {
        let error = format!("`{run}` is still running");
        return Err(Failure::input(error).hint("wait until it has finished"));
    }
    Ok(events)
}

fn attached_files(part: usize, dir: &Path, events: &[Event]) -> Vec<AttachedFile> {
    let paths = events.iter().filter_map(|event| match &event.kind {
        EventKind::Attached { attachment, .. } => Some(&attachment.path),
        _ => None,
    });
    let files = paths.filter_map(|source| {
        let (dir, target) = (dir.to_owned(), merge::attachment_path(part, source)?);
        Some(AttachedFile { dir, source: source.clone(), target })
    });
    files.collect()
}

/// Prints all problems.
fn refuse(problems: &[MergeProblem]) -> Failure {
    let next_hints = problems.iter().skip(1).map(MergeProblem::hint).chain([None]);
    for (problem, next_hint) in problems.iter().zip(next_hints) {
        // A hint of several consecutive problems is printed once.
        let hint = problem.hint().filter(|hint| next_hint != Some(hint));
        Failure::input(problem.clone()).maybe_hint(hint).print();
    }
    Failure::printed()
}

impl AttachedFile {
    fn copy(&self, dir: &RunDir) -> Result<(), Failure> {
        let Some(source) = self.resolve() else {
            let path = self.dir.join(&self.source);
            return terminal::stderr(|err| {
                writeln!(err, "warning: missing attachment: {}", path.display())
            });
        };
        let target = dir.path.join(&self.target);
        let created = target.parent().map_or(Ok(()), fs::create_dir_all);
        let copied = created.and_then(|()| fs::copy(source, &target));
        copied.map(drop).map_err(|source| {
            Failure::internal(ReportError { what: "the attachment", path: target, source })
        })
    }

    /// Refuses links to files outside of the attachments: the run may come from
    /// another machine.
    fn resolve(&self) -> Option<PathBuf> {
        let attachments = self.dir.join("attachments").canonicalize().ok()?;
        let file = self.dir.join(&self.source).canonicalize().ok()?;
        (file.starts_with(attachments) && file.is_file()).then_some(file)
    }
}

fn write(events: &[Event], dir: &RunDir) -> Result<Record, ReportError> {
    let mut journal = Journal::create(&dir.journal())?;
    let mut logs = Logs::new(&dir.path);
    let options = ConsoleOptions { progress: false, ..console_options(&dir.path, false) };
    let mut console = Console::stdout(options);
    let mut record = Record::default();
    let mut reporters: [&mut dyn Reporter; 3] = [&mut journal, &mut logs, &mut console];
    for event in events {
        record.apply(event);
        reporters.iter_mut().try_for_each(|reporter| reporter.event(event, &record))?;
    }
    reporters.iter_mut().try_for_each(|reporter| reporter.finish(&record))?;
    Ok(record)
}
