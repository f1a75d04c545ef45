//! Writes the journal.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use rtf_model::{Event, EventKind, Phase, Record};

use crate::{ReportError, Reporter};

const WHAT: &str = "the journal";

/// How much may wait in memory: a flood of messages is written in large pieces.
const BUFFER: usize = 64 * 1024;

/// Writes each event as a line of JSON.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: BufWriter<File>,
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
        Ok(Self { path: path.to_owned(), file: BufWriter::with_capacity(BUFFER, file) })
    }

    fn write(&mut self, event: &Event) -> std::io::Result<()> {
        serde_json::to_writer(&mut self.file, event)?;
        self.file.write_all(b"\n")?;
        if is_landmark(&event.kind) { self.file.flush() } else { Ok(()) }
    }
}

/// What a journal must not miss when the runner is killed right after it,
/// even while so much is going on that the queue is never empty.
fn is_landmark(kind: &EventKind) -> bool {
    // A recorder reads what the test told until then.
    if let EventKind::TestPhase { phase: Phase::Notice, .. } = kind {
        return true;
    }
    !matches!(
        kind,
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
            | EventKind::TestRepeated { .. }
    )
}

impl Reporter for Journal {
    fn event(&mut self, event: &Event, _record: &Record) -> Result<(), ReportError> {
        self.write(event).map_err(ReportError::at(WHAT, &self.path))
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.file.flush().map_err(ReportError::at(WHAT, &self.path))
    }

    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        let written = self.file.flush().and_then(|()| self.file.get_ref().sync_all());
        written.map_err(ReportError::at(WHAT, &self.path))
    }
}
