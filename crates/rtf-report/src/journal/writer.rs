//! Writes the journal.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rtf_model::{Event, EventKind, Phase, Record};

use super::page::WriteBuffer;
use super::presence::Presence;
use crate::{ReportError, Reporter};

const WHAT: &str = "the journal";

/// How much may wait in memory: a flood of messages is written in large pieces.
const BUFFER: usize = 64 * 1024;

/// While the queue of events is never empty, a landmark waits no longer than this.
const PATIENCE: Duration = Duration::from_millis(1);

/// Writes each event as a line of JSON with a check value.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Whole lines that are not in the file yet.
    page: WriteBuffer,
    presence: Presence,
    /// How many bytes the file has.
    written: u64,
    flushed: Instant,
    /// Whether a landmark waits.
    owes: bool,
}

impl Journal {
    /// Creates the journal's file, which must not exist.
    ///
    /// # Errors
    /// The file exists or cannot be written.
    pub fn create(path: &Path) -> Result<Self, ReportError> {
        // Append mode never overwrites existing data.
        let file = OpenOptions::new().append(true).create_new(true).open(path);
        let file = file.map_err(ReportError::at(WHAT, path))?;
        // Held until the runner ends, however it ends: see [`super::is_written`].
        // Readers hold it only for a moment. Some file systems have no
        // locks; the run does not depend on them.
        drop(file.lock());
        let presence = Presence::of(&file, path).map_err(ReportError::at(WHAT, path))?;
        Ok(Self {
            path: path.to_owned(),
            file,
            page: WriteBuffer::new(),
            presence,
            written: 0,
            flushed: Instant::now(),
            owes: false,
        })
    }

    fn write(&mut self, event: &Event) -> std::io::Result<()> {
        self.page.add(event)?;
        let landmark = landmark(&event.kind);
        self.owes |= matches!(landmark, Landmark::Soon);
        let is_due = matches!(landmark, Landmark::Now)
            || self.page.lines().len() >= BUFFER
            || (self.owes && self.flushed.elapsed() >= PATIENCE);
        if is_due { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        (self.flushed, self.owes) = (Instant::now(), false);
        if self.page.lines().is_empty() {
            return Ok(());
        }
        self.presence.check_file(&self.file, self.written)?;
        self.file.write_all(self.page.lines())?;
        self.written += self.page.lines().len() as u64;
        self.page.clear();
        Ok(())
    }

    fn close(&mut self) -> std::io::Result<()> {
        self.flush()?;
        self.file.sync_all()?;
        self.presence.check_file(&self.file, self.written)?;
        self.presence.check_path(&self.file)
    }
}

/// How soon after an event it must be in the file.
enum Landmark {
    /// With the others, when the queue is empty.
    None,
    /// The same, and also within a bounded time while the queue is never empty.
    Soon,
    /// At once.
    Now,
}

fn landmark(kind: &EventKind) -> Landmark {
    match kind {
        // A recorder reads the events of the test at this point.
        EventKind::TestPhase { phase: Phase::Notify, .. } => Landmark::Now,
        EventKind::SuitePlanned(_)
        | EventKind::FixturePlanned(_)
        | EventKind::HookPlanned(_)
        | EventKind::TestPlanned(_)
        | EventKind::TestPhase { .. }
        | EventKind::CasesPlanned { .. }
        | EventKind::CaseStarted(_)
        | EventKind::CaseFinished(_)
        | EventKind::Message { .. }
        | EventKind::Measured { .. }
        | EventKind::Sampled { .. }
        | EventKind::Attached { .. }
        | EventKind::Output(_)
        | EventKind::ResourcesMeasured { .. }
        | EventKind::TestSkipped { .. }
        | EventKind::TestRepeated { .. } => Landmark::None,
        _ => Landmark::Soon,
    }
}

impl Reporter for Journal {
    fn event(&mut self, event: &Event, _record: &Record) -> Result<(), ReportError> {
        self.write(event).map_err(ReportError::at(WHAT, &self.path))
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.flush().map_err(ReportError::at(WHAT, &self.path))
    }

    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.close().map_err(ReportError::at(WHAT, &self.path))
    }
}
