//! The server: its address, its thread, its end.

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use axum_server::tls_rustls::RustlsAcceptor;
use axum_server::{Handle, Server as HttpServer};
use hyper_util::rt::TokioTimer;
use tokio::sync::watch;

use crate::access::{self, Hosts, Rules, Secret};
use crate::app::App;
use crate::connections::{Limits, Listener, Peer};
use crate::journal_notifier::JournalNotifier;
use crate::routes::{Prepared, Routes, router};
use crate::service::{ServeError, Service, Settings};
use crate::tls::{self, Tls};

/// How many ports are tried when the first one is taken.
const PORTS: u16 = 50;
/// How long browsers have to take what was sent last.
const PARTING: Duration = Duration::from_millis(500);
/// How many requests one connection may have at the same time with HTTP/2.
const HTTP2_STREAMS: u32 = 32;
/// How nice this server's threads are to those that run tests.
const NICE: i32 = 10;

/// A server that has its address.
#[derive(Debug)]
pub struct BoundServer {
    listener: TcpListener,
    address: SocketAddr,
    wanted: SocketAddr,
    token: Secret,
    tls: Option<Tls>,
    hosts: Hosts,
    rules: Rules,
    limits: Limits,
}

/// A server that runs.
#[derive(Debug)]
pub struct WebServer {
    pub address: SocketAddr,
    wanted: SocketAddr,
    token: String,
    /// The SHA-256 of the certificate, when this server signed it itself.
    pub fingerprint: Option<String>,
    tls: bool,
    ending: watch::Sender<bool>,
    grown: watch::Sender<u64>,
    lingers: Arc<OnceLock<Instant>>,
    thread: JoinHandle<io::Result<()>>,
}

impl BoundServer {
    /// Binds the address. Clients wait until [`BoundServer::serve`].
    ///
    /// # Errors
    /// The settings do not allow it, or the system does not.
    pub fn new(settings: &Settings) -> Result<Self, ServeError> {
        let Settings { address: wanted, allow_remote: remote, .. } = *settings;
        if !wanted.ip().is_loopback() && !remote {
            return Err(ServeError::Remote(wanted.ip()));
        }
        let token = match &settings.token_file {
            Some(path) => Secret::read(path)?,
            None => Secret::random()?,
        };
        let tls = match &settings.tls {
            Some((certificate, key)) => Some(tls::given(certificate, key)?),
            None if remote => {
                let names = [access::machine(), format!("{}.local", access::machine())];
                let names: Vec<_> = settings.hosts.iter().cloned().chain(names).collect();
                Some(tls::self_signed(wanted.ip(), &names)?)
            }
            None => None,
        };
        let listener = listen(wanted)?;
        let address = listener.local_addr().map_err(ServeError::Start)?;
        let hosts = Hosts::new(address, remote, &settings.hosts);
        let (rules, limits) = (Rules { remote, tls: tls.is_some() }, settings.limits);
        Ok(Self { listener, address, wanted, token, tls, hosts, rules, limits })
    }

    /// Serves in a separate thread.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn serve(self, service: Service<'_>) -> Result<WebServer, ServeError> {
        let Self { listener, address, wanted, token, tls, hosts, rules, limits } = self;
        let shown = token.text().to_owned();
        let Prepared { app, ending, grown } =
            Prepared::new((token, hosts, rules), limits, service)?;
        let lingers = app.lingers.clone();
        let fingerprint = tls.as_ref().and_then(|tls| tls.fingerprint.clone());
        let run = move || serve(listener, limits, tls, app);
        let thread = std::thread::Builder::new().name("web".into()).spawn(run);
        Ok(WebServer {
            address,
            wanted,
            token: shown,
            fingerprint,
            tls: rules.tls,
            ending,
            grown,
            lingers,
            thread: thread.map_err(ServeError::Start)?,
        })
    }

    /// Answers requests without connections: for tests with arbitrary requests.
    ///
    /// # Errors
    /// The thread that reports wrong tokens cannot be started.
    pub fn without_connections(self, service: Service<'_>) -> Result<Routes, ServeError> {
        let token = self.token.text().to_owned();
        let access = (self.token, self.hosts, self.rules);
        let Prepared { app, ending, grown } = Prepared::new(access, self.limits, service)?;
        let (router, senders) = (router(app), (ending, grown));
        Ok(Routes { router, token, address: self.address, _senders: senders })
    }
}

/// Ends a server that another thread waits for.
#[derive(Debug)]
pub struct ShutdownHandle(watch::Sender<bool>);

impl ShutdownHandle {
    /// Sends the remaining events to the listeners; the server ends then.
    pub fn end(self) {
        self.0.send_replace(true);
    }
}

impl WebServer {
    /// The address to open, with the token.
    #[must_use]
    pub fn url(&self) -> String {
        let scheme = if self.tls { "https" } else { "http" };
        let (ip, port) = (self.address.ip(), self.address.port());
        // A browser cannot open the unspecified address.
        let host = match ip {
            ip if ip.is_unspecified() => access::machine(),
            IpAddr::V4(ip) => ip.to_string(),
            IpAddr::V6(ip) => format!("[{ip}]"),
        };
        format!("{scheme}://{host}:{port}/#token={}", self.token)
    }

    /// The port that was asked for, when it was taken.
    #[must_use]
    pub fn taken(&self) -> Option<u16> {
        let wanted = self.wanted.port();
        (wanted != 0 && wanted != self.address.port()).then_some(wanted)
    }

    /// The reporter of the run that is served live.
    #[must_use]
    pub fn live(&self) -> JournalNotifier {
        JournalNotifier { grown: self.grown.clone() }
    }

    /// Announces that the run has ended, and that the server stays for this time.
    pub fn linger(&self, time: Duration) {
        // The first word is the last one.
        let _ = self.lingers.set(Instant::now() + time);
    }

    /// What ends it from another thread.
    #[must_use]
    pub fn ender(&self) -> ShutdownHandle {
        ShutdownHandle(self.ending.clone())
    }

    /// Waits until the server ends, which it does not by itself.
    ///
    /// # Errors
    /// Why it ended.
    pub fn wait(self) -> io::Result<()> {
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the server panicked")))
    }

    /// Sends the remaining events to the listeners, and ends.
    ///
    /// # Errors
    /// Why it had ended before.
    pub fn stop(self) -> io::Result<()> {
        self.ender().end();
        self.wait()
    }
}

/// Listens on the address, or on the next port that is free.
fn listen(wanted: SocketAddr) -> Result<TcpListener, ServeError> {
    let mut address = wanted;
    loop {
        match TcpListener::bind(address) {
            Ok(listener) => return Ok(listener),
            Err(error)
                if error.kind() == io::ErrorKind::AddrInUse
                    && address.port() < wanted.port().saturating_add(PORTS)
                    && address.port() < u16::MAX =>
            {
                address.set_port(address.port() + 1);
            }
            Err(source) => return Err(ServeError::Listen { address, source }),
        }
    }
}

fn serve(listener: TcpListener, limits: Limits, tls: Option<Tls>, app: App) -> io::Result<()> {
    give_way();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .thread_name("web-read")
        .max_blocking_threads(4)
        .on_thread_start(give_way)
        .build()?;
    let service = runtime.block_on(async {
        let handle = Handle::new();
        let mut ending = app.ending.clone();
        let parting = handle.clone();
        tokio::spawn(async move {
            // An error means that no handle can end the server any more.
            let _ = ending.wait_for(|ending| *ending).await;
            parting.graceful_shutdown(Some(PARTING));
        });
        // The page asks for the newest run first: its journal is read while a browser starts. The first client
        // that reads it waits for the end of that.
        let runs = app.runs.clone();
        tokio::task::spawn_blocking(move || runs.read_ahead());
        let service = router(app).into_make_service_with_connect_info::<Peer>();
        let listener = Listener::new(listener, limits)?;
        let mut server = HttpServer::<Peer>::from_listener(listener).handle(handle);
        let builder = server.http_builder();
        builder.http1().timer(TokioTimer::new()).header_read_timeout(limits.head);
        builder.http2().max_concurrent_streams(HTTP2_STREAMS);
        match tls {
            Some(tls) => server.acceptor(RustlsAcceptor::new(tls.config)).serve(service).await,
            None => server.serve(service).await,
        }
    });
    runtime.shutdown_background();
    service
}

/// Lets the threads of the run go first, where the processor is short.
fn give_way() {
    // On Linux this is about the calling thread alone. A system that does not allow it serves as
    // well.
    let _ = rustix::process::setpriority_process(None, NICE);
}
