//! `result.xml`: the JUnit report with the names and the output of 2.x, so that a server
//! continues the histories of its tests.

use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;

use quick_junit::TestCase;
use rtf_model::{
    Event, EventKind, MessageKind, Record, Source, SuiteRecord, TestId, TestPlanned, TestRecord,
};

use super::file::unreadable;
use super::result_line::{ResultLine, Word};
use super::{lines, summary};
use crate::journal;
use crate::junit::{self, Style};

/// The suite of plug-ins of the command line.
const NO_SUITE: &str = "default";
/// A test of 2.x that names itself reports this, with its name: see `setName` in `spec/sdk.md`.
const OWN_NAME: &str = "test name: ";
/// The plug-ins that had the names of their files.
const SCRIPTS: [&str; 3] = ["lua", "python", "ruby"];

/// Writes the JUnit report of a run. The journal has the lines of the tests.
///
/// # Errors
/// The journal cannot be read, or `out` cannot be written.
pub fn write_junit(
    out: &mut dyn Write,
    record: &Record,
    journal: &Path,
    detail: bool,
) -> io::Result<()> {
    let folder = journal.parent();
    let mut style = PredecessorStyle { folder, detail, tests: HashMap::new() };
    journal::read_with(journal, |event, record| {
        style.add(event, record);
        Ok(())
    })
    .map_err(unreadable)?;
    junit::write_with(out, record, folder, &style)
}

struct PredecessorStyle<'a> {
    folder: Option<&'a Path>,
    /// Whether the lines contain the places in the sources.
    detail: bool,
    tests: HashMap<TestId, TestLines>,
}

/// What a test reported.
#[derive(Debug, Default)]
struct TestLines {
    /// The last name that it gave itself.
    own_name: Option<String>,
    lines: Vec<ResultLine>,
}

impl PredecessorStyle<'_> {
    fn add(&mut self, event: &Event, record: &Record) {
        let Some(id) = test_of(&event.kind) else { return };
        let test = self.tests.entry(id).or_default();
        if let Some(name) = own_name(&event.kind) {
            test.own_name = Some(name.to_owned());
            return;
        }
        let lines = lines::of(event, record).into_iter();
        test.lines.extend(lines.filter(|line| line.word != Word::Progress));
    }

    fn output(&self, test: &TestRecord, name: &str) -> String {
        let lines = self.tests.get(&test.plan.test).map_or(&[][..], |test| &test.lines);
        let mut out = String::new();
        for line in lines {
            let mut line = line.clone();
            line.rename(&test.plan.name, name);
            out += &format!("{}{}", line.word.as_str(), line.text());
            if let Some(place) = line.place.as_ref().filter(|_| self.detail) {
                out += &format!(" ({})", place.trim_end_matches('.'));
            }
            out.push('\n');
        }
        out + &junit::attachments(test, self.folder)
    }
}

impl Style for PredecessorStyle<'_> {
    fn suite_name<'r>(&self, suite: &'r SuiteRecord) -> &'r str {
        if summary::is_suite(suite) { &suite.plan.name } else { NO_SUITE }
    }

    fn adapt(&self, case: &mut TestCase, suite: &SuiteRecord, test: &TestRecord) {
        let own_name = self.tests.get(&test.plan.test).and_then(|test| test.own_name.as_deref());
        let name = name(&test.plan, own_name);
        case.name = junit::text(&name).into();
        case.set_classname(junit::text(&format!("{}.{name}", self.suite_name(suite))));
        let out = self.output(test, &name);
        case.system_out = (!out.is_empty()).then(|| out.into());
    }
}

/// The test whose result an event belongs to.
fn test_of(kind: &EventKind) -> Option<TestId> {
    match kind {
        EventKind::Message { test: Some(test), .. }
        | EventKind::Message { source: Source::Test(test), .. }
        | EventKind::Measured { test, .. }
        | EventKind::ProcessesLeaked { source: Source::Test(test), .. }
        | EventKind::TestSkipped { test, .. } => Some(*test),
        EventKind::TestFinished(finished) => Some(finished.test),
        _ => None,
    }
}

/// The name that a test gives itself.
fn own_name(kind: &EventKind) -> Option<&str> {
    match kind {
        EventKind::Message { source: Source::Test(_), message, .. }
            if message.kind == MessageKind::Report =>
        {
            message.text.strip_prefix(OWN_NAME)
        }
        _ => None,
    }
}

/// The name that a test had: its own, or that of its file. One that its suite names keeps that
/// name, which 2.x did not know.
fn name(plan: &TestPlanned, own_name: Option<&str>) -> String {
    let base = match plan.name.rsplit_once('#') {
        Some((base, number)) if number.chars().all(|c| c.is_ascii_digit()) => base,
        _ => &plan.name,
    };
    let file = Path::new(&plan.plugin);
    let text =
        |part: Option<&std::ffi::OsStr>| part.and_then(|part| part.to_str()).map(str::to_owned);
    let (file, stem) = (text(file.file_name()), text(file.file_stem()));
    let names_of_file = [
        file.as_deref(),
        stem.as_deref(),
        stem.as_deref().and_then(|stem| stem.strip_prefix("lib")),
    ];
    if !names_of_file.contains(&Some(base)) {
        return plan.name.clone();
    }
    let is_script = SCRIPTS.contains(&plan.plugin_type.as_str());
    own_name.map(str::to_owned).or(file.filter(|_| is_script)).unwrap_or_else(|| base.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str, plugin: &str, plugin_type: &str, own_name: Option<&str>) -> String {
        let (name, plugin) = (name.to_owned(), plugin.to_owned());
        let plugin_type = plugin_type.to_owned();
        super::name(&TestPlanned { name, plugin, plugin_type, ..TestPlanned::default() }, own_name)
    }

    /// A server saw `JointLimits#3` as a new test.
    #[test]
    fn a_test_has_the_name_that_it_had() {
        let own = Some("JointLimits Right Leg");
        for (name, plugin, own, expected) in [
            ("JointLimits#3", "/p/JointLimits.so", own, "JointLimits Right Leg"),
            ("JointLimits#3", "/p/JointLimits.so", None, "JointLimits"),
            ("JointLimits#3", "/p/libJointLimits.so", own, "JointLimits Right Leg"),
            ("JointLimits", "/p/JointLimits", None, "JointLimits"),
            ("left", "/p/JointLimits.so", own, "left"),
            ("left#2", "/p/JointLimits.so", own, "left#2"),
            ("Joint#x", "/p/Joint#x.so", None, "Joint#x"),
        ] {
            assert_eq!(named(name, plugin, "dll", own), expected, "{name} {plugin}");
        }
        assert_eq!(named("Good#2", "/p/Good.lua", "lua", None), "Good.lua");
        assert_eq!(named("Good#2", "/p/Good.rb", "ruby", Some("Mine")), "Mine");
        assert_eq!(named("good", "/p/Good.py", "python", None), "good");
    }
}
