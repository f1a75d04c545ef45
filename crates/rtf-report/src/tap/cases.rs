//! The cases of a test: a subtest of the test's point, with a subtest for each case that
//! contains cases.

use rtf_model::{Record, TestRecord, Verdict};

use super::syntax::{SUBTEST, description, severity};
use super::yaml::Yaml;
use crate::cases::{CaseResult, TestCases};
use crate::explain::{self, Extent, Sink};
use crate::{known_failure, words};

/// Cases that are nested more deeply are written at this depth, with their paths.
const DEPTH: usize = 8;

/// Writes the subtest of a test.
pub(super) fn subtest(
    text: &mut String,
    record: &Record,
    test: &TestRecord,
    cases: &TestCases<'_>,
) {
    let mut tree = Subtests { record, test, cases, inner: inner(cases) };
    let top = std::mem::take(&mut tree.inner[0]);
    let omitted = usize::from(cases.omitted > 0);
    tree.begin(text, (1, &test.plan.name), top.len() + omitted);
    for (number, index) in (1..).zip(&top) {
        tree.case(text, (2, number), *index);
    }
    if omitted > 0 {
        let indent = " ".repeat(2 * SUBTEST);
        let more = words::count(cases.omitted, "more case");
        *text += &format!("{indent}ok {} - {more}\n", top.len() + 1);
    }
}

struct Subtests<'a> {
    record: &'a Record,
    test: &'a TestRecord,
    cases: &'a TestCases<'a>,
    /// The cases at the top, and those in each case, one place later.
    inner: Vec<Vec<usize>>,
}

fn inner(cases: &TestCases<'_>) -> Vec<Vec<usize>> {
    let mut inner = vec![Vec::new(); cases.results.len() + 1];
    let mut depths: Vec<usize> = Vec::with_capacity(cases.results.len());
    // The place in `inner` that lists the case.
    let mut lists: Vec<usize> = Vec::with_capacity(cases.results.len());
    for (index, case) in cases.results.iter().enumerate() {
        let (depth, list) = match case.parent {
            None => (0, 0),
            Some(parent) if depths[parent] == DEPTH => (DEPTH, lists[parent]),
            Some(parent) => (depths[parent] + 1, parent + 1),
        };
        inner[list].push(index);
        depths.push(depth);
        lists.push(list);
    }
    inner
}

impl Subtests<'_> {
    fn begin(&self, text: &mut String, (level, name): (usize, &str), points: usize) {
        let indent = " ".repeat(level * SUBTEST);
        *text += &format!("{indent}# Subtest: {}\n", crate::escape::line(name));
        *text += &format!("{indent}{:SUBTEST$}1..{points}\n", "");
    }

    /// Writes the subtest of a case and its point, which is indented `level` times.
    fn case(&self, text: &mut String, (level, number): (usize, usize), index: usize) {
        let Some(case) = self.cases.results.get(index) else { return };
        let name = match case.record {
            Some(record) if record.depth() <= DEPTH => record.start.name.as_str(),
            _ => case.path,
        };
        let inner = &self.inner[index + 1];
        if !inner.is_empty() {
            self.begin(text, (level, name), inner.len());
            for (number, index) in (1..).zip(inner) {
                self.case(text, (level + 1, number), *index);
            }
        }
        let indent = " ".repeat(level * SUBTEST);
        let (ok, directive) = self.result(case);
        let line = format!("{indent}{ok} {number} - {}{directive}", description(name));
        *text += line.trim_end();
        text.push('\n');
        if case.is_problem {
            self.explain(text, level, case);
        }
    }

    fn result(&self, case: &CaseResult<'_>) -> (&'static str, String) {
        match case.verdict() {
            // Perl's harness counts `not ok … # SKIP` as a failure, others do not.
            None => ("ok", " # SKIP did not run".to_owned()),
            Some(Verdict::Passed) => ("ok", String::new()),
            Some(Verdict::Skipped) if known_failure::has_red_cases(self.record, self.test) => {
                ("not ok", String::new())
            }
            Some(Verdict::Skipped) => {
                let reason = case.record.and_then(|case| case.reason()).unwrap_or_default();
                ("ok", format!(" # SKIP {}", description(reason)))
            }
            Some(_) if known_failure::is_known(self.test) => {
                let reason = known_failure::describe(self.test);
                ("not ok", format!(" # TODO {}", description(&reason)))
            }
            Some(_) => ("not ok", String::new()),
        }
    }

    fn explain(&self, text: &mut String, level: usize, case: &CaseResult<'_>) {
        let Some(verdict) = case.verdict() else { return };
        let mut yaml = Yaml::new(text, level * SUBTEST);
        yaml.duration(case.duration);
        yaml.problem(verdict, severity(verdict), case.reason());
        if let Some(location) = self.cases.locations(case).next() {
            yaml.place(&location.file, location.line);
        }
        let explained = |sink: Sink<'_>| explain::case(self.cases, case, Extent::ALL, sink);
        yaml.lines("details", explain::lines(explained));
        yaml.end();
    }
}
