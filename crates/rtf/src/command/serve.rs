//! `rtf serve`: shows active and past runs in a browser until a signal ends it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use clap::ArgMatches;
use rtf_engine::signal::SignalListener;
use rtf_report::run_dir::JOURNAL;
use rtf_run::error::Failure;
use rtf_run::reruns::Reruns;
use rtf_run::web::{self, Served};
use rtf_run::{exit, history, terminal};
use rtf_web::{Capabilities, ShutdownHandle};

use super::VerbResult;
use crate::cli::ServeArgs;
use crate::request::{config, web_settings};

/// Serves runs.
pub fn run(mut args: ServeArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_history(&mut args.results, &mut args.history, matches)?;
    if let Some(dir) = args.dir {
        args.results.results = results_of(dir);
    }
    let results = &args.results.results;
    if !results.is_dir() {
        let error = format!("there is no results directory `{}`", results.display());
        let hint = "choose another directory with `--results DIR`, or run something first";
        return Err(Failure::input(error).hint(hint));
    }
    let history = history::resolve(args.history.history.as_deref(), results)?;
    let bound = web::bind(&web_settings(args.web, &args.access))?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(Failure::internal)?;
    let reruns = Arc::new(Reruns::new(results.canonicalize().map_err(Failure::internal)?));
    // From now on, a signal also ends the reruns.
    let signals = {
        let _context = runtime.enter();
        SignalListener::install().map_err(Failure::internal)?
    };
    let role = Capabilities::Viewer(reruns.clone());
    let server = web::serve(bound, Served { results, history, metrics: args.web_metrics, role })?;
    let ender = server.ender();
    let signals_thread = std::thread::Builder::new()
        .name("signals".into())
        .spawn(move || runtime.block_on(end_on_signal(signals, &reruns, ender)));
    let signals_thread = signals_thread.map_err(Failure::internal)?;
    server.wait().map_err(Failure::internal)?;
    // Only this thread ends the server.
    Ok(ExitCode::from(signals_thread.join().unwrap_or(exit::BROKEN)))
}

/// The results directory that a user names, also by one of its runs.
fn results_of(dir: PathBuf) -> PathBuf {
    if !dir.join(JOURNAL).is_file() {
        return dir;
    }
    // `latest` is a link.
    let run = dir.canonicalize().ok();
    run.and_then(|run| run.parent().map(Path::to_path_buf)).unwrap_or(dir)
}

/// Waits for a signal, ends the active rerun and then the server, and returns the exit
/// code.
async fn end_on_signal(mut signals: SignalListener, reruns: &Reruns, ender: ShutdownHandle) -> u8 {
    let (number, _) = signals.next().await;
    let mut active = reruns.end(number);
    while let Some(name) = active {
        terminal::notice(format_args!("rtf serve: waiting for the run {name} to end"));
        tokio::select! {
            () = reruns.wait_until_idle() => break,
            (number, _) = signals.next() => active = reruns.end(number),
        }
    }
    ender.end();
    exit::of_signal(number)
}
