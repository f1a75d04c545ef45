//! Turns the events of a run into cases.
//!
//! A case is the outermost method, or test without a method. Invocations of the method and
//! dynamic tests are cases in it. Classes and engines are no cases: their problems belong to
//! the cases in them that do not run.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rtf_model::{Attachment as File, ExitStatus, MessageKind, Outcome};

use super::events::{Attachment, Finished, Started, TestEvent, TestEvents};
use super::stack_trace;
use crate::case::{CaseResult, ListedCase, StartedCase};
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};

/// What an open element of the stream is.
#[derive(Clone, Debug)]
struct Element {
    unique_id: String,
    class: String,
    /// The path of its case; `None` if it is a container of cases.
    case: Option<String>,
}

/// Reads the events of one process.
#[derive(Debug, Default)]
pub(super) struct Reader {
    events: TestEvents,
    elements: HashMap<String, Element>,
    /// The selected cases, by their unique ids.
    selected: HashMap<String, StartedCase>,
    names: Names,
    classes: PathBuf,
    /// The directory of published files.
    output: PathBuf,
    has_events: bool,
    /// Why the virtual machine crashed.
    crash: Option<String>,
}

/// The names of cases so far.
#[derive(Debug, Default)]
struct Names(HashMap<String, String>);

impl Names {
    /// The name of a case: `example.ArmTest.moves()`; its unique id if another one has that
    /// name, or if it has no class.
    fn name(&mut self, started: &Started, class: &str) -> String {
        let name = match class.is_empty() {
            true => started.unique_id.clone(),
            false if started.method.is_none() && started.class.is_some() => class.to_owned(),
            false => format!("{class}.{}", started.legacy_name),
        };
        let owner = self.0.entry(name.clone()).or_insert_with(|| started.unique_id.clone());
        if *owner == started.unique_id { name } else { started.unique_id.clone() }
    }
}

/// Whether an element is a case, if nothing around it is.
fn is_case(started: &Started) -> bool {
    let is_class_template = || {
        let segment = started.unique_id.rsplit_once('/').map(|(_, segment)| segment);
        segment.is_some_and(|segment| segment.starts_with("[class-template:"))
    };
    started.is_test || started.method.is_some() || is_class_template()
}

/// Where a virtual machine that crashes writes its log.
pub(super) fn error_file(scratch: &Path) -> PathBuf {
    scratch.join("hs_err.log")
}

/// The reason in such a log: `#  SIGSEGV (0xb) at pc=0x00007f9f2c8b4f5e, pid=12`.
fn crash(log: &str) -> Option<String> {
    let lines = log.lines().filter_map(|line| line.strip_prefix('#'));
    let reason = lines.map(str::trim).find(|line| line.starts_with("SIG"))?;
    let reason = reason.split(", pid=").next().unwrap_or(reason);
    Some(format!("the Java virtual machine crashed: {reason}"))
}

/// The cases of a dry run.
pub(super) fn listed_cases(events: Vec<TestEvent>) -> Vec<ListedCase> {
    let mut names = Names::default();
    let mut cases = Vec::new();
    // The class of each container, and whether it is in a case.
    let mut elements: HashMap<String, (String, bool)> = HashMap::new();
    for event in events {
        let TestEvent::Started(started) = event else { continue };
        let (outer_class, in_case) = elements.get(&started.parent).cloned().unwrap_or_default();
        let class = started.class.clone().unwrap_or(outer_class);
        let is_case = !in_case && is_case(&started);
        if is_case {
            cases.push(ListedCase {
                name: names.name(&started, &class),
                tags: started.tags.clone(),
                id: Some(started.unique_id.clone()),
                ..ListedCase::default()
            });
        }
        elements.insert(started.id, (class, in_case || is_case));
    }
    cases
}

impl Reader {
    pub fn new(cases: &[ListedCase], classes: &Path, output: &Path) -> Self {
        let selected = cases.iter().filter_map(|case| Some((case.id.clone()?, case.start())));
        Self {
            selected: selected.collect(),
            classes: classes.to_owned(),
            output: output.to_owned(),
            ..Self::default()
        }
    }

    fn start(&mut self, started: Started, cases: &mut CaseReporter<'_>) {
        let outer = self.elements.get(&started.parent);
        let outer_case = outer.and_then(|outer| outer.case.clone());
        let outer_class = outer.map(|outer| outer.class.clone()).unwrap_or_default();
        let class = started.class.clone().unwrap_or(outer_class);
        let case = match outer_case {
            Some(outer) => {
                let (name, tags) = (started.display_name.clone(), started.tags.clone());
                let path = format!("{outer}/{name}");
                cases
                    .start_case(Some(&outer), StartedCase { name, tags, ..StartedCase::default() });
                Some(path)
            }
            None if is_case(&started) => Some(self.start_top(&started, &class, cases)),
            None => None,
        };
        let Started { id, unique_id, .. } = started;
        self.elements.insert(id, Element { unique_id, class, case });
    }

    fn start_top(
        &mut self,
        started: &Started,
        class: &str,
        cases: &mut CaseReporter<'_>,
    ) -> String {
        let case = self.selected.remove(&started.unique_id).unwrap_or_else(|| StartedCase {
            name: self.names.name(started, class),
            tags: started.tags.clone(),
            ..StartedCase::default()
        });
        let name = case.name.clone();
        cases.start(case);
        if started.display_name != started.legacy_name {
            cases.message(Some(&name), MessageKind::Report, &started.display_name, None);
        }
        name
    }

    fn reported(&self, id: &str, attachment: Attachment, cases: &mut CaseReporter<'_>) {
        let case = self.elements.get(id).and_then(|element| element.case.as_deref());
        match attachment {
            Attachment::Entry { key, value } => cases.property(case, &key, &value),
            Attachment::File { path, media_type } => {
                let path = self.output.join(path);
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let path = path.to_string_lossy().into_owned();
                cases.attach(case, File { name, path, media_type, ..File::default() });
            }
        }
    }

    fn finish(&mut self, finished: &Finished, cases: &mut CaseReporter<'_>) {
        let Some(element) = self.elements.remove(&finished.id) else { return };
        match &element.case {
            Some(case) => {
                let result = self.report_problem(finished, &element.class, Some(case), cases);
                cases.finish(case, result);
            }
            None => self.finish_container(finished, &element, cases),
        }
    }

    /// Reports the problem of an element, and returns the result of its case.
    fn report_problem(
        &self,
        finished: &Finished,
        class: &str,
        case: Option<&str>,
        cases: &mut CaseReporter<'_>,
    ) -> CaseResult {
        let trace = &finished.stack_trace;
        let skipped = |reason: String| {
            let reason = if reason.is_empty() { "skipped".to_owned() } else { reason };
            CaseResult::new(Outcome::Skipped, reason)
        };
        match finished.status.as_str() {
            "SUCCESSFUL" => CaseResult::default(),
            "SKIPPED" => skipped(finished.reason.clone()),
            "ABORTED" => skipped(stack_trace::assumption(trace)),
            _ => {
                let is_assertion = finished.is_assertion;
                let kind = if is_assertion { MessageKind::Failure } else { MessageKind::Error };
                let text = stack_trace::message(trace, is_assertion);
                let location = stack_trace::location(trace, class, &self.classes);
                if text.is_empty() && location.is_none() {
                    return CaseResult::new(Outcome::Error, format!("it is {}", finished.status));
                }
                cases.message(case, kind, text, location);
                CaseResult::default()
            }
        }
    }

    /// The cases of a class that did not run have its result.
    fn finish_container(
        &mut self,
        finished: &Finished,
        element: &Element,
        cases: &mut CaseReporter<'_>,
    ) {
        if finished.status == "SUCCESSFUL" {
            return;
        }
        let prefix = format!("{}/", element.unique_id);
        let inside = self.selected.keys().filter(|id| id.starts_with(&prefix));
        let mut inside: Vec<String> = inside.cloned().collect();
        inside.sort();
        let is_bad = !matches!(finished.status.as_str(), "SKIPPED" | "ABORTED");
        if inside.is_empty() && is_bad {
            self.report_problem(finished, &element.class, None, cases);
        }
        for id in inside {
            let Some(case) = self.selected.remove(&id) else { continue };
            let name = case.name.clone();
            cases.start(case);
            let result = self.report_problem(finished, &element.class, Some(&name), cases);
            cases.finish(&name, result);
        }
    }
}

impl ReportReader for Reader {
    fn report(&mut self, bytes: &[u8], cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        self.has_events = true;
        for event in self.events.feed(bytes)? {
            match event {
                TestEvent::Started(started) => self.start(started, cases),
                TestEvent::Reported { id, attachment } => self.reported(&id, attachment, cases),
                TestEvent::Finished(finished) => self.finish(&finished, cases),
            }
        }
        Ok(())
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let log = error_file(&self.output);
        if let Ok(text) = std::fs::read_to_string(&log) {
            self.crash = crash(&text);
            let (name, media_type) = ("hs_err.log".to_owned(), "text/plain".to_owned());
            let path = log.to_string_lossy().into_owned();
            cases.attach(None, File { name, path, media_type, ..File::default() });
        }
        let has_exited = matches!(end, ExitStatus::Code(_)) && cases.innermost().is_none();
        let is_complete = self.events.is_complete();
        match (has_exited && !is_complete, self.has_events) {
            (true, true) => Err(Garbage("it ends too early".to_owned())),
            (true, false) if matches!(end, ExitStatus::Code(0 | 1)) => Err(Garbage(
                "the console launcher sent no events; version 6.1 or later is needed".to_owned(),
            )),
            _ => Ok(()),
        }
    }

    fn crash_reason(&self) -> Option<String> {
        self.crash.clone()
    }
}
