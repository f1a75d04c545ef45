//! One case of an attempt, and the cases that it contains, while the journal is read.

use std::collections::{HashMap, HashSet};

use rtf_model::{CaseFinished, CaseId, CaseRecord, CaseStart, Event, EventKind, Micros};

use crate::problem::Problem;

/// The error of an attempt without this case.
pub(super) fn no_case(case: CaseId) -> Problem {
    Problem::not_found(format!("there is no case {case} in this attempt"))
}

/// Which events are of a case or of the cases that it contains.
#[derive(Debug)]
pub(super) struct CaseFilter {
    case: CaseId,
    /// The case and those that it contains, as far as they have started.
    inside: HashSet<CaseId>,
}

impl CaseFilter {
    pub fn new(case: CaseId) -> Self {
        Self { case, inside: HashSet::new() }
    }

    /// Adds a case that starts.
    pub fn add(&mut self, event: &Event) {
        let EventKind::CaseStarted(started) = &event.kind else { return };
        let CaseStart { case, parent, .. } = &started.start;
        if *case == self.case || parent.is_some_and(|parent| self.inside.contains(&parent)) {
            self.inside.insert(*case);
        }
    }

    /// Whether an event was reported in the case.
    pub fn contains(&self, event: &Event) -> bool {
        let case = match &event.kind {
            EventKind::Message { message, .. } => message.case,
            EventKind::Measured { measurement, .. } => measurement.case,
            EventKind::Sampled { samples, .. } => samples.case,
            EventKind::Attached { attachment, .. } => attachment.case,
            _ => None,
        };
        case.is_some_and(|case| self.inside.contains(&case))
    }

    /// # Errors
    /// The case has not started.
    pub fn check(&self) -> Result<(), Problem> {
        if self.inside.is_empty() { Err(no_case(self.case)) } else { Ok(()) }
    }
}

/// A case and the cases that it contains, also those that a record does not keep.
#[derive(Debug)]
pub(super) struct CaseReader {
    case: CaseId,
    /// The top-level case around it.
    top: Option<CaseId>,
    /// Of each case before it, the top-level case around that, and its path.
    before: HashMap<CaseId, (CaseId, String)>,
    found: Vec<CaseRecord>,
}

impl CaseReader {
    pub fn new(case: CaseId) -> Self {
        Self { case, top: None, before: HashMap::new(), found: Vec::new() }
    }

    /// Adds the start or the end of a case. Returns whether all about the case is known.
    pub fn add(&mut self, event: Event) -> bool {
        match event.kind {
            EventKind::CaseStarted(started) => self.start(event.at, started.start),
            EventKind::CaseFinished(finished) => return self.finish(event.at, finished),
            _ => {}
        }
        false
    }

    /// The cases, in the order in which they started.
    ///
    /// # Errors
    /// The case has not started.
    pub fn into_cases(self) -> Result<Vec<CaseRecord>, Problem> {
        if self.found.is_empty() { Err(no_case(self.case)) } else { Ok(self.found) }
    }

    fn start(&mut self, at: Micros, start: CaseStart) {
        let around = start.parent.and_then(|parent| self.position(parent));
        let path = match (around, start.parent.and_then(|parent| self.before.get(&parent))) {
            (Some(index), _) => format!("{}/{}", self.found[index].path, start.name),
            (None, Some((_, path))) => format!("{path}/{}", start.name),
            (None, None) => start.name.clone(),
        };
        if start.case == self.case || around.is_some() {
            if start.case == self.case {
                self.top = Some(self.top_of(&start));
            }
            let (finished, is_superseded) = (None, false);
            self.found.push(CaseRecord { start, path, started: at, finished, is_superseded });
        } else if self.found.is_empty() {
            self.before.insert(start.case, (self.top_of(&start), path));
        }
    }

    fn finish(&mut self, at: Micros, finished: CaseFinished) -> bool {
        let is_top = self.top == Some(finished.case);
        if is_top && finished.rerun {
            self.found.iter_mut().for_each(|case| case.is_superseded = true);
        }
        if let Some(index) = self.position(finished.case) {
            self.found[index].finished = Some((at, finished));
        }
        is_top
    }

    fn top_of(&self, start: &CaseStart) -> CaseId {
        let around = start.parent.and_then(|parent| self.before.get(&parent));
        around.map_or(start.case, |(top, _)| *top)
    }

    fn position(&self, case: CaseId) -> Option<usize> {
        self.found.binary_search_by_key(&case, |it| it.start.case).ok()
    }
}
