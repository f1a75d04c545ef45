//! Judges a test by its exit code and output, as `ctest` does.

use std::path::Path;
use std::time::{Duration, Instant};

use regex::Regex;
use rtf_model::{Attachment, ExitStatus, MessageKind, Outcome};

use super::measurements::{self, Printed};
use super::properties::CTestCase;
use crate::case::CaseResult;
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};
use crate::last_output::OutputStream;

/// Maximum size of an output that is searched.
const OUTPUT_BYTES: usize = 64 << 20;

/// The number of lines of output that a reason quotes.
const QUOTED_LINES: usize = 10;

/// The longest line that a reason quotes, in characters.
const QUOTED_CHARS: usize = 300;

/// Reads the output of a test, and judges the test at its end.
#[derive(Default)]
pub struct Judge {
    test: CTestCase,
    output: Vec<u8>,
    is_cut: bool,
    /// When an expression of `TIMEOUT_AFTER_MATCH` matched.
    matched: Option<Instant>,
}

/// How `ctest` judges a test that has exited.
#[derive(Debug, PartialEq, Eq)]
enum Judgement {
    Passed,
    Failed(String),
    Skipped(String),
}

impl Judge {
    pub fn new(test: CTestCase) -> Self {
        Self { test, ..Self::default() }
    }

    /// `ctest` reads lines, and ends the last one.
    fn text(&self) -> String {
        let mut text = String::from_utf8_lossy(&self.output).into_owned();
        if !text.is_empty() && !text.ends_with('\n') {
            text.push('\n');
        }
        text
    }

    fn watch_for_match(&mut self) {
        if let (Some((_, expressions)), None) = (&self.test.timeout_after_match, self.matched) {
            let text = self.text();
            if expressions.iter().any(|regex| regex.is_match(&text)) {
                self.matched = Some(Instant::now());
            }
        }
    }

    /// The limit after the match, if it was exceeded.
    fn exceeded(&self) -> Option<Duration> {
        let (limit, _) = self.test.timeout_after_match.as_ref()?;
        self.matched.filter(|matched| matched.elapsed() > *limit).map(|_| *limit)
    }

    fn judge(&self, code: i32, output: &str) -> Judgement {
        let CTestCase { pass, fail, skip, .. } = &self.test;
        if let Some((pattern, _)) = first_match(skip, output) {
            return Judgement::Skipped(format!(
                "the output matches SKIP_REGULAR_EXPRESSION `{pattern}`"
            ));
        }
        if self.test.skip_code == Some(code) {
            let line = last_line(output);
            let reason = format!("exit code {code} is its SKIP_RETURN_CODE");
            return Judgement::Skipped(if line.is_empty() {
                reason
            } else {
                format!("{line} ({reason})")
            });
        }
        let problem = if let Some((pattern, _)) = first_match(fail, output) {
            Some(format!("the output matches FAIL_REGULAR_EXPRESSION `{pattern}`"))
        } else if !pass.is_empty() && first_match(pass, output).is_none() {
            let patterns: Vec<String> = pass.iter().map(|(it, _)| format!("`{it}`")).collect();
            Some(format!(
                "the output does not match PASS_REGULAR_EXPRESSION {}",
                patterns.join(" or ")
            ))
        } else if pass.is_empty() && code != 0 {
            Some(format!("exit code {code}"))
        } else {
            None
        };
        match (problem, self.test.will_fail) {
            (None, false) | (Some(_), true) => Judgement::Passed,
            (Some(problem), false) => Judgement::Failed(problem),
            (None, true) => Judgement::Failed(
                "the test passed, and its property WILL_FAIL requires a failure".to_owned(),
            ),
        }
    }

    /// Reports everything that the test has measured and attached.
    fn report_results(&self, output: &str, has_failed: bool, cases: &mut CaseReporter<'_>) {
        for (name, value) in &self.test.measurements {
            cases.property(None, name, value);
        }
        let files = self.test.attached.iter();
        let failed = self.test.attached_on_fail.iter().filter(|_| has_failed);
        for path in files.chain(failed) {
            self.attach("", path, "", cases);
        }
        for printed in measurements::find(output) {
            match printed {
                Printed::Value(name, value) => cases.property(None, &name, &value),
                Printed::File { name, path, media_type } => {
                    self.attach(&name, &path, &media_type, cases)
                }
                Printed::Details(text) => cases.message(None, MessageKind::Report, text, None),
                Printed::Label(label) => {
                    cases.message(None, MessageKind::Report, format!("label: {label}"), None);
                }
            }
        }
    }

    fn attach(&self, name: &str, path: &str, media_type: &str, cases: &mut CaseReporter<'_>) {
        let dir = self.test.working_dir.as_deref().unwrap_or(Path::new("."));
        let file = dir.join(path);
        if !file.is_file() {
            let text = format!("the attachment `{path}` does not exist");
            return cases.message(None, MessageKind::Report, text, None);
        }
        let base = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let name = if name.is_empty() { base } else { name.to_owned() };
        let (path, media_type) = (file.to_string_lossy().into_owned(), media_type.to_owned());
        cases.attach(None, Attachment { name, path, media_type, ..Attachment::default() });
    }
}

impl ReportReader for Judge {
    fn output(&mut self, _stream: OutputStream, bytes: &[u8], _cases: &mut CaseReporter<'_>) {
        let room = OUTPUT_BYTES.saturating_sub(self.output.len());
        self.is_cut |= bytes.len() > room;
        self.output.extend(&bytes[..bytes.len().min(room)]);
        self.watch_for_match();
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let output = self.text();
        let path = self.test.name.clone();
        let judgement = match end {
            ExitStatus::Code(code) => self.judge(code, &output),
            ExitStatus::Signal(_) => Judgement::Failed(format!("the test ended with {end}")),
        };
        self.report_results(&output, matches!(judgement, Judgement::Failed(_)), cases);
        let result = if let Some(limit) = self.exceeded() {
            let reason = format!(
                "the test ran longer than {limit:?} after the match of TIMEOUT_AFTER_MATCH"
            );
            CaseResult::new(Outcome::TimedOut, reason)
        } else if let ExitStatus::Signal(_) = end {
            // The supervisor finishes the case: it has crashed in any case.
            return Ok(());
        } else if self.is_cut && self.test.searches_output() {
            let reason =
                "the test printed more than 64 MiB, which its regular expressions cannot search";
            CaseResult::new(Outcome::Error, reason)
        } else {
            match judgement {
                Judgement::Passed => CaseResult::default(),
                Judgement::Failed(reason) => {
                    CaseResult::new(Outcome::Failed, with_quote(&reason, &output))
                }
                Judgement::Skipped(reason) => CaseResult::new(Outcome::Skipped, reason),
            }
        };
        cases.finish(&path, result);
        Ok(())
    }
}

fn first_match<'a>(
    expressions: &'a [(String, Regex)],
    output: &str,
) -> Option<&'a (String, Regex)> {
    expressions.iter().find(|(_, regex)| regex.is_match(output))
}

fn last_line(output: &str) -> String {
    let line = output.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default();
    line.trim().chars().take(QUOTED_CHARS).collect()
}

/// A reason with the end of the output.
fn with_quote(reason: &str, output: &str) -> String {
    let lines: Vec<String> = output
        .lines()
        .filter(|line| !line.trim().is_empty())
        .map(|line| line.chars().take(QUOTED_CHARS).collect())
        .collect();
    let start = lines.len().saturating_sub(QUOTED_LINES);
    match &lines[start..] {
        [] => reason.to_owned(),
        [line] => format!("{reason}: {line}"),
        // The first line is all that an overview shows.
        [.., last] => format!("{reason}: {last}\n{}", lines[start..].join("\n")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::regex_dialect;
    use super::*;

    fn expressions(pattern: &str) -> Vec<(String, Regex)> {
        vec![(pattern.to_owned(), regex_dialect::compile(pattern).unwrap())]
    }

    fn judged(test: CTestCase, code: i32, output: &str) -> String {
        match Judge::new(test).judge(code, output) {
            Judgement::Passed => "passed".to_owned(),
            Judgement::Failed(reason) => format!("failed: {reason}"),
            Judgement::Skipped(reason) => format!("skipped: {reason}"),
        }
    }

    #[test]
    fn as_ctest_judges() {
        let test = CTestCase::default;
        assert_eq!(judged(test(), 0, ""), "passed");
        assert_eq!(judged(test(), 3, ""), "failed: exit code 3");
        let pass = || CTestCase { pass: expressions("ye+s"), ..test() };
        // The exit code does not matter then.
        assert_eq!(judged(pass(), 4, "yes\n"), "passed");
        assert_eq!(
            judged(pass(), 0, "no\n"),
            "failed: the output does not match PASS_REGULAR_EXPRESSION `ye+s`"
        );
        let fail = CTestCase { fail: expressions("bad"), ..pass() };
        assert!(judged(fail, 0, "yes bad\n").starts_with("failed: the output matches FAIL"));
        let inverted = || CTestCase { will_fail: true, ..pass() };
        assert_eq!(judged(inverted(), 0, "no\n"), "passed");
        assert!(judged(inverted(), 0, "yes\n").starts_with("failed: the test passed, and"));
        let skip = CTestCase { skip: expressions("no arm"), will_fail: true, ..test() };
        assert!(judged(skip, 1, "no arm\n").starts_with("skipped: the output matches"));
        let code = || CTestCase { skip_code: Some(77), ..test() };
        assert_eq!(
            judged(code(), 77, "a\nno arm\n\n"),
            "skipped: no arm (exit code 77 is its SKIP_RETURN_CODE)"
        );
        assert_eq!(judged(code(), 77, ""), "skipped: exit code 77 is its SKIP_RETURN_CODE");
        assert_eq!(judged(code(), 0, ""), "passed");
    }

    #[test]
    fn a_reason_quotes_the_end_of_the_output() {
        assert_eq!(with_quote("exit code 1", ""), "exit code 1");
        assert_eq!(with_quote("exit code 1", "no arm\n\n"), "exit code 1: no arm");
        let long = (1..=20).map(|line| format!("{line}\n")).collect::<String>();
        assert!(with_quote("x", &long).starts_with("x: 20\n11\n12\n"));
    }
}
