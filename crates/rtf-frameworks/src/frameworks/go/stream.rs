//! The stream of `go test -json`: one object per line.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rtf_model::{ExitStatus, MessageKind, Outcome};
use serde::Deserialize;

use super::text::{self, Crash, LogEntry};
use crate::case::{CaseResult, ListedCase, StartedCase};
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};

/// How much text of a test is kept at most, for its log and the reason of a failure.
const TEXT_BYTES: usize = 1024 * 1024;

/// The longest quote of a bad line.
const QUOTED_CHARS: usize = 200;

#[derive(Debug, Deserialize)]
#[serde(rename_all = "PascalCase")]
struct Event {
    action: String,
    test: Option<String>,
    #[serde(default)]
    output: String,
    #[serde(default)]
    key: String,
    #[serde(default)]
    value: String,
}

/// How far the test has been reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    /// It is not reported yet: most parallel tests pause at once.
    Started,
    /// It waits until the sequential tests have ended. After a crash, it runs in the next
    /// process.
    Paused,
    /// It is an open case.
    Open,
}

/// A test that has not ended.
#[derive(Debug)]
struct RunningTest {
    progress: Progress,
    /// Its number in the order of starts.
    number: usize,
    text: String,
}

/// Reads the stream of one process.
#[derive(Debug, Default)]
pub(super) struct Reader {
    dir: PathBuf,
    starts: HashMap<String, StartedCase>,
    /// The incomplete last line.
    line: Vec<u8>,
    running: HashMap<String, RunningTest>,
    started: usize,
    /// The test in which the process died, and why.
    crash: Option<(String, Crash)>,
}

impl Reader {
    pub fn new(dir: &Path, cases: &[ListedCase]) -> Self {
        let starts = cases.iter().map(|case| (case.name.clone(), case.start())).collect();
        // Stack traces have no symbolic links.
        let dir = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
        Self { dir, starts, ..Self::default() }
    }

    fn carry_out(&mut self, event: Event, cases: &mut CaseReporter<'_>) {
        let Some(test) = event.test else {
            return cases.output(event.output.as_bytes());
        };
        match event.action.as_str() {
            "run" => {
                self.started += 1;
                let (progress, number) = (Progress::Started, self.started);
                self.running.insert(test, RunningTest { progress, number, text: String::new() });
            }
            "pause" => {
                let running = self.running.get_mut(&test);
                if let Some(running) = running.filter(|it| it.progress == Progress::Started) {
                    running.progress = Progress::Paused;
                }
            }
            "cont" => self.open(&test, cases),
            "output" => self.print(&test, &event.output, cases),
            "attr" => {
                self.open(&test, cases);
                cases.property(Some(&test), &event.key, &event.value);
            }
            "pass" | "fail" | "skip" => self.end(&test, &event.action, cases),
            _ => {}
        }
    }

    /// Reports the start of a test, and before it those of the tests around it.
    fn open(&mut self, test: &str, cases: &mut CaseReporter<'_>) {
        let running = self.running.get_mut(test).filter(|it| it.progress != Progress::Open);
        let Some(running) = running else { return };
        running.progress = Progress::Open;
        let parent = self.parent(test);
        if let Some(parent) = &parent {
            self.open(parent, cases);
        }
        let name = parent.as_ref().map_or(test, |parent| &test[parent.len() + 1..]);
        let unknown = || StartedCase { name: name.to_owned(), ..StartedCase::default() };
        let start = self.starts.get(test).cloned().unwrap_or_else(unknown);
        cases.start_case(parent.as_deref(), start);
    }

    /// The test that contains this one. The name of a subtest can contain slashes.
    fn parent(&self, test: &str) -> Option<String> {
        let slashes = test.rmatch_indices('/').map(|(at, _)| &test[..at]);
        slashes.into_iter().find(|outer| self.running.contains_key(*outer)).map(str::to_owned)
    }

    fn print(&mut self, test: &str, output: &str, cases: &mut CaseReporter<'_>) {
        if let Some(running) = self.running.get_mut(test) {
            running.text.push_str(output);
            // The end says why the test failed.
            if running.text.len() > TEXT_BYTES {
                let half = running.text.ceil_char_boundary(TEXT_BYTES / 2);
                running.text.drain(..half);
            }
        }
        if !text::is_framing(output, test) {
            self.open(test, cases);
            cases.output(output.as_bytes());
        }
    }

    fn end(&mut self, test: &str, action: &str, cases: &mut CaseReporter<'_>) {
        self.open(test, cases);
        let Some(running) = self.running.get(test) else { return };
        let mut entries = text::log_entries(&running.text, &self.dir);
        if action == "fail" {
            // Other text can look like a panic; that of a test in which the process died
            // follows the test's own last line.
            let mark = format!("--- FAIL: {test} (");
            let after = running.text.rfind(&mark).map_or(&*running.text, |at| &running.text[at..]);
            if let Some(crash) = text::crash(after, &self.dir) {
                self.crash = Some((test.to_owned(), crash));
                return;
            }
        }
        let result = match action {
            "pass" => CaseResult::default(),
            "skip" => {
                let reason = entries.pop().map(|entry| entry.text);
                CaseResult::new(Outcome::Skipped, reason.unwrap_or_else(|| "skipped".to_owned()))
            }
            _ => {
                self.report_failure(test, entries, text::example_failure(&running.text), cases);
                CaseResult::new(Outcome::Failed, "it failed without a message")
            }
        };
        self.running.remove(test);
        cases.finish(test, result);
    }

    /// Reports why a test failed. Its log does not distinguish errors from other entries, but
    /// mostly ends with one.
    fn report_failure(
        &self,
        test: &str,
        mut entries: Vec<LogEntry>,
        example: Option<String>,
        cases: &mut CaseReporter<'_>,
    ) {
        let last = entries.pop();
        for LogEntry { text, location } in entries {
            cases.message(Some(test), MessageKind::Report, text, Some(location));
        }
        if let Some(LogEntry { text, location }) = last {
            cases.message(Some(test), MessageKind::Failure, text, Some(location));
        } else if let Some(text) = example {
            let location = self.starts.get(test).and_then(|start| start.location.clone());
            cases.message(Some(test), MessageKind::Failure, text, location);
        }
    }

    /// Finds the test in which the process died: that which says so, or the last one.
    fn find_crash(&mut self, cases: &mut CaseReporter<'_>) {
        self.release(cases);
        let open = self.running.iter().filter(|(_, it)| it.progress == Progress::Open);
        let mut open: Vec<(&String, &RunningTest)> = open.collect();
        open.sort_by_key(|(_, it)| it.number);
        let crashes = open.iter().rev().find_map(|(test, running)| {
            Some(((*test).clone(), text::crash(&running.text, &self.dir)?))
        });
        let names: Vec<String> = open.into_iter().map(|(test, _)| test.clone()).collect();
        self.crash = self.crash.take().or(crashes);
        let Some((culprit, crash)) = &self.crash else { return };
        cases.message(Some(culprit), MessageKind::Error, &crash.reason, crash.location.clone());
        // Tests that ran in parallel died with it.
        let is_other = |name: &&String| {
            !culprit.starts_with(*name) && !name.starts_with(&format!("{culprit}/"))
        };
        for name in names.iter().rev().filter(is_other) {
            let reason = format!("`{culprit}` ended the process in which this test was running");
            cases.finish(name, CaseResult::new(Outcome::Crashed, reason));
        }
    }
}

impl ReportReader for Reader {
    fn report(&mut self, bytes: &[u8], cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        self.line.extend_from_slice(bytes);
        let Some(end) = self.line.iter().rposition(|byte| *byte == b'\n') else { return Ok(()) };
        let rest = self.line.split_off(end + 1);
        let lines = std::mem::replace(&mut self.line, rest);
        for line in lines.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
            let event = serde_json::from_slice(line).map_err(|_| {
                let quote: String =
                    String::from_utf8_lossy(line).chars().take(QUOTED_CHARS).collect();
                Garbage(format!("`go test -json` printed `{quote}`"))
            })?;
            self.carry_out(event, cases);
        }
        Ok(())
    }

    fn holds_back(&self) -> bool {
        self.running.values().any(|test| test.progress == Progress::Started)
    }

    fn release(&mut self, cases: &mut CaseReporter<'_>) {
        let started = self.running.iter().filter(|(_, it)| it.progress == Progress::Started);
        let mut started: Vec<(usize, String)> =
            started.map(|(test, it)| (it.number, test.clone())).collect();
        started.sort();
        for (_, test) in started {
            self.open(&test, cases);
        }
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        if end != ExitStatus::Code(0) {
            self.find_crash(cases);
        }
        Ok(())
    }

    fn crash_reason(&self) -> Option<String> {
        self.crash.as_ref().map(|(_, crash)| crash.reason.clone())
    }
}
