//! Who may do what: the token, sessions of browsers, and the two headers that
//! tell where a request comes from and what it believes to speak to.
//!
//! [`guard`] stands before every route.

mod guesses;
mod host_header;
mod secret;

use std::io;
use std::net::IpAddr;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};

use axum::body::Body;
use axum::extract::{ConnectInfo, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

pub use host_header::{Hosts, machine};
pub use secret::{Secret, TokenError};

use crate::address::API;
use crate::connections::Peer;
use crate::problem::Problem;

use guesses::Guesses;

/// The largest body of a request: a token and some room.
const BODY: usize = 4096;

/// Who makes a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who {
    /// An unknown client.
    Nobody,
    /// A program with the token.
    Token,
    /// A browser with a session.
    Session,
}

/// What holds for all requests.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Whether other machines may connect: reading then needs the token, too.
    pub remote: bool,
    pub tls: bool,
}

/// Who may do what.
#[derive(Debug)]
pub struct Access {
    token: Secret,
    session: Secret,
    cookie: String,
    hosts: Hosts,
    rules: Rules,
    guesses: Guesses,
    log: AccessLog,
}

/// Maximum number of pending reports; further ones are dropped.
const REPORTS: usize = 16;

/// Reports wrong tokens.
#[derive(Debug)]
pub struct AccessLog(SyncSender<WrongToken>);

impl AccessLog {
    /// Reports in a separate thread, because writing a report may block.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn start(report: impl Fn(WrongToken) + Send + 'static) -> io::Result<Self> {
        let (sender, reports) = sync_channel(REPORTS);
        let write = move || reports.iter().for_each(report);
        std::thread::Builder::new().name("web-log".into()).spawn(write)?;
        Ok(Self(sender))
    }

    fn report(&self, wrong: WrongToken) {
        // The count in the next report includes dropped ones.
        let _ = self.0.try_send(wrong);
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrongToken {
    pub client: IpAddr,
    /// Recent number of wrong tokens of this client.
    pub count: u64,
}

impl Access {
    /// The rules of a server.
    ///
    /// # Errors
    /// The system has no random bytes.
    pub fn new(
        token: Secret,
        hosts: Hosts,
        rules: Rules,
        log: AccessLog,
    ) -> Result<Self, TokenError> {
        let (cookie, session) = (format!("rtf-{}", hosts.port()), Secret::random()?);
        Ok(Self { token, session, cookie, hosts, rules, guesses: Guesses::default(), log })
    }

    #[must_use]
    pub fn token_to_read(&self) -> bool {
        self.rules.remote
    }

    /// Whether this is the token. After a wrong one, the client waits and the log has a line.
    async fn is_token(&self, client: IpAddr, guess: &str) -> bool {
        let Err(count) = self.guesses.attempt(client, || self.token.is(guess)).await else {
            return true;
        };
        // The first one is worth a line, and then ever fewer.
        if count.is_power_of_two() {
            self.log.report(WrongToken { client, count });
        }
        false
    }

    async fn who(&self, client: IpAddr, headers: &HeaderMap) -> Who {
        let text = |value: &HeaderValue| value.to_str().ok().map(str::to_owned);
        let bearer = headers.get(header::AUTHORIZATION).and_then(text);
        let bearer = bearer.as_deref().and_then(|value| value.strip_prefix("Bearer "));
        if let Some(token) = bearer
            && self.is_token(client, token.trim()).await
        {
            return Who::Token;
        }
        let cookies = headers.get_all(header::COOKIE).iter().filter_map(text);
        let mut pairs = cookies.flat_map(|line| {
            line.split(';').map(|pair| pair.trim().to_owned()).collect::<Vec<_>>()
        });
        let is_ours = |pair: String| {
            pair.split_once('=')
                .is_some_and(|(name, value)| name == self.cookie && self.session.is(value))
        };
        if pairs.any(is_ours) { Who::Session } else { Who::Nobody }
    }

    /// The cookie of a session of a client with the token.
    pub async fn open_session(&self, client: IpAddr, token: &str) -> Option<HeaderValue> {
        let is_token = self.is_token(client, token).await;
        is_token.then(|| self.cookie(self.session.text(), ""))
    }

    /// The cookie that ends a session.
    #[must_use]
    pub fn closed_session(&self) -> HeaderValue {
        self.cookie("", "; Max-Age=0")
    }

    fn cookie(&self, value: &str, more: &str) -> HeaderValue {
        let secure = if self.rules.tls { "; Secure" } else { "" };
        let cookie =
            format!("{}={value}; HttpOnly; SameSite=Strict; Path=/{secure}{more}", self.cookie);
        HeaderValue::from_str(&cookie).unwrap_or(HeaderValue::from_static("rtf="))
    }

    /// Finds out who makes the request, and whether that is allowed.
    async fn check(&self, client: IpAddr, request: &mut Request) -> Result<(), Problem> {
        let host = self.hosts.check(request.uri(), request.headers())?;
        let headers = request.headers().clone();
        let who = self.who(client, &headers).await;
        request.extensions_mut().insert(who);
        let path = request.uri().path();
        if !request.method().is_safe() {
            self.check_change(request, &host, who)?;
        }
        let is_open = path == API || is_session(path) || !is_data(path);
        if self.rules.remote && who == Who::Nobody && !is_open {
            return Err(unauthorised("reading from beyond this machine needs the token"));
        }
        Ok(())
    }

    fn check_change(&self, request: &Request, host: &str, who: Who) -> Result<(), Problem> {
        let headers = request.headers();
        let foreign = || {
            let detail = "a page of another origin may not change anything here";
            Problem::new(StatusCode::FORBIDDEN, detail)
        };
        match headers.get(header::ORIGIN) {
            Some(origin) if !host_header::is_origin_of(origin, host, self.rules.tls) => {
                return Err(foreign());
            }
            Some(_) => {}
            // Browsers always tell; a cookie alone proves nothing.
            None if who == Who::Session => return Err(foreign()),
            None => {}
        }
        let site = headers.get("sec-fetch-site").map(HeaderValue::as_bytes);
        if site.is_some_and(|site| site != b"same-origin" && site != b"none") {
            return Err(foreign());
        }
        let path = request.uri().path();
        if who == Who::Nobody && !is_session(path) && is_data(path) && is_known(request.method()) {
            return Err(unauthorised("control needs the token"));
        }
        let length = headers.get(header::CONTENT_LENGTH).and_then(|l| l.to_str().ok());
        let has_body = length.is_some_and(|length| length != "0")
            || headers.contains_key(header::TRANSFER_ENCODING);
        let kind = headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
        let is_json = |kind: &str| {
            kind.split(';')
                .next()
                .is_some_and(|k| k.trim().eq_ignore_ascii_case("application/json"))
        };
        // A form of another site cannot send JSON without asking first.
        if (has_body || kind.is_some()) && !kind.is_some_and(is_json) {
            let detail = "a body is taken as `application/json` only";
            return Err(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, detail));
        }
        if length.and_then(|length| length.parse::<usize>().ok()).is_some_and(|l| l > BODY) {
            return Err(Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "the body is too long"));
        }
        Ok(())
    }
}

fn unauthorised(detail: &str) -> Problem {
    let hint = "send `Authorization: Bearer TOKEN`, or open a session; the token is part of the \
                address that was printed at the start";
    Problem::new(StatusCode::UNAUTHORIZED, detail).hint(hint)
}

fn is_session(path: &str) -> bool {
    path.strip_prefix(API) == Some("/session")
}

/// Methods that some route has; the others are refused by all.
fn is_known(method: &Method) -> bool {
    [Method::POST, Method::DELETE].contains(method)
}

/// Whether this path may lead to what was tested; the page itself and the API's
/// description hold none of it. Whole routes are compared: parts of a path are the
/// names of runs and files, which may be anything.
fn is_data(path: &str) -> bool {
    let below = |root: &str| path.strip_prefix(root).filter(|rest| !is_name(rest));
    let in_api = below("/api").is_some();
    let is_description = path.strip_prefix(API) == Some("/openapi.json");
    let is_viewer = path == "/api/docs";
    in_api && !is_description && !is_viewer
        || below("/status").is_some()
        || below("/update").is_some()
        || below("/metrics").is_some()
}

/// Whether this continues a name: `/api` is not a prefix of `/apiary`.
fn is_name(rest: &str) -> bool {
    !rest.is_empty() && !rest.starts_with('/')
}

/// Lets through what is allowed.
pub async fn guard(
    State(access): State<Arc<Access>>,
    ConnectInfo(Peer(client)): ConnectInfo<Peer>,
    mut request: Request<Body>,
    next: Next,
) -> Response {
    match access.check(client.ip(), &mut request).await {
        Ok(()) => next.run(request).await,
        Err(problem) => problem.into_response(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_routes_need_no_token() {
        for open in ["/", "/assets/x.js", "/api/docs", "/api/v1/openapi.json", "/apiary"] {
            assert!(!is_data(open), "{open}");
        }
        for data in [
            "/api",
            "/api/v1",
            "/api/v1/runs/own/files/attachments/openapi.json",
            "/api/v1/runs/openapi.json",
            "/api/v1//openapi.json",
            "/api/v1/openapi.json/",
            "/api/v2/anything",
            "/status",
            "/status/",
            "/update",
            "/metrics",
        ] {
            assert!(is_data(data), "{data}");
        }
    }
}
