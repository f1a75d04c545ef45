//! `rtf run`: plan, open the reports, run, report.

use std::sync::Arc;

use rtf_engine::guard::Link;
use rtf_engine::locks::LockOptions;
use rtf_report::Reporter;
use rtf_report::background_writer::BackgroundWriter;
use rtf_report::journal::Journal;
use rtf_report::logs::Logs;
use rtf_report::run_dir::{self, RunDir};
use rtf_web::{Capabilities, JournalNotifier, Server};

use super::job::Job;
use super::web::{self, Asks};
use super::{Outcome, list, locks, output, planning};
use crate::cli::{ListFormat, RunArgs};
use crate::error::Failure;

/// Runs, under a guard.
pub fn run(args: &RunArgs, guard: Link) -> Outcome {
    let planned = planning::plan(&args.input, &args.results)?;
    if args.dry_run {
        return list::show(&planned, ListFormat::Text);
    }
    output::check_reports(&args.reports)?;
    if let Some(option) = args.web.without_effect() {
        let what = format!("`{option}` has no effect without `--web`");
        return Err(Failure::input(what).hint("give `--web`, too".to_owned()));
    }
    let web = args.web.web.map(|address| web::bind(address, &args.web.access)).transpose()?;
    let folder = run_dir::create(&args.results.results).map_err(|error| {
        Failure::input(error).hint("choose another folder with `--results DIR`".to_owned())
    })?;
    let journal = Journal::create(&folder.journal()).map_err(Failure::input)?;
    let asks = Arc::new(Asks::new(args.shutdown_timeout));
    let role = Capabilities::Runner(folder.name.clone(), asks.clone());
    let web = web.map(|bound| web::serve(bound, &args.results.results, role)).transpose()?;
    let live = web.as_ref().map(Server::live);
    let outlet = output::outlet()?;
    let reporters = reporters(journal, live, args, (&folder, &outlet))?;
    let (forks, max_fail) = (args.fork, args.input.repeat.most_fails());
    let locks = LockOptions { dir: locks::folder(), limit: args.lock_timeout };
    let (planned, folder, asks, jobs, outlet) = (&planned, &folder, &asks, args.jobs, &outlet);
    let job = Job { planned, folder, forks, asks, max_fail, locks, jobs, outlet };
    let ended = job.perform(reporters, guard);
    if let (Some(server), Some(time)) = (&web, args.web.web_linger)
        && !asks.is_interrupted()
    {
        web::linger(server, time)?;
    }
    // What is wrong with the server is not the run's: `rtf serve` shows it again.
    drop(web.map(Server::stop));
    ended
}

fn reporters(
    journal: Journal,
    live: Option<JournalNotifier>,
    args: &RunArgs,
    (folder, outlet): (&RunDir, &BackgroundWriter),
) -> Result<Vec<Box<dyn Reporter>>, Failure> {
    let logs = Logs::new(&folder.path);
    let mut reporters: Vec<Box<dyn Reporter>> = vec![Box::new(journal), Box::new(logs)];
    // What is told to be in the journal and the logs is there.
    reporters.extend(live.map(|live| Box::new(live) as Box<dyn Reporter>));
    for (format, path) in &args.reports {
        reporters.push(output::open_report(*format, path, Some(&folder.path))?);
    }
    // What is shown comes last: what it names is there.
    reporters.extend(output::shown(args, &folder.path, outlet));
    Ok(reporters)
}
