//! Reports the cases of a test to the runner: numbers them, keeps the open ones, and
//! compares them with the selected ones.

mod process;
mod reports;

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::time::Instant;

use rtf_host::Session;
use rtf_model::protocol::{CaseSelector, Notification};
use rtf_model::{CaseId, CaseStart, MessageKind, Outcome};

use crate::case::{CaseResult, Retry, StartedCase};
use crate::wanted::WantedCases;
use process::PresentProcess;

/// How many names a message lists.
const NAMES_SHOWN: usize = 5;

/// Maximum number of planned names in a notification, whose size is limited.
const NAMES_IN_LINE: usize = 4096;

#[derive(Debug)]
struct OpenCase {
    path: String,
    case: CaseId,
    parent: Option<CaseId>,
    started: Instant,
    has_problem: bool,
}

/// Reports the cases of one attempt of a test. A path is a name after those of the cases
/// that contain it, joined with `/`.
#[derive(Debug)]
pub struct CaseReporter<'a> {
    session: &'a Session,
    started: u32,
    open: Vec<OpenCase>,
    /// Top-level cases that have finished: whether without a problem.
    results: HashMap<String, bool>,
    /// After which results the supervisor runs a top-level case again.
    retry: Option<Retry>,
    skipped: usize,
    /// The top-level cases that are expected; `None` if any is.
    expected: Option<HashSet<String>>,
    /// The cases that the runner wants, if the program announces its cases itself.
    wanted: Option<WantedCases>,
    process: PresentProcess,
    /// The path of the open case in which the program is, if it is not the innermost one.
    current: Option<String>,
    /// Whether the program skipped itself.
    is_skipped: bool,
    /// The end of the only case of a process, which is held back until the process has ended.
    held_end: Option<(CaseId, Notification)>,
}

impl<'a> CaseReporter<'a> {
    #[must_use]
    pub fn new(session: &'a Session) -> Self {
        Self {
            session,
            started: 0,
            open: Vec::new(),
            results: HashMap::new(),
            retry: None,
            skipped: 0,
            expected: None,
            wanted: None,
            process: PresentProcess::default(),
            current: None,
            is_skipped: false,
            held_end: None,
        }
    }

    /// Announces top-level cases. Others are errors from then on.
    pub fn plan(&mut self, names: impl IntoIterator<Item = String>) {
        let names: Vec<String> = names.into_iter().collect();
        self.expected.get_or_insert_default().extend(names.iter().cloned());
        for part in names.chunks(NAMES_IN_LINE) {
            self.session.forward(&Notification::CasesPlanned { names: part.to_vec() });
        }
    }

    /// Sets the cases that the runner wants, for a program that announces its cases itself.
    pub fn want(&mut self, wanted: &[CaseSelector]) {
        self.wanted = Some(WantedCases::new(wanted, std::iter::empty()));
    }

    /// The program announces top-level cases. Returns for each one whether it runs in the
    /// present process.
    pub fn announce(&mut self, names: Vec<String>) -> Vec<bool> {
        if !self.process.is_later {
            let wanted = names.iter().filter(|name| self.is_wanted(name)).cloned();
            let wanted: Vec<String> = wanted.collect();
            self.plan(wanted);
        }
        names.iter().map(|name| self.runs(name)).collect()
    }

    /// Whether a top-level case runs in the present process: it is selected and has not
    /// finished in an earlier one.
    #[must_use]
    pub fn runs(&self, name: &str) -> bool {
        self.is_wanted(name)
            && (!self.results.contains_key(name) || self.process.finished.contains(name))
            && self.process.selection.as_ref().is_none_or(|selection| selection.contains(name))
    }

    fn is_wanted(&self, name: &str) -> bool {
        self.wanted.as_ref().is_none_or(|wanted| wanted.includes(name))
    }

    /// Whether top-level cases were announced.
    #[must_use]
    pub fn has_plan(&self) -> bool {
        self.expected.is_some()
    }

    /// Sets after which results of a top-level case another attempt of it follows.
    pub fn retry(&mut self, retry: Option<Retry>) {
        self.retry = retry;
    }

    /// Whether a top-level case is still to be run.
    #[must_use]
    pub fn is_awaited(&self, name: &str) -> bool {
        !self.results.contains_key(name)
            && self.expected.as_ref().is_none_or(|expected| expected.contains(name))
    }

    /// Starts a case in the open case with this path, or a top-level case.
    pub fn start_case(&mut self, parent: Option<&str>, case: StartedCase) {
        match parent {
            Some(parent) => self.start_in(Some(parent), case),
            None => self.start(case),
        }
    }

    /// Starts a top-level case.
    pub fn start(&mut self, case: StartedCase) {
        if self.expected.as_ref().is_some_and(|expected| !expected.contains(&case.name)) {
            let text = format!("the program ran `{}`, which was not selected", case.name);
            self.test_error(text);
        }
        self.start_in(None, case);
    }

    fn start_in(&mut self, parent: Option<&str>, case: StartedCase) {
        if self.session.interrupted() {
            return;
        }
        if parent.is_none() && (self.held_end.is_some() || !self.open.is_empty()) {
            self.end_process();
        }
        let parent = parent.and_then(|path| self.find(path));
        let (parent, path) = match parent {
            Some(open) => (Some(open.case), format!("{}/{}", open.path, case.name)),
            None => (None, case.name.clone()),
        };
        let id = CaseId(self.started + 1);
        let StartedCase { name, parameters, tags, location } = case;
        let start = CaseStart { parent, parameters, tags, location, ..CaseStart::new(id, name) };
        if !self.session.forward(&Notification::CaseStarted(start)) {
            return self.test_error("a case has a name that is longer than 16 MiB".to_owned());
        }
        self.started = id.0;
        let started = Instant::now();
        self.current = None;
        self.open.push(OpenCase { path, case: id, parent, started, has_problem: false });
    }

    /// The program is in the open case with this path, until another case starts or finishes.
    pub fn set_current(&mut self, path: &str) {
        self.current = Some(path.to_owned());
    }

    /// Finishes the open case with this path. The cases in it must have finished.
    pub fn finish(&mut self, path: &str, result: CaseResult) {
        let Some(index) = self.open.iter().rposition(|open| open.path == path) else {
            return self.report_unmatched(path, result);
        };
        let case = self.open[index].case;
        // Cases that the framework left open have the result that their messages report.
        while let Some(inner) = self.open.iter().rposition(|open| open.parent == Some(case)) {
            let path = self.open[inner].path.clone();
            self.finish(&path, CaseResult::default());
        }
        let Some(index) = self.open.iter().rposition(|open| open.case == case) else { return };
        let open = self.open.remove(index);
        self.current = None;
        let CaseResult { outcome, reason, duration, rerun } = result;
        let is_held = self.process.has_only_case && open.parent.is_none();
        let duration = duration.or_else(|| is_held.then(|| open.started.elapsed()));
        let duration_us = duration.map(|it| u64::try_from(it.as_micros()).unwrap_or(u64::MAX));
        let is_bad = outcome.is_some_and(|it| !matches!(it, Outcome::Passed | Outcome::Skipped));
        let has_problem = open.has_problem || is_bad;
        let is_retried = self.retry.is_some_and(|retry| retry.follows(outcome, has_problem));
        let rerun = (rerun || is_retried) && open.parent.is_none();
        // The next attempt decides.
        self.process.has_problem |= has_problem && !rerun;
        if let Some(parent) = open.parent {
            let mut others = self.open.iter_mut();
            if let Some(parent) = others.find(|other| other.case == parent) {
                parent.has_problem |= has_problem;
            }
        } else {
            self.process.count += 1;
            self.process.last_finished = Some(open.path.clone());
            if !rerun {
                let is_skipped = outcome == Some(Outcome::Skipped) && !has_problem;
                self.record_result(open.path, !has_problem, is_skipped);
            }
        }
        let episode = None;
        let finished =
            Notification::CaseFinished { case, outcome, reason, duration_us, rerun, episode };
        if self.session.interrupted() {
            return;
        }
        self.report_end();
        self.held_end = Some((case, finished));
        if !is_held {
            self.report_end();
        }
    }

    /// Reports the end of the case that finished last.
    fn report_end(&mut self) {
        let Some((case, finished)) = self.held_end.take() else { return };
        if !self.session.forward(&finished)
            && let Notification::CaseFinished { outcome, duration_us, rerun, .. } = finished
        {
            let reason = Some("the reason is longer than 16 MiB".to_owned());
            let episode = None;
            let end =
                Notification::CaseFinished { case, outcome, reason, duration_us, rerun, episode };
            self.session.forward(&end);
        }
    }

    /// A top-level case has finished, perhaps for a second time.
    fn record_result(&mut self, name: String, has_passed: bool, is_skipped: bool) {
        self.process.finished.insert(name.clone());
        match self.results.entry(name) {
            Entry::Occupied(mut before) => *before.get_mut() &= has_passed,
            Entry::Vacant(place) => {
                place.insert(has_passed);
                self.skipped += usize::from(is_skipped);
            }
        }
    }

    /// Reports the end of a case that is not open: a problem, if it did not pass.
    fn report_unmatched(&mut self, path: &str, result: CaseResult) {
        let text = format!("the program finished `{path}`, which is not running");
        match result.outcome {
            None | Some(Outcome::Passed | Outcome::Skipped) => {
                self.message(None, MessageKind::Report, format!("warning: {text}"), None);
            }
            Some(_) => {
                let reason = result.reason.map(|reason| format!(": {reason}")).unwrap_or_default();
                self.test_error(format!("{text}{reason}"));
            }
        }
    }

    /// Starts and finishes a top-level case that does not run.
    pub fn add(&mut self, case: StartedCase, result: CaseResult) {
        let path = case.name.clone();
        self.start(case);
        if !self.session.interrupted() {
            self.finish(&path, result);
        }
    }

    /// Skips the test: the program reported that it has no cases to run.
    pub fn skip_test(&mut self, reason: &str) {
        self.is_skipped = true;
        self.session.record_result(Outcome::Skipped, reason);
    }

    /// The path of the innermost open case.
    #[must_use]
    pub fn innermost(&self) -> Option<&str> {
        self.open.last().map(|open| open.path.as_str())
    }

    /// The path of the open top-level case that was started first, and its start.
    #[must_use]
    pub fn running(&self) -> Option<(&str, Instant)> {
        let top = self.open.iter().find(|open| open.parent.is_none())?;
        Some((&top.path, top.started))
    }

    /// The results of the finished top-level cases: true without a problem.
    #[must_use]
    pub fn results(&self) -> &HashMap<String, bool> {
        &self.results
    }

    /// How many cases there are, if all of them were skipped.
    #[must_use]
    pub fn all_skipped(&self) -> Option<usize> {
        (self.skipped > 0 && self.skipped == self.results.len()).then_some(self.skipped)
    }

    /// Describes the planned cases that were not reported.
    #[must_use]
    pub fn missing(&self) -> Option<String> {
        let expected = self.expected.as_ref()?;
        let mut missing: Vec<&str> = expected
            .iter()
            .map(String::as_str)
            .filter(|name| !self.results.contains_key(*name))
            .collect();
        if missing.is_empty() {
            return None;
        }
        missing.sort_unstable();
        let names: Vec<String> =
            missing.iter().take(NAMES_SHOWN).map(|name| format!("`{name}`")).collect();
        let dots = if missing.len() > NAMES_SHOWN { ", …" } else { "" };
        let (some, all) = (missing.len(), expected.len());
        Some(format!("{some} of {all} selected cases were not run: {}{dots}", names.join(", ")))
    }

    /// Finishes all open cases: with this result if no open case is in it, otherwise with the
    /// result of those.
    pub fn end_open(&mut self, result: &CaseResult) {
        let parents: HashSet<CaseId> = self.open.iter().filter_map(|open| open.parent).collect();
        while let Some(open) = self.open.last() {
            let (path, is_outer) = (open.path.clone(), parents.contains(&open.case));
            let result = if is_outer { CaseResult::default() } else { result.clone() };
            self.finish(&path, result);
        }
    }

    fn find(&self, path: &str) -> Option<&OpenCase> {
        self.open.iter().rfind(|open| open.path == path)
    }
}
