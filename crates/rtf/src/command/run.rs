//! `rtf run`: plan, open the reports, run, report.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use rtf_engine::guard::Link;
use rtf_engine::run::{RunOptions, Sink, Stop, execute};
use rtf_engine::signal;
use rtf_model::{EVENTS_VERSION, Event, RunStarted};
use rtf_report::console::{Console, ConsoleOptions, Verbosity};
use rtf_report::journal::Journal;
use rtf_report::junit::JunitFile;
use rtf_report::logs::Logs;
use rtf_report::run_folder::{self, RunFolder};
use rtf_report::text::TextFile;
use rtf_report::{Fanout, FanoutHandle, ReportError, Reporter};
use tokio::sync::watch;

use super::planning::{self, Planned};
use super::{Outcome, again};
use crate::cli::{Format, RunArgs};
use crate::error::Failure;
use crate::exit;

const REPORT_HINT: &str = "choose another path with `--report FORMAT=PATH`";

/// Runs, under a guard.
pub fn run(args: &RunArgs, guard: Link) -> Outcome {
    let planned = planning::plan(&args.input)?;
    check_reports(&args.reports)?;
    let folder = run_folder::create(&args.results.results).map_err(|error| {
        Failure::input(error).hint("choose another folder with `--results DIR`".to_owned())
    })?;
    let fanout = Fanout::start(reporters(args, &folder)?).map_err(Failure::own)?;
    let guard = Arc::new(guard);
    let ended = run_plan(&planned, &folder, fanout.handle(), guard.clone());
    let finished = fanout.join();
    let killed_by = ended.map_err(Failure::own)?;
    let wrote_all = finished.errors.is_empty();
    for error in finished.errors {
        Failure::own(error).show();
    }
    Ok(match killed_by {
        Some(signal) => ExitCode::from(u8::try_from(128 + signal).unwrap_or(exit::FAILED)),
        None if wrote_all => exit::of_run(&finished.record),
        None => ExitCode::from(exit::BROKEN),
    })
}

fn reporters(args: &RunArgs, folder: &RunFolder) -> Result<Vec<Box<dyn Reporter>>, Failure> {
    let options = ConsoleOptions {
        verbosity: if args.verbose { Verbosity::Verbose } else { Verbosity::Normal },
        folder: Some(folder.path.clone()),
        rerun: again::command(),
        ..ConsoleOptions::default()
    };
    let mut reporters: Vec<Box<dyn Reporter>> = vec![
        Box::new(Journal::create(&folder.journal()).map_err(Failure::input)?),
        Box::new(Logs::new(&folder.path)),
    ];
    for (format, path) in &args.reports {
        reporters.push(open_report(*format, path, Some(&folder.path))?);
    }
    // The console comes last: what it names is there.
    reporters.push(Box::new(Console::stdout(options)));
    Ok(reporters)
}

/// Finds out before anything is started whether the reports can be written.
fn check_reports(reports: &[(Format, PathBuf)]) -> Result<(), Failure> {
    for (index, (format, path)) in reports.iter().enumerate() {
        if reports[..index].iter().any(|(_, earlier)| earlier == path) {
            let message = format!("two reports would be written to `{}`", path.display());
            return Err(Failure::input(message).hint(REPORT_HINT.to_owned()));
        }
        open_report(*format, path, None)?;
    }
    Ok(())
}

/// Opens a report's file.
pub fn open_report(
    format: Format,
    path: &Path,
    folder: Option<&Path>,
) -> Result<Box<dyn Reporter>, Failure> {
    let report: Result<Box<dyn Reporter>, ReportError> = match format {
        Format::Text => TextFile::new(path).map(|report| Box::new(report) as _),
        Format::Junit => JunitFile::new(path, folder).map(|report| Box::new(report) as _),
    };
    report.map_err(|error| Failure::input(error).hint(REPORT_HINT.to_owned()))
}

/// Runs the plan; `Some` with the signal that ended `rtf` the hard way.
fn run_plan(
    planned: &Planned,
    folder: &RunFolder,
    events: FanoutHandle,
    guard: Arc<Link>,
) -> std::io::Result<Option<i32>> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let (stops, stopped) = watch::channel(None::<Stop>);
    let options = RunOptions {
        started: started(planned, folder)?,
        warnings: planned.warnings.clone(),
        journal: folder.journal().canonicalize()?,
        folder: folder.path.canonicalize()?,
        guard: guard.clone(),
    };
    let sink: Arc<dyn Sink> = Arc::new(Reports(events));
    runtime.block_on(async {
        tokio::select! {
            biased;
            signal = signal::forward(&stops, &guard) => signal.map(Some),
            done = execute(&planned.plan, options, sink, stopped) => done.map(|()| None),
        }
    })
}

fn started(planned: &Planned, folder: &RunFolder) -> std::io::Result<RunStarted> {
    Ok(RunStarted {
        version: EVENTS_VERSION,
        run: folder.name.clone(),
        rtf: env!("CARGO_PKG_VERSION").to_owned(),
        started_at: folder.started_at.clone(),
        command: std::env::args_os().map(|arg| arg.to_string_lossy().into_owned()).collect(),
        folder: std::env::current_dir()?.to_string_lossy().into_owned(),
        suites: u32::try_from(planned.plan.suites.len()).unwrap_or(u32::MAX),
        tests: planned.plan.tests,
    })
}

/// The way of a run's events to the reporters.
#[derive(Debug)]
struct Reports(FanoutHandle);

impl Sink for Reports {
    fn emit(&self, event: Event) {
        self.0.send(event);
    }

    fn is_congested(&self) -> bool {
        self.0.is_congested()
    }
}
