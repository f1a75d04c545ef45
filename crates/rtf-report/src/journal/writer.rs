//! Writes the journal.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rtf_model::{Event, EventKind, Phase, Record};

use crate::{ReportError, Reporter};

const WHAT: &str = "the journal";

/// How much may wait in memory: a flood of messages is written in large pieces.
const BUFFER: usize = 64 * 1024;

/// While the queue of events is never empty, a landmark waits no longer than this.
const PATIENCE: Duration = Duration::from_millis(1);

/// Writes each event as a line of JSON.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: BufWriter<File>,
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
        let file = File::create_new(path).map_err(ReportError::at(WHAT, path))?;
        // Held until the runner ends, however it ends: see [`super::is_written`].
        // Nobody else holds it for longer than a look. Some file systems have no
        // locks; the run does not depend on them.
        drop(file.lock());
        let file = BufWriter::with_capacity(BUFFER, file);
        Ok(Self { path: path.to_owned(), file, flushed: Instant::now(), owes: false })
    }

    fn write(&mut self, event: &Event) -> std::io::Result<()> {
        serde_json::to_writer(&mut self.file, event)?;
        self.file.write_all(b"\n")?;
        let landmark = landmark(&event.kind);
        self.owes |= matches!(landmark, Landmark::Soon);
        let is_due =
            matches!(landmark, Landmark::Now) || (self.owes && self.flushed.elapsed() >= PATIENCE);
        if is_due { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        (self.flushed, self.owes) = (Instant::now(), false);
        self.file.flush()
    }
}

/// How soon after an event it must be in the file.
enum Landmark {
    /// With the others, when the queue is empty.
    None,
    /// The same, but also while so much is going on that the queue is never empty.
    Soon,
    /// At once.
    Now,
}

fn landmark(kind: &EventKind) -> Landmark {
    match kind {
        // A recorder reads what the test told until then.
        EventKind::TestPhase { phase: Phase::Notice, .. } => Landmark::Now,
        EventKind::SuitePlanned(_)
        | EventKind::FixturePlanned(_)
        | EventKind::HookPlanned(_)
        | EventKind::TestPlanned(_)
        | EventKind::TestPhase { .. }
        | EventKind::Message { .. }
        | EventKind::Measured { .. }
        | EventKind::Sampled { .. }
        | EventKind::Attached { .. }
        | EventKind::Output(_)
        | EventKind::Used { .. }
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
        let written = self.flush().and_then(|()| self.file.get_ref().sync_all());
        written.map_err(ReportError::at(WHAT, &self.path))
    }
}
