//! `robottestingframework-testrunner`: the command line of robot-testing-framework 2.x,
//! for which `rtf` is called by this name. `spec/testrunner.md` specifies it.

mod args;

use std::cell::Cell;
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::num::NonZeroU16;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use args::{Args, OutputType};
use clap::Parser as _;
use clap::error::ErrorKind;
use rtf_engine::locks::LockOptions;
use rtf_model::{Manifest, Record};
use rtf_plan::plan::{Compatibility, Options, RunnerEnvironment};
use rtf_process::fork_server::ForkMode;
use rtf_report::predecessor::{self, ResultList, ResultListOptions};
use rtf_report::run_dir::JOURNAL;
use rtf_report::{ReportError, ReportFile, WriteReport, local_time};
use rtf_run::error::Failure;
use rtf_run::finish::ResultTargets;
use rtf_run::guarded::{self, Supervision};
use rtf_run::operator::Attendance;
use rtf_run::request::{RunRequest, TestsRequest, WebRequest};
use rtf_run::revision::RevisionQuery;
use rtf_run::{exit, history, plan, preflight, reports, run, terminal};

use crate::cli::WebAccessArgs;
use crate::command::VerbResult;
use crate::request::{locks_dir, web_settings};

/// The program's name.
pub const NAME: &str = "robottestingframework-testrunner";

/// The version whose command line this is, which scripts ask for.
const PREDECESSOR_VERSION: &str = "2.0.1";

/// The default of `rtf run --shutdown-timeout`.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(60);

/// Whether the program was called by this name.
pub fn is_called() -> bool {
    let program = std::env::args_os().next().unwrap_or_default();
    Path::new(&program).file_stem().is_some_and(|stem| stem == NAME)
}

/// Runs; exits with 0 or 1, as the predecessor does.
pub fn main() -> ExitCode {
    let outcome = match Args::try_parse() {
        Ok(args) if args.version => print_version(),
        Ok(args) => run(&args),
        Err(error) => {
            // Standard error may be closed.
            let _ = error.print();
            let is_help = error.kind() == ErrorKind::DisplayHelp;
            Ok(ExitCode::from(if is_help { exit::PASSED } else { exit::FAILED }))
        }
    };
    let code = outcome.unwrap_or_else(|failure| failure.print());
    if code == ExitCode::from(exit::PASSED) { code } else { ExitCode::from(exit::FAILED) }
}

fn print_version() -> VerbResult {
    let version = env!("CARGO_PKG_VERSION");
    terminal::stdout(|out| {
        writeln!(out, "{NAME} version {PREDECESSOR_VERSION} (compatible; rtf {version})")
    })?;
    Ok(ExitCode::SUCCESS)
}

fn check_args(args: &Args) -> Result<(), Failure> {
    if args.inputs().is_empty() {
        let hint = "add `--test`, `--tests`, `--suite` or `--suites`";
        let hint = format!("{hint}; `{NAME} --help` explains them");
        return Err(Failure::input("no test and no suite is given").hint(hint));
    }
    for word in &args.ignored {
        let word = word.to_string_lossy();
        terminal::stderr(|err| writeln!(err, "warning: `{word}` is not an option, ignored"))?;
    }
    Ok(())
}

fn run(args: &Args) -> VerbResult {
    check_args(args)?;
    let results = ResultsDir::new(args).map_err(Failure::internal)?;
    let supervision = Supervision {
        lifeline: None,
        patience: SHUTDOWN_TIMEOUT,
        keeps_journal: !results.is_temporary,
    };
    let is_runner = Cell::new(false);
    let run = |guard| {
        is_runner.set(true);
        let request = request(args, &results.path)?;
        let planned = plan::plan(&request.tests)?;
        planned.print_warnings()?;
        let report = open_result_file(args, &results.path).transpose().map_err(|error| {
            Failure::input(error).hint("choose another path with `--output FILE`")
        })?;
        let prepared =
            preflight::prepare(&request, report.into_iter().collect(), |_, stdout, _| {
                Ok(vec![Box::new(ResultList::over(stdout, console_options(args)))])
            })?;
        run::run(&request, &planned, prepared, guard, &ResultTargets::default())
    };
    let outcome = guarded::run(supervision, run, |_, record| complete(args, &results.path, record));
    // The guard needs the journal until the runner has ended.
    if !is_runner.get() {
        results.remove_if_temporary();
    }
    outcome
}

/// The request. Its manifest has no inputs: `--rerun` cannot rerun the run.
fn request(args: &Args, results: &Path) -> Result<RunRequest, Failure> {
    let runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let options = Options {
        compatibility: Compatibility::Predecessor,
        recursive: args.recursive,
        param: args.param.clone(),
        environment: args.environment.clone(),
        repetitions: args.repetition.max(1),
        ..Options::new(runner, local_time::now().date())
    };
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, args.web_port));
    let revision = RevisionQuery::start(&options.runner.current_dir);
    Ok(RunRequest {
        tests: TestsRequest::new(args.inputs(), options, Manifest::default()),
        results: results.to_owned(),
        results_option: "the variable `RTF_RESULTS`",
        symlink: None,
        web: args.web_reporter.then(|| WebRequest {
            settings: web_settings(address, &WebAccessArgs::default()),
            hint: Some("choose another port with `--web-port N`"),
            linger: None,
        }),
        fork_mode: ForkMode::default(),
        max_fail: None,
        locks: LockOptions { dir: locks_dir(), limit: None },
        jobs: NonZeroU16::MIN,
        shutdown_timeout: SHUTDOWN_TIMEOUT,
        debug: None,
        attendance: Attendance::on_page(args.web_reporter, "there is no page"),
        database: history::default_database(results).into(),
        revision,
    })
}

/// Completes the result file and standard output after the runner died.
fn complete(args: &Args, results: &Path, record: &Record) {
    if let Some(file) = open_result_file(args, results) {
        reports::finish(file, record);
    }
    reports::finish(Ok(ResultList::stdout(console_options(args))), record);
}

fn console_options(args: &Args) -> ResultListOptions {
    ResultListOptions { verbose: args.verbose, detail: args.detail, summary: !args.no_summary }
}

/// Opens the result file of the run in `results`, unless the user wants none.
fn open_result_file(args: &Args, results: &Path) -> Option<Result<ReportFile, ReportError>> {
    let path = args.result_file()?;
    let (results, detail) = (results.to_owned(), args.detail);
    let journal = move |record: &Record| {
        let run = record.run.as_ref().map_or("", |started| &started.run);
        results.join(run).join(JOURNAL)
    };
    let (what, write): (_, WriteReport) = match args.output_type {
        OutputType::Text => (
            "the result file",
            Box::new(move |out, record| predecessor::write(out, &journal(record), detail)),
        ),
        OutputType::Junit => (
            "the JUnit report",
            Box::new(move |out, record| {
                predecessor::write_junit(out, record, &journal(record), detail)
            }),
        ),
    };
    Some(ReportFile::new(what, path, write))
}

/// The results directory.
struct ResultsDir {
    path: PathBuf,
    is_temporary: bool,
}

impl ResultsDir {
    fn new(args: &Args) -> io::Result<Self> {
        if args.no_output {
            let dir = tempfile::Builder::new().prefix(NAME).tempdir()?;
            return Ok(Self { path: dir.keep(), is_temporary: true });
        }
        let dir = std::env::var_os("RTF_RESULTS").filter(|dir| !dir.is_empty());
        let path = dir.map_or_else(|| PathBuf::from("rtf-results"), PathBuf::from);
        Ok(Self { path, is_temporary: false })
    }

    fn remove_if_temporary(&self) {
        if self.is_temporary {
            // A leftover is in the system's temporary directory.
            let _ = std::fs::remove_dir_all(&self.path);
        }
    }
}
