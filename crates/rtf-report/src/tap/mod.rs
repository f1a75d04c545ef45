//! The record of a run as TAP 14 (the Test Anything Protocol): a subtest for
//! each suite, and in it a test point for each test, with YAML diagnostics. The cases of
//! a test are a subtest of its point.
//!
//! What is live and what is written afterwards are the same bytes: both walk
//! over the record in the order of the plan, as far as it is known.

mod cases;
mod points;
mod syntax;
mod yaml;

use std::io::{self, Write};

use rtf_model::{Event, EventKind, Record, SuiteRecord};

use crate::stdout_stream::LineStream;
use crate::{ReportError, Reporter, escape, finding, words};

/// Writes the TAP report of a record that will not change any more.
///
/// # Errors
/// `out` cannot be written.
pub fn write(out: &mut dyn Write, record: &Record) -> io::Result<()> {
    let mut text = String::new();
    Walk::default().go_on(&mut text, record, true);
    out.write_all(text.as_bytes())
}

/// Writes TAP during the run.
pub struct TapStream {
    stream: LineStream,
    walk: Walk,
}

impl TapStream {
    #[must_use]
    pub fn new(out: Box<dyn Write + Send>) -> Self {
        Self { stream: LineStream::new("TAP", out), walk: Walk::default() }
    }

    fn go_on(&mut self, record: &Record, over: bool) {
        let mut text = String::new();
        self.walk.go_on(&mut text, record, over);
        self.stream.push(&text);
    }
}

impl Reporter for TapStream {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        // Nothing else decides about a test or a suite.
        let decides = matches!(
            event.kind,
            EventKind::SuiteStarted { .. }
                | EventKind::TestFinished(_)
                | EventKind::TestSkipped { .. }
                | EventKind::TestRepeated { .. }
                | EventKind::SuiteFinished { .. }
        );
        if decides {
            self.go_on(record, false);
        }
        self.stream.flush_if_long()
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.stream.flush()
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        self.go_on(record, true);
        self.stream.finish()
    }
}

/// How far the report is.
#[derive(Debug, Default)]
struct Walk {
    planned: bool,
    /// How many suites are written.
    suites: usize,
    /// How many tests of the next suite are written, once it is begun.
    tests: Option<usize>,
}

impl Walk {
    /// Writes what is decided, in order; `over` says that nothing more will be.
    fn go_on(&mut self, text: &mut String, record: &Record, over: bool) {
        if !self.planned {
            self.planned = true;
            *text += "TAP version 14\n";
            // `Bail out!` would end the stream, so damage is a comment.
            if let Some(damage) = words::damage(record) {
                *text += &format!("# {}\n", escape::line(&damage));
            }
            *text += &format!("1..{}\n", record.suites.len());
        }
        while let Some(suite) = record.suites.get(self.suites) {
            if !self.suite(text, record, suite, over) {
                return;
            }
            self.suites += 1;
            self.tests = None;
        }
        if let Some(problem) = finding::run_problem(record).filter(|_| over) {
            *text += &format!("Bail out! {}\n", escape::line(&problem));
        }
    }

    /// Continues a suite; returns whether it is complete.
    fn suite(
        &mut self,
        text: &mut String,
        record: &Record,
        suite: &SuiteRecord,
        over: bool,
    ) -> bool {
        if suite.started.is_none() && !over {
            return false;
        }
        if self.tests.is_none() {
            let name = escape::line(&suite.plan.name);
            *text += &format!("# Subtest: {name}\n    1..{}\n", suite.tests.len());
        }
        let written = self.tests.get_or_insert(0);
        let rest = suite.tests.iter().enumerate().skip(*written);
        for (index, test) in rest.filter_map(|(i, id)| Some((i, record.tests.get(id.index())?))) {
            if test.verdict().is_none() && !over {
                return false;
            }
            points::test(text, index + 1, record, test);
            *written = index + 1;
        }
        if suite.finished.is_none() && !over {
            return false;
        }
        points::suite(text, self.suites + 1, record, suite);
        true
    }
}
