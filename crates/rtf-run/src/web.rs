//! The web server of `rtf run --web` and `rtf serve`.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use rtf_engine::signal::SignalListener;
use rtf_history::Location;
use rtf_report::console::TestCommands;
use rtf_web::{BoundServer, Capabilities, ServeError, Service, Settings, WebServer, WrongToken};

use crate::campaign::report::ServedCampaigns;
use crate::error::Failure;
use crate::history::ServedHistory;
use crate::{rerun_command, terminal};

const LABEL: &str = "\u{1b}[1mweb\u{1b}[0m";

/// Binds the address.
pub fn bind(settings: &Settings) -> Result<BoundServer, Failure> {
    BoundServer::new(settings).map_err(failure)
}

/// What is served.
pub struct Served<'a> {
    /// The results directory.
    pub results: &'a Path,
    /// The database of the history, which may not exist.
    pub history: Location,
    /// Whether `/metrics` shows it.
    pub metrics: bool,
    /// What the server can do.
    pub role: Capabilities,
}

/// Starts the server and prints its address.
pub fn serve(bound: BoundServer, served: Served<'_>) -> Result<WebServer, Failure> {
    let Served { results, history, metrics, role } = served;
    let history = Arc::new(ServedHistory { database: history });
    let campaigns = Arc::new(ServedCampaigns { results: results.to_owned() });
    let commands: fn() -> TestCommands = rerun_command::for_tests;
    let wrong_token = Box::new(report_wrong_token);
    let server = bound
        .serve(Service { results, history, campaigns, metrics, role, commands, wrong_token })
        .map_err(failure)?;
    terminal::stderr(|err| {
        if let Some(taken) = server.taken() {
            let port = server.address.port();
            writeln!(err, "{LABEL}: port {taken} is in use, using port {port}")?;
        }
        writeln!(err, "{LABEL}: {}", server.url())?;
        match &server.fingerprint {
            Some(sha) => writeln!(err, "{LABEL}: self-signed certificate, SHA-256 {sha}"),
            None => Ok(()),
        }
    })?;
    Ok(server)
}

/// Continues to serve for this time or until a signal, which may have arrived while the reports
/// were written.
pub async fn linger(server: &WebServer, time: Duration, signals: &mut SignalListener) {
    server.linger(time);
    terminal::notice(format_args!(
        "{LABEL}: the run has finished; serving it for {time:?}, or until Ctrl-C"
    ));
    tokio::select! {
        biased;
        _ = signals.next() => {}
        () = tokio::time::sleep(time) => {}
    }
}

fn report_wrong_token(WrongToken { client, count }: WrongToken) {
    let times = if count > 1 { format!(", {count} times in a minute") } else { String::new() };
    terminal::notice(format_args!("{LABEL}: wrong token from {client}{times}"));
}

fn failure(error: ServeError) -> Failure {
    let hint = error.hint();
    Failure::input(error).maybe_hint(hint)
}
