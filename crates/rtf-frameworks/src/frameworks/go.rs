//! Go packages, through `go test -json`.
//!
//! The report mixes the verdicts of tests with everything that they print. It reports no
//! verdict for a test in which the process died, or `fail`: the output decides (`text.rs`).

mod stream;
mod text;
mod version;

use std::process::Command;
use std::time::Duration;

use rtf_model::Location;

use crate::case::ListedCase;
use crate::framework::{
    Framework, Launch, ListError, ReportChannel, ReportReader, StackDump, TestProgram,
};
use crate::listing;

/// The limit for compiling and listing: the first build compiles all dependencies.
const LIST_LIMIT: Duration = Duration::from_secs(900);

/// An argument has at most 128 KiB.
const PATTERN_BYTES: usize = 120 * 1024;

/// Flags that would change which tests run, or the report.
const RESERVED: [&str; 9] =
    ["-run", "-list", "-skip", "-bench", "-fuzz", "-cpu", "-json", "-c", "-v"];

#[derive(Clone, Copy, Debug)]
pub struct Go;

impl Framework for Go {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        check_arguments(&test.args)?;
        if !test.file.is_dir() {
            let name = test.file.display();
            return Err(ListError::new(format!("`{name}` is no directory of a Go package")));
        }
        version::check(&test.file)?;
        let mut command = go_test(test);
        command.arg("-list=.").args(&test.args);
        let listed = listing::run(command, LIST_LIMIT)?;
        if !listed.status.success() {
            let message = format!("`go test` cannot build the tests\n{}", listed.quote());
            return Err(ListError::new(message));
        }
        let sources = Sources::read(test);
        let text = String::from_utf8_lossy(&listed.stdout);
        let names = text.lines().filter(|line| is_test(line));
        let case = |name: &str| ListedCase {
            name: name.to_owned(),
            location: sources.location(name),
            ..ListedCase::default()
        };
        let cases: Vec<ListedCase> = names.map(case).collect();
        if cases.is_empty() {
            let quote = listed.quote();
            return Err(ListError::new(format!(
                "the package has no tests\n`go test` printed\n{quote}"
            )));
        }
        Ok(Some(cases))
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::Stdout
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let names: Vec<&str> = launch.cases.cases.iter().map(|case| case.name.as_str()).collect();
        let pattern = match launch.cases.is_all {
            true => String::new(),
            false => format!("^({})$", names.join("|")),
        };
        if pattern.len() > PATTERN_BYTES {
            return Err(format!("the names of {} tests are too long for `-run`", names.len()));
        }
        let mut command = go_test(launch.test);
        command.args(["-json", "-count=1"]).arg(format!("-run={pattern}"));
        // The suite limits the time. An argument of the suite comes later, and so it counts.
        command.arg("-timeout=0").args(&launch.test.args);
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        Box::new(stream::Reader::new(&launch.test.file, launch.cases.cases))
    }

    fn stack_dump(&self) -> StackDump {
        StackDump::SignalToOutput(rustix::process::Signal::QUIT)
    }
}

fn go_test(test: &TestProgram) -> Command {
    let mut command = Command::new("go");
    command.arg("test").current_dir(&test.file);
    command
}

/// Flags may have one dash or two, and the prefix `test.`.
fn check_arguments(args: &[String]) -> Result<(), ListError> {
    let flags = args.iter().take_while(|arg| !matches!(arg.as_str(), "-args" | "--args"));
    for arg in flags {
        let flag = arg.split('=').next().unwrap_or(arg).replacen("--", "-", 1);
        let flag = flag.replacen("-test.", "-", 1);
        if RESERVED.contains(&flag.as_str()) {
            let message = format!("`{flag}` is set by rtf; select tests with `cases`");
            return Err(ListError::new(message));
        }
    }
    Ok(())
}

/// `-list` also prints benchmarks, which `-run` does not select.
fn is_test(line: &str) -> bool {
    let is_name = line.chars().all(|char| char.is_alphanumeric() || char == '_');
    is_name && ["Test", "Example", "Fuzz"].iter().any(|start| line.starts_with(start))
}

/// The test files of a package, to find its functions.
struct Sources(Vec<(String, String)>);

impl Sources {
    fn read(test: &TestProgram) -> Self {
        let entries = std::fs::read_dir(&test.file).into_iter().flatten().flatten();
        let paths = entries.map(|entry| entry.path());
        let tests = paths.filter(|path| path.to_string_lossy().ends_with("_test.go"));
        let read = |path: std::path::PathBuf| {
            Some((path.to_string_lossy().into_owned(), std::fs::read_to_string(&path).ok()?))
        };
        Self(tests.filter_map(read).collect())
    }

    fn location(&self, name: &str) -> Option<Location> {
        let start = format!("func {name}(");
        self.0.iter().find_map(|(file, text)| {
            let line = text.lines().position(|line| line.starts_with(&start))?;
            Some(Location { file: file.clone(), line: u32::try_from(line + 1).ok()? })
        })
    }
}
