//! Catch2, version 3.
//!
//! Its XML reporter writes the results while the cases run, to the file that it is given, so
//! that standard output stays free. The reporter keeps the text that a case writes to
//! `std::cout`, `std::cerr` and `std::clog`, and adds it at the end of the case.

mod stream;

use std::process::Command;

use rtf_model::Location;

use super::assertion;
use crate::case::ListedCase;
use crate::framework::{
    Framework, Launch, ListError, OpenChannel, ReportChannel, ReportReader, TestProgram,
};
use crate::listing;
use crate::xml_report::XmlReport;
use crate::xml_stream::XmlEvent;

/// The exit code if all cases were skipped.
const ALL_SKIPPED: i32 = 4;

/// Options that would change where results go, or what is listed.
const RESERVED: [&str; 12] = [
    "-r",
    "--reporter",
    "-o",
    "--out",
    "-f",
    "--input-file",
    "--list-tests",
    "--list-tags",
    "--list-reporters",
    "--list-listeners",
    "-c",
    "--section",
];

/// A prefix of a test specification that negates it.
const EXCLUDE: &str = "exclude:";
const EXCLUDE_WILDCARD: &str = "*xclude:";

#[derive(Clone, Copy, Debug)]
pub struct Catch2;

impl Framework for Catch2 {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        listing::refuse_reserved(&test.args, &RESERVED)?;
        let mut cases = list(test, None)?;
        // Hidden cases do not run by default.
        for hidden in list(test, Some("[.]"))? {
            if !cases.contains(&hidden) {
                let reason = Some("hidden".to_owned());
                cases.push(ListedCase { disabled: true, disabled_reason: reason, ..hidden });
            }
        }
        assertion::unique_names(&mut cases);
        Ok(Some(cases))
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::Descriptor
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = command(launch.test);
        if let OpenChannel::Descriptor(path) = &launch.channel {
            command.arg("-r").arg(format!("xml::out={}", path.display()));
        }
        if !launch.cases.is_all {
            // A file, because an argument has at most 128 KiB.
            let file = launch.scratch.join("cases");
            let names = launch.cases.cases.iter().map(|case| pattern(case) + "\n");
            std::fs::write(&file, names.collect::<String>()).map_err(|error| error.to_string())?;
            command.arg("-f").arg(file);
        }
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
        let mut command = command(test);
        command.arg("--list-tests");
        Some(command)
    }

    fn accepts_exit(&self, code: i32, has_problem: bool) -> bool {
        // The reader checks whether all cases were skipped.
        code == 0 || has_problem || code == ALL_SKIPPED
    }
}

fn command(test: &TestProgram) -> Command {
    let mut command = test.command();
    // Bazel's variables select cases and add a report.
    for name in ["BAZEL_TEST", "TESTBRIDGE_TEST_ONLY", "TEST_SHARD_INDEX", "TEST_TOTAL_SHARDS"] {
        command.env_remove(name);
    }
    command
}

/// A test specification that only matches this case.
fn pattern(case: &ListedCase) -> String {
    let name = case.id.as_deref().unwrap_or(&case.name);
    let mut pattern = String::from("\"");
    // Catch2 reads the prefix also in quotes, as the exclusion of the rest. A wildcard in its
    // place matches the name.
    let rest = name.strip_prefix(EXCLUDE);
    pattern.push_str(if rest.is_some() { EXCLUDE_WILDCARD } else { "" });
    for character in rest.unwrap_or(name).chars() {
        if matches!(character, '\\' | ',' | '[' | ']' | '"' | '*') {
            pattern.push('\\');
        }
        pattern.push(character);
    }
    pattern + "\""
}

/// The cases that match the arguments of the test, or this specification in addition.
fn list(test: &TestProgram, specification: Option<&str>) -> Result<Vec<ListedCase>, ListError> {
    let (text, listed) = listing::run_with_file(|list| {
        let mut command = command(test);
        command.arg("--list-tests").arg("-r").arg(format!("xml::out={}", list.display()));
        // After a comma: otherwise both specifications would have to match.
        command.args(specification.map(|text| format!(",{text}")));
        command
    })?;
    parse_list(&text).ok_or_else(|| listed.not_of("Catch2 3", &test.file, "--list-tests -r xml"))
}

/// The cases in a list; `None` if it is none.
pub(super) fn parse_list(text: &[u8]) -> Option<Vec<ListedCase>> {
    let events = XmlReport::parse("MatchingTests", text)?;
    let (mut cases, mut case) = (Vec::new(), ListedCase::default());
    let mut location = Location { file: String::new(), line: 0 };
    for event in &events {
        let XmlEvent::End { name, text } = event else { continue };
        match name.as_str() {
            "Name" => text.trim().clone_into(&mut case.name),
            "Tags" => case.tags = tags(text),
            "File" => text.trim().clone_into(&mut location.file),
            "Line" => location.line = text.trim().parse().unwrap_or(0),
            "TestCase" => {
                let is_known = !location.file.is_empty();
                case.location = is_known.then(|| location.clone());
                cases.push(std::mem::take(&mut case));
            }
            _ => {}
        }
    }
    Some(cases)
}

/// The tags in `[arm][fast]`.
fn tags(text: &str) -> Vec<String> {
    let tags = text.trim().trim_start_matches('[').trim_end_matches(']').split("][");
    tags.filter(|tag| !tag.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped() {
        let name = "a, [b] \"c\" \\ * ~".to_owned();
        let case = ListedCase { name, ..ListedCase::default() };
        assert_eq!(pattern(&case), r#""a\, \[b\] \"c\" \\ \* ~""#);
        let name = "exclude:a*".to_owned();
        let case = ListedCase { name, ..ListedCase::default() };
        assert_eq!(pattern(&case), r#""*xclude:a\*""#);
    }

    #[test]
    fn a_list_has_locations_and_tags() {
        let text = b"<?xml version=\"1.0\"?>\n<MatchingTests>\n<TestCase>\n<Name>a &lt;b></Name>\n\
            <ClassName/>\n<Tags>[arm][odd tag]</Tags>\n<SourceInfo>\n<File>/a.cpp</File>\n\
            <Line>7</Line>\n</SourceInfo></TestCase></MatchingTests>";
        let [case] = &*parse_list(text).expect("a list") else { panic!("one case") };
        assert_eq!(
            (case.name.as_str(), &*case.tags),
            ("a <b>", &["arm", "odd tag"].map(String::from)[..])
        );
        assert_eq!(case.location, Some(Location { file: "/a.cpp".to_owned(), line: 7 }));
        assert_eq!(parse_list(b"All available test cases:\n"), None);
        assert_eq!(parse_list(b"<MatchingTests>"), None);
    }
}
