//! Writes the output of each process to a separate file in the run's directory.
//!
//! The files are created on demand. They contain the output of the
//! events, with the same limits as in the journal.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use rtf_model::{
    Event, EventKind, FixtureId, HookId, Output, Record, Source, SuiteId, SuitePrepared, TestId,
};

use crate::{ReportError, Reporter, explain, private_resources};

const WHAT: &str = "a log";

/// Names longer than this are cut.
const NAME_LENGTH: usize = 80;

/// The log of the newest attempt of a test, relative to the run's directory:
/// `logs/arm.EncoderTest.r2.log`.
#[must_use]
pub fn test_log(record: &Record, id: TestId) -> PathBuf {
    let attempt = record.tests.get(id.index()).and_then(|test| test.attempts.last());
    let (repetition, attempt) = attempt.map_or((1, 1), |a| (a.repetition, a.attempt));
    attempt_log(record, id, (repetition, attempt))
}

/// The log of one attempt (its repetition and its number) of a test, relative
/// to the run's directory.
#[must_use]
pub fn attempt_log(record: &Record, id: TestId, number: (u32, u32)) -> PathBuf {
    let Some(test) = record.tests.get(id.index()) else {
        return PathBuf::from(format!("logs/test~{id}.log"));
    };
    let (repetition, attempt) = number;
    let suite = record.suites.get(test.plan.suite.index()).map_or("", |s| &s.plan.name);
    // A test that is named like another log must not share it.
    let ambiguous = ["fixture-", "hook-"].iter().any(|word| test.plan.name.starts_with(word))
        || test.plan.name == "suite";
    let mut name = base(suite, &test.plan.name, ambiguous, &format!("t{id}"));
    if test.plan.is_repeated() {
        name += &format!(".r{repetition}");
    }
    path(name, attempt)
}

/// The log of one start of a fixture, counted from 1, relative to the run's directory:
/// `logs/arm.fixture-simulator.a2.log`.
#[must_use]
pub fn fixture_start_log(record: &Record, id: FixtureId, start: u32) -> PathBuf {
    let Some(fixture) = record.fixture(id) else {
        return PathBuf::from(format!("logs/fixture~{id}.log"));
    };
    let suite = record.suites.get(fixture.plan.suite.index()).map_or("", |s| &s.plan.name);
    let name = format!("fixture-{}", fixture.plan.name);
    path(base(suite, &name, false, &format!("f{id}")), start)
}

/// The log of one run of a hook, counted from 1, relative to the run's directory:
/// `logs/arm.hook-park.a2.log`.
#[must_use]
pub fn hook_run_log(record: &Record, id: HookId, run: usize) -> PathBuf {
    let Some(hook) = record.hooks.get(id.index()) else {
        return PathBuf::from(format!("logs/hook~{id}.log"));
    };
    let suite = record.suites.get(hook.plan.suite.index()).map_or("", |s| &s.plan.name);
    let name = format!("hook-{}", hook.plan.name);
    let run = u32::try_from(run).unwrap_or(u32::MAX);
    path(base(suite, &name, false, &format!("h{id}")), run)
}

/// The log of the newest attempt, start or run of a source.
#[must_use]
pub fn log(record: &Record, source: Source) -> PathBuf {
    match source {
        Source::Test(id) => test_log(record, id),
        Source::Fixture(id) => {
            fixture_start_log(record, id, record.fixture(id).map_or(1, |fixture| fixture.starts))
        }
        Source::Hook(id) => {
            let runs = record.hooks.get(id.index()).map_or(1, |hook| hook.runs.len());
            hook_run_log(record, id, runs)
        }
    }
}

/// The private resources of a suite, relative to the run's directory:
/// `logs/arm.suite.log`.
#[must_use]
pub fn suite_log(record: &Record, id: SuiteId) -> PathBuf {
    let suite = record.suites.get(id.index()).map_or("", |s| &s.plan.name);
    path(base(suite, "suite", false, &format!("s{id}")), 1)
}

fn path(mut name: String, attempt: u32) -> PathBuf {
    if attempt > 1 {
        name += &format!(".a{attempt}");
    }
    PathBuf::from(format!("logs/{name}.log"))
}

/// `suite.name` where both are plain; otherwise made safe for every file
/// system, and made unique by the id after a `~`.
fn base(suite: &str, name: &str, ambiguous: bool, id: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let safe = |text: &str| -> String {
        text.chars().take(NAME_LENGTH).map(|c| if plain(c) { c } else { '_' }).collect()
    };
    let (safe_suite, safe_name) = (safe(suite), safe(name));
    if ambiguous || safe_suite != suite || safe_name != name {
        format!("{safe_suite}.{safe_name}~{id}")
    } else {
        format!("{safe_suite}.{safe_name}")
    }
}

/// Writes the logs in the run's directory.
#[derive(Debug)]
pub struct Logs {
    folder: PathBuf,
    open: HashMap<Source, LogFile>,
}

#[derive(Debug)]
struct LogFile {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Logs {
    /// Logs in `logs/` of this run's directory.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), open: HashMap::new() }
    }

    fn print(&mut self, output: &Output, record: &Record) -> Result<(), ReportError> {
        use std::collections::hash_map::Entry;
        let log = match self.open.entry(output.source) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                let path = self.folder.join(log(record, output.source));
                let file = create(&path).map_err(ReportError::at(WHAT, &path))?;
                entry.insert(LogFile { path, file: BufWriter::new(file) })
            }
        };
        log.print(output).map_err(ReportError::at(WHAT, &log.path))
    }

    /// The private resources of a suite.
    fn prepared(&self, prepared: &SuitePrepared, record: &Record) -> Result<(), ReportError> {
        let path = self.folder.join(suite_log(record, prepared.suite));
        let lines = explain::lines(|sink| private_resources::show(prepared, sink));
        let text = lines.join("\n") + "\n";
        let written = create(&path).and_then(|mut file| file.write_all(text.as_bytes()));
        written.map_err(ReportError::at(WHAT, &path))
    }

    fn close(&mut self, source: Source) -> Result<(), ReportError> {
        match self.open.remove(&source) {
            Some(mut log) => log.file.flush().map_err(ReportError::at(WHAT, &log.path)),
            None => Ok(()),
        }
    }
}

fn create(path: &Path) -> std::io::Result<File> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    OpenOptions::new().create(true).append(true).open(path)
}

impl LogFile {
    fn print(&mut self, output: &Output) -> std::io::Result<()> {
        if output.omitted_bytes > 0 {
            write!(self.file, "\n[… {} bytes left out …]\n", output.omitted_bytes)?;
        }
        self.file.write_all(output.text.as_bytes())
    }
}

impl Reporter for Logs {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        match &event.kind {
            EventKind::SuitePrepared(prepared) => self.prepared(prepared, record),
            EventKind::Output(output) => self.print(output, record),
            EventKind::TestFinished(finished) => self.close(Source::Test(finished.test)),
            EventKind::FixtureStopped { fixture, .. } => self.close(Source::Fixture(*fixture)),
            EventKind::HookFinished { hook, .. } => self.close(Source::Hook(*hook)),
            _ => Ok(()),
        }
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        let flushed =
            |log: &mut LogFile| log.file.flush().map_err(ReportError::at(WHAT, &log.path));
        self.open.values_mut().try_for_each(flushed)
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        self.idle(record)
    }
}
