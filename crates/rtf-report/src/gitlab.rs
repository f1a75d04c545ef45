//! Sections of GitLab's job log: the output of a suite can be folded. They
//! are folded initially, because the summary at the end names all problems. Suites
//! that run in parallel have none, because sections
//! cannot overlap.

use std::io::Write;
use std::path::Path;

use jiff::Timestamp;
use rtf_model::{Event, EventKind, Micros, Record, SuiteId};

use crate::disconnect::UntilDisconnect;
use crate::{ReportError, Reporter, escape};

/// Puts the output of another reporter into sections, one for
/// each suite.
pub struct Sections {
    inner: Box<dyn Reporter>,
    out: UntilDisconnect,
    /// The suite whose section is open.
    open: Option<SuiteId>,
}

impl Sections {
    /// Sections around what `inner` writes; both write to `out`'s place.
    #[must_use]
    pub fn around(inner: Box<dyn Reporter>, out: Box<dyn Write + Send>) -> Self {
        Self { inner, out: UntilDisconnect::new(out), open: None }
    }

    fn begin(&mut self, suite: SuiteId, at: Micros, record: &Record) -> Result<(), ReportError> {
        // Earlier output precedes the section.
        self.inner.idle(record)?;
        self.open = Some(suite);
        let name = record.suites.get(suite.index()).map_or("", |suite| suite.plan.name.as_str());
        let (time, name) = (unix_time(record, at), escape::line(name));
        self.write(&format!(
            "\x1b[0Ksection_start:{time}:rtf_suite_{suite}[collapsed=true]\r\x1b[0Ksuite {name}\n"
        ))
    }

    fn end(&mut self, suite: SuiteId, at: Micros, record: &Record) -> Result<(), ReportError> {
        self.inner.idle(record)?;
        self.open = None;
        let time = unix_time(record, at);
        self.write(&format!("\x1b[0Ksection_end:{time}:rtf_suite_{suite}\r\x1b[0K\n"))
    }

    fn write(&mut self, text: &str) -> Result<(), ReportError> {
        let written = self.out.write_all(text.as_bytes());
        written.map_err(ReportError::at("sections", Path::new("standard output")))
    }
}

impl Reporter for Sections {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        match event.kind {
            EventKind::SuiteStarted { suite } if !record.runs_suites_in_parallel() => {
                self.begin(suite, event.at, record)?;
            }
            _ => {}
        }
        self.inner.event(event, record)?;
        match event.kind {
            EventKind::SuiteFinished { suite } if self.open == Some(suite) => {
                self.end(suite, event.at, record)
            }
            _ => Ok(()),
        }
    }

    fn idle(&mut self, record: &Record) -> Result<(), ReportError> {
        self.inner.idle(record)
    }

    fn reporter_failed(&mut self, error: &ReportError) {
        self.inner.reporter_failed(error);
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        if let Some(suite) = self.open {
            self.end(suite, record.last_at, record)?;
        }
        self.inner.finish(record)
    }
}

/// Seconds since 1970 at a moment of the run.
fn unix_time(record: &Record, at: Micros) -> i64 {
    let started = record.run.as_ref().and_then(|run| run.started_at.parse::<Timestamp>().ok());
    let seconds = i64::try_from(at.as_duration().as_secs()).unwrap_or(i64::MAX);
    started.map_or(0, |started| started.as_second().saturating_add(seconds))
}
