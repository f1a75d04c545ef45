//! doctest.
//!
//! Its XML reporter writes the results while the cases run, to the file that it is given, so
//! that standard output stays free.

mod stream;

use std::process::Command;

use super::assertion;
use crate::case::ListedCase;
use crate::framework::{
    Framework, Launch, ListError, OpenChannel, ReportChannel, ReportReader, TestProgram,
};
use crate::listing;
use crate::xml_report::XmlReport;
use crate::xml_stream::XmlEvent;

/// The longest argument that Linux accepts is 128 KiB.
const FILTER_BYTES: usize = 120 * 1024;

/// Options that would change where results go, or which cases run. Each one also exists with
/// `dt-` after its dashes.
const RESERVED: [&str; 16] = [
    "-r",
    "--reporters",
    "-o",
    "--out",
    "-tc",
    "--test-case",
    "-ltc",
    "--list-test-cases",
    "-dt-r",
    "--dt-reporters",
    "-dt-o",
    "--dt-out",
    "-dt-tc",
    "--dt-test-case",
    "-dt-ltc",
    "--dt-list-test-cases",
];

#[derive(Clone, Copy, Debug)]
pub struct Doctest;

impl Framework for Doctest {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        listing::refuse_reserved(&test.args, &RESERVED)?;
        let enabled = list(test, &[])?;
        let mut cases = list(test, &["--no-skip=true"])?;
        for case in &mut cases {
            if !enabled.contains(case) {
                case.disabled = true;
                case.disabled_reason = Some("decorated with `doctest::skip`".to_owned());
            }
        }
        assertion::unique_names(&mut cases);
        Ok(Some(cases))
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::Descriptor
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = launch.test.command();
        command.arg("--reporters=xml");
        if let OpenChannel::Descriptor(path) = &launch.channel {
            command.arg(format!("--out={}", path.display()));
        }
        if launch.cases.is_all {
            return Ok(command);
        }
        let names = launch.cases.cases.iter().map(framework_name);
        let patterns: Vec<String> = names.map(escape).collect();
        if patterns.iter().any(String::is_empty) {
            return Err("doctest cannot select a test case without a name".to_owned());
        }
        let filter = patterns.join(",");
        if filter.len() > FILTER_BYTES {
            let count = patterns.len();
            return Err(format!("doctest cannot select {count} cases: their names are too long"));
        }
        command.arg(format!("--test-case={filter}")).arg("--case-sensitive=true");
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        Box::new(stream::Reader::new(launch.cases.cases))
    }

    fn omits_disabled(&self) -> bool {
        true
    }

    fn has_own_report(&self) -> bool {
        true
    }

    fn fork_server_command(&self, test: &TestProgram) -> Option<Command> {
        let mut command = test.command();
        command.arg("--list-test-cases");
        Some(command)
    }
}

/// The name by which the framework knows the case.
fn framework_name(case: &ListedCase) -> &str {
    match case.id.as_deref().unwrap_or(&case.name) {
        stream::UNNAMED => "",
        name => name,
    }
}

/// A filter for this name, in which `*` and `?` match themselves and more.
fn escape(name: &str) -> String {
    name.replace('\\', "\\\\").replace(',', "\\,")
}

fn list(test: &TestProgram, options: &[&str]) -> Result<Vec<ListedCase>, ListError> {
    let (text, listed) = listing::run_with_file(|list| {
        let mut command = test.command();
        command.args(["--list-test-cases", "--reporters=xml"]).args(options);
        command.arg(format!("--out={}", list.display()));
        command
    })?;
    let options = "--list-test-cases --reporters=xml";
    parse_list(&text).ok_or_else(|| listed.not_of("doctest", &test.file, options))
}

/// The cases in a list; `None` if it is none.
pub(super) fn parse_list(text: &[u8]) -> Option<Vec<ListedCase>> {
    let events = XmlReport::parse("doctest", text)?;
    let case = |event: &XmlEvent| {
        let XmlEvent::Start { name, attributes } = event else { return None };
        let suite = attributes.get("testsuite");
        (name == "TestCase").then(|| ListedCase {
            name: stream::case_name(attributes),
            location: assertion::location(attributes, "filename"),
            tags: (!suite.is_empty()).then(|| suite.to_owned()).into_iter().collect(),
            ..ListedCase::default()
        })
    };
    Some(events.iter().filter_map(case).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_locations_and_suites() {
        let text = b"<?xml version=\"1.0\"?>\n<doctest binary=\"a\" version=\"2.4.9\">\n\
            <Options order_by=\"file\"/>\n\
            <TestCase name=\"opens\" testsuite=\"gripper, left\" filename=\"a.cpp\" line=\"7\"/>\n\
            <TestCase filename=\"a.cpp\" line=\"8\" skipped=\"false\"/>\n\
            <OverallResultsTestCases unskipped=\"2\"/>\n</doctest>";
        let [named, unnamed] = &*parse_list(text).expect("a list") else { panic!("two cases") };
        assert_eq!(
            (named.name.as_str(), &*named.tags),
            ("opens", &["gripper, left".to_owned()][..])
        );
        assert_eq!(named.location.as_ref().map(|it| it.line), Some(7));
        assert_eq!((unnamed.name.as_str(), framework_name(unnamed)), (stream::UNNAMED, ""));
        assert_eq!(parse_list(b"[doctest] listing all test case names"), None);
    }

    #[test]
    fn commas_are_escaped() {
        assert_eq!(escape("a, b\\c*"), "a\\, b\\\\c*");
    }
}
