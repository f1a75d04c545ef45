//! Request → everything that a run writes to and serves, before the first process
//! starts: reports, web server, run directory, journal.

use std::sync::Arc;

use rtf_report::background_writer::BackgroundWriter;
use rtf_report::episode_results::EpisodeResults;
use rtf_report::journal::Journal;
use rtf_report::logs::Logs;
use rtf_report::run_dir::{self, RunDir};
use rtf_report::{ReportFile, Reporter};
use rtf_web::{Capabilities, WebServer};

use crate::control::ControlChannels;
use crate::error::Failure;
use crate::request::{RunRequest, WebRequest};
use crate::web::{self, Served};

/// The outputs of a run, and requests to it.
pub struct Prepared {
    pub dir: RunDir,
    /// The reporters, in the order in which they receive an event.
    pub reporters: Vec<Box<dyn Reporter>>,
    pub stdout: BackgroundWriter,
    pub server: Option<WebServer>,
    pub control: Arc<ControlChannels>,
}

/// Prepares a run. `reports` are open; `console` creates the reporters that print.
pub fn prepare(
    request: &RunRequest,
    reports: Vec<ReportFile>,
    console: impl FnOnce(
        &RunDir,
        &BackgroundWriter,
        &Arc<ControlChannels>,
    ) -> Result<Vec<Box<dyn Reporter>>, Failure>,
) -> Result<Prepared, Failure> {
    let bind =
        |web: &WebRequest| web::bind(&web.settings).map_err(|failure| failure.maybe_hint(web.hint));
    let bound = request.web.as_ref().map(bind).transpose()?;
    let dir = run_dir::create(&request.results).map_err(|error| {
        let hint = format!("choose another directory with {}", request.results_option);
        Failure::input(error).hint(hint)
    })?;
    if let Some(link) = &request.symlink {
        run_dir::link(&dir, link).map_err(|error| {
            // Nothing will run: remove the empty directory.
            drop(std::fs::remove_dir(&dir.path));
            Failure::input(error).hint("choose another path with `--symlink PATH`")
        })?;
    }
    let journal = Journal::create(&dir.journal()).map_err(Failure::input)?;
    let control = Arc::new(ControlChannels::new(request.shutdown_timeout));
    let role = Capabilities::Runner(dir.name.clone(), control.clone());
    let history = request.database.clone();
    let served = Served { results: &request.results, history, metrics: false, role };
    let server = bound.map(|bound| web::serve(bound, served)).transpose()?;
    let stdout = BackgroundWriter::new(Box::new(std::io::stdout())).map_err(Failure::internal)?;
    // Others refer to what the journal and the logs contain, so these come first.
    let mut reporters: Vec<Box<dyn Reporter>> =
        vec![Box::new(journal), Box::new(Logs::new(&dir.path))];
    if !request.tests.episodes.is_empty() {
        reporters.push(Box::new(EpisodeResults::create(&dir.path).map_err(Failure::input)?));
    }
    reporters.extend(server.as_ref().map(|server| Box::new(server.live()) as Box<dyn Reporter>));
    reporters.extend(reports.into_iter().map(|report| Box::new(report) as Box<dyn Reporter>));
    reporters.extend(console(&dir, &stdout, &control)?);
    Ok(Prepared { dir, reporters, stdout, server, control })
}
