//! Sections and subcases: parts of a test case that Catch2 and doctest enter one after the
//! other in several runs of the test case. They are cases in its case.
//!
//! A section with sections in it is entered once for each of them. It stays open until
//! another section begins in its place. A section that is entered again after it ended, for
//! example with the next value of a generator, is a new case: `NAME#2`.

use std::collections::HashMap;

use rtf_model::Location;

use crate::case::{CaseResult, StartedCase};
use crate::case_reporter::CaseReporter;

#[derive(Debug)]
struct Section {
    name: String,
    location: Option<Location>,
    path: String,
    has_inner: bool,
}

/// The running test case and its open sections.
#[derive(Debug, Default)]
pub(super) struct Sections {
    top: String,
    /// The open sections, each in the one before.
    open: Vec<Section>,
    /// How many of them the program is in.
    depth: usize,
    /// How many sections of a path there were.
    entered: HashMap<String, usize>,
}

impl Sections {
    /// Starts the case of a test case.
    pub fn start_case(case: StartedCase, cases: &mut CaseReporter<'_>) -> Self {
        let top = case.name.clone();
        cases.start(case);
        Self { top, ..Self::default() }
    }

    /// The path of the section in which the program is.
    pub fn path(&self) -> &str {
        match self.depth.checked_sub(1) {
            Some(index) => &self.open[index].path,
            None => &self.top,
        }
    }

    /// Whether the program is in a section.
    pub fn is_inside(&self) -> bool {
        self.depth > 0
    }

    /// The program enters a section.
    pub fn enter(&mut self, name: &str, location: Option<Location>, cases: &mut CaseReporter<'_>) {
        if let Some(open) = self.open.get(self.depth)
            && open.name == name
            && open.location == location
        {
            cases.set_current(&open.path);
            self.depth += 1;
            return;
        }
        self.close_left(cases);
        let parent = self.path().to_owned();
        if let Some(parent) = self.open.last_mut() {
            parent.has_inner = true;
        }
        let number = self.entered.entry(format!("{parent}/{name}")).or_default();
        *number += 1;
        let unique = if *number == 1 { name.to_owned() } else { format!("{name}#{number}") };
        let path = format!("{parent}/{unique}");
        let start =
            StartedCase { name: unique, location: location.clone(), ..StartedCase::default() };
        cases.start_case(Some(&parent), start);
        self.open.push(Section { name: name.to_owned(), location, path, has_inner: false });
        self.depth += 1;
    }

    /// The program leaves a section, with this result if there was no section in it.
    /// Returns whether there was none.
    pub fn leave(&mut self, result: CaseResult, cases: &mut CaseReporter<'_>) -> bool {
        let Some(depth) = self.depth.checked_sub(1) else { return false };
        self.depth = depth;
        let is_leaf = !self.open[depth].has_inner;
        if is_leaf && let Some(section) = self.open.pop() {
            cases.finish(&section.path, result);
        }
        cases.set_current(self.path());
        is_leaf
    }

    /// Finishes the sections that the program has left.
    pub fn close_left(&mut self, cases: &mut CaseReporter<'_>) {
        while self.open.len() > self.depth
            && let Some(section) = self.open.pop()
        {
            cases.finish(&section.path, CaseResult::default());
        }
    }

    pub fn finish_case(mut self, result: CaseResult, cases: &mut CaseReporter<'_>) {
        self.depth = 0;
        self.close_left(cases);
        cases.finish(&self.top, result);
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;
    use std::os::unix::net::UnixStream;

    use rtf_host::Session;
    use rtf_model::MessageKind;

    use super::*;

    #[test]
    fn a_report_belongs_to_the_section_in_which_the_program_is() {
        let (mut ours, theirs) = UnixStream::pair().expect("sockets");
        let session = Session::over(theirs);
        let mut cases = CaseReporter::new(&session);
        let start = StartedCase { name: "case".to_owned(), ..StartedCase::default() };
        let mut sections = Sections::start_case(start, &mut cases);
        let report = |cases: &mut CaseReporter<'_>| {
            cases.message(None, MessageKind::Report, "report", None);
        };
        sections.enter("outer", None, &mut cases);
        sections.enter("inner", None, &mut cases);
        report(&mut cases);
        sections.leave(CaseResult::default(), &mut cases);
        report(&mut cases);
        sections.leave(CaseResult::default(), &mut cases);
        report(&mut cases);
        sections.enter("outer", None, &mut cases);
        report(&mut cases);
        sections.enter("second", None, &mut cases);
        report(&mut cases);
        sections.finish_case(CaseResult::default(), &mut cases);
        drop(cases);
        drop(session);
        let mut text = String::new();
        ours.read_to_string(&mut text).expect("text");
        let case = |line: &str| {
            let line: serde_json::Value = serde_json::from_str(line).expect("JSON");
            (line["method"] == "message").then(|| line["params"]["case"].as_u64())?
        };
        let reported: Vec<u64> = text.lines().filter_map(case).collect();
        assert_eq!(reported, [3, 2, 1, 2, 4]);
    }
}
