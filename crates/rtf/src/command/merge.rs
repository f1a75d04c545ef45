//! `rtf merge`: makes one run of several, as of the parts that `--shard` made.
//!
//! The runs stay as they are. The new one has a journal of its own, from which
//! everything else is made again, and copies of what tests attached.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use rtf_model::{Event, EventKind, Record, RunState};
use rtf_report::console::{Console, ConsoleOptions};
use rtf_report::journal::{self, Journal};
use rtf_report::logs::Logs;
use rtf_report::merge::{self, Header, Part, Problem};
use rtf_report::run_dir::{self, RunDir};
use rtf_report::{ReportError, Reporter};

use super::show::{find, unreadable};
use super::{Outcome, again, show};
use crate::cli::MergeArgs;
use crate::error::Failure;
use crate::exit;

/// A file that a test attached.
struct Attached {
    /// The run's folder.
    folder: PathBuf,
    /// Where it is there.
    from: String,
    /// Where it is in the new folder.
    to: String,
}

/// Merges, and shows what came of it.
pub fn run(args: &MergeArgs) -> Outcome {
    let mut parts = Vec::new();
    let mut attached = Vec::new();
    for (number, run) in args.runs.iter().enumerate() {
        let path = find(&args.results, run)?;
        let events = read(run, &path)?;
        let folder = path.parent().unwrap_or(Path::new("."));
        attached.extend(attachments(number, folder, &events));
        parts.push(Part { name: run.clone(), events });
    }
    let merged = merge::merge(parts, args.partial).map_err(|problems| refused(&problems))?;
    let folder = run_dir::create(&args.results.results).map_err(|error| {
        Failure::input(error).hint("choose another folder with `--results DIR`".to_owned())
    })?;
    for file in &attached {
        file.copy(&folder)?;
    }
    let header = Header {
        run: folder.name.clone(),
        rtf: env!("CARGO_PKG_VERSION").to_owned(),
        command: std::env::args_os().map(|arg| arg.to_string_lossy().into_owned()).collect(),
    };
    let record = write(&merged.events(header), &folder).map_err(Failure::own)?;
    Ok(exit::of_run(&record))
}

/// All events of a run that is over.
fn read(run: &str, path: &Path) -> Result<Vec<Event>, Failure> {
    let mut events = Vec::new();
    let stored = journal::read_with(path, |event, _| {
        events.push(event.clone());
        Ok(())
    });
    let stored = stored.map_err(unreadable)?;
    show::refuse_damaged(run, &stored.record)?;
    let goes_on = stored.record.state == RunState::Running
        && File::open(path).is_ok_and(|journal| journal::is_written(&journal));
    if goes_on {
        return Err(Failure::input(format!("`{run}` goes on")).hint("wait for its end".to_owned()));
    }
    Ok(events)
}

fn attachments(part: usize, folder: &Path, events: &[Event]) -> Vec<Attached> {
    let paths = events.iter().filter_map(|event| match &event.kind {
        EventKind::Attached { attachment, .. } => Some(&attachment.path),
        _ => None,
    });
    let attached = paths.filter_map(|from| {
        let (folder, to) = (folder.to_owned(), merge::attachment_path(part, from)?);
        Some(Attached { folder, from: from.clone(), to })
    });
    attached.collect()
}

/// Tells every problem.
fn refused(problems: &[Problem]) -> Failure {
    let next = problems.iter().skip(1).map(Problem::hint).chain([None]);
    for (problem, next) in problems.iter().zip(next) {
        // The same hint for many is said once.
        let hint = problem.hint().filter(|hint| next != Some(hint));
        Failure::input(problem.clone()).hint(hint.map(str::to_owned)).show();
    }
    Failure::told(exit::BAD_INPUT)
}

impl Attached {
    fn copy(&self, into: &RunDir) -> Result<(), Failure> {
        let Some(from) = self.file() else {
            let what = self.folder.join(&self.from);
            let mut err = anstream::stderr().lock();
            let told =
                writeln!(err, "warning: what a test attached is not there: {}", what.display());
            return Failure::unless_reader_left(told);
        };
        let to = into.path.join(&self.to);
        let folder = to.parent().map_or(Ok(()), fs::create_dir_all);
        let copied = folder.and_then(|()| fs::copy(from, &to));
        copied.map(drop).map_err(|source| {
            Failure::own(ReportError { what: "what a test attached", path: to, source })
        })
    }

    /// The file itself: a run may come from elsewhere, and no link in it leads
    /// to other files of this machine.
    fn file(&self) -> Option<PathBuf> {
        let root = self.folder.join("attachments").canonicalize().ok()?;
        let file = self.folder.join(&self.from).canonicalize().ok()?;
        (file.starts_with(root) && file.is_file()).then_some(file)
    }
}

/// Writes the journal, makes the logs of it, and shows it.
fn write(events: &[Event], folder: &RunDir) -> Result<Record, ReportError> {
    let mut journal = Journal::create(&folder.journal())?;
    let mut logs = Logs::new(&folder.path);
    let mut console = Console::stdout(ConsoleOptions {
        folder: Some(folder.path.clone()),
        progress: false,
        rerun: again::command(),
        ..ConsoleOptions::default()
    });
    let mut record = Record::default();
    let mut reporters: [&mut dyn Reporter; 3] = [&mut journal, &mut logs, &mut console];
    for event in events {
        record.apply(event);
        reporters.iter_mut().try_for_each(|reporter| reporter.event(event, &record))?;
    }
    reporters.iter_mut().try_for_each(|reporter| reporter.finish(&record))?;
    Ok(record)
}
