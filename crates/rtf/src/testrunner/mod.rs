//! `robottestingframework-testrunner`: the command line of
//! robot-testing-framework 2.x, on top of the same engine as `rtf run`.
//! `spec/testrunner.md` is the contract.
//!
//! It is the same program, called by another name.

mod args;

use std::io::{self, Write};
use std::num::NonZeroU16;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use clap::Parser as _;
use clap::error::ErrorKind;
use rtf_engine::guard::Link;
use rtf_engine::locks::LockOptions;
use rtf_model::Record;
use rtf_plan::plan::{Compatibility, Options, RunnerEnvironment};
use rtf_process::fork_server::ForkMode;
use rtf_report::journal::Journal;
use rtf_report::junit;
use rtf_report::logs::Logs;
use rtf_report::predecessor::{self, Console, ConsoleOptions};
use rtf_report::{Reporter, run_dir};
use rtf_web::{Capabilities, Server};

use crate::command::Outcome;
use crate::command::job::Job;
use crate::command::locks;
use crate::command::output;
use crate::command::planning;
use crate::command::web::{self, Asks};
use crate::error::Failure;
use crate::exit;
use crate::guarded::{Guarded, finish};
use args::{Args, OutputType};

/// The program's name.
pub const NAME: &str = "robottestingframework-testrunner";

/// The version whose command line this is: scripts ask for it.
const PREDECESSOR_VERSION: &str = "2.0.1";

/// As for `rtf run`.
const SHUTDOWN: Duration = Duration::from_secs(60);

/// Whether the program was called by this name.
pub fn is_called() -> bool {
    let called = std::env::args_os().next().unwrap_or_default();
    Path::new(&called).file_stem().is_some_and(|stem| stem == NAME)
}

/// Runs; ends with 0 or 1, as the predecessor did.
pub fn main() -> ExitCode {
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => {
            // Nobody is left to tell when standard error is closed.
            let _ = error.print();
            let helped = error.kind() == ErrorKind::DisplayHelp;
            return ExitCode::from(if helped { exit::PASSED } else { exit::FAILED });
        }
    };
    let code = run(&args).unwrap_or_else(|failure| failure.show());
    if code == ExitCode::from(exit::PASSED) { code } else { ExitCode::from(exit::FAILED) }
}

fn run(args: &Args) -> Outcome {
    if args.version {
        let version = env!("CARGO_PKG_VERSION");
        let line = format!("{NAME} version {PREDECESSOR_VERSION} (compatible; rtf {version})");
        Failure::unless_reader_left(writeln!(anstream::stdout(), "{line}"))?;
        return Ok(ExitCode::SUCCESS);
    }
    if args.requests().is_empty() {
        let hint = format!(
            "name one with `--test`, `--tests`, `--suite` or `--suites`, see `{NAME} --help`"
        );
        return Err(Failure::input("no test and no suite is named").hint(hint));
    }
    Failure::unless_reader_left(warn(args))?;
    let results = Results::new(args).map_err(Failure::own)?;
    let runner = std::cell::Cell::new(false);
    let run = |guard| {
        runner.set(true);
        perform(args, &results, guard)
    };
    let close = |journal: &Path, record: &Record| after_death(args, journal, record);
    let (kept, lifeline, patience) = (results.scratch.is_none(), None, SHUTDOWN);
    let outcome = Guarded { run, close: &close, kept, lifeline, patience }.watch();
    // The guard is still there when the runner is not.
    if !runner.get() {
        results.clear();
    }
    outcome
}

/// Tells what has no effect.
fn warn(args: &Args) -> io::Result<()> {
    let mut err = anstream::stderr().lock();
    for word in &args.ignored {
        writeln!(err, "warning: `{}` is no option, and is ignored", word.to_string_lossy())?;
    }
    Ok(())
}

fn perform(args: &Args, results: &Results, guard: Link) -> Outcome {
    let surroundings = RunnerEnvironment::from_current_process().map_err(Failure::own)?;
    let mut options = Options::new(surroundings);
    options.compatibility = Compatibility::Predecessor;
    options.recursive = args.recursive;
    options.param.clone_from(&args.param);
    options.environment.clone_from(&args.environment);
    options.repetitions = args.repetition.max(1);
    let planned = planning::plan_requests(&args.requests(), &options)?;
    planned.show_warnings()?;
    result_file(args, Path::new(""))?;
    let web = args.web_reporter.then(|| web::bind_loopback(args.web_port)).transpose();
    let web =
        web.map_err(|failure| failure.hint("choose another port with `--web-port N`".to_owned()))?;
    let folder = run_dir::create(&results.folder).map_err(|error| {
        Failure::input(error)
            .hint("choose another folder with the variable `RTF_RESULTS`".to_owned())
    })?;
    let mut reporters: Vec<Box<dyn Reporter>> = vec![
        Box::new(Journal::create(&folder.journal()).map_err(Failure::input)?),
        Box::new(Logs::new(&folder.path)),
    ];
    let asks = Arc::new(Asks::new(SHUTDOWN));
    let role = Capabilities::Runner(folder.name.clone(), asks.clone());
    let web = web.map(|bound| web::serve(bound, &results.folder, role)).transpose()?;
    reporters.extend(web.as_ref().map(|web| Box::new(web.live()) as Box<dyn Reporter>));
    reporters.extend(result_file(args, &folder.journal())?);
    let outlet = output::outlet()?;
    reporters.push(Box::new(Console::over(&outlet, console_options(args))));
    let job = Job {
        planned: &planned,
        folder: &folder,
        forks: ForkMode::default(),
        asks: &asks,
        max_fail: None,
        locks: LockOptions { dir: locks::folder(), limit: None },
        jobs: NonZeroU16::MIN,
        outlet: &outlet,
    };
    let ended = job.perform(reporters, guard);
    // What is wrong with the server is not the run's.
    drop(web.map(Server::stop));
    ended
}

/// What the runner would have written at its end.
fn after_death(args: &Args, journal: &Path, record: &Record) {
    if let Some(file) = result_file(args, journal).transpose() {
        finish(file, record);
    }
    finish(Ok(Box::new(Console::stdout(console_options(args)))), record);
}

fn console_options(args: &Args) -> ConsoleOptions {
    ConsoleOptions { verbose: args.verbose, detail: args.detail, summary: !args.no_summary }
}

/// Opens the result file; finds out whether it can be written.
fn result_file(args: &Args, journal: &Path) -> Result<Option<Box<dyn Reporter>>, Failure> {
    let Some(path) = args.result_file() else { return Ok(None) };
    let file: Result<Box<dyn Reporter>, _> = match args.output_type {
        OutputType::Text => {
            predecessor::file(path, journal, args.detail).map(|file| Box::new(file) as _)
        }
        OutputType::Junit => junit::file(path, journal.parent()).map(|file| Box::new(file) as _),
    };
    file.map(Some).map_err(|error| {
        Failure::input(error).hint("choose another path with `--output FILE`".to_owned())
    })
}

/// Where runs are kept.
struct Results {
    folder: PathBuf,
    /// A folder that is gone with the run.
    scratch: Option<PathBuf>,
}

impl Results {
    fn new(args: &Args) -> io::Result<Self> {
        if args.no_output {
            let folder = tempfile::Builder::new().prefix(NAME).tempdir()?.keep();
            return Ok(Self { scratch: Some(folder.clone()), folder });
        }
        let given = std::env::var_os("RTF_RESULTS").filter(|folder| !folder.is_empty());
        let folder = given.map_or_else(|| PathBuf::from("rtf-results"), PathBuf::from);
        Ok(Self { folder, scratch: None })
    }

    fn clear(&self) {
        if let Some(folder) = &self.scratch {
            // What cannot be removed lies in the system's temporary folder.
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}
