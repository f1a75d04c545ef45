//! Rust packages, whose tests `cargo test` builds.
//!
//! Each test runs in a process, because the stable report of a test program does not
//! separate results from output. The program is started as cargo does.

mod build;
mod output;

use std::process::Command;
use std::sync::{Mutex, PoisonError};

use crate::case::ListedCase;
use crate::framework::{Framework, Launch, ListError, ReportChannel, ReportReader, TestProgram};
use crate::listing::{self, LIST_LIMIT};
use build::{Build, TestBinary};

/// Arguments of `cargo test` that would change what it prints or runs.
const RESERVED: [&str; 3] = ["--no-run", "--message-format", "--doc"];

/// Arguments of test programs, after `--`, that rtf sets.
const RESERVED_FOR_PROGRAMS: [&str; 8] = [
    "--exact",
    "--list",
    "--format",
    "--nocapture",
    "--no-capture",
    "--test-threads",
    "--logfile",
    "--quiet",
];

/// The adapter, with the test programs that it has listed.
#[derive(Debug, Default)]
pub struct Cargo {
    build: Mutex<Build>,
}

/// The arguments before and after `--`.
fn split(args: &[String]) -> (&[String], &[String]) {
    match args.iter().position(|arg| arg == "--") {
        Some(at) => (&args[..at], &args[at + 1..]),
        None => (args, &[]),
    }
}

impl Framework for Cargo {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        let (cargo_args, program_args) = split(&test.args);
        listing::refuse_reserved(cargo_args, &RESERVED)?;
        listing::refuse_reserved(program_args, &RESERVED_FOR_PROGRAMS)?;
        let build = build::build(&test.file, cargo_args)?;
        let mut cases = Vec::new();
        for (index, binary) in build.binaries.iter().enumerate() {
            cases.extend(list_binary(index, binary, program_args)?);
        }
        *self.build.lock().unwrap_or_else(PoisonError::into_inner) = build;
        if cases.is_empty() {
            return Err(ListError::new("the package has no tests, except perhaps doc tests"));
        }
        Ok(Some(cases))
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::Stdout
    }

    fn watches_output(&self, _launch: &Launch<'_>) -> bool {
        true
    }

    fn needs_separate_processes(&self) -> bool {
        true
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let build = self.build.lock().unwrap_or_else(PoisonError::into_inner);
        let (binary, test) = selected(launch, &build).ok_or("no test is selected")?;
        let mut command = binary.command();
        command.args(split(&launch.test.args).1);
        command.args(["--exact", test, "--nocapture", "--test-threads=1"]);
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let build = self.build.lock().unwrap_or_else(PoisonError::into_inner);
        let test = selected(launch, &build).map(|(_, test)| test);
        let case = launch.cases.cases.first().map(|case| case.name.as_str());
        let (test, case) = (test.unwrap_or_default(), case.unwrap_or_default());
        Box::new(output::Reader::new(case, test, &build.workspace))
    }
}

/// The test of a process, and its program. Its id is `INDEX:NAME`.
fn selected<'a>(launch: &Launch<'a>, build: &'a Build) -> Option<(&'a TestBinary, &'a str)> {
    let (index, name) = launch.cases.cases.first()?.id.as_deref()?.split_once(':')?;
    Some((build.binaries.get(index.parse::<usize>().ok()?)?, name))
}

/// Lists the tests of a program.
fn list_binary(
    index: usize,
    binary: &TestBinary,
    args: &[String],
) -> Result<Vec<ListedCase>, ListError> {
    let tests = names(binary, args, &["--list", "--format", "terse"])?;
    let ignored = match args.iter().any(|arg| arg == "--include-ignored" || arg == "--ignored") {
        true => Vec::new(),
        false => names(binary, args, &["--list", "--format", "terse", "--ignored"])?,
    };
    let reasons = ignore_reasons(binary, args, &ignored)?;
    let case = |test: String| {
        let disabled = ignored.contains(&test);
        let marks = reasons.iter().find(|(name, _)| *name == test);
        ListedCase {
            name: format!("{}::{test}", binary.name),
            disabled,
            disabled_reason: disabled
                .then(|| marks.map_or("ignored", |(_, reason)| reason).to_owned()),
            id: Some(format!("{index}:{test}")),
            ..ListedCase::default()
        }
    };
    Ok(tests.into_iter().map(case).collect())
}

fn names(binary: &TestBinary, args: &[String], list: &[&str]) -> Result<Vec<String>, ListError> {
    let mut command = binary.command();
    command.args(args).args(list);
    let listed = listing::run(command, LIST_LIMIT)?;
    let text = String::from_utf8_lossy(&listed.stdout);
    let mut names = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        match line.rsplit_once(": ") {
            Some((name, "test")) => names.push(name.to_owned()),
            Some((_, "benchmark")) => {}
            _ => return Err(no_list(binary, line)),
        }
    }
    match listed.status.success() {
        true => Ok(names),
        false => Err(no_list(binary, &listed.quote())),
    }
}

fn no_list(binary: &TestBinary, printed: &str) -> ListError {
    let name = &binary.name;
    ListError::new(format!(
        "the test program `{name}` does not list its tests as those of Rust do; other targets can be selected with `--lib`, `--test NAME` and so on in `param`\nit printed\n{printed}"
    ))
}

/// Why tests are ignored, which only a run of them shows; it does not run them.
fn ignore_reasons(
    binary: &TestBinary,
    args: &[String],
    ignored: &[String],
) -> Result<Vec<(String, String)>, ListError> {
    if ignored.is_empty() {
        return Ok(Vec::new());
    }
    let mut command = binary.command();
    command.args(args).args(["--test-threads=1", "--exact"]).args(ignored);
    let listed = listing::run(command, LIST_LIMIT)?;
    let text = String::from_utf8_lossy(&listed.stdout);
    let lines = text.lines().filter_map(|line| line.strip_prefix("test "));
    let reason = |line: &str| {
        let (name, reason) = line.split_once(" ... ignored, ")?;
        Some((name.to_owned(), reason.to_owned()))
    };
    Ok(lines.filter_map(reason).collect())
}
