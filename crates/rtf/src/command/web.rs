//! The browser's view of a run: `--web`, and what `rtf serve` shares with it.

use std::io::Write;
use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

use rtf_engine::run::{Control, Stop, StopLevel};
use rtf_engine::signal::Signals;
use rtf_model::{SuiteId, TestId};
use rtf_report::console::RerunCommand;
use rtf_web::{BoundServer, Capabilities, Limits, Server, Service, Settings, WrongToken};
use tokio::sync::watch;

use crate::cli::WebAccessArgs;
use crate::error::Failure;

/// Who stops, in the words of verdicts.
const PERSON: &str = "a person, in the browser";

/// What may come from a browser into a run.
#[derive(Debug)]
pub struct Asks {
    /// The end of the run.
    pub stops: watch::Sender<Option<Stop>>,
    /// Everything else.
    pub controls: watch::Sender<Vec<Control>>,
    /// How long the end of the run may take.
    pub shutdown_timeout: Duration,
}

impl Asks {
    /// Nobody asks for anything yet.
    pub fn new(shutdown_timeout: Duration) -> Self {
        let (stops, controls) = (watch::channel(None).0, watch::channel(Vec::new()).0);
        Self { stops, controls, shutdown_timeout }
    }
}

impl Asks {
    /// Whether something else than the browser has ended the run.
    pub fn is_interrupted(&self) -> bool {
        self.stops.borrow().as_ref().is_some_and(|stop| stop.reason != PERSON)
    }
}

impl rtf_web::RunControl for Asks {
    fn stop_run(&self) {
        self.stops.send_if_modified(|stop| {
            // A signal that came before asks for as much, or for more.
            let first = stop.is_none();
            if first {
                let (level, limit) = (StopLevel::TearDown, self.shutdown_timeout);
                *stop = Some(Stop { level, reason: PERSON.to_owned(), limit });
            }
            first
        });
    }

    fn stop_test(&self, test: TestId) {
        let by = PERSON.to_owned();
        self.controls.send_modify(|asked| asked.push(Control::StopTest { test, by }));
    }

    fn skip_suite(&self, suite: SuiteId) {
        let by = PERSON.to_owned();
        self.controls.send_modify(|asked| asked.push(Control::SkipSuite { suite, by }));
    }
}

/// Takes the address, before anything is started.
pub fn bind(address: SocketAddr, args: &WebAccessArgs) -> Result<BoundServer, Failure> {
    let settings = Settings {
        address,
        allow_remote: args.web_allow_remote,
        token_file: args.web_token_file.clone(),
        tls: args.web_cert.clone().zip(args.web_key.clone()),
        hosts: args.web_hosts.clone(),
        limits: Limits::default(),
    };
    BoundServer::new(&settings).map_err(failed)
}

/// Takes a port of this machine alone, or the next one that is free.
pub fn bind_loopback(port: u16) -> Result<BoundServer, Failure> {
    let address = SocketAddr::from((std::net::Ipv4Addr::LOCALHOST, port));
    bind(address, &WebAccessArgs::default())
}

/// Serves, and says where.
pub fn serve(bound: BoundServer, results: &Path, role: Capabilities) -> Result<Server, Failure> {
    let server = {
        let (rerun, wrong_token) =
            (super::again::command as fn() -> RerunCommand, Box::new(report));
        bound.serve(Service { results, role, rerun, wrong_token }).map_err(failed)?
    };
    let mut err = anstream::stderr().lock();
    Failure::unless_reader_left(tell(&mut err, &server))?;
    Ok(server)
}

/// Serves on after the run, for this long or until a signal.
pub fn linger(server: &Server, time: Duration) -> Result<(), Failure> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(Failure::own)?.block_on(async {
        let mut signals = Signals::install().map_err(Failure::own)?;
        server.linger(time);
        let (bold, reset) = ("\u{1b}[1m", "\u{1b}[0m");
        // Whoever has left needs no word.
        let _ = writeln!(
            anstream::stderr(),
            "{bold}web{reset}: the run is over, and shown for {time:?} more, or until Ctrl-C"
        );
        tokio::select! {
            _ = signals.next() => {}
            () = tokio::time::sleep(time) => {}
        }
        Ok(())
    })
}

/// Reports that somebody sent a wrong token.
fn report(WrongToken { client, count }: WrongToken) {
    let (bold, reset) = ("\u{1b}[1m", "\u{1b}[0m");
    let times = if count > 1 { format!(", {count} times in a minute") } else { String::new() };
    // Whoever has left needs no word.
    let _ = writeln!(anstream::stderr(), "{bold}web{reset}: wrong token from {client}{times}");
}

fn failed(error: rtf_web::ServeError) -> Failure {
    let hint = error.hint().map(str::to_owned);
    Failure::input(error).hint(hint)
}

fn tell(err: &mut impl Write, server: &Server) -> std::io::Result<()> {
    let (bold, reset) = ("\u{1b}[1m", "\u{1b}[0m");
    if let Some(taken) = server.taken() {
        let port = server.address().port();
        writeln!(err, "{bold}web{reset}: port {taken} is taken, port {port} is used")?;
    }
    writeln!(err, "{bold}web{reset}: {}", server.url())?;
    if let Some(fingerprint) = server.fingerprint() {
        writeln!(
            err,
            "{bold}web{reset}: the certificate is signed by rtf itself, SHA-256 {fingerprint}"
        )?;
    }
    err.flush()
}
