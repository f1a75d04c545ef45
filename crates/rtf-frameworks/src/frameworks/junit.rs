//! JUnit 4, 5 and 6, through the console launcher of the JUnit platform.
//!
//! The launcher writes Open Test Reporting events: for the list into a file, in a dry run;
//! for a run to a socket, because the file is not flushed. Invocations of a method, such as
//! those of a parameterized test, are not known before the run.

mod events;
mod launcher;
mod stack_trace;
mod stream;

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::case::ListedCase;
use crate::framework::{
    Framework, Launch, ListError, OpenChannel, ReportChannel, ReportReader, StackDump, TestProgram,
};
use crate::listing::{self, file_name};
use events::TestEvents;

/// The limit for listing the tests.
const LIST_LIMIT: Duration = Duration::from_secs(120);

/// Options that would change which tests run, or the report.
const RESERVED: [&str; 30] = [
    "-u",
    "--select-uri",
    "-f",
    "--select-file",
    "-d",
    "--select-directory",
    "-o",
    "--select-module",
    "-p",
    "--select-package",
    "-c",
    "--select-class",
    "-m",
    "--select-method",
    "-r",
    "--select-resource",
    "-i",
    "--select-iteration",
    "--uid",
    "--select-unique-id",
    "--select",
    "--scan-classpath",
    "--scan-class-path",
    "--scan-modules",
    "--details",
    "--reports-dir",
    "--redirect-stdout",
    "--redirect-stderr",
    "discover",
    "execute",
];

#[derive(Clone, Copy, Debug)]
pub struct JUnit;

impl Framework for JUnit {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        listing::refuse_reserved(&test.args, &RESERVED)?;
        let dir = tempfile::tempdir().map_err(|error| ListError::new(error.to_string()))?;
        let mut command = command(test, None).map_err(ListError::new)?;
        command.arg(scan(test));
        command.arg("--config=junit.platform.execution.dryRun.enabled=true");
        command
            .arg(format!("--config=junit.platform.reporting.output.dir={}", dir.path().display()));
        let listed = listing::run(command, LIST_LIMIT)?;
        let report = std::fs::read(dir.path().join("open-test-report.xml")).unwrap_or_default();
        match parse_list(&report) {
            Some(cases) if !cases.is_empty() => Ok(Some(cases)),
            _ => Err(no_tests(test, &listed)),
        }
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::Socket
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = command(launch.test, Some(launch.scratch))?;
        if let OpenChannel::Socket(address) = &launch.channel {
            let port = address.port();
            command.arg(format!("--config=junit.platform.reporting.open.xml.socket={port}"));
        }
        drop(std::fs::remove_file(stream::error_file(launch.scratch)));
        // Files that tests publish.
        let output = launch.scratch.display();
        command.arg(format!("--config=junit.platform.reporting.output.dir={output}"));
        if launch.cases.is_all {
            command.arg(scan(launch.test));
        } else {
            let ids = launch.cases.cases.iter().filter_map(|case| case.id.as_deref());
            let lines: String = ids.map(select_line).collect();
            let file = launch.scratch.join("selected");
            std::fs::write(&file, lines).map_err(|error| error.to_string())?;
            command.arg(format!("@{}", file.display()));
        }
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let (file, scratch) = (&launch.test.file, launch.scratch);
        Box::new(stream::Reader::new(launch.cases.cases, file, scratch))
    }

    fn stack_dump(&self) -> StackDump {
        StackDump::SignalToOutput(rustix::process::Signal::QUIT)
    }
}

/// The cases in the report of a dry run; `None` if it is none.
pub(super) fn parse_list(report: &[u8]) -> Option<Vec<ListedCase>> {
    TestEvents::default().feed(report).ok().map(stream::listed_cases)
}

/// The command for both: a run, and the list.
fn command(test: &TestProgram, scratch: Option<&Path>) -> Result<Command, String> {
    let mut command = Command::new(launcher::java()?);
    if let Some(scratch) = scratch {
        let file = stream::error_file(scratch);
        command.arg(format!("-XX:ErrorFile={}", file.display()));
    }
    command.arg("-jar").arg(launcher::find()?).arg("execute");
    command.args(["--disable-banner", "--disable-ansi-colors", "--details=none"]);
    command.arg("--config=junit.platform.reporting.open.xml.enabled=true");
    command.arg(format!("--class-path={}", test.file.display())).args(&test.args);
    Ok(command)
}

fn scan(test: &TestProgram) -> String {
    format!("--scan-class-path={}", test.file.display())
}

/// A line of an argument file, in which quotes and backslashes are escaped.
fn select_line(id: &str) -> String {
    let id = id.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"--select-unique-id={id}\"\n")
}

fn no_tests(test: &TestProgram, listed: &listing::Listed) -> ListError {
    let (name, status) = (file_name(&test.file), listed.status);
    let hint = match listed.quote().is_empty() {
        true => {
            "\nnames of test classes start with `Test` or end with `Test` or `Tests`; `-n PATTERN` in `param` changes that"
        }
        false => "",
    };
    listed.error(format!("the console launcher finds no tests in `{name}` ({status}){hint}"))
}
